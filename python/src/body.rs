//! Python class of a body of a simulation.

use std::sync::Arc;

use impactite::scene::Totals;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::fields::Fields;
use crate::running::Running;

/// A body of a simulation, as it is when it is asked.
///
/// Its arrays have a row a point (a particle, or an element), in the order of `numbers`. They are gathered once a state, all in one
/// pass, and handed over without a copy; later steps do not change them. They cannot be written to: that would change nothing in the
/// simulation.
#[pyclass(frozen, module = "impactite")]
pub struct Body {
    running: Arc<Running>,
    place: usize,
    #[pyo3(get)]
    /// Its name.
    name: String,
    #[pyo3(get)]
    /// The name of its law; empty without one.
    law: &'static str,
    #[pyo3(get)]
    /// The names in `state`.
    state_names: Vec<String>,
}

impl Body {
    /// Create the body at this index of a scene.
    pub fn new(
        running: Arc<Running>,
        place: usize,
        name: String,
        law: &'static str,
        state_names: Vec<String>,
    ) -> Self {
        Body { running, place, name, law, state_names }
    }

    fn fields(&self, py: Python<'_>) -> PyResult<Arc<Fields>> {
        self.running.fields(py, self.place)
    }

    fn totals(&self, py: Python<'_>) -> PyResult<Totals> {
        let place = self.place;
        self.running.look(py, |solver| solver.bodies().get(place).map_or(Totals::default(), |b| b.totals()))
    }
}

#[pymethods]
impl Body {
    /// How many points it has; none of a wall.
    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        let place = self.place;
        self.running.look(py, |solver| solver.bodies().get(place).map_or(0, |b| b.len()))
    }
    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a Body cannot be pickled or copied; its arrays can be, and `simulation.save(path)` writes a checkpoint",
        ))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<impactite.Body {:?}, {} points, {}>", self.name, self.__len__(py)?, self.law))
    }

    /// Mass, kg (per radian around an axis, per metre of depth in the plane).
    #[getter]
    fn mass(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.totals(py)?.mass)
    }
    /// Momentum along x, y, z, kg m/s.
    #[getter]
    fn momentum(&self, py: Python<'_>) -> PyResult<(f64, f64, f64)> {
        Ok(self.totals(py)?.momentum.into())
    }
    /// Kinetic energy, J.
    #[getter]
    fn kinetic(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.totals(py)?.kinetic)
    }
    /// Internal energy, plastic work and heat included, J.
    #[getter]
    fn internal(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.totals(py)?.internal)
    }

    /// Numbers of the points, which stay the same over a run; shape (n,).
    #[getter]
    fn numbers(&self, py: Python<'_>) -> PyResult<Py<PyArray1<i64>>> {
        Ok(self.fields(py)?.numbers.clone_ref(py))
    }
    /// Positions, m; shape (n, 3), (r, z, 0) around an axis.
    #[getter]
    fn positions(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        Ok(self.fields(py)?.positions.clone_ref(py))
    }
    /// Velocities, m/s; shape (n, 3).
    #[getter]
    fn velocities(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        Ok(self.fields(py)?.velocities.clone_ref(py))
    }
    /// Cauchy stress xx, yy, zz, yz, xz, xy, tension positive, Pa; shape (n, 6).
    #[getter]
    fn stress(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        Ok(self.fields(py)?.stress.clone_ref(py))
    }
    /// Masses, kg (per radian, per metre of depth); shape (n,).
    #[getter]
    fn masses(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        Ok(self.fields(py)?.masses.clone_ref(py))
    }
    /// Volumes, m^3 (per radian, per metre of depth); shape (n,).
    #[getter]
    fn volumes(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        Ok(self.fields(py)?.volumes.clone_ref(py))
    }
    /// How wide points are drawn, m: edges of cubes or squares of their volume; shape (n,).
    #[getter]
    fn widths(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        Ok(self.fields(py)?.widths.clone_ref(py))
    }
    /// Pressure, compression positive, Pa; shape (n,).
    #[getter]
    fn pressure(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        Ok(self.fields(py)?.pressure.clone_ref(py))
    }
    /// Von Mises equivalent stress, Pa; shape (n,).
    #[getter]
    fn von_mises(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        Ok(self.fields(py)?.von_mises.clone_ref(py))
    }
    /// Which points have failed; shape (n,), bool.
    #[getter]
    fn failed(&self, py: Python<'_>) -> PyResult<Py<PyArray1<bool>>> {
        Ok(self.fields(py)?.failed.clone_ref(py))
    }
    /// What the law keeps of each point, by the names in `state_names`; shapes (n,).
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (fields, all) = (self.fields(py)?, PyDict::new(py));
        self.state_names
            .iter()
            .zip(&fields.state)
            .try_for_each(|(name, column)| all.set_item(name, column))?;
        Ok(all)
    }
}
