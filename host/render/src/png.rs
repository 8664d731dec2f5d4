//! PNG files: 8-bit RGB, not interlaced.

use std::{
    fs::File,
    io::{BufReader, BufWriter},
    path::Path,
};

use crate::{canvas::Canvas, file::FileError};

/// Writes `canvas` to `path`, replacing what was there.
///
/// # Errors
/// If the file cannot be made or written, or the canvas has no pixel.
pub fn write(path: impl AsRef<Path>, canvas: &Canvas) -> Result<(), FileError> {
    let path = path.as_ref();
    encode(path, canvas).map_err(|error| FileError::new(path, &error))
}

/// Reads a picture of 8-bit RGB from `path`.
///
/// # Errors
/// If the file cannot be read, or is no PNG of 8-bit RGB.
pub fn read(path: impl AsRef<Path>) -> Result<Canvas, FileError> {
    let path = path.as_ref();
    decode(path)
        .map_err(|error| FileError::new(path, &error))?
        .ok_or_else(|| FileError::new(path, &"not a picture of 8-bit RGB"))
}

fn encode(path: &Path, canvas: &Canvas) -> Result<(), ::png::EncodingError> {
    let file = BufWriter::new(File::create(path)?);
    let mut encoder = ::png::Encoder::new(file, canvas.width() as u32, canvas.height() as u32);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(canvas.rgb())?;
    writer.finish()
}

fn decode(path: &Path) -> Result<Option<Canvas>, ::png::DecodingError> {
    let mut reader = ::png::Decoder::new(BufReader::new(File::open(path)?)).read_info()?;
    let mut rgb = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let frame = reader.next_frame(&mut rgb)?;
    let is_rgb =
        frame.color_type == ::png::ColorType::Rgb && frame.bit_depth == ::png::BitDepth::Eight;
    Ok(is_rgb.then(|| Canvas::from_rgb(frame.width as usize, frame.height as usize, rgb)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let path = std::env::temp_dir().join(format!("cauldron-png-{}.png", std::process::id()));
        let canvas = Canvas::from_rgb(5, 3, (0..45).collect());
        write(&path, &canvas).unwrap();
        assert_eq!(read(&path).unwrap(), canvas);
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn an_error_names_the_file_and_the_reason() {
        let error = read("no/such/file.png").unwrap_err().to_string();
        assert!(error.starts_with("no/such/file.png: ") && error.len() > 20, "{error}");
        assert!(write("no/such/file.png", &Canvas::new(1, 1, [0; 3])).is_err());
    }
}
