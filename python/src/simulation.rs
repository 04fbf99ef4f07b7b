//! Python class of a simulation.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::body::Body;
use crate::error::Failed;
use crate::running::Running;

/// A scene that is set up and goes on by steps, made by `Scene.simulation`.
///
/// A step that cannot be made raises `RunError`. While it steps other threads of Python run; one that asks it for something waits for
/// a step to end. Ctrl-C stops it between two steps, after which it may go on.
#[pyclass(frozen, module = "impactite")]
pub struct Simulation(Arc<Running>);

impl Simulation {
    /// Create a simulation of a scene that is set up.
    pub fn new(running: Running) -> Self {
        Simulation(Arc::new(running))
    }
}

#[pymethods]
impl Simulation {
    /// Make `n` steps, or fewer where the scene ends. Returns how many were made: 0 at the end.
    #[pyo3(signature = (n=1))]
    fn step(&self, py: Python<'_>, n: u64) -> PyResult<u64> {
        // After the end of the scene no step is made towards it.
        if self.0.ended(py)? { Ok(0) } else { self.0.advance(py, None, n) }
    }

    /// Step until the time `t`, s, which is met exactly: the last steps are shortened for it. It may be after the end of the scene.
    fn run_until(&self, py: Python<'_>, t: f64) -> PyResult<()> {
        self.0.advance(py, Some(t), u64::MAX).map(drop)
    }

    /// Step until the scene ends: the same bits as `impactite.run`.
    fn run(&self, py: Python<'_>) -> PyResult<()> {
        if self.0.ended(py)? { Ok(()) } else { self.0.advance(py, None, u64::MAX).map(drop) }
    }

    /// Simulated time, s.
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        self.0.look(py, |solver| solver.time())
    }
    /// Steps made.
    #[getter]
    fn steps(&self, py: Python<'_>) -> PyResult<u64> {
        self.0.look(py, |solver| solver.steps())
    }
    /// Size of the last step, s; None before the first.
    #[getter]
    fn dt(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        self.0.look(py, |solver| solver.clock().last)
    }
    /// Has the scene come to its end?
    #[getter]
    fn reached_end(&self, py: Python<'_>) -> PyResult<bool> {
        self.0.ended(py)
    }
    /// When the scene ends, s.
    #[getter]
    fn end(&self) -> f64 {
        self.0.scene.end.value
    }
    /// The method, in a line of words.
    #[getter]
    fn method(&self, py: Python<'_>) -> PyResult<String> {
        self.0.look(py, |solver| solver.method())
    }
    /// Dimensions of the scene, 2 or 3.
    #[getter]
    fn dimensions(&self, py: Python<'_>) -> PyResult<usize> {
        self.0.look(py, |solver| solver.dimensions())
    }
    /// Threads that it steps on.
    #[getter]
    fn threads(&self) -> usize {
        self.0.threads
    }

    /// The bodies, by name. They show the simulation as it is when they are asked.
    #[getter]
    fn bodies<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let py = slf.py();
        let said = slf.get().0.look(py, |solver| {
            let of = |b: &&dyn impactite::scene::Body| (b.name().to_string(), b.law(), b.state_names());
            solver.bodies().iter().map(of).collect::<Vec<_>>()
        })?;
        let all = PyDict::new(py);
        for (place, (name, law, states)) in said.into_iter().enumerate() {
            all.set_item(&name, Body::new(slf.get().0.clone(), place, name.clone(), law, states))?;
        }
        Ok(all)
    }

    /// The measures of the scene as it stands, in SI units, by name. Of a quarter model they are those of the quarter.
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = self.0.measured(py)?;
        let all = PyDict::new(py);
        self.0.scene.measures.keys().zip(values).try_for_each(|(name, value)| all.set_item(name, value))?;
        Ok(all)
    }

    /// Energies, J (per radian around an axis, per metre of depth in the plane).
    ///
    /// `kinetic`, `internal`, `total` (their sum), `work` of loads, `friction`, `impacts`, `damping`, `viscosity` (numerical), `viscous_heat` (of laws, part of
    /// `internal`), `unexplained`; and `error`, what nothing
    /// explains over the largest energy so far.
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (totals, account) = self.0.look(py, |solver| (solver.totals(), solver.account()))?;
        let all = PyDict::new(py);
        for (name, value) in [
            ("kinetic", totals.kinetic_now()),
            ("internal", totals.internal),
            ("total", totals.kinetic_now() + totals.internal),
            ("work", account.work),
            ("friction", account.friction),
            ("impacts", account.impacts),
            ("damping", account.damping),
            ("viscosity", account.viscosity),
            ("viscous_heat", account.viscous_heat),
            ("unexplained", account.unexplained),
            ("error", account.energy_error()),
        ] {
            all.set_item(name, value)?;
        }
        Ok(all)
    }

    /// What the run warned of so far.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.0.look(py, |solver| {
            solver.warnings().iter().map(|w| impactite_input::shown(&w.to_string())).collect()
        })
    }

    /// Write a checkpoint to the file `path`, which is the old one or the new one at any time.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let written = self.0.look(py, |solver| solver.save(&path))?;
        Ok(written.map_err(|error| Failed::Checkpoint(path, error))?)
    }

    /// Go on from the checkpoint `path` that a simulation of the same scene saved, bit for bit. After a `RunError` this simulation is
    /// not to be used any more.
    fn resume(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        Ok(py.detach(|| self.0.resume(&path))?)
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Simulation cannot be pickled or copied; save a checkpoint by `simulation.save(path)` and resume it by \
             `scene.simulation().resume(path)`; scenes, results and arrays can be pickled",
        ))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (time, steps) = self.0.look(py, |solver| (solver.time(), solver.steps()))?;
        Ok(format!("<impactite.Simulation {:?}, t = {time} s, {steps} steps>", self.0.scene.title))
    }
}
