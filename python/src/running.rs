//! State of a simulation, shared with its bodies.

use std::ops::{Deref, DerefMut};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use impactite::observe::RunView;
use impactite::parallel::Team;
use impactite::scene::Solver;
use impactite_input::measured::Measures;
use impactite_input::{SceneFile, Source};
use parking_lot::MutexGuard;
use pyo3::prelude::*;

use crate::error::Failed;
use crate::fields::{Columns, Fields};

/// Longest interval between checks for Ctrl-C, unless one step takes longer.
const PIECE: Duration = Duration::from_millis(50);
const BROKEN_OFF: &str = "the simulation broke off within a step and cannot go on";

/// Scene that is set up, with its threads.
pub struct Running {
    /// Parsed scene file.
    pub scene: Arc<SceneFile>,
    /// Number of threads.
    pub threads: usize,
    /// Locked only without the interpreter lock (GIL), for which a stepping thread may wait. A lock that can be handed over: a thread
    /// that unlocks and locks again, as one does that steps, is faster than any that waits.
    state: parking_lot::Mutex<State>,
    /// Process of the thread that has locked `state`; 0 if unlocked.
    holder: AtomicU32,
    /// Arrays of each body.
    gathered: Mutex<Vec<Option<Gathered>>>,
}

/// Arrays of a body.
struct Gathered {
    /// Value of [`State::changes`] when the arrays were gathered.
    changes: u64,
    fields: Arc<Fields>,
}

struct State {
    solver: Box<dyn Solver>,
    /// Threads of the solver, which measures use, too.
    team: Team,
    /// Measures of the scene, by the initial positions of points.
    measures: Measures,
    /// Number of changes of the scene.
    changes: u64,
    /// Reason for which the simulation is unusable, if it is.
    unusable: Option<String>,
}

impl State {
    /// True if a measure ends the scene.
    fn by_measure(&self) -> Result<bool, Failed> {
        Ok(self.team.run(|| self.measures.ended(&RunView::of(&*self.solver)))?.is_some())
    }
}

/// Locked state.
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
    // Reset before the lock of the state is released.
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.state.unusable.get_or_insert_with(|| BROKEN_OFF.into());
        }
        self.holder.store(0, Ordering::SeqCst);
    }
}
impl Held<'_> {
    /// Let the thread that has waited longest have the state, if one waits.
    fn give_way(&mut self) {
        let process = self.holder.swap(0, Ordering::SeqCst);
        MutexGuard::bump(&mut self.state);
        self.holder.store(process, Ordering::SeqCst);
    }
}

impl Running {
    /// Set up the scene.
    pub fn new(source: &Source, scene: Arc<SceneFile>, threads: Option<usize>) -> Result<Self, Failed> {
        let all = || std::thread::available_parallelism().map_or(1, usize::from).min(Team::MOST);
        let team = Team::new(threads.unwrap_or_else(all)).map_err(|e| Failed::Value(e.to_string()))?;
        let threads = team.threads();
        let mut solver = team.run(|| source.build(&scene))?;
        solver.set_team(team.clone());
        let measures = team.run(|| Measures::new(source, &scene, &*solver))?;
        let gathered = solver.bodies().iter().map(|_| None).collect();
        let state = State { solver, team, measures, changes: 0, unusable: None };
        Ok(Running {
            scene,
            threads,
            state: parking_lot::Mutex::new(state),
            holder: AtomicU32::new(0),
            gathered: Mutex::new(gathered),
        })
    }

    fn lock(&self) -> Result<Held<'_>, Failed> {
        let process = std::process::id();
        let mut waited = 0;
        let state = loop {
            match self.state.try_lock() {
                Some(state) => break state,
                None => match self.holder.load(Ordering::SeqCst) {
                    // Time between locking and storing the holder: permanent only in a child that was forked at that moment.
                    0 if waited < 1000 => {
                        waited += 1;
                        std::thread::sleep(Duration::from_millis(1));
                    }
                    holder if holder == process => break self.state.lock(),
                    // Locked by a thread of the parent process, which does not exist in the child.
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

    /// Return the result of `look` on the solver between two steps.
    pub fn look<R: Send>(
        &self,
        py: Python<'_>,
        look: impl FnOnce(&mut dyn Solver) -> R + Send,
    ) -> PyResult<R> {
        Ok(py.detach(|| Ok::<R, Failed>(look(&mut *self.lock()?.solver)))?)
    }

    /// Return the measures of the current state, in SI units.
    pub fn measured(&self, py: Python<'_>) -> PyResult<Vec<f64>> {
        let taken = py.detach(|| {
            let state = self.lock()?;
            Ok::<_, Failed>(state.team.run(|| state.measures.take(&RunView::of(&*state.solver)))?)
        });
        Ok(taken?)
    }

    /// Return the arrays of a body by its index, gathered once per state.
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
        // Another thread may have been faster: all threads return its arrays.
        let fields = Arc::new(Fields::new(py, columns)?);
        if let Some(fields) = kept(changes) {
            return Ok(fields);
        }
        if let Some(slot) = self.gathered.lock().ok().as_mut().and_then(|all| all.get_mut(place)) {
            *slot = Some(Gathered { changes, fields: fields.clone() });
        }
        Ok(fields)
    }

    /// Release the arrays; memory that Python still references stays.
    fn forget(&self) {
        if let Ok(mut gathered) = self.gathered.lock() {
            gathered.fill_with(|| None);
        }
    }

    /// True if the scene has reached its end time or the end condition of a measure.
    pub fn ended(&self, py: Python<'_>) -> PyResult<bool> {
        let ended = py.detach(|| {
            let state = self.lock()?;
            Ok::<_, Failed>(state.solver.reached(self.scene.end.value) || state.by_measure()?)
        });
        Ok(ended?)
    }

    /// Make at most `most` steps towards the end of the scene or towards `time`, s, with regular checks for signals. Returns the number of
    /// steps made.
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
                        state.give_way();
                        return Ok(false);
                    }
                    state.changes += 1;
                    let State { solver, team, measures, .. } = &mut *state;
                    solver.step_towards(end)?;
                    team.run(|| measures.look(&RunView::of(&**solver)))?;
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

    /// Resume from a checkpoint; after an error of the checkpoint the simulation is unusable.
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
