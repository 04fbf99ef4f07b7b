//! Checkpoints and restart of a case.
//!
//! A case is a number of simulations, each of segments: runs to given times, between which the case takes snapshots and
//! notes numbers. Every simulation writes checkpoints, `LABEL.checkpoint` in the folder of the case. A resumed simulation
//! skips the segments before the interrupted one and loads their snapshots and notes from the checkpoint; the interrupted
//! segment continues from the checkpoint, including solver and observers. The output is the same, byte for byte, as without
//! interruption. The other simulations of the case run again, and so does everything that a case does without a
//! [`Simulation`].

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use mpm_core::observe::Observer;
use mpm_core::output::Snapshot;
use mpm_core::{Archive, CheckpointError, Run, RunError, RunSummary, Solver};

use crate::CaseError;

/// Checkpoints of the simulations of a case, and the one to resume from.
#[derive(Debug)]
pub struct Restart {
    folder: PathBuf,
    every: Duration,
    heading: Heading,
    /// Checkpoint to resume from, and label of its simulation.
    resumed: Option<(PathBuf, String)>,
    /// Number of simulations with each label.
    labels: Mutex<BTreeMap<String, u32>>,
}

/// Options of a case by name, as given or by default.
pub type Options = Vec<(String, String)>;

impl Restart {
    /// Create the checkpoints of a case with these options, which a checkpoint to resume from must share. `every` is the time
    /// between two checkpoints.
    ///
    /// # Errors
    /// Checkpoint that cannot be read, is damaged, or is of another case or of other options.
    pub fn new(
        case: &str,
        options: Options,
        folder: &Path,
        every: Duration,
        resumed: Option<&Path>,
    ) -> Result<Self, CaseError> {
        let mut heading = Heading { case: case.into(), options, label: String::new() };
        let resumed = match resumed {
            Some(path) => {
                let label = heading.label_of(path).map_err(refused(path))?;
                frames_beside(path, folder)?;
                Some((path.to_path_buf(), label))
            }
            None => None,
        };
        Ok(Restart { folder: folder.into(), every, heading, resumed, labels: Mutex::default() })
    }

    /// Begin a simulation with a label, the name of its checkpoint. A repeated label gets a number: simulations that run in
    /// parallel need distinct labels, since their order may change.
    ///
    /// # Errors
    /// Label with a path separator; checkpoint that cannot be read.
    pub fn scene(&self, label: impl Into<String>) -> Result<Simulation, CaseError> {
        let mut label = label.into();
        if label.contains(['/', '\\']) {
            let allowed = "without path separators";
            return Err(CaseError::Other(format!("label = {label} is not allowed; it must be {allowed}")));
        }
        let mut labels = self.labels.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = labels.entry(label.clone()).and_modify(|times| *times += 1).or_insert(1);
        if *taken > 1 {
            label = format!("{label}-{taken}");
        }
        drop(labels);
        let checkpoints = Some((self.folder.join(format!("{label}.checkpoint")), self.every));
        let heading = Heading { label, ..self.heading.clone() };
        let mut simulation = Simulation { checkpoints, heading, ..Simulation::alone() };
        if let Some((path, label)) = &self.resumed
            && *label == simulation.heading.label
        {
            let mut saved = Kept::default();
            let read = Run::preface_of(path).and_then(|mut file| {
                simulation.heading.archive(&mut file)?;
                saved.archive(&mut file)
            });
            read.map_err(refused(path))?;
            simulation.saved = Some((path.clone(), saved));
        }
        Ok(simulation)
    }
}

fn refused(path: &Path) -> impl Fn(CheckpointError) -> CaseError + use<> {
    let path = path.to_path_buf();
    move |source| CaseError::Resume { path: path.clone(), source }
}

/// Copy the ParaView frames written before the interruption from beside the checkpoint to the folder of this run. Later
/// frames are written again.
fn frames_beside(checkpoint: &Path, folder: &Path) -> Result<(), CaseError> {
    let from = checkpoint.parent().unwrap_or(Path::new("")).join("paraview");
    let to = folder.join("paraview");
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        move |source| CaseError::File { path, source }
    };
    if !from.is_dir() || from.canonicalize().ok() == to.canonicalize().ok() {
        return Ok(());
    }
    std::fs::create_dir_all(&to).map_err(failed(&to))?;
    for entry in from.read_dir().map_err(failed(&from))?.flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|e| e == "vtp") {
            let copy = to.join(entry.file_name());
            std::fs::copy(&path, &copy).map_err(failed(&copy))?;
        }
    }
    Ok(())
}

/// Heading of a checkpoint of a case.
#[derive(Clone, Debug, Default)]
struct Heading {
    case: String,
    options: Options,
    label: String,
}

impl Heading {
    /// Store in a checkpoint, or load from one and compare all but the label.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.same("case", &self.case)?;
        file.same("version of the program", env!("CARGO_PKG_VERSION"))?;
        let here = self.options.clone();
        file.list(&mut self.options, &Default::default(), |file, (name, value)| {
            file.text(name)?;
            file.text(value)
        })?;
        let saved = std::mem::replace(&mut self.options, here);
        let value = |of: &Options, name: &str| {
            of.iter().find(|(n, _)| n == name).map_or("not given".into(), |(_, value)| value.clone())
        };
        for (name, _) in saved.iter().chain(&self.options) {
            let (there, here) = (value(&saved, name), value(&self.options, name));
            if there != here {
                return Err(CheckpointError::OtherScene { what: name.clone(), saved: there, here });
            }
        }
        file.text(&mut self.label)
    }

    /// Return the label of the simulation of a checkpoint, if the file is intact and of this case.
    fn label_of(&mut self, path: &Path) -> Result<String, CheckpointError> {
        let mut file = Run::preface_of(path)?;
        self.archive(&mut file)?;
        file.skip_rest()?;
        file.close()?;
        Ok(std::mem::take(&mut self.label))
    }
}

/// Stored results of the segments of a simulation.
#[derive(Clone, Debug, Default)]
struct Kept {
    /// Summaries of the finished segments.
    segments: Vec<RunSummary>,
    snapshots: Vec<Snapshot>,
    notes: Vec<Vec<f64>>,
}

impl Kept {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.segments, &RunSummary::default(), |file, segment| segment.archive(file))?;
        file.snapshots(&mut self.snapshots)?;
        file.list(&mut self.notes, &Vec::new(), |file, note| file.list(note, &0.0, Archive::real))
    }
}

/// One simulation of a case, in segments.
pub struct Simulation {
    /// Path of the checkpoints and time between them, if any.
    checkpoints: Option<(PathBuf, Duration)>,
    /// Time of the last checkpoint, or of the start of the simulation.
    last: Instant,
    heading: Heading,
    kept: Kept,
    /// Checkpoint and its stored results, while segments are skipped.
    saved: Option<(PathBuf, Kept)>,
}

impl Simulation {
    /// Create a simulation without checkpoints.
    #[must_use]
    pub fn alone() -> Self {
        Simulation {
            checkpoints: None,
            last: Instant::now(),
            heading: Heading::default(),
            kept: Kept::default(),
            saved: None,
        }
    }

    /// Run a segment to `end` (s) with these observers, which must be the same in every run of this segment.
    ///
    /// A skipped segment leaves solver and observers unchanged: decisions about segments must depend on
    /// [`Simulation::note`] or on the initial state.
    ///
    /// # Errors
    /// Errors of [`Run::until`] and [`Run::resume`]. [`Simulation::summary`] includes the segment up to the error.
    pub fn until<'a>(
        &mut self,
        solver: &'a mut (dyn Solver + 'static),
        observers: impl IntoIterator<Item = &'a mut dyn Observer>,
        end: f64,
    ) -> Result<(), RunError> {
        if let Some((_, saved)) = &self.saved
            && let Some(over) = saved.segments.get(self.kept.segments.len())
        {
            self.kept.segments.push(*over);
            return Ok(());
        }
        let resumed = self.saved.take().map(|(path, _)| path);
        let Simulation { heading, kept, checkpoints, .. } = self;
        let mut preface = |file: &mut Archive| {
            heading.archive(file)?;
            kept.archive(file)
        };
        let mut run = Run::new(solver).preface(&mut preface);
        for observer in observers {
            run = run.observe(observer);
        }
        if let Some((path, every)) = checkpoints {
            run = run.checkpoint_by_clock(&*path, *every, self.last);
        }
        if let Some(path) = resumed {
            run = run.resume(path)?;
        }
        let result = run.until(end);
        let (taken, last) = (run.summary(), run.last_checkpoint());
        drop(run);
        self.kept.segments.push(taken);
        self.last = last.unwrap_or(self.last);
        result.map(|_| ())
    }

    /// Store a snapshot, or load it from the checkpoint while segments are skipped.
    ///
    /// # Errors
    /// Errors of `take`; checkpoint with too few snapshots.
    pub fn keep<E: Into<CaseError>>(
        &mut self,
        take: impl FnOnce() -> Result<Snapshot, E>,
    ) -> Result<&Snapshot, CaseError> {
        let place = self.kept.snapshots.len();
        let snapshot = match &self.saved {
            Some((path, saved)) => saved.snapshots.get(place).cloned().ok_or_else(|| too_few(path))?,
            None => take().map_err(Into::into)?,
        };
        self.kept.snapshots.push(snapshot);
        Ok(&self.kept.snapshots[place])
    }

    /// Store numbers of solver or observers between segments, or load them from the checkpoint while segments are skipped.
    ///
    /// # Errors
    /// Errors of `take`; checkpoint with too few notes.
    pub fn note<const N: usize>(
        &mut self,
        take: impl FnOnce() -> Result<[f64; N], CaseError>,
    ) -> Result<[f64; N], CaseError> {
        let place = self.kept.notes.len();
        let note = match &self.saved {
            Some((path, saved)) => {
                let note = saved.notes.get(place).and_then(|note| note[..].try_into().ok());
                note.ok_or_else(|| too_few(path))?
            }
            None => take()?,
        };
        self.kept.notes.push(note.to_vec());
        Ok(note)
    }

    /// Snapshots stored so far.
    #[must_use]
    pub fn snapshots(&self) -> &[Snapshot] {
        &self.kept.snapshots
    }

    /// Return all snapshots at the end of the simulation.
    #[must_use]
    pub fn into_snapshots(self) -> Vec<Snapshot> {
        self.kept.snapshots
    }

    /// Return the summary of the segments so far, skipped ones included.
    #[must_use]
    pub fn summary(&self) -> RunSummary {
        self.kept.segments.iter().fold(RunSummary::default(), |mut sum, segment| {
            sum += *segment;
            sum
        })
    }
}

fn too_few(path: &Path) -> CaseError {
    let why = "it has less of the segments before it than the case keeps".into();
    refused(path)(CheckpointError::Damaged { path: path.into(), why })
}
