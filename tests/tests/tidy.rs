//! Habits worth enforcing, over the whole tree.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// Files that git tracks or would; all files where there is no git.
fn files() -> Vec<PathBuf> {
    let args = ["ls-files", "--cached", "--others", "--exclude-standard"];
    let listed = Command::new("git").args(args).current_dir(root()).output();
    match listed {
        Ok(output) if output.status.success() => {
            let names = String::from_utf8(output.stdout).unwrap();
            names.lines().map(|name| root().join(name)).filter(|path| path.exists()).collect()
        }
        _ => walk(&root()),
    }
}

fn walk(dir: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(dir).unwrap().map(|e| e.unwrap().path());
    let wanted = entries.filter(|p| {
        let name = p.file_name().unwrap().to_string_lossy().into_owned();
        !["target", "out", ".git"].contains(&name.as_str())
    });
    wanted.flat_map(|p| if p.is_dir() { walk(&p) } else { vec![p] }).collect()
}

fn sources() -> Vec<(String, String)> {
    let rust = files().into_iter().filter(|p| p.extension().is_some_and(|e| e == "rs"));
    rust.map(|p| {
        let name = p.strip_prefix(root()).unwrap().to_string_lossy().into_owned();
        (name, fs::read_to_string(&p).unwrap())
    })
    .collect()
}

/// What breaks a habit, a line each.
fn offenders(wrong: impl Fn(&str, &str) -> Option<String>) -> Vec<String> {
    let sources = sources();
    assert!(sources.len() > 50, "found only {} sources", sources.len());
    sources
        .iter()
        .filter_map(|(name, text)| Some(format!("{name}: {}", wrong(name, text)?)))
        .collect()
}

const NONE: [String; 0] = [];

#[test]
fn the_root_shows_the_house_and_nothing_else() {
    let agreed = [
        "CHANGELOG.md",
        "Cargo.lock",
        "Cargo.toml",
        "LICENSE",
        "README.md",
        "firmware",
        "hil",
        "host",
        "protocol",
        "tests",
    ];
    let mut seen: Vec<String> = files()
        .iter()
        .map(|p| {
            p.strip_prefix(root()).unwrap().iter().next().unwrap().to_string_lossy().into_owned()
        })
        .filter(|name| !name.starts_with('.'))
        .collect();
    seen.sort();
    seen.dedup();
    assert_eq!(seen, agreed);
}

#[test]
fn every_file_says_what_it_is() {
    let silent = offenders(|name, text| {
        let is_test_module = name.ends_with("/tests.rs");
        let speaks = text.starts_with("//!") || text.starts_with("#!") || is_test_module;
        (!speaks).then(|| "begins without a //! line".into())
    });
    assert_eq!(silent, NONE);
}

#[test]
fn no_file_is_a_god() {
    let large = offenders(|_, text| {
        let lines = text.lines().count();
        (lines > 450).then(|| format!("{lines} lines"))
    });
    assert_eq!(large, NONE);
    let mut lengths: Vec<usize> = sources().iter().map(|(_, t)| t.lines().count()).collect();
    lengths.sort_unstable();
    let median = lengths[lengths.len() / 2];
    assert!(median <= 250, "the median file has {median} lines");
}

#[test]
fn comments_keep_to_a_hundred_columns() {
    let is_wide = |line: &&str| line.trim_start().starts_with("//") && line.chars().count() > 100;
    let wide = offenders(|_, text| text.lines().find(is_wide).map(|line| format!("has {line}")));
    assert_eq!(wide, NONE);
}

#[test]
fn nothing_is_left_over() {
    let words =
        [concat!("FIX", "ME"), concat!("XX", "X"), concat!("HA", "CK"), concat!("#[ign", "ore")];
    let left = offenders(|_, text| {
        words.iter().find(|w| text.contains(**w)).map(|w| format!("holds {w}"))
    });
    assert_eq!(left, NONE);
}

#[test]
fn unsafe_stays_where_it_is_explained() {
    let homes = ["host/fluid/src/pool.rs", "host/fluid/src/simd.rs"];
    let unsafe_block = concat!("unsafe", " {");
    let stray = offenders(|name, text| {
        let at_home = homes.contains(&name) || name.starts_with("firmware/boards/mps2/");
        (!at_home && text.contains(unsafe_block)).then(|| "holds an unsafe block".into())
    });
    assert_eq!(stray, NONE);
    let bare = offenders(|_, text| {
        let blocks = text.matches(unsafe_block).count();
        let reasons = text.matches("SAFETY:").count();
        (reasons < blocks).then(|| format!("{blocks} unsafe blocks, {reasons} reasons"))
    });
    assert_eq!(bare, NONE);
}

/// The device neither fuses nor asks a library whose bits differ; clippy watches calls, this
/// watches what clippy cannot see: the names at all.
#[test]
fn the_device_computes_with_plain_ieee_arithmetic() {
    let words = ["mul_add", "libm::", ".powi(", ".powf(", "fast-math"];
    let wrong = offenders(|name, text| {
        let device = name.starts_with("firmware/src/") || name.starts_with("protocol/src/");
        let code = text.split("#[cfg(test)]").next().unwrap_or(text);
        let word = words.iter().find(|w| device && code.contains(**w));
        word.map(|w| format!("holds {w}"))
    });
    assert_eq!(wrong, NONE);
}

#[test]
fn pictures_are_light() {
    let heavy: Vec<String> = files()
        .iter()
        .filter(|p| p.extension().is_some_and(|e| e == "png"))
        .map(|p| (p, fs::metadata(p).unwrap().len()))
        .filter(|(p, bytes)| {
            *bytes > 200 * 1024 || !p.starts_with(root().join("host/app/pictures"))
        })
        .map(|(p, bytes)| format!("{}: {bytes} B", p.display()))
        .collect();
    assert_eq!(heavy, NONE);
}
