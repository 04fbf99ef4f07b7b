//! Motion of projectile and plug over time.

use mpm_contact::SurfaceDistance;
use mpm_contact::particles::Bodies;
use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::scene::Body;
use mpm_core::{Archive, CheckpointError};
use sph::Layout;

use crate::pieces::pieces;
use crate::setup::{PROJECTILE, Setup};

/// Scene of projectile and plate.
pub type Scene = Bodies<2, SurfaceDistance>;

/// Fraction of the projectile's radius within which the plate is in front of it.
const AHEAD: f64 = 0.9;
/// Fraction of the projectile's velocity above which plate matter moves with it.
const FLIES: f64 = 0.5;

/// State of the scene at one time. Masses and energies are of the whole, not per radian.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Velocity of the projectile's centre of mass, m/s.
    pub projectile: f64,
    /// Velocity of the plate region initially in front of the projectile, m/s.
    pub ahead: f64,
    /// Mass of the plate that moves at more than half the projectile's velocity, kg.
    pub flying: f64,
    /// Intact piece of the plate on the axis: velocity, m/s, mass, kg, and largest radius, m; the whole plate while it is connected.
    pub plug: [f64; 3],
    /// True if that piece is disconnected from the rim.
    pub free: bool,
    /// Largest radius and length of the projectile, m.
    pub projectile_size: [f64; 2],
    /// Number of failed particles of the plate.
    pub failed: usize,
    /// Kinetic energy of projectile and plate, internal energy, friction, and energy removed by contact, stabilisation and reference
    /// updates, J.
    pub energies: [f64; 5],
}

impl Row {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let Row { time, projectile, ahead, flying, plug, free, projectile_size, failed, energies } = self;
        let numbers = [time, projectile, ahead, flying].into_iter();
        file.reals(numbers.chain(plug).chain(projectile_size).chain(energies))?;
        let mut words = [u64::from(*free), *failed as u64];
        words.iter_mut().try_for_each(|word| file.word(word))?;
        (*free, *failed) = (words[0] != 0, words[1] as usize);
        Ok(())
    }
}

/// Observer of projectile and plug.
pub struct Track {
    pace: Pace,
    /// Initial layout of the plate.
    plate: Layout<2>,
    /// Half spacing in the projectile, m.
    half: f64,
    pub rows: Vec<Row>,
}

impl Track {
    /// Create the observer with an interval, s.
    pub fn new(setup: &Setup, plate: Layout<2>, interval: f64) -> Result<Self, ObserveError> {
        Ok(Track { pace: Pace::interval(interval)?, plate, half: 0.5 * setup.fine(), rows: Vec::new() })
    }

    /// Evaluate the plate for a row.
    fn plate(&self, plate: &dyn Body, row: &mut Row) -> Result<(), ObserveError> {
        let round = std::f64::consts::TAU;
        let (mut positions, mut spacings, mut moving) = (Vec::new(), Vec::new(), Vec::new());
        let (mut ahead, mut flying, mut failed) = ([0.0; 2], 0.0, 0);
        let least = FLIES * row.projectile;
        plate.for_each(&mut |p| {
            let speed = p.velocity[1];
            if self.plate.positions[p.number][0] < AHEAD * PROJECTILE[0] {
                ahead[0] += p.mass * speed;
                ahead[1] += p.mass;
            }
            flying += if speed > least { round * p.mass } else { 0.0 };
            if p.failed {
                failed += 1;
            } else {
                positions.push([p.position[0], p.position[1]]);
                spacings.push(self.plate.spacings[p.number]);
                moving.push([p.mass, speed]);
            }
        });
        (row.ahead, row.flying, row.failed) = (ahead[0] / ahead[1], flying, failed);
        let radius = |n: &usize| positions[*n][0];
        let by_radius = |a: &usize, b: &usize| radius(a).total_cmp(&radius(b));
        let all = || 0..positions.len();
        let (Some(inner), Some(outer)) = (all().min_by(by_radius), all().max_by(by_radius)) else {
            return Ok(());
        };
        let pieces = pieces(&positions, &spacings).map_err(|error| ObserveError::Other(error.to_string()))?;
        let (mut momentum, mut mass, mut widest) = (0.0, 0.0, 0.0f64);
        for n in all().filter(|n| pieces[*n] == pieces[inner]) {
            momentum += moving[n][0] * moving[n][1];
            mass += moving[n][0];
            widest = widest.max(radius(&n) + 0.5 * spacings[n]);
        }
        row.plug = [momentum / mass, round * mass, widest];
        row.free = pieces[inner] != pieces[outer];
        Ok(())
    }
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let scene = now.solver_as::<Scene>()?;
        let (round, given) = (std::f64::consts::TAU, now.exchange());
        let [projectile, plate] = [0, 1].map(|b| scene.totals_of(b).unwrap_or_default());
        let parts = [
            projectile.kinetic,
            plate.kinetic,
            projectile.internal + plate.internal,
            given.friction,
            given.impacts - given.conversion,
        ];
        let mut row = Row {
            time: now.time(),
            projectile: projectile.momentum[1] / projectile.mass,
            energies: parts.map(|e| round * e),
            ..Row::default()
        };
        let (mut low, mut high, mut widest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
        for p in scene.particles(0) {
            let [r, z] = p.position;
            (low, high, widest) = (low.min(z), high.max(z), widest.max(r));
        }
        row.projectile_size = [widest + self.half, high - low + 2.0 * self.half];
        if let Some(body) = scene.body(1) {
            self.plate(body, &mut row)?;
        }
        self.rows.push(row);
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| row.archive(file))
    }
}
