//! Files that are there whole or not at all.

use std::ffi::OsStr;
use std::fs::{File, FileType, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::OutputError;

/// A file in the making: it takes the name it is to have when it is [finished](WholeFile::finish), so that readers see the old one or the
/// new one, never half, and no other file of that name that is in the making, in this process or another. What is not finished is removed.
///
/// Until then it lies beside its place, under that name with the number of the process, a number of its own and `.part` behind it. A
/// symbolic link stays what it is, and what it points to is replaced. What is no regular file (a folder, a device, a pipe) is not.
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
    /// The name it is to have, as it was given.
    path: PathBuf,
    /// The same behind symbolic links.
    place: PathBuf,
    /// Before the name of what is removed, so that it is closed first.
    file: File,
    part: Part,
}

/// The name of a file that is removed, unless it has got another one.
#[derive(Debug)]
struct Part(PathBuf);

impl Drop for Part {
    fn drop(&mut self) {
        if !self.0.as_os_str().is_empty() {
            // Of no use, and not what went wrong.
            let _ = std::fs::remove_file(&self.0);
        }
    }
}

/// Symbolic links on the way to a file: as many as Linux follows.
const MOST_LINKS: usize = 40;
/// Longest name that a part has in its own, bytes: file systems allow 255.
const LONGEST: usize = 200;

/// Parts of this process so far.
static PARTS: AtomicU64 = AtomicU64::new(0);

impl WholeFile {
    /// To become the file at `path`.
    ///
    /// # Errors
    /// A path that is something else than a regular file, or names none; a folder where no file can be made.
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
                // Left by a process that was killed and had this number, or by one of another machine.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(OutputError::file("create", path)(error)),
            }
        }
    }

    /// The name it is to have.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// All is written: make it the file of its name, on the disk.
    ///
    /// # Errors
    /// What was written cannot be kept, or the name not be given; then the old file is as it was.
    pub fn finish(self) -> Result<(), OutputError> {
        self.settle().map(|_| ())
    }

    /// The same of a file that goes on growing under its name.
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

/// Remove the parts of files that processes left in a folder when they were killed: those of files whose name begins with `name`. Parts of
/// this process stay, and a folder that is not there has none.
///
/// # Errors
/// A folder that cannot be read, or a part that cannot be removed.
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

/// Is this the name of a part, NAME...PROCESS-NUMBER.part, that no file of this process has?
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

/// Where the file of this path is or is to be, behind symbolic links; what is there must be a regular file.
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
        // Links are read from where they are; one with a root stands for itself.
        place = place.with_file_name("").join(to);
    }
    Err(refused("a symbolic link without an end"))
}

/// What is neither a file nor a link, in words.
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

/// Write a file whole or not at all ([`WholeFile`]).
///
/// # Errors
/// As for [`WholeFile::create`] and [`WholeFile::finish`], and a full disk; then the old file is as it was.
pub fn write_whole(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> Result<(), OutputError> {
    let path = path.as_ref();
    let mut file = WholeFile::create(path)?;
    file.write_all(bytes.as_ref()).map_err(OutputError::file("write", path))?;
    file.finish()
}
