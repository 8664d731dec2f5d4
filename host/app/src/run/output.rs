//! The folder that a run writes: claimed before the run begins, and never taken from somebody
//! else's files.

use std::{
    cell::{Cell, RefCell},
    fs, io,
    path::{Path, PathBuf},
};

use crate::Failure;

/// What every run writes first and last; a folder with it is a run's.
const MARK: &str = "run.json";

/// Names that a run gives to its files.
fn is_ours(name: &str) -> bool {
    let frame = name.strip_prefix("frame-").and_then(|rest| rest.strip_suffix(".png"));
    let numbered = |n: &str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
    frame.is_some_and(numbered)
        || ["contact-sheet.png", "plot.png", "run.csv", MARK].contains(&name)
}

/// A folder to write into.
#[derive(Clone, Debug)]
pub struct Output {
    dir: PathBuf,
    /// Files of the run before, which go when the first of this one comes.
    old: RefCell<Vec<PathBuf>>,
    begun: Cell<bool>,
}

impl Output {
    /// Makes `dir`, or takes it over from an earlier run, whose files stay until this run has
    /// something to put in their place.
    ///
    /// # Errors
    /// [`Failure::Input`] if it cannot be made or written, or if it holds anything that is not a
    /// run's: nothing is touched then.
    pub fn claim(dir: &Path) -> Result<Self, Failure> {
        let cannot = |why: &dyn std::fmt::Display| {
            let dir = dir.display();
            Failure::Input(format!("cannot write into {dir}: {why}; choose another --out"))
        };
        fs::create_dir_all(dir).map_err(|e| cannot(&e))?;
        let mut old = Vec::new();
        for entry in fs::read_dir(dir).map_err(|e| cannot(&e))? {
            let entry = entry.map_err(|e| cannot(&e))?;
            let name = entry.file_name();
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            if !(is_file && name.to_str().is_some_and(is_ours)) {
                let what = format!("it holds {}, which is not a run's", name.display());
                return Err(cannot(&what));
            }
            old.push(entry.path());
        }
        if !old.is_empty() && !dir.join(MARK).exists() {
            return Err(cannot(&format!(
                "it holds files, and no {MARK} says that they are a run's"
            )));
        }
        prove_writable(dir).map_err(|e| cannot(&e))?;
        Ok(Self { dir: dir.into(), old: RefCell::new(old), begun: Cell::new(false) })
    }

    /// The path of a file that is about to be written. Before the first, the files of an earlier
    /// run are removed, and the folder is marked as a run's.
    ///
    /// # Errors
    /// [`Failure::Input`] if that cannot be done.
    pub fn file(&self, name: &str) -> Result<PathBuf, Failure> {
        if !self.begun.replace(true) {
            let cleared = self.old.take().iter().try_for_each(fs::remove_file);
            cleared
                .and_then(|()| fs::write(self.dir.join(MARK), "{}"))
                .map_err(|why| cannot_write(&self.dir, &why))?;
        }
        Ok(self.dir.join(name))
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
        let path = self.file(name)?;
        fs::write(&path, bytes).map_err(|why| cannot_write(&path, &why))
    }
}

fn cannot_write(path: &Path, why: &io::Error) -> Failure {
    Failure::Input(format!("cannot write {}: {why}", path.display()))
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
        let again = Output::claim(&dir).unwrap();
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 2, "kept until there is something new");
        again.write("plot.png", b"new").unwrap();
        assert!(!dir.join("frame-0001.png").exists() && dir.join(MARK).exists());
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
    fn names_like_ours_are_not_enough() {
        let dir = scratch("alike");
        fs::create_dir_all(dir.join("frame-1.png")).unwrap();
        fs::write(dir.join("run.json"), "mine").unwrap();
        assert!(Output::claim(&dir).is_err(), "a folder is no frame");
        fs::remove_dir(dir.join("frame-1.png")).unwrap();
        fs::rename(dir.join("run.json"), dir.join("plot.png")).unwrap();
        assert!(Output::claim(&dir).is_err(), "a plot without a run");
        assert_eq!(fs::read_to_string(dir.join("plot.png")).unwrap(), "mine");
        assert!(!is_ours("frame-.png"));
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
