//! Bullet, target and results, common to all methods.

use std::path::Path;

use clap::ValueEnum;
use examples::{CaseError, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::output::{History, Snapshot};
use mpm_core::{Archive, CheckpointError};
use mpm_materials::{
    Adiabatic, Constitutive, Heat, JohnsonCook, Logarithmic, MieGruneisen, Solid, TensilePressure, library,
};

/// Length and width of the bullet, m.
pub const BULLET: [f64; 2] = [28.4e-3, 8.0e-3];
/// Thickness and height of the target, m.
pub const TARGET: [f64; 2] = [50.0e-3, 200.0e-3];
/// Impact speed, m/s.
pub const SPEED: f64 = 1140.0;
/// Times of the pictures, s.
pub const MOMENTS: [f64; 3] = [10.0e-6, 32.0e-6, 65.0e-6];
/// End of a run, s.
pub const END: f64 = 72.0e-6;
/// Interval between two entries of a history, s.
pub const HISTORY: f64 = 0.5e-6;
/// Mean area per particle in the paper, m^2.
pub const PAPER_AREA: f64 = (BULLET[0] * BULLET[1] + TARGET[0] * TARGET[1]) / 11428.0;
/// Linear and quadratic coefficient of the bulk viscosity \[M\]; the paper has none.
const BULK_VISCOSITY: [f64; 2] = [0.1, 1.5];
/// Spall strength of aluminium and tungsten alloys at these rates, Pa \[M\]; the paper has no failure.
const SPALL: [f64; 2] = [1.2e9, 2.5e9];

/// How bullet and target lie in space. The bullet flies along the last axis around an axis, else along the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Space {
    /// Endless in depth, as in the paper
    PlaneStrain,
    /// A round bullet on the axis of a round target, 200 mm across
    Axisymmetric,
}

impl Space {
    /// Return the axis of flight.
    pub fn axis(self) -> usize {
        match self {
            Space::PlaneStrain => 0,
            Space::Axisymmetric => 1,
        }
    }
    /// Return a vector along the direction of flight.
    pub fn along(self, length: f64) -> [f64; 2] {
        std::array::from_fn(|d| if d == self.axis() { length } else { 0.0 })
    }
    /// Return the name in outcomes.
    pub fn name(self) -> &'static str {
        match self {
            Space::PlaneStrain => "plane",
            Space::Axisymmetric => "round",
        }
    }
    /// Return area or volume of bullet and target: per metre of depth, or per radian, m^2 or m^3.
    pub fn measures(self) -> [f64; 2] {
        [BULLET, TARGET].map(|[length, width]| match self {
            Space::PlaneStrain => length * width,
            Space::Axisymmetric => length * width * width / 8.0,
        })
    }
    /// Return the shapes of bullet and target, with the front of the target at 0 along the flight; in axisymmetric runs from this radius
    /// (m).
    fn shapes(self, from: f64) -> Result<[Cuboid<2>; 2], CaseError> {
        let ([l, d], [t, w]) = (BULLET, TARGET);
        Ok(match self {
            Space::PlaneStrain => {
                [Cuboid::new([-l, -0.5 * d], [0.0, 0.5 * d])?, Cuboid::new([0.0, -0.5 * w], [t, 0.5 * w])?]
            }
            Space::Axisymmetric => {
                [Cuboid::new([from, -l], [0.5 * d, 0.0])?, Cuboid::new([from, 0.0], [0.5 * w, t])?]
            }
        })
    }
}

/// Parameters of a run, for either method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    pub space: Space,
    /// Laws of bullet and target.
    pub metals: [Metal; 2],
    /// Requested particle spacing, m; in axisymmetric runs the nearest that fits the radius of the bullet is used.
    pub spacing: f64,
    /// Coefficient of friction between bullet and target.
    pub friction: f64,
    pub threads: usize,
}

impl Setup {
    /// Return the exact mass of bullet and target, kg per metre of depth or per radian.
    pub fn mass(&self) -> f64 {
        let density = self.metals.map(|m| Constitutive::<f64>::density(&m));
        density.iter().zip(self.space.measures()).map(|(d, v)| d * v).sum()
    }
}

/// Metal of the paper's table.
pub type Metal = Solid<
    JohnsonCook<f64, Logarithmic<f64>, Adiabatic<f64>>,
    MieGruneisen<f64>,
    TensilePressure<f64>,
    mpm_materials::BulkViscosity<f64>,
>;

/// Return the tungsten of the bullet.
pub fn tungsten() -> Result<Metal, CaseError> {
    let heat = Heat { room: 298.0, melt: 1723.0, exponent: 0.4, heat_capacity: 134.0, taylor_quinney: 0.9 };
    let strength = JohnsonCook::new(134.8e9, 1.2e9, 1.03e9, 0.019)?.with_rate(Logarithmic::new(0.034, 1.0)?);
    let strength = strength.with_heat(Adiabatic::new(heat)?);
    metal(Solid::new(strength, MieGruneisen::new(19220.0, 4020.0, 1.24, 1.67)?), SPALL[1])
}

/// Return the aluminium of the target.
pub fn aluminium() -> Result<Metal, CaseError> {
    metal(library::aluminium_feng_2014(), SPALL[0])
}

fn metal(plain: library::Metal<f64>, spall: f64) -> Result<Metal, CaseError> {
    let [linear, quadratic] = BULK_VISCOSITY;
    Ok(plain.with_failure(TensilePressure::new(spall)?).with_bulk_viscosity(linear, quadratic)?)
}

/// Seed bullet and target for particle contacts: particles of about this spacing (m) on a square lattice, displaced at random by up to
/// `jitter` of half their distance. In axisymmetric runs some are on the axis, so that elements cover the body up to it.
pub fn packed(space: Space, spacing: f64, jitter: f64) -> Result<[Seeds<2>; 2], CaseError> {
    let plain = Filling::new().jittered(7, jitter);
    match space {
        Space::PlaneStrain => {
            let lattice = Lattice::new([0.0; 2], spacing)?;
            let [bullet, target] = space.shapes(0.0)?;
            Ok([fill(&bullet, &lattice, 1, &plain)?, fill(&target, &lattice, 1, &plain)?])
        }
        Space::Axisymmetric => {
            let radius = 0.5 * BULLET[1];
            let h = radius / ((radius / spacing - 0.5).round().max(1.0) + 0.5);
            let lattice = Lattice::new([0.5 * h, 0.0], h)?;
            let [bullet, target] = space.shapes(0.5 * h)?;
            let ring = |shape: &Cuboid<2>| fill(shape, &lattice, 1, &plain.axisymmetric());
            let (mut bullet, mut target) = (ring(&bullet)?, ring(&target)?);
            add_column(&mut bullet, -BULLET[0], 0.0, h);
            add_column(&mut target, 0.0, TARGET[0], h);
            Ok([bullet, target])
        }
    }
}

/// Add particles on the axis between two heights, at this spacing, m: a cylinder of half that radius between them.
fn add_column(seeds: &mut Seeds<2>, from: f64, to: f64, spacing: f64) {
    let cells = (from / spacing).round() as i64..(to / spacing).round() as i64;
    let volume = (to - from) * spacing * spacing / 8.0 / cells.clone().count() as f64;
    for cell in cells {
        seeds.positions.push([0.0, (cell as f64 + 0.5) * spacing]);
        seeds.volumes.push(volume);
    }
}

/// Seed bullet and target for material points of about this spacing (m), two per cell and axis; also return the lattice of the cells.
pub fn celled(space: Space, spacing: f64) -> Result<(Lattice<2>, [Seeds<2>; 2]), CaseError> {
    let (spacing, filling) = match space {
        Space::PlaneStrain => (spacing, Filling::new()),
        Space::Axisymmetric => {
            let radius = 0.5 * BULLET[1];
            (radius / (radius / spacing).round().max(1.0), Filling::new().axisymmetric())
        }
    };
    let lattice = Lattice::new([0.0; 2], 2.0 * spacing)?;
    let [bullet, target] = space.shapes(0.0)?;
    Ok((lattice, [fill(&bullet, &lattice, 2, &filling)?, fill(&target, &lattice, 2, &filling)?]))
}

/// Entry of the history.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Entry {
    /// Time, s.
    pub time: f64,
    /// Depth of the bullet's foremost particle behind the front of the target, m; with particle contacts, of the largest connected piece.
    pub tip: f64,
    /// Velocity of the bullet's centre of mass, m/s.
    pub speed: f64,
    /// Kinetic and internal energy, and energy removed by contact and revisions, over the initial kinetic energy.
    pub energies: [f64; 3],
}

impl Entry {
    /// Store or load the entry.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let Entry { time, tip, speed, energies } = self;
        file.reals([time, tip, speed].into_iter().chain(energies))
    }
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub method: &'static str,
    pub space: Space,
    pub history: Vec<Entry>,
    pub frames: Vec<Snapshot>,
    /// Mass of the particles over that of bullet and target.
    pub mass: f64,
    /// Energy added by revisions, over the initial energy; `None` without revisions.
    pub added: Option<f64>,
    pub totals: Totals,
}

impl Outcome {
    /// Return method and space, as in tables.
    pub fn name(&self) -> String {
        format!("{}, {}", self.method, self.space.name())
    }
    /// Return the depth of the tip at a time, m.
    pub fn tip(&self, time: f64) -> f64 {
        let pair = self.history.windows(2).find(|p| p[1].time >= time);
        pair.map_or(f64::NAN, |p| {
            let part = (time - p[0].time) / (p[1].time - p[0].time);
            p[0].tip + part * (p[1].tip - p[0].tip)
        })
    }
    /// Return the time when the depth of the tip equals the initial thickness of the target, s, if reached.
    pub fn through(&self) -> Option<f64> {
        self.history
            .windows(2)
            .find(|p| p[1].tip >= TARGET[0])
            .map(|p| p[0].time + (TARGET[0] - p[0].tip) / (p[1].tip - p[0].tip) * (p[1].time - p[0].time))
    }
    /// Return the mean speed of the tip between the first two pictures, m/s.
    pub fn interface_speed(&self) -> f64 {
        (self.tip(MOMENTS[1]) - self.tip(MOMENTS[0])) / (MOMENTS[1] - MOMENTS[0])
    }
    /// Write the history to a file.
    pub fn save(&self, folder: &Path) -> Result<(), CaseError> {
        let columns = [
            ("time", "s"),
            ("tip", "m"),
            ("bullet", "m/s"),
            ("kinetic", "-"),
            ("internal", "-"),
            ("taken", "-"),
        ];
        let mut csv = History::create(
            folder.join(format!("history_{}_{}.csv", self.method, self.space.name())),
            columns,
        )?;
        for e in &self.history {
            csv.push(&[e.time, e.tip, e.speed, e.energies[0], e.energies[1], e.energies[2]])?;
        }
        Ok(())
    }
}
