//! What observers see.

use std::cell::OnceCell;

use crate::geometry::Lattice;
use crate::output::{FieldValues, OutputError, ParticleSize, Snapshot};
use crate::parallel::Float;
use crate::step::nodes::NodeLedger;
use crate::step::{Body, ContactNode, Encounters, Mpm, PairContact, Particle, Totals, Work};

/// A run between two steps. Knows neither the method nor the grid, so that observers need not either.
pub struct Moment<'a, T: Float, const D: usize> {
    pub(super) work: &'a dyn Work<T, D>,
    pub(super) time: f64,
    pub(super) end: f64,
    pub(super) step: u64,
    pub(super) bodies: &'a [Box<dyn Body<T, D>>],
    pub(super) contacts: &'a [PairContact],
    pub(super) encounters: &'a Encounters<T>,
    pub(super) lattice: Lattice<D>,
    pub(super) ledger: NodeLedger,
    pub(super) axisymmetric: bool,
    pub(super) updates: f64,
    pub(super) wall_seconds: f64,
    pub(super) totals: OnceCell<Totals>,
}

impl<T: Float, const D: usize> Moment<'_, T, D> {
    /// Simulated time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }
    /// When the run ends, s.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }
    /// Steps made since the scene was set up.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.step
    }
    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &[Box<dyn Body<T, D>>] {
        self.bodies
    }
    /// The pairs of bodies that were ever in contact: force, nodes and gap in the last step, energy since the
    /// start.
    #[must_use]
    pub fn contacts(&self) -> &[PairContact] {
        self.contacts
    }
    /// The nodes in contact in the last step, with gap, normal and impulse.
    #[must_use]
    pub fn contact_nodes(&self) -> Vec<ContactNode> {
        self.encounters.nodes(&self.lattice)
    }
    /// What boundaries and loads gave to the material since the start, and what contact took.
    #[must_use]
    pub fn ledger(&self) -> NodeLedger {
        self.ledger
    }
    /// Are the coordinates (r, z) of a body of revolution? Then extensive quantities are per radian.
    #[must_use]
    pub fn axisymmetric(&self) -> bool {
        self.axisymmetric
    }
    /// Seconds of wall-clock time spent in the steps of this run so far, observers left out.
    #[must_use]
    pub fn wall_seconds(&self) -> f64 {
        self.wall_seconds
    }
    /// Particle updates a second in this run so far; 0 before its first step.
    #[must_use]
    pub fn rate(&self) -> f64 {
        if self.wall_seconds > 0.0 { self.updates / self.wall_seconds } else { 0.0 }
    }
    /// Totals over all particles, added up once however many observers ask.
    pub fn totals(&self) -> &Totals {
        self.totals
            .get_or_init(|| self.bodies.iter().map(|b| b.totals()).fold(Totals::default(), |a, b| a.plus(&b)))
    }

    /// All particles of all bodies as pictures and files want them.
    ///
    /// Fields: `velocity` (m/s), `stress` (Cauchy, Pa), `pressure` (compression positive, Pa), `von_mises`
    /// (Pa), `particle` (its number in its body), then every number the laws keep, by
    /// [`Body::state_names`]; NaN for bodies whose law keeps no such number. `stress_xx` and its five
    /// companions are left out, being in `stress`; a name already taken gets `state_` before it.
    ///
    /// Bodies are numbered in their order, from 0. A particle's size is the edge of a cube (square in two
    /// dimensions) of its volume.
    ///
    /// # Errors
    /// A scene without particles, or law state names that cannot be field names.
    pub fn snapshot(&self) -> Result<Snapshot, OutputError> {
        self.work.snapshot(self)
    }

    pub(crate) fn gathered(&self) -> Result<Snapshot, OutputError> {
        let mut columns = Gathered::new(self.bodies);
        for (index, body) in self.bodies.iter().enumerate() {
            let places = columns.places(&body.state_names());
            body.for_each(&mut |p| columns.push(index as u32, p, size_of(p, D, self.axisymmetric), &places));
        }
        columns.into_snapshot(D, self.time, self.step)
    }
}

/// Edge of a cube (square) of a particle's volume, m.
fn size_of(p: &Particle, dimension: usize, axisymmetric: bool) -> f64 {
    let size = match (dimension, axisymmetric) {
        (3, _) => p.volume.cbrt(),
        (_, true) => (p.volume / p.position[0]).sqrt(),
        (_, false) => p.volume.sqrt(),
    };
    if size.is_finite() && size > 0.0 { size } else { f64::MIN_POSITIVE }
}

/// Names that the snapshot gives itself.
const TAKEN: [&str; 7] = ["velocity", "stress", "pressure", "von_mises", "particle", "body", "size"];

/// Columns of a snapshot while it is gathered.
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
}

impl Gathered {
    fn new<T: Float, const D: usize>(bodies: &[Box<dyn Body<T, D>>]) -> Self {
        let mut names: Vec<String> = Vec::new();
        for name in bodies.iter().flat_map(|b| b.state_names()) {
            if !is_stress(&name) && !names.contains(&name) {
                names.push(name);
            }
        }
        Gathered { state: vec![Vec::new(); names.len()], names, ..Self::default() }
    }

    /// For every column, which number of a body's state fills it.
    fn places(&self, body: &[String]) -> Vec<Option<usize>> {
        self.names.iter().map(|name| body.iter().position(|n| n == name)).collect()
    }

    fn push(&mut self, body: u32, p: &Particle, size: f64, places: &[Option<usize>]) {
        let (pressure, von_mises) = (p.pressure(), p.von_mises());
        self.positions.push(p.position);
        self.sizes.push(size);
        self.bodies.push(body);
        self.velocity.push(p.velocity);
        self.stress.push(p.stress);
        self.pressure.push(pressure);
        self.von_mises.push(von_mises);
        self.particle.push(p.number as f64);
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
        for (name, column) in self.names.into_iter().zip(self.state) {
            let name = if TAKEN.contains(&name.as_str()) { format!("state_{name}") } else { name };
            snapshot = snapshot.with_field(name, FieldValues::Scalar(column))?;
        }
        Ok(snapshot)
    }
}

/// Is it one of the six columns of a law's Cauchy stress?
fn is_stress(name: &str) -> bool {
    name.strip_prefix("stress_").is_some_and(|c| ["xx", "yy", "zz", "yz", "xz", "xy"].contains(&c))
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// The scene as observers would see it now.
    #[must_use]
    pub fn moment(&self) -> Moment<'_, T, D> {
        Moment {
            work: self.work(),
            time: self.time(),
            end: self.time(),
            step: self.steps(),
            bodies: self.bodies(),
            contacts: self.contacts(),
            encounters: self.encounters(),
            lattice: *self.grid().lattice(),
            ledger: self.ledger(),
            axisymmetric: self.facts().hoop,
            updates: 0.0,
            wall_seconds: 0.0,
            totals: OnceCell::new(),
        }
    }

    /// All particles of all bodies as pictures and files want them; see [`Moment::snapshot`].
    ///
    /// # Errors
    /// As [`Moment::snapshot`].
    pub fn snapshot(&self) -> Result<Snapshot, OutputError> {
        self.moment().snapshot()
    }
}
