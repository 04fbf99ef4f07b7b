//! Snapshots of scenes.

use std::collections::HashMap;

use impactite_output::{Cells, FieldKind, FieldValues, OutputError, ParticleSize, Snapshot};

use crate::archive::{Archive, CheckpointError};
use crate::body::{Body, PointView};
use crate::clock::Clock;

/// Gather all points of all bodies.
pub(crate) fn gather(
    dimensions: usize,
    axisymmetric: bool,
    clock: &Clock,
    bodies: &[&dyn Body],
) -> Result<Snapshot, OutputError> {
    let mut columns = Gathered::new(bodies);
    for (index, body) in bodies.iter().enumerate() {
        let places = columns.places(&body.state_names());
        // A failed point carries no tension, and its volume may grow without bound: its drawn width is at most that of the widest intact
        // one.
        let (mut failed, mut widest) = (Vec::new(), 0.0f64);
        body.for_each(&mut |p| {
            let width = p.drawn_width(dimensions, axisymmetric);
            if p.failed {
                failed.push(columns.sizes.len());
            } else {
                widest = widest.max(width);
            }
            columns.push(index as u32, p, width, &places);
        });
        if widest > 0.0 {
            for point in failed {
                columns.sizes[point] = columns.sizes[point].min(widest);
            }
        }
    }
    // Lines are drawn in the plane.
    let snapshot = columns.into_snapshot(dimensions.max(2), clock.time, clock.steps)?;
    Ok(snapshot.with_body_names(bodies.iter().map(|body| body.name())))
}

/// Return names and kinds of the fields of [`Solver::snapshot`](crate::Solver::snapshot), without their values.
#[must_use]
pub fn snapshot_fields(bodies: &[&dyn Body]) -> Vec<(String, FieldKind)> {
    let own = OWN.into_iter().map(|(name, kind)| (name.to_string(), kind));
    own.chain(state_fields(bodies).into_iter().map(|name| (field_name(name), FieldKind::Scalar))).collect()
}

/// Fields of every snapshot.
const OWN: [(&str, FieldKind); 5] = [
    ("velocity", FieldKind::Vector),
    ("stress", FieldKind::Tensor),
    ("pressure", FieldKind::Scalar),
    ("von_mises", FieldKind::Scalar),
    ("particle", FieldKind::Scalar),
];

/// Return the names of the state variables that become fields.
fn state_fields(bodies: &[&dyn Body]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in bodies.iter().flat_map(|b| b.state_names()) {
        if !is_stress(&name) && !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Return the field name of a state variable.
fn field_name(name: String) -> String {
    if TAKEN.contains(&name.as_str()) { format!("state_{name}") } else { name }
}

impl Archive {
    /// Write or read snapshots.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn snapshots(&mut self, list: &mut Vec<Snapshot>) -> Result<(), CheckpointError> {
        let mut count = list.len();
        self.count(&mut count)?;
        if self.reads() {
            list.clear();
            for _ in 0..count {
                let mut parts = Parts::default();
                parts.archive(self)?;
                list.push(parts.into_snapshot().map_err(|error| self.damaged(error.to_string()))?);
            }
            return Ok(());
        }
        list.iter().try_for_each(|snapshot| Parts::of(snapshot).archive(self))
    }
}

/// Contents of a snapshot.
#[derive(Default)]
struct Parts {
    dimension: usize,
    time: f64,
    step: u64,
    positions: Vec<[f64; 3]>,
    /// One size for all points, or one per point.
    sizes: Vec<f64>,
    uniform: bool,
    bodies: Vec<u32>,
    names: Vec<String>,
    fields: Vec<(String, Field)>,
    cells: Option<Cells>,
    node_vectors: Vec<(String, Vec<[f64; 3]>)>,
}

/// Columns of a field by its number of components; one of them is not empty.
#[derive(Clone, Default)]
struct Field {
    components: u64,
    scalars: Vec<f64>,
    vectors: Vec<[f64; 3]>,
    tensors: Vec<[f64; 6]>,
}

impl Field {
    fn of(values: &FieldValues) -> Self {
        let blank = Field::default();
        match values.clone() {
            FieldValues::Scalar(scalars) => Field { components: 1, scalars, ..blank },
            FieldValues::Vector(vectors) => Field { components: 3, vectors, ..blank },
            FieldValues::Tensor(tensors) => Field { components: 6, tensors, ..blank },
        }
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.word(&mut self.components)?;
        file.list(&mut self.scalars, &0.0, Archive::real)?;
        file.list(&mut self.vectors, &[0.0; 3], |file, v| file.reals(v))?;
        file.list(&mut self.tensors, &[0.0; 6], |file, t| file.reals(t))
    }

    fn into_values(self) -> FieldValues {
        match self.components {
            1 => FieldValues::Scalar(self.scalars),
            3 => FieldValues::Vector(self.vectors),
            _ => FieldValues::Tensor(self.tensors),
        }
    }
}

impl Parts {
    fn of(snapshot: &Snapshot) -> Self {
        let (sizes, uniform) = match snapshot.size() {
            ParticleSize::Uniform(size) => (vec![*size], true),
            ParticleSize::Each(list) => (list.clone(), false),
        };
        Parts {
            dimension: snapshot.dimension(),
            time: snapshot.time(),
            step: snapshot.step(),
            positions: snapshot.positions().to_vec(),
            sizes,
            uniform,
            bodies: snapshot.bodies().to_vec(),
            names: snapshot.body_names().to_vec(),
            fields: snapshot.fields().map(|(name, values)| (name.to_string(), Field::of(values))).collect(),
            cells: snapshot.cells().cloned(),
            node_vectors: snapshot
                .node_vectors()
                .map(|(name, list)| (name.to_string(), list.to_vec()))
                .collect(),
        }
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.count(&mut self.dimension)?;
        file.real(&mut self.time)?;
        file.word(&mut self.step)?;
        file.list(&mut self.positions, &[0.0; 3], |file, x| file.reals(x))?;
        file.flag(&mut self.uniform)?;
        file.list(&mut self.sizes, &0.0, Archive::real)?;
        file.list(&mut self.bodies, &0, |file, body| file.index(body, usize::MAX))?;
        file.list(&mut self.names, &String::new(), Archive::text)?;
        file.list(&mut self.fields, &Default::default(), |file, (name, field)| {
            file.text(name)?;
            field.archive(file)
        })?;
        file.option(&mut self.cells, |file, Cells { nodes, corners, ends }| {
            file.list(nodes, &[0.0; 3], |file, x| file.reals(x))?;
            file.list(corners, &0, |file, corner| file.index(corner, usize::MAX))?;
            file.list(ends, &0, |file, end| file.index(end, usize::MAX))
        })?;
        file.list(&mut self.node_vectors, &Default::default(), |file, (name, list)| {
            file.text(name)?;
            file.list(list, &[0.0; 3], |file, v| file.reals(v))
        })
    }

    fn into_snapshot(self) -> Result<Snapshot, OutputError> {
        let size = match (self.uniform, self.sizes.first()) {
            (true, Some(size)) => ParticleSize::Uniform(*size),
            _ => ParticleSize::Each(self.sizes),
        };
        let snapshot = Snapshot::new(self.dimension, self.time, self.step, self.positions, size)?;
        let snapshot = snapshot.with_bodies(self.bodies)?.with_body_names(self.names);
        let snapshot = match self.cells {
            Some(cells) => snapshot.with_cells(cells)?,
            None => snapshot,
        };
        let snapshot =
            self.node_vectors.into_iter().try_fold(snapshot, |s, (n, v)| s.with_node_vector(n, v))?;
        let fields = self.fields.into_iter();
        fields
            .map(|(name, field)| (name, field.into_values()))
            .try_fold(snapshot, |s, (n, v)| s.with_field(n, v))
    }
}

/// Field names reserved for snapshots and frames.
const TAKEN: [&str; 8] =
    ["velocity", "displacement", "stress", "pressure", "von_mises", "particle", "body", "size"];

/// Columns of a snapshot during gathering.
#[derive(Default)]
struct Gathered {
    positions: Vec<[f64; 3]>,
    sizes: Vec<f64>,
    bodies: Vec<u32>,
    velocity: Vec<[f64; 3]>,
    stress: Vec<[f64; 6]>,
    pressure: Vec<f64>,
    von_mises: Vec<f64>,
    particle: Vec<f64>,
    names: Vec<String>,
    state: Vec<Vec<f64>>,
    cells: Cells,
    /// Node numbers by the bits of their positions: neighbouring cells share nodes.
    nodes: HashMap<[u64; 3], u32>,
}

impl Gathered {
    fn new(bodies: &[&dyn Body]) -> Self {
        let names = state_fields(bodies);
        let count = bodies.iter().map(|body| body.len()).sum();
        Gathered {
            positions: Vec::with_capacity(count),
            sizes: Vec::with_capacity(count),
            bodies: Vec::with_capacity(count),
            velocity: Vec::with_capacity(count),
            stress: Vec::with_capacity(count),
            pressure: Vec::with_capacity(count),
            von_mises: Vec::with_capacity(count),
            particle: Vec::with_capacity(count),
            state: names.iter().map(|_| Vec::with_capacity(count)).collect(),
            names,
            ..Self::default()
        }
    }

    /// Return for every column the index of its variable in a body's state.
    fn places(&self, body: &[String]) -> Vec<Option<usize>> {
        self.names.iter().map(|name| body.iter().position(|n| n == name)).collect()
    }

    fn push(&mut self, body: u32, p: &PointView, size: f64, places: &[Option<usize>]) {
        let (pressure, von_mises) = (p.pressure(), p.von_mises());
        self.positions.push(p.position);
        self.sizes.push(size);
        self.bodies.push(body);
        self.velocity.push(p.velocity);
        self.stress.push(p.stress);
        self.pressure.push(pressure);
        self.von_mises.push(von_mises);
        self.particle.push(p.number as f64);
        for corner in &p.corners {
            let next = self.cells.nodes.len() as u32;
            let node = *self.nodes.entry(corner.map(f64::to_bits)).or_insert(next);
            if node == next {
                self.cells.nodes.push(*corner);
            }
            self.cells.corners.push(node);
        }
        self.cells.ends.push(self.cells.corners.len() as u32);
        for (column, place) in self.state.iter_mut().zip(places) {
            column.push(place.and_then(|i| p.state.get(i).copied()).unwrap_or(f64::NAN));
        }
    }

    fn into_snapshot(self, dimension: usize, time: f64, step: u64) -> Result<Snapshot, OutputError> {
        let mut snapshot =
            Snapshot::new(dimension, time, step, self.positions, ParticleSize::Each(self.sizes))?
                .with_bodies(self.bodies)?
                .with_vector("velocity", self.velocity)?
                .with_tensor("stress", self.stress)?
                .with_scalar("pressure", self.pressure)?
                .with_scalar("von_mises", self.von_mises)?
                .with_scalar("particle", self.particle)?;
        if !self.cells.corners.is_empty() {
            snapshot = snapshot.with_cells(self.cells)?;
        }
        for (name, column) in self.names.into_iter().zip(self.state) {
            snapshot = snapshot.with_field(field_name(name), FieldValues::Scalar(column))?;
        }
        Ok(snapshot)
    }
}

/// True for the six components of a law's Cauchy stress.
fn is_stress(name: &str) -> bool {
    name.strip_prefix("stress_").is_some_and(|c| ["xx", "yy", "zz", "yz", "xz", "xy"].contains(&c))
}
