//! Scenes and kernels of the yardstick benchmark, composed from the framework's parts.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use clap::ValueEnum;

use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::grid::Node;
use mpm_core::{
    BlockGrid, Boundary, Composition, Deformable, Flip, Float, FullSpace, IntoKernels, Linear, Method, Mls,
    Mpm, Musl, OneField, QuadraticBSpline, Side, Team, TimeControl, Usl,
};
use mpm_materials::strength::{Adiabatic, AdiabaticJohnsonCook, Heat, Logarithmic};
use mpm_materials::{
    BulkViscosity, Constitutive, IntoMaterial, JohnsonCook, LinearElastic, MieGruneisen, Moduli, NeoHookean,
    NoFailure, Solid,
};
use serde::Serialize;

use crate::CaseError;

/// What a step computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kernel {
    /// Trilinear shape functions, MUSL-FLIP, linear elasticity in rate form; scene S1
    LinearMuslElastic,
    /// The same with Johnson-Cook, Mie-Grueneisen, bulk viscosity and heat; scene S2
    LinearMuslJohnsonCook,
    /// Quadratic B-splines, USL-APIC in the moving-least-squares form, neo-Hookean; scene S1
    QuadraticApicUsl,
}

impl Kernel {
    /// Name in tables and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Kernel::LinearMuslElastic => "linear-musl-elastic",
            Kernel::LinearMuslJohnsonCook => "linear-musl-johnson-cook",
            Kernel::QuadraticApicUsl => "quadratic-apic-usl",
        }
    }

    /// Name of the scene.
    pub fn scene(self) -> &'static str {
        if self == Kernel::LinearMuslJohnsonCook { "S2" } else { "S1" }
    }
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// Kernel of a step.
    pub kernel: Kernel,
    /// Requested number of particles; the scene has about as many.
    pub particles: usize,
    /// Number of threads.
    pub threads: usize,
    /// Number of timed steps.
    pub steps: u64,
    /// Call of the law in passes over particles.
    pub way: Way,
}

/// How passes reach the law of their particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Way {
    /// By a call for many particles
    #[default]
    Called,
    /// As part of them
    Inlined,
}

impl Way {
    /// Build a body of a law for a method.
    pub fn body<'a, T, M, C>(
        self,
        name: &str,
        method: M,
        law: C,
        seeds: &'a Seeds<3>,
    ) -> Deformable<'a, 3, C, T>
    where
        T: Float,
        M: Composition<T, 3> + IntoKernels<T, 3>,
        C: Constitutive<T> + IntoMaterial<T, Law = C>,
    {
        let body = Deformable::new(name, law, seeds);
        if self == Way::Inlined { body.inlined(method) } else { body }
    }
}

/// Result of a run: the keys of the yardstick, and two more.
#[derive(Clone, Debug, Serialize)]
pub struct Measured {
    /// Name of the kernel.
    pub kernel: String,
    /// Name of the scene.
    pub scene: &'static str,
    /// Number of particles.
    pub particles: usize,
    /// Cells with particles at the end.
    pub cells: usize,
    /// Number of threads.
    pub threads: usize,
    /// Number of timed steps.
    pub steps: u64,
    /// Wall-clock time of the steps, s, without scene construction and first step.
    pub seconds: f64,
    /// Part of `seconds` spent on the grid, with contact, s: all but particle passes and sorting of particles into bins.
    pub grid_seconds: f64,
    /// Particles times steps over `seconds`, 1/s.
    pub particle_updates_per_second: f64,
    /// Storage of a particle, bytes.
    pub bytes_per_particle: usize,
    /// Size of a node, bytes.
    pub bytes_per_node: usize,
    /// Checksum of positions, velocities and stresses at the end; independent of the number of threads.
    pub checksum: String,
    /// Momentum error: |p - p0 - impulse of the wall| over sum of m |v|.
    pub momentum_drift: f64,
    /// Relative energy change over the whole run; negative for a loss.
    pub energy_drift: f64,
    /// Memory of the solver per particle, grid and scratch included, bytes.
    pub total_bytes_per_particle: f64,
    /// Memory of the grid, bytes.
    pub grid_bytes: usize,
    /// Bits of a floating-point number.
    pub bits: usize,
}

/// The law of [`Kernel::LinearMuslJohnsonCook`].
pub type HeatedCopper<T> = Solid<AdiabaticJohnsonCook<T>, MieGruneisen<T>, NoFailure, BulkViscosity<T>>;

/// Run a job in the precision `T`.
///
/// # Errors
/// Invalid scene definition; step that fails.
pub fn measure<T: Float>(job: &Job) -> Result<Measured, CaseError>
where
    Method<Linear, Flip, Musl, FullSpace>: IntoKernels<T, 3>,
    Method<QuadraticBSpline, Mls, Usl, FullSpace>: IntoKernels<T, 3>,
    LinearElastic<T>: IntoMaterial<T, Law = LinearElastic<T>>,
    NeoHookean<T>: IntoMaterial<T, Law = NeoHookean<T>>,
    HeatedCopper<T>: IntoMaterial<T, Law = HeatedCopper<T>>,
{
    let (of, way) = (T::of, job.way);
    let moduli = || Moduli::bulk_shear(of(1.0 + 1.6 / 3.0), of(0.8));
    match job.kernel {
        Kernel::LinearMuslElastic => {
            let law = LinearElastic::new(of(1.0), moduli()?)?;
            timed(job, cube(job.particles, Method::new(Linear, Flip, Musl, FullSpace), law, way)?)
        }
        Kernel::QuadraticApicUsl => {
            let law = NeoHookean::new(of(1.0), moduli()?)?;
            timed(job, cube(job.particles, Method::new(QuadraticBSpline, Mls, Usl, FullSpace), law, way)?)
        }
        Kernel::LinearMuslJohnsonCook => {
            let heat = Heat {
                room: of(294.0),
                melt: of(1356.0),
                exponent: of(1.09),
                heat_capacity: of(383.0),
                taylor_quinney: of(1.0),
            };
            let strength = JohnsonCook::new(of(46.0e9), of(90.0e6), of(292.0e6), of(0.31))?
                .with_rate(Logarithmic::new(of(0.025), of(1.0))?)
                .with_heat(Adiabatic::new(heat)?);
            let eos = MieGruneisen::new(of(8960.0), of(3940.0), of(1.489), of(1.99))?;
            let law = Solid::new(strength, eos).with_bulk_viscosity(of(0.06), of(1.5))?;
            timed(job, cylinder(job.particles, Method::new(Linear, Flip, Musl, FullSpace), law, way)?)
        }
    }
}

/// Place particles on a 2 x 2 x 2 lattice in the cells `low..high` of edge `h` that are `inside` (in cells).
pub fn lattice_points(low: [i64; 3], high: [i64; 3], h: f64, inside: impl Fn([f64; 3]) -> bool) -> Seeds<3> {
    let mut positions = Vec::new();
    for k in 2 * low[2]..2 * high[2] {
        for j in 2 * low[1]..2 * high[1] {
            for i in 2 * low[0]..2 * high[0] {
                let x = [i, j, k].map(|a| (a as f64 + 0.5) * 0.5);
                if inside(x) {
                    positions.push(x.map(|x| x * h));
                }
            }
        }
    }
    let volumes = vec![0.125 * h * h * h; positions.len()];
    Seeds::placed(positions, volumes, [0.25 * h; 3])
}

/// Build S1: a cube of about so many particles in a smooth velocity field, h = 1, dt = 0.19.
///
/// # Errors
/// Invalid scene definition.
pub fn cube<T, M, C>(particles: usize, method: M, law: C, way: Way) -> Result<Mpm<3, T>, CaseError>
where
    T: Float,
    M: Composition<T, 3> + IntoKernels<T, 3>,
    C: Constitutive<T> + IntoMaterial<T, Law = C>,
{
    cube_of(particles, method, |seeds| way.body("cube", method, law, seeds))
}

/// Build S1 with a body of any law on the particles of the cube; its velocity is set here.
///
/// # Errors
/// Invalid scene definition.
pub fn cube_of<T: Float, L: IntoMaterial<T>>(
    particles: usize,
    method: impl IntoKernels<T, 3>,
    body: impl FnOnce(&Seeds<3>) -> Deformable<'_, 3, L, T>,
) -> Result<Mpm<3, T>, CaseError> {
    let cells = (particles as f64 / 8.0).cbrt().round().max(1.0);
    let seeds = lattice_points([8; 3], [8 + cells as i64; 3], 1.0, |_| true);
    let velocity = |x: [f64; 3]| {
        let wave = |d: usize| 0.1 * (0.4 + 0.6 * (x[(d + 1) % 3] * 6.0 / cells).sin());
        [wave(0), wave(1), wave(2)]
    };
    let mut mpm = Mpm::<3, T>::of(method, BlockGrid::new(Lattice::new([0.0; 3], 1.0)?), OneField);
    mpm.add_body(body(&seeds).moving(velocity))?;
    mpm.set_time_control(TimeControl::Fixed(0.19))?;
    Ok(mpm)
}

/// Build S2: a cylinder 25.4 mm long, four radii, hits a wall at 190 m/s; dt = h / 20 km/s.
///
/// # Errors
/// Invalid scene definition.
pub fn cylinder<T, M, C>(particles: usize, method: M, law: C, way: Way) -> Result<Mpm<3, T>, CaseError>
where
    T: Float,
    M: Composition<T, 3> + IntoKernels<T, 3>,
    C: Constitutive<T> + IntoMaterial<T, Law = C>,
{
    let radius = (particles as f64 / 8.0 / (4.0 * std::f64::consts::PI)).cbrt();
    let (around, length) = (radius.ceil() as i64, (4.0 * radius).round().max(1.0) as i64);
    let (wall, middle) = (4, 6 + around + around / 2);
    let h = 25.4e-3 / length as f64;
    let low = [middle - around, middle - around, wall];
    let high = [middle + around, middle + around, wall + length];
    let axis = middle as f64;
    let seeds = lattice_points(low, high, h, |x| (x[0] - axis).hypot(x[1] - axis) < radius);
    let mut mpm = Mpm::<3, T>::of(method, BlockGrid::new(Lattice::new([0.0; 3], h)?), OneField);
    mpm.add_body(way.body("bar", method, law, &seeds).moving(|_| [0.0, 0.0, -190.0]))?;
    mpm.bound(Boundary::Wall { axis: 2, at: wall as f64 * h, side: Side::Above, velocity: 0.0 })?;
    mpm.set_time_control(TimeControl::Fixed(0.25 * h / 5000.0))?;
    Ok(mpm)
}

/// Wall-clock time spent at particles so far, s.
fn at_particles<T: Float>(mpm: &Mpm<3, T>) -> f64 {
    let stages = mpm_core::Solver::stage_seconds(mpm);
    stages.into_iter().filter(|(name, _)| *name == "particles").map(|(_, seconds)| seconds).sum()
}

/// Time the steps of a job on a scene.
///
/// # Errors
/// Step that fails.
pub fn timed<T: Float>(job: &Job, mut mpm: Mpm<3, T>) -> Result<Measured, CaseError> {
    mpm.set_team(Team::new(job.threads)?);
    let before = mpm.totals();
    mpm.step()?; // not timed: the first step maps the particles, later ones reuse that
    let (clock, spent) = (Instant::now(), at_particles(&mpm));
    for _ in 0..job.steps {
        mpm.step()?;
    }
    let seconds = clock.elapsed().as_secs_f64();
    let grid_seconds = seconds - (at_particles(&mpm) - spent);
    let (after, given) = (mpm.totals(), mpm.exchange());
    let lost = |d: usize| after.momentum[d] - before.momentum[d] - given.impulse[d] - given.dropped[d];
    let drift = crate::largest((0..3).map(|d| lost(d).abs()));
    let energy = |t: &mpm_core::Totals| t.kinetic + t.internal;
    let n = mpm.particles();
    let (cells, checksum) = fingerprint(&mpm);
    let suffix = if size_of::<T>() == 4 { "-f32" } else { "" };
    Ok(Measured {
        kernel: format!("{}{suffix}", job.kernel.name()),
        scene: job.kernel.scene(),
        particles: n,
        cells,
        threads: job.threads,
        steps: job.steps,
        seconds,
        grid_seconds,
        particle_updates_per_second: n as f64 * job.steps as f64 / seconds,
        bytes_per_particle: mpm.bodies().iter().map(|b| b.particle_bytes()).max().unwrap_or(0),
        bytes_per_node: size_of::<Node<T>>(),
        checksum: format!("{checksum:016x}"),
        momentum_drift: drift / before.momentum_scale,
        energy_drift: energy(&after) / energy(&before) - 1.0,
        total_bytes_per_particle: mpm.bytes() as f64 / n as f64,
        grid_bytes: mpm.grid().bytes(),
        bits: 8 * size_of::<T>(),
    })
}

/// Return the number of cells with particles, and a hash of position, velocity and stress of all particles (FNV-1a).
fn fingerprint<T: Float>(mpm: &Mpm<3, T>) -> (usize, u64) {
    let h = mpm.grid().lattice().spacing();
    let (mut cells, mut hash) = (Vec::with_capacity(mpm.particles()), 0xcbf2_9ce4_8422_2325_u64);
    for body in mpm.bodies() {
        body.for_each(&mut |p| {
            cells.push(p.position.map(|x| (x / h).floor() as i32));
            for x in p.position.iter().chain(&p.velocity).chain(&p.stress) {
                hash = (hash ^ x.to_bits()).wrapping_mul(0x100_0000_01b3);
            }
        });
    }
    cells.sort_unstable();
    cells.dedup();
    (cells.len(), hash)
}

/// Run the kernel `K1` to `K4` (`K3f` in single precision) of a built yardstick of hand-written kernels once, on its scene
/// `S1` to `S3`. Return the object that it prints, with the numbers `particles`, `seconds`, `particle_updates_per_second`
/// and `bytes_per_particle`.
///
/// # Errors
/// Program that does not run, or prints no such object.
pub fn hand_written(
    program: &Path,
    kernel: &str,
    scene: &str,
    job: &Job,
) -> Result<serde_json::Value, CaseError> {
    let value = printed(
        Command::new(program)
            .args(["--kernel", kernel, "--scene", scene, "--particles", &job.particles.to_string()])
            .args(["--threads", &job.threads.to_string(), "--steps", &job.steps.to_string()]),
    )?;
    for key in ["particles", "seconds", "particle_updates_per_second", "bytes_per_particle"] {
        if !value[key].is_number() {
            return Err(CaseError::Other(format!("{}: no number `{key}` in {value}", program.display())));
        }
    }
    Ok(value)
}

/// Run a program and parse the JSON object on its last line.
///
/// # Errors
/// Program that does not run, or prints no object.
pub fn printed(command: &mut Command) -> Result<serde_json::Value, CaseError> {
    let program = command.get_program().to_os_string();
    let fail = |what: String| CaseError::Other(format!("{}: {what}", program.display()));
    let output = command.output().map_err(|e| fail(e.to_string()))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let line = text.lines().next_back().ok_or_else(|| fail("it printed nothing".into()))?;
    Ok(serde_json::from_str(line)?)
}

/// Median, minimum and maximum.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// Minimum.
    pub least: f64,
    /// Maximum.
    pub most: f64,
}

impl Spread {
    /// Compute the spread of values.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut v: Vec<f64> = values.collect();
        v.sort_by(f64::total_cmp);
        let n = v.len();
        if n == 0 {
            return Spread { median: f64::NAN, least: f64::NAN, most: f64::NAN };
        }
        Spread { median: 0.5 * (v[(n - 1) / 2] + v[n / 2]), least: v[0], most: v[n - 1] }
    }
    /// Format with this number of digits after the point.
    pub fn text(&self, digits: usize) -> String {
        format!("{:.digits$} [{:.digits$} - {:.digits$}]", self.median, self.least, self.most)
    }
}
