//! Atomic file replacement.

use std::ffi::OsStr;
use std::fs::{File, FileType, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::OutputError;

/// Temporary file that replaces the file at its path atomically when it is [finished](WholeFile::finish): readers see the complete old
/// file or the complete new one, and concurrent writers, in this process or another, do not interfere. An unfinished file is removed.
///
/// Until then it is in the same folder, under the final name with a suffix of process number, serial number and `.part`. A
/// symbolic link is kept, and its target is replaced. A path that is no regular file (a folder, a device, a pipe) is not replaced.
///
/// ```
/// use impactite_output::WholeFile;
/// use std::io::Write;
/// # let path = std::env::temp_dir().join(format!("impactite-doc-whole-{}", std::process::id()));
/// let mut file = WholeFile::create(&path)?;
/// writeln!(file, "to be or not to be")?;
/// assert!(!path.exists());
/// file.finish()?;
/// assert!(path.is_file());
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct WholeFile {
    /// Final path, as requested.
    path: PathBuf,
    /// Final path with symbolic links resolved.
    place: PathBuf,
    /// Declared before the temporary name, so that the file is closed before it is removed.
    file: File,
    part: Part,
}

/// Name of a temporary file, which is removed on drop unless it was renamed.
#[derive(Debug)]
struct Part(PathBuf);

impl Drop for Part {
    fn drop(&mut self) {
        if !self.0.as_os_str().is_empty() {
            // A failure here is harmless, and not the primary error.
            let _ = std::fs::remove_file(&self.0);
        }
    }
}

/// Maximum number of symbolic links on the path of a file, as in Linux.
const MOST_LINKS: usize = 40;
/// Maximum length of a name that a temporary name contains, bytes: file systems allow 255.
const LONGEST: usize = 200;

/// Number of temporary files of this process so far.
static PARTS: AtomicU64 = AtomicU64::new(0);

impl WholeFile {
    /// Create a temporary file that will replace the file at `path`.
    ///
    /// # Errors
    /// A path that is no regular file, or has no file name; a folder in which no file can be created.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, OutputError> {
        let path = path.as_ref();
        let place = place(path)?;
        let refused = |found| OutputError::NoFile { path: path.to_path_buf(), found };
        let name = place.file_name().ok_or_else(|| refused("the name of no file"))?;
        let name = if name.len() <= LONGEST { name } else { OsStr::new("file") };
        loop {
            let mut part = name.to_os_string();
            part.push(format!(".{}-{}.part", std::process::id(), PARTS.fetch_add(1, Ordering::Relaxed)));
            let part = place.with_file_name(part);
            match OpenOptions::new().write(true).create_new(true).open(&part) {
                Ok(file) => {
                    let path = path.to_path_buf();
                    return Ok(WholeFile { path, place, file, part: Part(part) });
                }
                // Left behind by a killed process of the same number, or by a process on another machine.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(OutputError::file("create", path)(error)),
            }
        }
    }

    /// Final path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Finish the file: flush it to the disk and rename it to its final path.
    ///
    /// # Errors
    /// A failed write or rename; the old file is then unchanged.
    pub fn finish(self) -> Result<(), OutputError> {
        self.settle().map(|_| ())
    }

    /// Finish the file like [`finish`](Self::finish), but keep it open for appending.
    pub(crate) fn settle(self) -> Result<File, OutputError> {
        let WholeFile { path, place, file, mut part } = self;
        file.sync_all().map_err(OutputError::file("write", &path))?;
        std::fs::rename(&part.0, &place).map_err(OutputError::file("rename to", &path))?;
        part.0.clear();
        Ok(file)
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.file.write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

/// Remove temporary files that killed processes left in a folder, for files whose name begins with `name`. Temporary files of
/// this process are kept; a missing folder is no error.
///
/// # Errors
/// A folder that cannot be read, or a temporary file that cannot be removed.
pub fn remove_parts(folder: impl AsRef<Path>, name: &str) -> Result<(), OutputError> {
    let folder = folder.as_ref();
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(OutputError::file("look at", folder)(error)),
    };
    for entry in entries {
        let path = entry.map_err(OutputError::file("look at", folder))?.path();
        let is_left = path.file_name().and_then(OsStr::to_str).is_some_and(|file| is_left_part(file, name));
        if is_left && path.is_file() {
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(OutputError::file("remove", &path)(error));
                }
                _ => {}
            }
        }
    }
    Ok(())
}

/// True for the name of a temporary file, NAME...PROCESS-NUMBER.part, that this process does not use.
fn is_left_part(file: &str, name: &str) -> bool {
    let numbers = file.strip_prefix(name).and_then(|rest| rest.strip_suffix(".part"));
    let Some((process, number)) =
        numbers.and_then(|n| n.rsplit_once('.')).and_then(|(_, n)| n.split_once('-'))
    else {
        return false;
    };
    let (Ok(process), Ok(number)) = (process.parse::<u32>(), number.parse::<u64>()) else { return false };
    process != std::process::id() || number >= PARTS.load(Ordering::Relaxed)
}

/// Resolve symbolic links to the path of an existing regular file or of a file to be created.
fn place(path: &Path) -> Result<PathBuf, OutputError> {
    let refused = |found| OutputError::NoFile { path: path.to_path_buf(), found };
    let mut place = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let kind = match std::fs::symlink_metadata(&place) {
            Ok(about) => about.file_type(),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(place),
            Err(error) => return Err(OutputError::file("look at", path)(error)),
        };
        if kind.is_file() {
            return Ok(place);
        }
        if !kind.is_symlink() {
            return Err(refused(other(kind)));
        }
        let to = std::fs::read_link(&place).map_err(OutputError::file("follow", path))?;
        // Links are relative to their folder; absolute links replace the path.
        place = place.with_file_name("").join(to);
    }
    Err(refused("a symbolic link without an end"))
}

/// Describe a type that is neither a file nor a link, in words.
fn other(kind: FileType) -> &'static str {
    if kind.is_dir() {
        return "a folder";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
        if kind.is_fifo() {
            return "a pipe";
        }
        if kind.is_socket() {
            return "a socket";
        }
    }
    "something else"
}

/// Write a file atomically ([`WholeFile`]).
///
/// # Errors
/// Errors of [`WholeFile::create`] and [`WholeFile::finish`], and a full disk; the old file is then unchanged.
pub fn write_whole(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> Result<(), OutputError> {
    let path = path.as_ref();
    let mut file = WholeFile::create(path)?;
    file.write_all(bytes.as_ref()).map_err(OutputError::file("write", path))?;
    file.finish()
}
