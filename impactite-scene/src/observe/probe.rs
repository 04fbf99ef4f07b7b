//! Quantities of chosen particles.

use std::path::Path;

use super::{ObserveError, Observer, Pace, RunView};
use crate::archive::{Archive, CheckpointError};
use crate::body::{Body, PointView};
use impactite_output::{Column, History, OutputError};

/// Quantity that a probe reads from its particle.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// Component of the position, m: 0, 1, 2 are x, y, z (r, z in axisymmetric scenes); 3 and more read z.
    Position(usize),
    /// Component of the velocity, m/s, numbered as for the position.
    Velocity(usize),
    /// Pressure, compression positive, Pa.
    Pressure,
    /// Von Mises stress, Pa.
    VonMises,
    /// Component of the Cauchy stress, Pa: 0 to 5 are xx, yy, zz, yz, xz, xy; 6 and more read xy.
    Stress(usize),
    /// Volume, m^3 (per radian or metre of depth in two dimensions).
    Volume,
    /// State variable of the law, by its name in [`Body::state_names`], in its own unit.
    State(String),
}

/// Probe of a quantity of one particle.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Number of the body, from 0 in the order of addition.
    pub body: usize,
    /// Number of the particle in its body: its index among the seeds.
    pub particle: usize,
    /// Quantity to read.
    pub quantity: Quantity,
}

impl Probe {
    /// Create a probe of particle number `particle` of body number `body`.
    #[must_use]
    pub fn new(body: usize, particle: usize, quantity: Quantity) -> Self {
        Probe { body, particle, quantity }
    }

    fn column(&self) -> Column {
        let axis = |d: usize| ["x", "y", "z"][d.min(2)];
        let (what, unit) = match &self.quantity {
            Quantity::Position(d) => (format!("position {}", axis(*d)), "m"),
            Quantity::Velocity(d) => (format!("velocity {}", axis(*d)), "m/s"),
            Quantity::Pressure => ("pressure".into(), "Pa"),
            Quantity::VonMises => ("von Mises stress".into(), "Pa"),
            Quantity::Stress(c) => {
                (format!("stress {}", ["xx", "yy", "zz", "yz", "xz", "xy"][(*c).min(5)]), "Pa")
            }
            Quantity::Volume => ("volume".into(), "m^3"),
            Quantity::State(name) => (name.clone(), "SI"),
        };
        Column::new(format!("{what} of {}:{}", self.body, self.particle), unit)
    }

    fn read(&self, p: &PointView, state: Option<usize>) -> f64 {
        match &self.quantity {
            Quantity::Position(d) => p.position[(*d).min(2)],
            Quantity::Velocity(d) => p.velocity[(*d).min(2)],
            Quantity::Pressure => p.pressure(),
            Quantity::VonMises => p.von_mises(),
            Quantity::Stress(c) => p.stress[(*c).min(5)],
            Quantity::Volume => p.volume,
            Quantity::State(_) => state.and_then(|i| p.state.get(i).copied()).unwrap_or(f64::NAN),
        }
    }

    /// Return the index of the quantity in the law's state, if it is a state variable.
    fn place(&self, body: &dyn Body) -> Result<Option<usize>, ObserveError> {
        let Quantity::State(name) = &self.quantity else { return Ok(None) };
        let names = body.state_names();
        match names.iter().position(|n| n == name) {
            Some(place) => Ok(Some(place)),
            None => Err(ObserveError::NoState {
                body: body.name().into(),
                name: name.clone(),
                available: names.join(", "),
            }),
        }
    }
}

/// Values of all probes at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeRow {
    /// Time, s.
    pub time: f64,
    /// One value per probe, in their order.
    pub values: Vec<f64>,
}

/// Observer that records quantities of chosen particles and optionally writes them as CSV. Each observation visits all particles, so probe
/// no more often than needed.
///
/// ```
/// use impactite_scene::observe::{Pace, Probe, Probes, Quantity};
/// let probes = Probes::new(
///     [Probe::new(0, 17, Quantity::VonMises), Probe::new(0, 17, Quantity::State("plastic_strain".into()))],
///     Pace::interval(1.0e-6)?,
/// );
/// # Ok::<(), impactite_scene::observe::ObserveError>(())
/// ```
pub struct Probes {
    pace: Pace,
    probes: Vec<Probe>,
    rows: Vec<ProbeRow>,
    file: Option<History>,
}

impl Probes {
    /// Create an observer with these probes and this pace.
    #[must_use]
    pub fn new(probes: impl IntoIterator<Item = Probe>, pace: Pace) -> Self {
        Probes { pace, probes: probes.into_iter().collect(), rows: Vec::new(), file: None }
    }

    /// Also write a CSV file at `path`: time, then one column per probe.
    ///
    /// # Errors
    /// A duplicate probe, or a file that cannot be created.
    pub fn with_csv(mut self, path: impl AsRef<Path>) -> Result<Self, ObserveError> {
        let columns = std::iter::once(Column::new("time", "s")).chain(self.probes.iter().map(Probe::column));
        self.file = Some(History::create(path, columns)?);
        Ok(self)
    }

    fn write(&mut self, row: &ProbeRow) -> Result<(), OutputError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let mut numbers = vec![row.time];
        numbers.extend_from_slice(&row.values);
        file.push(&numbers)
    }

    /// Recorded values, in order of time.
    #[must_use]
    pub fn rows(&self) -> &[ProbeRow] {
        &self.rows
    }

    fn read(&self, now: &RunView<'_>) -> Result<Vec<f64>, ObserveError> {
        let bodies = now.bodies();
        let mut values: Vec<Option<f64>> = vec![None; self.probes.len()];
        let mut places = Vec::with_capacity(self.probes.len());
        for probe in &self.probes {
            let body = bodies.get(probe.body);
            let body = body.ok_or(ObserveError::NoBody { body: probe.body, bodies: bodies.len() })?;
            places.push(probe.place(*body)?);
        }
        for (index, body) in bodies.iter().enumerate() {
            if self.probes.iter().all(|p| p.body != index) {
                continue;
            }
            body.for_each(&mut |p| {
                for (i, probe) in self.probes.iter().enumerate() {
                    if probe.body == index && probe.particle == p.number {
                        values[i] = Some(probe.read(p, places[i]));
                    }
                }
            });
        }
        let missing = |probe: &Probe| ObserveError::NoParticle {
            body: bodies[probe.body].name().into(),
            particle: probe.particle,
            particles: bodies[probe.body].len(),
        };
        values.into_iter().zip(&self.probes).map(|(v, probe)| v.ok_or_else(|| missing(probe))).collect()
    }
}

impl Observer for Probes {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let row = ProbeRow { time: now.time(), values: self.read(now)? };
        self.write(&row)?;
        self.rows.push(row);
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let blank = ProbeRow { time: 0.0, values: Vec::new() };
        file.list(&mut self.rows, &blank, |file, row| {
            file.real(&mut row.time)?;
            file.list(&mut row.values, &0.0, Archive::real)
        })?;
        if file.reads() {
            let rows = self.rows.clone();
            rows.iter().try_for_each(|row| self.write(row))?;
        }
        Ok(())
    }
}
