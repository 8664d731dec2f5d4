//! SVG files: plots whose words stay words and whose lines stay sharp at any size.

use std::{fs, path::Path};

use crate::file::FileError;

/// Writes a document, for instance that of [`crate::Plot::svg`], to `path`, replacing what was
/// there.
///
/// # Errors
/// If the file cannot be made or written.
pub fn write(path: impl AsRef<Path>, document: &str) -> Result<(), FileError> {
    let path = path.as_ref();
    fs::write(path, document).map_err(|error| FileError::new(path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_names_the_file_and_the_reason() {
        let error = write("no/such/file.svg", "<svg/>").unwrap_err().to_string();
        assert!(error.starts_with("no/such/file.svg: ") && error.len() > 20, "{error}");
    }
}
