//! Numbers that go to a file or come from one: what is said once holds for both.

use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::bufread::GzDecoder;
use flate2::write::GzEncoder;

use impactite_output::{OutputError, WholeFile};
use impactite_simd::Float;

use crate::error::StepError;

/// A checkpoint that could not be written, or a scene that it could not be read into.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The operating system refused a file.
    #[error(transparent)]
    File(#[from] OutputError),
    /// A file that is none, or not whole.
    #[error("`{}` is no checkpoint that can be read: {why}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The scene is not the one that was saved.
    #[error("the checkpoint is of another scene: {what} is `{saved}` there and `{here}` here")]
    OtherScene {
        /// What differs.
        what: String,
        /// What it is in the checkpoint.
        saved: String,
        /// What it is in the scene.
        here: String,
    },
    /// The scene has no room for it.
    #[error("{0}")]
    NoRoom(String),
    /// A run that was stopped cannot go on.
    #[error("a run that was stopped is not saved: {0}")]
    Stopped(Box<StepError>),
}

/// A file of 64-bit words, least significant byte first, in gzip for its checksum; not compressed, which would take longer than
/// it is worth for such numbers.
///
/// Every method takes what it says to the file, or puts there what the file says.
pub struct Archive {
    path: PathBuf,
    store: Store,
}

enum Store {
    To(BufWriter<GzEncoder<WholeFile>>),
    From(BufReader<GzDecoder<BufReader<File>>>),
}

/// Blocks further out are none: cells are counted to 2^30.
const FARTHEST: u32 = 1 << 29;

type Done = Result<(), CheckpointError>;

impl Archive {
    /// To be written; the file `path` stays as it is until [`Archive::close`].
    ///
    /// # Errors
    /// The file.
    pub fn create(path: &Path) -> Result<Self, CheckpointError> {
        let file = WholeFile::create(path)?;
        let store = Store::To(BufWriter::new(GzEncoder::new(file, Compression::none())));
        Ok(Archive { path: path.into(), store })
    }

    /// To be read.
    ///
    /// # Errors
    /// The file.
    pub fn open(path: &Path) -> Result<Self, CheckpointError> {
        let file = File::open(path).map_err(OutputError::file("open", path))?;
        let store = Store::From(BufReader::new(GzDecoder::new(BufReader::new(file))));
        Ok(Archive { path: path.into(), store })
    }

    /// Is it being read?
    pub fn reads(&self) -> bool {
        matches!(self.store, Store::From(_))
    }

    /// All is said: make it the file of its name, or see that it is whole and that nothing follows.
    ///
    /// # Errors
    /// A file that cannot be written; one that is damaged, or goes on after its end.
    pub fn close(self) -> Done {
        match self.store {
            Store::To(words) => {
                let written = words.into_inner().map_err(std::io::IntoInnerError::into_error);
                let file = written.and_then(GzEncoder::finish);
                Ok(file.map_err(OutputError::file("write", &self.path))?.finish()?)
            }
            Store::From(mut words) => {
                let damaged = |why: String| CheckpointError::Damaged { path: self.path.clone(), why };
                // The checksum is looked at where the words end.
                let more = words.read(&mut [0]).map_err(|error| damaged(error.to_string()))? > 0;
                let mut rest = words.into_inner().into_inner();
                match more || rest.fill_buf().map_or(true, |bytes| !bytes.is_empty()) {
                    true => Err(damaged("it goes on after its end".into())),
                    false => Ok(()),
                }
            }
        }
    }

    /// Read what is left without looking at it, and see that the file is whole.
    ///
    /// # Errors
    /// The file.
    pub fn skip_rest(&mut self) -> Done {
        if let Store::From(words) = &mut self.store {
            let skipped = std::io::copy(words, &mut std::io::sink());
            skipped.map_err(|error| self.damaged(error.to_string()))?;
        }
        Ok(())
    }

    /// What is told of a file that cannot be as it is.
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
        }
    }

    /// A word.
    pub fn word(&mut self, word: &mut u64) -> Done {
        let mut bytes = word.to_le_bytes();
        self.bytes(&mut bytes)?;
        *word = u64::from_le_bytes(bytes);
        Ok(())
    }

    /// A coordinate of a block.
    pub fn integer(&mut self, x: &mut i32) -> Done {
        let mut word = i64::from(*x) as u64;
        self.word(&mut word)?;
        let coordinate = i32::try_from(word as i64).ok().filter(|x| x.unsigned_abs() <= FARTHEST);
        *x = coordinate.ok_or_else(|| self.damaged(format!("{word:#x} is no coordinate")))?;
        Ok(())
    }

    /// A number below `end`.
    pub fn index(&mut self, x: &mut u32, end: usize) -> Done {
        let mut word = u64::from(*x);
        self.word(&mut word)?;
        let index = u32::try_from(word).ok().filter(|&n| (n as usize) < end);
        *x = index.ok_or_else(|| self.damaged(format!("{word} is no number below {end}")))?;
        Ok(())
    }

    /// How many there are of something.
    pub fn count(&mut self, count: &mut usize) -> Done {
        let mut word = *count as u64;
        self.word(&mut word)?;
        *count = usize::try_from(word).map_err(|_| self.damaged(format!("{word:#x} is no count")))?;
        Ok(())
    }

    /// Yes or no.
    pub fn flag(&mut self, flag: &mut bool) -> Done {
        let mut word = u64::from(*flag);
        self.word(&mut word)?;
        *flag = word != 0;
        Ok(())
    }

    /// A real number, by its bits.
    pub fn real(&mut self, x: &mut f64) -> Done {
        let mut word = x.to_bits();
        self.word(&mut word)?;
        *x = f64::from_bits(word);
        Ok(())
    }

    /// Some.
    pub fn reals<'a>(&mut self, numbers: impl IntoIterator<Item = &'a mut f64>) -> Done {
        numbers.into_iter().try_for_each(|x| self.real(x))
    }

    /// Numbers of the scene's precision.
    pub fn numbers<'a, T: Float>(&mut self, numbers: impl IntoIterator<Item = &'a mut T>) -> Done {
        numbers.into_iter().try_for_each(|x| {
            let mut wide = x.to_double();
            self.real(&mut wide)?;
            *x = T::of(wide);
            Ok(())
        })
    }

    /// Something that may not be there.
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

    /// A list. `blank` is what an entry is before it is read.
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

    /// Words.
    ///
    /// # Errors
    /// The file; words that are not UTF-8.
    pub fn text(&mut self, text: &mut String) -> Done {
        let mut bytes = std::mem::take(text).into_bytes();
        self.list(&mut bytes, &0, |file, byte| file.bytes(std::slice::from_mut(byte)))?;
        *text = String::from_utf8(bytes).map_err(|error| self.damaged(error.to_string()))?;
        Ok(())
    }

    /// What must be the same in the scene that is read into.
    ///
    /// # Errors
    /// It is not.
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
