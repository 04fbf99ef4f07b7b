//! A scene that goes on by steps, as a simulation and its bodies share it.

use std::ops::{Deref, DerefMut};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::{Duration, Instant};

use impactite::parallel::Team;
use impactite::scene::Solver;
use impactite_input::measured::Measures;
use impactite_input::{SceneFile, Source};
use pyo3::prelude::*;

use crate::error::Failed;
use crate::fields::{Columns, Fields};

/// How long Python waits at most to be asked whether Ctrl-C was pressed, unless one step takes longer.
const PIECE: Duration = Duration::from_millis(50);

/// A scene that is set up, on threads.
pub struct Running {
    /// What it was made from.
    pub scene: Arc<SceneFile>,
    /// How many threads.
    pub threads: usize,
    /// Taken by whoever does not hold the interpreter, which a thread that steps may wait for.
    state: Mutex<State>,
    /// Process of the thread that has locked `state`; 0 if none has.
    holder: AtomicU32,
    /// The arrays of each body.
    gathered: Mutex<Vec<Option<Gathered>>>,
}

/// The arrays of a body.
struct Gathered {
    /// [`State::changes`] when they were.
    changes: u64,
    fields: Arc<Fields>,
}

struct State {
    solver: Box<dyn Solver>,
    /// Its measures, by where points are at the start.
    measures: Measures,
    /// Counts what changed the scene.
    changes: u64,
    /// Why it is not to be used any more.
    unusable: Option<String>,
}

impl State {
    /// Does a measure end the scene?
    fn by_measure(&self) -> Result<bool, Failed> {
        Ok(self.measures.ended(&*self.solver)?.is_some())
    }
}

/// The state, while a thread uses it.
struct Held<'a> {
    state: MutexGuard<'a, State>,
    holder: &'a AtomicU32,
}

impl Deref for Held<'_> {
    type Target = State;
    fn deref(&self) -> &State {
        &self.state
    }
}
impl DerefMut for Held<'_> {
    fn deref_mut(&mut self) -> &mut State {
        &mut self.state
    }
}
impl Drop for Held<'_> {
    // Before the state itself is given back.
    fn drop(&mut self) {
        self.holder.store(0, Ordering::SeqCst);
    }
}

impl Running {
    /// The scene, set up.
    pub fn new(source: &Source, scene: Arc<SceneFile>, threads: Option<usize>) -> Result<Self, Failed> {
        let all = || std::thread::available_parallelism().map_or(1, usize::from).min(Team::MOST);
        let team = Team::new(threads.unwrap_or_else(all)).map_err(|e| Failed::Value(e.to_string()))?;
        let threads = team.threads();
        let mut solver = source.build(&scene)?;
        solver.set_team(team);
        let measures = Measures::new(source, &scene, &*solver)?;
        let gathered = solver.bodies().iter().map(|_| None).collect();
        let state = State { solver, measures, changes: 0, unusable: None };
        Ok(Running {
            scene,
            threads,
            state: Mutex::new(state),
            holder: AtomicU32::new(0),
            gathered: Mutex::new(gathered),
        })
    }

    fn lock(&self) -> Result<Held<'_>, Failed> {
        let broken = || Failed::Unusable("the simulation broke off within a step and cannot go on".into());
        let process = std::process::id();
        let mut waited = 0;
        let state = loop {
            match self.state.try_lock() {
                Ok(state) => break state,
                Err(TryLockError::Poisoned(_)) => return Err(broken()),
                Err(TryLockError::WouldBlock) => match self.holder.load(Ordering::SeqCst) {
                    // Between locking and storing the holder. It lasts only in a child that was forked at that moment.
                    0 if waited < 1000 => {
                        waited += 1;
                        std::thread::sleep(Duration::from_millis(1));
                    }
                    holder if holder == process => break self.state.lock().map_err(|_| broken())?,
                    // Locked by a thread of the parent, which the child does not have.
                    _ => {
                        return Err(Failed::Unusable(
                            "the process was forked while another thread used the simulation, which cannot go on in the child; \
                             make it there, or start processes by multiprocessing.set_start_method(\"spawn\")"
                                .into(),
                        ));
                    }
                },
            }
        };
        self.holder.store(process, Ordering::SeqCst);
        let held = Held { state, holder: &self.holder };
        match &held.unusable {
            Some(why) => Err(Failed::Unusable(why.clone())),
            None => Ok(held),
        }
    }

    /// What `look` finds, between two steps.
    pub fn look<R: Send>(
        &self,
        py: Python<'_>,
        look: impl FnOnce(&mut dyn Solver) -> R + Send,
    ) -> PyResult<R> {
        Ok(py.detach(|| Ok::<R, Failed>(look(&mut *self.lock()?.solver)))?)
    }

    /// The measures as the scene stands, in SI units.
    pub fn measured(&self, py: Python<'_>) -> PyResult<Vec<f64>> {
        let taken = py.detach(|| {
            let state = self.lock()?;
            Ok::<_, Failed>(state.measures.take(&*state.solver)?)
        });
        Ok(taken?)
    }

    /// The arrays of the body at this place: gathered once a state.
    pub fn fields(&self, py: Python<'_>, place: usize) -> PyResult<Arc<Fields>> {
        let kept = |changes: u64| {
            let gathered = self.gathered.lock().ok()?;
            let there = gathered.get(place)?.as_ref()?;
            (there.changes == changes).then(|| there.fields.clone())
        };
        let found = py.detach(|| {
            let state = self.lock()?;
            if let Some(fields) = kept(state.changes) {
                return Ok(Ok(fields));
            }
            let solver = &*state.solver;
            let bodies = solver.bodies();
            let body = bodies.get(place).ok_or_else(|| Failed::Value(format!("there is no body {place}")))?;
            let columns = Columns::of(*body, solver.dimensions(), solver.axisymmetric());
            Ok::<_, Failed>(Err((state.changes, columns)))
        })?;
        let (changes, columns) = match found {
            Ok(fields) => return Ok(fields),
            Err(gathered) => gathered,
        };
        // Another thread may have been faster, and all are to have the same arrays.
        let fields = Arc::new(Fields::new(py, columns)?);
        if let Some(fields) = kept(changes) {
            return Ok(fields);
        }
        if let Some(slot) = self.gathered.lock().ok().as_mut().and_then(|all| all.get_mut(place)) {
            *slot = Some(Gathered { changes, fields: fields.clone() });
        }
        Ok(fields)
    }

    /// Give back the memory of arrays that nobody else holds.
    fn forget(&self) {
        if let Ok(mut gathered) = self.gathered.lock() {
            gathered.fill_with(|| None);
        }
    }

    /// Has the scene come to its end: to the time, or to what a measure says?
    pub fn ended(&self, py: Python<'_>) -> PyResult<bool> {
        let ended = py.detach(|| {
            let state = self.lock()?;
            Ok::<_, Failed>(state.solver.reached(self.scene.end.value) || state.by_measure()?)
        });
        Ok(ended?)
    }

    /// At most so many steps towards the end of the scene, or towards `time`, s; Python is asked every now and then. Returns how many were made.
    pub fn advance(&self, py: Python<'_>, time: Option<f64>, most: u64) -> PyResult<u64> {
        let end = time.unwrap_or(self.scene.end.value);
        self.forget();
        let mut made = 0;
        loop {
            let done = py.detach(|| {
                let mut state = self.lock()?;
                let start = Instant::now();
                if !end.is_finite() || state.solver.clock().is_past(end) {
                    let time = state.solver.time();
                    return Err(Failed::Value(format!(
                        "end = {end} s is not allowed; it must be finite and not before the time reached, {time} s"
                    )));
                }
                while made < most && !state.solver.reached(end) && !(time.is_none() && state.by_measure()?) {
                    if start.elapsed() >= PIECE {
                        return Ok(false);
                    }
                    state.changes += 1;
                    let State { solver, measures, .. } = &mut *state;
                    solver.step_towards(end)?;
                    measures.look(&**solver)?;
                    made += 1;
                }
                if state.solver.reached(end) || time.is_none() && state.by_measure()? {
                    state.solver.look_at_the_end()?;
                }
                Ok::<bool, Failed>(true)
            })?;
            py.check_signals()?;
            if done {
                return Ok(made);
            }
        }
    }

    /// Go on from a checkpoint; where that fails it is not used any more.
    pub fn resume(&self, path: &Path) -> Result<(), Failed> {
        self.forget();
        let mut state = self.lock()?;
        if state.measures.looks() {
            let why = "measures over time, forces of conditions and `until` are not in checkpoints of simulations; a run by `impactite.run` goes on with them by `impactite.resume`";
            return Err(Failed::Value(why.into()));
        }
        state.changes += 1;
        state.solver.resume(path).map_err(|error| {
            state.unusable = Some(format!("the simulation was left half resumed by `{}`", path.display()));
            Failed::Checkpoint(path.into(), error)
        })
    }
}
