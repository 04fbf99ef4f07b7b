//! Run folder: locked for one run at a time, and cleared of the files of an earlier run.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

use crate::CliError;

/// Name of the checkpoint in the folder of a run.
pub const CHECKPOINT: &str = "run.checkpoint";
/// Name of the scene file in the folder of a run.
pub const SCENE: &str = "scene.toml";
/// Name of the result file in the folder of a run: the JSON object of `--json`.
pub const RESULT: &str = "result.json";
/// Name of the measure history in the folder of a run.
pub const MEASURES: &str = "measures.csv";
/// Name of the file that is locked while a run writes into its folder.
pub const LOCK: &str = ".lock";
/// Folders of pictures and of frames for ParaView, and the name of both series.
pub(crate) const PICTURES: &str = "pictures";
pub(crate) const FRAMES: &str = "paraview";
/// Folder of profiles, a CSV file each.
pub(crate) const PROFILES: &str = "profiles";
pub(crate) const SERIES: &str = "scene";

/// Exclusive lock on the folder of a run. The operating system releases it at any end of the process.
#[derive(Debug)]
pub(crate) struct FolderLock {
    path: PathBuf,
    _lock: File,
}

impl FolderLock {
    /// Lock the folder at `path`, and create it if it does not exist.
    ///
    /// # Errors
    /// Folder locked by another run, or folder that cannot be created.
    pub fn new(path: &Path) -> Result<Self, CliError> {
        std::fs::create_dir_all(path).map_err(CliError::file(path))?;
        let name = path.join(LOCK);
        let mut lock = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&name)
            .map_err(CliError::file(&name))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut process = String::new();
                let _ = lock.read_to_string(&mut process);
                return Err(CliError::Locked { path: path.into(), process: process.trim().into() });
            }
            // File system without locks: the run continues unlocked.
            Err(TryLockError::Error(why)) => {
                tracing::warn!("`{}` cannot be locked ({why}): start no second run there", path.display());
            }
        }
        // The process number serves the message of a second run only; the lock does not depend on it.
        let _ = lock
            .set_len(0)
            .and_then(|()| lock.rewind())
            .and_then(|()| write!(lock, "{}", std::process::id()));
        Ok(FolderLock { path: path.into(), _lock: lock })
    }

    /// Remove the files of an earlier run, so that a failed run leaves no results of another one. Other files stay.
    ///
    /// # Errors
    /// File that cannot be removed.
    pub fn clear(&self) -> Result<(), CliError> {
        for name in [impactite_report::FILE, RESULT, "report.html", MEASURES, CHECKPOINT, SCENE] {
            remove(&self.path.join(name))?;
        }
        for folder in [PICTURES, FRAMES] {
            self.each(folder, &|name| {
                name.starts_with(&format!("{SERIES}_")) || name.starts_with(&format!("{SERIES}."))
            })?;
        }
        self.each(PROFILES, &|name| name.ends_with(".csv"))?;
        self.clear_parts()
    }

    /// Remove incomplete files (`.part`) of a killed run.
    ///
    /// # Errors
    /// File that cannot be removed.
    pub fn clear_parts(&self) -> Result<(), CliError> {
        ["", PICTURES, FRAMES, PROFILES]
            .iter()
            .try_for_each(|folder| self.each(folder, &|name| name.ends_with(".part")))
    }

    /// Remove the files of a subfolder whose name satisfies `which`.
    fn each(&self, folder: &str, which: &dyn Fn(&str) -> bool) -> Result<(), CliError> {
        let Ok(entries) = std::fs::read_dir(self.path.join(folder)) else { return Ok(()) };
        for entry in entries.flatten() {
            if entry.file_name().to_str().is_some_and(which) && entry.path().is_file() {
                remove(&entry.path())?;
            }
        }
        Ok(())
    }
}

/// Remove a file, if it exists.
pub(crate) fn remove(path: &Path) -> Result<(), CliError> {
    match std::fs::remove_file(path) {
        Err(why) if why.kind() != std::io::ErrorKind::NotFound => Err(CliError::file(path)(why)),
        _ => Ok(()),
    }
}
