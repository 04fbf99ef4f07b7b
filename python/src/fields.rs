//! State of the points of a body as arrays.

use impactite::scene::{Body, PointView};
use numpy::ndarray::Array2;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Columns of all points of a body, sorted by point number, in memory that the arrays take over.
#[derive(Default)]
pub struct Columns {
    numbers: Vec<i64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    stress: Vec<f64>,
    masses: Vec<f64>,
    volumes: Vec<f64>,
    widths: Vec<f64>,
    pressure: Vec<f64>,
    von_mises: Vec<f64>,
    failed: Vec<bool>,
    state: Vec<Vec<f64>>,
}

impl Columns {
    /// Gather the columns of a body in one pass over its points, in a scene of so many dimensions.
    pub fn of(body: &dyn Body, dimensions: usize, axisymmetric: bool) -> Self {
        let mut all = Columns { state: vec![Vec::new(); body.state_names().len()], ..Columns::default() };
        all.reserve(body.len());
        body.for_each(&mut |p| all.push(p, p.drawn_width(dimensions, axisymmetric)));
        if !all.numbers.is_sorted() {
            all.sort();
        }
        all
    }

    fn reserve(&mut self, points: usize) {
        self.numbers.reserve_exact(points);
        self.positions.reserve_exact(3 * points);
        self.velocities.reserve_exact(3 * points);
        self.stress.reserve_exact(6 * points);
        self.failed.reserve_exact(points);
        let Columns { masses, volumes, widths, pressure, von_mises, state, .. } = self;
        let scalars = [masses, volumes, widths, pressure, von_mises];
        scalars.into_iter().chain(state).for_each(|column| column.reserve_exact(points));
    }

    fn push(&mut self, p: &PointView, width: f64) {
        // Point numbers fit, since they are indices in memory.
        self.numbers.push(p.number as i64);
        self.positions.extend(p.position);
        self.velocities.extend(p.velocity);
        self.stress.extend(p.stress);
        self.masses.push(p.mass);
        self.volumes.push(p.volume);
        self.widths.push(width);
        self.pressure.push(p.pressure());
        self.von_mises.push(p.von_mises());
        self.failed.push(p.failed);
        self.state.iter_mut().zip(&p.state).for_each(|(column, value)| column.push(*value));
    }

    /// Sort by point number, since a solver sorts points by position.
    fn sort(&mut self) {
        let mut order: Vec<usize> = (0..self.numbers.len()).collect();
        order.sort_unstable_by_key(|&place| self.numbers[place]);
        arrange(&mut self.numbers, &order, 1);
        arrange(&mut self.positions, &order, 3);
        arrange(&mut self.velocities, &order, 3);
        arrange(&mut self.stress, &order, 6);
        arrange(&mut self.failed, &order, 1);
        let Columns { masses, volumes, widths, pressure, von_mises, state, .. } = self;
        let scalars = [masses, volumes, widths, pressure, von_mises];
        scalars.into_iter().chain(state).for_each(|column| arrange(column, &order, 1));
    }
}

/// Reorder the rows of a table of `width` columns.
fn arrange<X: Copy>(table: &mut Vec<X>, order: &[usize], width: usize) {
    let mut rows = Vec::with_capacity(table.len());
    order.iter().for_each(|&row| rows.extend_from_slice(&table[width * row..width * (row + 1)]));
    *table = rows;
}

/// Read-only arrays of the columns, without a copy. Repeated requests return the same arrays.
pub struct Fields {
    pub numbers: Py<PyArray1<i64>>,
    pub positions: Py<PyArray2<f64>>,
    pub velocities: Py<PyArray2<f64>>,
    pub stress: Py<PyArray2<f64>>,
    pub masses: Py<PyArray1<f64>>,
    pub volumes: Py<PyArray1<f64>>,
    pub widths: Py<PyArray1<f64>>,
    pub pressure: Py<PyArray1<f64>>,
    pub von_mises: Py<PyArray1<f64>>,
    pub failed: Py<PyArray1<bool>>,
    pub state: Vec<Py<PyArray1<f64>>>,
}

impl Fields {
    /// Move the columns to Python arrays.
    pub fn new(py: Python<'_>, columns: Columns) -> PyResult<Self> {
        Ok(Fields {
            numbers: list(py, columns.numbers),
            positions: table(py, columns.positions, 3)?,
            velocities: table(py, columns.velocities, 3)?,
            stress: table(py, columns.stress, 6)?,
            masses: list(py, columns.masses),
            volumes: list(py, columns.volumes),
            widths: list(py, columns.widths),
            pressure: list(py, columns.pressure),
            von_mises: list(py, columns.von_mises),
            failed: list(py, columns.failed),
            state: columns.state.into_iter().map(|column| list(py, column)).collect(),
        })
    }
}

fn list<X: Element>(py: Python<'_>, column: Vec<X>) -> Py<PyArray1<X>> {
    let array = PyArray1::from_vec(py, column);
    array.readwrite().make_nonwriteable();
    array.unbind()
}

fn table(py: Python<'_>, values: Vec<f64>, width: usize) -> PyResult<Py<PyArray2<f64>>> {
    let shaped = Array2::from_shape_vec((values.len() / width, width), values);
    let shaped = shaped.map_err(|error| crate::error::RunError::new_err(error.to_string()))?;
    let array = PyArray2::from_owned_array(py, shaped);
    array.readwrite().make_nonwriteable();
    Ok(array.unbind())
}
