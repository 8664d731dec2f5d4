//! Wavefront OBJ: points and polygons, nothing else of it.

use glam::Vec3;

use super::mesh::Soup;

/// The triangles of a file.
///
/// # Errors
/// The line, from 1, and what is wrong with it.
pub(super) fn read(bytes: &[u8]) -> Result<Soup, (usize, String)> {
    let text = String::from_utf8_lossy(bytes);
    let (mut points_m, mut triangles) = (Vec::new(), Vec::new());
    for (line, text) in text.lines().enumerate() {
        let at = |what| (line + 1, what);
        let mut words = text.split_whitespace();
        match words.next() {
            Some("v") => points_m.push(point(words).map_err(at)?),
            Some("f") => {
                let corner = |word| corner(word, points_m.len());
                let corners: Vec<u32> = words.map(corner).collect::<Result<_, _>>().map_err(at)?;
                if corners.len() < 3 {
                    return Err(at(format!("a face has {} corners, not 3 or more", corners.len())));
                }
                triangles.extend(corners[1..].windows(2).map(|c| [corners[0], c[0], c[1]]));
            }
            _ => {}
        }
    }
    Ok((points_m, triangles))
}

fn point<'a>(words: impl Iterator<Item = &'a str>) -> Result<Vec3, String> {
    let mut at = [0.0; 3];
    let mut found = 0;
    // A fourth number is a weight, further ones a colour.
    for (to, word) in at.iter_mut().zip(words) {
        *to = word.parse().map_err(|_| format!("'{word}' is not a number"))?;
        found += 1;
    }
    if found == 3 { Ok(at.into()) } else { Err(format!("a point has {found} numbers, not 3")) }
}

/// The point that a corner such as `7`, `7/1/2` or `-1` names, from 0.
fn corner(word: &str, points: usize) -> Result<u32, String> {
    let number = word.split('/').next().unwrap_or("");
    let wrong = || format!("'{word}' names none of the {points} points above it, counted from 1");
    let place: i64 = number.parse().map_err(|_| wrong())?;
    let from_0 = if place < 0 { points as i64 + place } else { place - 1 };
    let known = (0..points as i64).contains(&from_0);
    u32::try_from(from_0).ok().filter(|_| known).ok_or_else(wrong)
}
