//! Bars of one piece and of two, in uniaxial strain: a strip two cells high between planes of symmetry, an impact end to end
//! (V8), and a wave through a joint under pressure (V9).

use std::sync::Arc;

use mpm_contact::particles::Bodies;
use mpm_contact::{Frictionless, Pairs, SurfaceDistance};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::observe::RunView;
use mpm_core::{
    Archive, BlockGrid, Boundary, CheckpointError, Deformable, IntoKernels, Mpm, Side, Solver, Traction,
};
use sph::{Layout, Sph};

use crate::blocks::scene::{Asked, Rubber, Seen, Task, Watch, mean, rubber, run, velocity};
use crate::{CaseError, Detection, Law, Simulation, Totals};

/// Density, kg/m^3.
pub const DENSITY: f64 = 1000.0;
/// Wave speed, m/s.
pub const WAVE: f64 = 100.0;
/// Length of a bar, m.
pub const LENGTH: f64 = 1.0;

/// A strip two cells high between planes of symmetry, still empty, and its lattice of cells of `h` metres.
///
/// # Errors
/// What a scene refuses.
pub fn strip<M: IntoKernels<f64, 2>>(
    method: M,
    h: f64,
    asked: Asked,
) -> Result<(Mpm<2>, Lattice<2>), CaseError> {
    let lattice = Lattice::new([0.0; 2], h)?;
    let contact = asked.touch(0.0, (Detection::Plane, Law::Coulomb), [WAVE, h])?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: 2.0 * h, side: Side::Below })?;
    Ok((mpm, lattice))
}

/// Particles of a strip between two places, m; two a cell and axis.
///
/// # Errors
/// Places in the wrong order.
pub fn piece(lattice: &Lattice<2>, from: f64, to: f64) -> Result<Seeds<2>, CaseError> {
    let shape = Cuboid::new([from, 0.0], [to, 2.0 * lattice.spacing()])?;
    Ok(fill(&shape, lattice, 2, &Filling::new())?)
}

/// Closing speed of bars that hit each other, m/s: a strain of 1/4000, so that no particle leaves its cell.
pub const SPEED: f64 = 0.05;

/// What came of an impact of two bars end to end (V8).
pub struct Struck {
    /// Exact velocity of the joint, m/s.
    pub joint: f64,
    /// Exact stress behind the waves, Pa.
    pub stress: f64,
    /// Means of velocity, m/s, and stress, Pa, around the joint when the waves have run 0.8 of a bar.
    pub plateau: [f64; 2],
    /// Just after that: the mean of the error of the velocity over all of both bars, over the closing speed.
    pub error: f64,
    /// And the largest velocity of the second bar over that of the joint, less 1.
    pub overshoot: f64,
    /// The last time at which the stress of the contact was half of the exact one, s.
    pub last: f64,
    /// Time, s, velocities of the first and the second bar, m/s, stress of the contact, Pa.
    pub rows: Vec<[f64; 4]>,
    /// Work, and errors of the ledger.
    pub totals: Totals,
}

/// A bar of [`LENGTH`] in `cells` cells hits another at rest, `ratio` times as heavy and stiff, `second` times as long, with
/// a linear bulk viscosity of `viscosity`.
///
/// # Errors
/// What a scene refuses, and a step that breaks.
pub fn strike<M: IntoKernels<f64, 2>>(
    method: M,
    cells: u32,
    [ratio, second]: [f64; 2],
    viscosity: f64,
    task: impl Into<Task>,
) -> Result<Struck, CaseError> {
    let Task { asked, simulation } = task.into();
    let h = LENGTH / f64::from(cells);
    let (mut mpm, lattice) = strip(method, h, asked)?;
    mpm.add("first", law(1.0, viscosity)?, &piece(&lattice, -LENGTH, 0.0)?, |_| [SPEED, 0.0])?;
    mpm.add("second", law(ratio, viscosity)?, &piece(&lattice, 0.0, second * LENGTH)?, |_| [0.0; 2])?;
    struck(&mut mpm, ratio, 2.0 * h, simulation)
}

/// Two equal bars as of [`strike`] by smoothed particles, `cells` of them along each, that meet by their surfaces.
///
/// # Errors
/// As [`strike`].
pub fn strike_of_particles<M: sph::Composition<2>>(
    method: M,
    cells: u32,
    viscosity: f64,
) -> Result<Struck, CaseError> {
    let h = LENGTH / f64::from(cells);
    let lattice = Lattice::new([0.0; 2], h)?;
    let mut bars = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    for (name, from, speed) in [("first", -LENGTH, SPEED), ("second", 0.0, 0.0)] {
        let shape = Cuboid::new([from, 0.0], [from + LENGTH, 2.0 * h])?;
        let layout = Layout::of_seeds(&fill(&shape, &lattice, 1, &Filling::new())?);
        let mut bar = Sph::new(method, law(1.0, viscosity)?, &layout, |_| [speed, 0.0])?;
        bar.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
        bar.bound(Boundary::Symmetry { axis: 1, at: 2.0 * h, side: Side::Below })?;
        bars.add(name, bar);
    }
    struck(&mut bars, 1.0, 2.0 * h, Simulation::alone())
}

/// The law of a bar `ratio` times as heavy and stiff.
fn law(ratio: f64, viscosity: f64) -> Result<Rubber, CaseError> {
    rubber(ratio * DENSITY, ratio * DENSITY * WAVE * WAVE, 0.0, viscosity)
}

/// What comes of the impact in a scene of the two bars, with a section of `area` square metres.
fn struck(
    scene: &mut (dyn Solver + 'static),
    ratio: f64,
    area: f64,
    simulation: Simulation,
) -> Result<Struck, CaseError> {
    let impedance = [DENSITY * WAVE, ratio * DENSITY * WAVE];
    let joint = SPEED * impedance[0] / (impedance[0] + impedance[1]);
    let stress = -impedance[1] * joint;
    let when = 0.8 * LENGTH / WAVE;
    let mut history = History { plateau: [f64::NAN; 2], profile: [f64::NAN; 2], last: 0.0, rows: Vec::new() };
    let totals = run(scene, 3.5 * LENGTH / WAVE, Watch::STEPS, simulation, &mut history, |seen, now| {
        let force = now.contacts().iter().map(|p| p.force[0]).sum::<f64>() / area;
        if force > 0.5 * stress.abs() {
            seen.last = now.time();
        }
        if now.time() <= when {
            let near = [-0.4 * LENGTH, 0.4 * LENGTH];
            seen.plateau = [mean(now, near, |p| p.velocity[0]), mean(now, near, |p| p.stress[0])];
        } else if seen.profile[0].is_nan() {
            seen.profile = profile(now, joint);
        }
        seen.rows.push([now.time(), velocity(now, 0)[0], velocity(now, 1)[0], force]);
    })?;
    let History { plateau, profile: [error, overshoot], last, rows } = history;
    Ok(Struck { joint, stress, plateau, error, overshoot, last, rows, totals })
}

/// As in [`Struck`]; the profile is error and overshoot.
struct History {
    plateau: [f64; 2],
    profile: [f64; 2],
    last: f64,
    rows: Vec<[f64; 4]>,
}

impl Seen for History {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals(self.plateau.iter_mut().chain(&mut self.profile).chain([&mut self.last]))?;
        file.list(&mut self.rows, &[0.0; 4], |file, row| file.reals(row))
    }
}

/// Error and overshoot of the velocities, as of [`Struck`].
fn profile(now: &RunView<'_>, joint: f64) -> [f64; 2] {
    // Waves run through the material; the first bar moved until then.
    let (way, t) = (WAVE * now.time(), now.time());
    let (mut off, mut volume, mut fastest) = (0.0, 0.0, 0.0_f64);
    for (n, body) in now.bodies().iter().enumerate() {
        body.for_each(&mut |p| {
            let x = p.position[0];
            let exact = match n {
                0 if x < SPEED * t - way => SPEED,
                1 if x > way => 0.0,
                _ => joint,
            };
            off += p.volume * (p.velocity[0] - exact).abs();
            volume += p.volume;
            if n == 1 {
                fastest = fastest.max(p.velocity[0]);
            }
        });
    }
    [off / volume / SPEED, fastest / joint - 1.0]
}

/// Pressure that holds the joint together, Pa, and how long it takes to apply, s.
pub const PRELOAD: f64 = 4.0e3;
const RAMP: f64 = 20.0 * 2.0 * LENGTH / WAVE;
/// Length of the pulse, s.
const PULSE: f64 = 0.4 * LENGTH / WAVE;

/// Time after the pulse began, s, velocity, m/s, and stress, Pa, at a quarter and three quarters of the bar.
pub type Row = [f64; 5];

/// A bar of one piece (`joined`) or two of `cells` in all, pressed and then hit (or pulled) at its left end with `pulse` Pa.
///
/// # Errors
/// What a scene refuses, and a step that breaks.
pub fn pressed<M: IntoKernels<f64, 2>>(
    method: M,
    cells: u32,
    joined: bool,
    pulse: f64,
    task: impl Into<Task>,
) -> Result<(Vec<Row>, Totals), CaseError> {
    let Task { asked, simulation } = task.into();
    let h = 0.5 * LENGTH / f64::from(cells / 2);
    let (mut mpm, lattice) = strip(method, h, asked)?;
    mpm.bound(Boundary::Fixed { axis: 0, at: LENGTH, side: Side::Below })?;
    let law = || rubber(DENSITY, DENSITY * WAVE * WAVE, 0.0, 0.0);
    let load = Traction {
        region: Arc::new(Cuboid::new([-1.0, -1.0], [0.5 * h, 1.0])?),
        axis: 0,
        history: Arc::new(move |t: f64| {
            let ramp = (t / RAMP).min(1.0);
            let smooth = ramp * ramp * (3.0 - 2.0 * ramp);
            let part = (t - RAMP) / PULSE;
            let hit =
                if (0.0..1.0).contains(&part) { (std::f64::consts::PI * part).sin().powi(2) } else { 0.0 };
            [PRELOAD * smooth + pulse * hit, 0.0]
        }),
        revolved: false,
    };
    let middle = 0.5 * LENGTH;
    if joined {
        mpm.add_body(Deformable::new("bar", law()?, &piece(&lattice, 0.0, LENGTH)?).with_traction(load))?;
    } else {
        mpm.add_body(Deformable::new("left", law()?, &piece(&lattice, 0.0, middle)?).with_traction(load))?;
        mpm.add("right", law()?, &piece(&lattice, middle, LENGTH)?, |_| [0.0; 2])?;
    }
    let mut history = Pulse(Vec::new());
    let end = RAMP + 1.15 * LENGTH / WAVE;
    let totals = run(&mut mpm, end, Watch::STEPS, simulation, &mut history, |seen, now| {
        if now.time() >= RAMP {
            let at = |x: f64| [x - 2.0 * h, x + 2.0 * h];
            let of = |x: f64| [mean(now, at(x), |p| p.velocity[0]), mean(now, at(x), |p| p.stress[0])];
            let (a, b) = (of(0.25 * LENGTH), of(0.75 * LENGTH));
            seen.0.push([now.time() - RAMP, a[0], b[0], a[1], b[1]]);
        }
    })?;
    Ok((history.0, totals))
}

struct Pulse(Vec<Row>);

impl Seen for Pulse {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.0, &[0.0; 5], |file, row| file.reals(row))
    }
}

/// The largest change of a column from where it starts, in the direction of `sign`.
pub fn most(rows: &[Row], column: usize, sign: f64) -> f64 {
    let start = rows.first().map_or(f64::NAN, |r| r[column]);
    rows.iter().map(|r| sign * (r[column] - start)).fold(f64::NEG_INFINITY, f64::max)
}

/// The largest difference of the velocity at a quarter between a bar of two pieces and one of one, over that of a
/// pulse of `pulse` Pa: the share that the joint reflects.
pub fn reflected(bonded: &[Row], split: &[Row], pulse: f64) -> f64 {
    let incident = pulse / (DENSITY * WAVE);
    let back = |r: &Row| {
        // The steps of both runs differ a little: look at the same time.
        let other = bonded.iter().min_by(|a, b| (a[0] - r[0]).abs().total_cmp(&(b[0] - r[0]).abs()));
        other.map_or(f64::NAN, |o| (r[1] - o[1]).abs())
    };
    crate::largest(split.iter().map(back)) / incident
}
