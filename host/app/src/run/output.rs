//! The folder that a run writes: claimed before the run begins, and never taken from somebody
//! else's files.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::Failure;

/// What a run writes last, and what therefore says that a folder is a run's.
const MARK: &str = "run.json";

/// Names that a run gives to its files.
fn is_ours(name: &str) -> bool {
    let frame = name.strip_prefix("frame-").and_then(|rest| rest.strip_suffix(".png"));
    frame.is_some_and(|number| number.bytes().all(|b| b.is_ascii_digit()))
        || ["contact-sheet.png", "plot.png", "run.csv", MARK].contains(&name)
}

/// A folder to write into.
#[derive(Clone, Debug)]
pub struct Output {
    dir: PathBuf,
}

impl Output {
    /// Makes `dir`, or takes it over from an earlier run, whose files are removed.
    ///
    /// # Errors
    /// [`Failure::Input`] if it cannot be made or written, or if it holds anything that is not a
    /// run's: nothing is touched then.
    pub fn claim(dir: &Path) -> Result<Self, Failure> {
        let cannot = |why: &dyn std::fmt::Display| {
            Failure::Input(format!(
                "cannot write into {}: {why}; choose another --out",
                dir.display()
            ))
        };
        fs::create_dir_all(dir).map_err(|e| cannot(&e))?;
        let mut old = Vec::new();
        for entry in fs::read_dir(dir).map_err(|e| cannot(&e))? {
            let entry = entry.map_err(|e| cannot(&e))?;
            let name = entry.file_name();
            if !name.to_str().is_some_and(is_ours) {
                let what = format!("it holds {}, which is not a run's", name.display());
                return Err(cannot(&what));
            }
            old.push(entry.path());
        }
        prove_writable(dir).map_err(|e| cannot(&e))?;
        old.iter().try_for_each(fs::remove_file).map_err(|e| cannot(&e))?;
        Ok(Self { dir: dir.into() })
    }

    /// The path of a file in the folder.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.dir.join(name)
    }

    /// The folder.
    #[must_use]
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Writes a file.
    ///
    /// # Errors
    /// [`Failure::Input`] if it cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.file(name);
        fs::write(&path, bytes)
            .map_err(|why| Failure::Input(format!("cannot write {}: {why}", path.display())))
    }
}

fn prove_writable(dir: &Path) -> io::Result<()> {
    let probe = dir.join(format!(".cauldron-{}", std::process::id()));
    fs::write(&probe, [])?;
    fs::remove_file(probe)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scratch(name: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("cauldron-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        dir
    }

    #[test]
    fn an_earlier_run_makes_room() {
        let dir = scratch("again");
        let output = Output::claim(&dir).unwrap();
        output.write("frame-0001.png", b"old").unwrap();
        output.write(MARK, b"{}").unwrap();
        Output::claim(&dir).unwrap();
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 0);
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn somebody_elses_files_are_left_alone() {
        let dir = scratch("theirs");
        fs::create_dir_all(&dir).unwrap();
        fs::write(dir.join("run.csv"), "mine").unwrap();
        fs::write(dir.join("thesis.tex"), "mine too").unwrap();
        let Err(Failure::Input(said)) = Output::claim(&dir) else { panic!("taken") };
        assert!(said.contains("thesis.tex"), "{said}");
        assert_eq!(fs::read_to_string(dir.join("run.csv")).unwrap(), "mine");
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn a_file_is_no_folder() {
        let path = scratch("file");
        fs::write(&path, "mine").unwrap();
        assert!(Output::claim(&path).is_err());
        assert!(Output::claim(&path.join("below")).is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
        fs::remove_file(&path).unwrap();
    }
}
