//! Checkpoint archive: the same calls write numbers to a file and read them back.

use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Cursor, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::bufread::GzDecoder;
use flate2::write::GzEncoder;

use impactite_output::{OutputError, WholeFile};
use impactite_simd::Float;

use crate::error::StepError;

/// Error of writing a checkpoint, or of reading one into a scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// File error of the operating system.
    #[error(transparent)]
    File(#[from] OutputError),
    /// Damaged or incomplete checkpoint, or a file of another format.
    #[error("`{}` is no checkpoint that can be read: {why}", path.display())]
    Damaged {
        /// Path of the file.
        path: PathBuf,
        /// Defect of the file.
        why: String,
    },
    /// Checkpoint of another scene.
    #[error("the checkpoint is of another scene: {what} is `{saved}` there and `{here}` here")]
    OtherScene {
        /// Quantity that differs.
        what: String,
        /// Value in the checkpoint.
        saved: String,
        /// Value in the scene.
        here: String,
    },
    /// Checkpoint that does not fit into the scene, for example beyond its grid.
    #[error("{0}")]
    NoRoom(String),
    /// Stopped run, which cannot be saved.
    #[error("a run that was stopped is not saved: {0}")]
    Stopped(Box<StepError>),
}

/// File of 64-bit words, least significant byte first, in gzip for its checksum. It is not compressed, since compression of such numbers
/// takes more time than it is worth.
///
/// Each method writes its argument if the archive was created, and overwrites it with the stored value if the archive was opened.
pub struct Archive {
    path: PathBuf,
    store: Store,
}

enum Store {
    To(BufWriter<GzEncoder<WholeFile>>),
    From(BufReader<GzDecoder<BufReader<File>>>),
    ToMemory(Vec<u8>),
    FromMemory(Cursor<Vec<u8>>),
}

/// Largest magnitude of a block coordinate: cells are counted to 2^30.
const FARTHEST: u32 = 1 << 29;

type Done = Result<(), CheckpointError>;

impl Archive {
    /// Create an archive for writing; the file `path` stays as it is until [`Archive::close`].
    ///
    /// # Errors
    /// I/O error.
    pub fn create(path: &Path) -> Result<Self, CheckpointError> {
        let file = WholeFile::create(path)?;
        let store = Store::To(BufWriter::new(GzEncoder::new(file, Compression::none())));
        Ok(Archive { path: path.into(), store })
    }

    /// Open an archive for reading.
    ///
    /// # Errors
    /// I/O error.
    pub fn open(path: &Path) -> Result<Self, CheckpointError> {
        let file = File::open(path).map_err(OutputError::file("open", path))?;
        let store = Store::From(BufReader::new(GzDecoder::new(BufReader::new(file))));
        Ok(Archive { path: path.into(), store })
    }

    /// Create an archive in memory for writing, for a step that may be repeated; [`Archive::again`] opens it for reading.
    pub fn in_memory() -> Self {
        Archive { path: "memory".into(), store: Store::ToMemory(Vec::new()) }
    }

    /// Open an archive in memory for reading from its start; one that is a file stays as it is.
    #[must_use]
    pub fn again(self) -> Self {
        let store = match self.store {
            Store::ToMemory(bytes) => Store::FromMemory(Cursor::new(bytes)),
            Store::FromMemory(bytes) => Store::FromMemory(Cursor::new(bytes.into_inner())),
            file => file,
        };
        Archive { path: self.path, store }
    }

    /// True if the archive is open for reading.
    pub fn reads(&self) -> bool {
        matches!(self.store, Store::From(_) | Store::FromMemory(_))
    }

    /// Finish the archive: rename a written file to its final name, or check that a read file is complete and ends here.
    ///
    /// # Errors
    /// I/O error; damaged file; data after the end.
    pub fn close(self) -> Done {
        match self.store {
            Store::To(words) => {
                let written = words.into_inner().map_err(std::io::IntoInnerError::into_error);
                let file = written.and_then(GzEncoder::finish);
                Ok(file.map_err(OutputError::file("write", &self.path))?.finish()?)
            }
            Store::From(mut words) => {
                let damaged = |why: String| CheckpointError::Damaged { path: self.path.clone(), why };
                // Reading to the end of the words verifies the checksum.
                let more = words.read(&mut [0]).map_err(|error| damaged(error.to_string()))? > 0;
                let mut rest = words.into_inner().into_inner();
                match more || rest.fill_buf().map_or(true, |bytes| !bytes.is_empty()) {
                    true => Err(damaged("it goes on after its end".into())),
                    false => Ok(()),
                }
            }
            Store::ToMemory(_) | Store::FromMemory(_) => Ok(()),
        }
    }

    /// Skip the remaining words and verify the checksum.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn skip_rest(&mut self) -> Done {
        if let Store::From(words) = &mut self.store {
            let skipped = std::io::copy(words, &mut std::io::sink());
            skipped.map_err(|error| self.damaged(error.to_string()))?;
        }
        Ok(())
    }

    /// Return the error of a damaged file, with its reason.
    pub fn damaged(&self, why: impl Into<String>) -> CheckpointError {
        CheckpointError::Damaged { path: self.path.clone(), why: why.into() }
    }

    fn bytes(&mut self, bytes: &mut [u8]) -> Done {
        match &mut self.store {
            Store::To(words) => Ok(words.write_all(bytes).map_err(OutputError::file("write", &self.path))?),
            Store::From(words) => words.read_exact(bytes).map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => self.damaged("it ends too early"),
                _ => self.damaged(error.to_string()),
            }),
            Store::ToMemory(all) => {
                all.extend_from_slice(bytes);
                Ok(())
            }
            Store::FromMemory(words) => {
                words.read_exact(bytes).map_err(|_| self.damaged("it ends too early"))
            }
        }
    }

    /// Write or read a word.
    pub fn word(&mut self, word: &mut u64) -> Done {
        let mut bytes = word.to_le_bytes();
        self.bytes(&mut bytes)?;
        *word = u64::from_le_bytes(bytes);
        Ok(())
    }

    /// Write or read a block coordinate.
    pub fn integer(&mut self, x: &mut i32) -> Done {
        let mut word = i64::from(*x) as u64;
        self.word(&mut word)?;
        let coordinate = i32::try_from(word as i64).ok().filter(|x| x.unsigned_abs() <= FARTHEST);
        *x = coordinate.ok_or_else(|| self.damaged(format!("{word:#x} is no coordinate")))?;
        Ok(())
    }

    /// Write or read an index below `end`.
    pub fn index(&mut self, x: &mut u32, end: usize) -> Done {
        let mut word = u64::from(*x);
        self.word(&mut word)?;
        let index = u32::try_from(word).ok().filter(|&n| (n as usize) < end);
        *x = index.ok_or_else(|| self.damaged(format!("{word} is no number below {end}")))?;
        Ok(())
    }

    /// Write or read a count.
    pub fn count(&mut self, count: &mut usize) -> Done {
        let mut word = *count as u64;
        self.word(&mut word)?;
        *count = usize::try_from(word).map_err(|_| self.damaged(format!("{word:#x} is no count")))?;
        Ok(())
    }

    /// Write or read a truth value.
    pub fn flag(&mut self, flag: &mut bool) -> Done {
        let mut word = u64::from(*flag);
        self.word(&mut word)?;
        *flag = word != 0;
        Ok(())
    }

    /// Write or read a real number by its bits.
    pub fn real(&mut self, x: &mut f64) -> Done {
        let mut word = x.to_bits();
        self.word(&mut word)?;
        *x = f64::from_bits(word);
        Ok(())
    }

    /// Write or read real numbers.
    pub fn reals<'a>(&mut self, numbers: impl IntoIterator<Item = &'a mut f64>) -> Done {
        numbers.into_iter().try_for_each(|x| self.real(x))
    }

    /// Write or read numbers of the scene's precision, as 64-bit ones.
    pub fn numbers<'a, T: Float>(&mut self, numbers: impl IntoIterator<Item = &'a mut T>) -> Done {
        numbers.into_iter().try_for_each(|x| {
            let mut wide = x.to_double();
            self.real(&mut wide)?;
            *x = T::of(wide);
            Ok(())
        })
    }

    /// Write or read an optional value.
    pub fn option<X: Default>(
        &mut self,
        option: &mut Option<X>,
        each: impl FnOnce(&mut Self, &mut X) -> Done,
    ) -> Done {
        let mut there = option.is_some();
        self.flag(&mut there)?;
        if !there {
            *option = None;
            return Ok(());
        }
        each(self, option.get_or_insert_default())
    }

    /// Write or read a list. `blank` is the initial value of an entry that is read.
    pub fn list<X: Clone>(
        &mut self,
        list: &mut Vec<X>,
        blank: &X,
        mut each: impl FnMut(&mut Self, &mut X) -> Done,
    ) -> Done {
        let mut count = list.len();
        self.count(&mut count)?;
        if self.reads() {
            list.clear();
        }
        for n in 0..count {
            if self.reads() {
                list.push(blank.clone());
            }
            each(self, &mut list[n])?;
        }
        Ok(())
    }

    /// Write or read a text.
    ///
    /// # Errors
    /// I/O error; text that is not UTF-8.
    pub fn text(&mut self, text: &mut String) -> Done {
        let mut bytes = std::mem::take(text).into_bytes();
        self.list(&mut bytes, &0, |file, byte| file.bytes(std::slice::from_mut(byte)))?;
        *text = String::from_utf8(bytes).map_err(|error| self.damaged(error.to_string()))?;
        Ok(())
    }

    /// Write the constant `here` of the scene, named `what`, or compare it with the stored one.
    ///
    /// # Errors
    /// I/O error; a stored constant that differs.
    pub fn same(&mut self, what: &str, here: &str) -> Done {
        let mut saved = here.as_bytes().to_vec();
        self.list(&mut saved, &0, |file, byte| file.bytes(std::slice::from_mut(byte)))?;
        if saved == here.as_bytes() {
            return Ok(());
        }
        let saved = String::from_utf8_lossy(&saved).into_owned();
        Err(CheckpointError::OtherScene { what: what.into(), saved, here: here.into() })
    }
}
