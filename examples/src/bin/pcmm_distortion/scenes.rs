//! Scenes in which elements are distorted until they are deleted, for any parts of the method.

use examples::{CaseError, Restart, Simulation};
use mpm_core::geometry::{Cuboid, Lattice};
use mpm_core::observe::{Ledger, Observer, Pace};
use mpm_core::output::Snapshot;
use mpm_core::{Boundary, PlaneStrain, RunError, Side, Solver};
use mpm_materials::{
    Constitutive, Elastic, IntoMaterial, JohnsonCook, LogarithmicBulk, MieGruneisen, Moduli, ObjectiveRate,
    Solid, Sym3,
};
use pcmm::simplex::overlap;
use pcmm::{AzimuthFan, Composition, LocalDelaunay, Masses, Method, NoRotation, Packing, Pcmm, pieces};

/// Parts of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// Original formulation: fans, means of particles, no rotation of stress, volumes of elements.
    Printed,
    /// Consistent parts.
    Consistent,
}

impl Parts {
    /// Return the label of a simulation of this body.
    fn label(self, body: &str) -> String {
        match self {
            Parts::Printed => format!("{body}_printed"),
            Parts::Consistent => format!("{body}_ours"),
        }
    }
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Time reached over the end time.
    pub reached: f64,
    /// Error that stopped the run, if any.
    pub broke: Option<String>,
    /// Largest momentum error over the largest sum of m |v|; impulses of boundaries are accounted for.
    pub momentum: f64,
    /// Largest energy error over the largest energy; work of boundaries and revisions are accounted for.
    pub energy: f64,
    /// Energy added by revisions, over the initial kinetic energy.
    pub added: f64,
    /// Mass in elements over its initial value.
    pub covered: f64,
    /// Number of steps.
    pub steps: u64,
    /// Final state.
    pub snapshot: Snapshot,
}

type Steel<R> =
    Solid<Elastic<f64>, LogarithmicBulk<f64>, mpm_materials::NoFailure, mpm_materials::BulkViscosity<f64>, R>;

fn steel() -> Result<Steel<mpm_materials::HughesWinget>, CaseError> {
    let moduli = Moduli::young_poisson(206e9, 0.3)?;
    Ok(Solid::new(Elastic::new(moduli.shear)?, LogarithmicBulk::new(7850.0, moduli.bulk)?)
        .with_bulk_viscosity(0.06, 1.5)?)
}

fn copper() -> Solid<JohnsonCook<f64>, MieGruneisen<f64>> {
    Solid::new(JohnsonCook::copper_taylor(), MieGruneisen::copper())
}

/// Run a body to its end, with the energy balance in every step.
fn watch<M: Composition<2>>(
    body: &mut Pcmm<2, M>,
    end: f64,
    simulation: &mut Simulation,
) -> Result<Outcome, CaseError> {
    let (start, covered) = (body.totals(), body.coverage().mass);
    let mut ledger = Ledger::new(Pace::every_step());
    let observers: [&mut dyn Observer; 1] = [&mut ledger];
    let broke = match simulation.until(body, observers, end) {
        Ok(()) => None,
        Err(RunError::Step(error)) => Some(error.to_string()),
        Err(error) => return Err(error.into()),
    };
    Ok(Outcome {
        reached: body.time() / end,
        broke,
        momentum: ledger.worst_momentum_error(),
        energy: ledger.worst_energy_error(),
        added: body.audit().energy_added() / start.kinetic,
        covered: body.coverage().mass / covered,
        steps: body.steps(),
        snapshot: body.snapshot()?,
    })
}

/// Run `body` with a law and either set of parts.
macro_rules! with_parts {
    ($parts:expr, $h:expr, $stretch:expr, $law:expr, |$method:ident, $by:ident| $body:expr) => {
        match $parts {
            Parts::Printed => {
                let $method = Method::printed(PlaneStrain, AzimuthFan::new(0.45 * $h)?);
                let $by = $law.with_rate(NoRotation).compiled();
                $body
            }
            Parts::Consistent => {
                let $method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.45 * $h, $stretch)?);
                let $by = $law;
                $body
            }
        }
    };
}

fn block(size: [f64; 2], h: f64) -> Result<Packing<2>, CaseError> {
    Ok(Packing::on_nodes(&Cuboid::new([0.0; 2], size)?, &Lattice::new([0.0; 2], h)?)?)
}

/// Elastic bar of case 1, 1 mm x 20 mm, at ten times its speed: 500 m/s on a rigid wall, for 9 microseconds.
pub fn fast_bar(parts: Parts, cells: u32, restart: &Restart) -> Result<Outcome, CaseError> {
    let h = 1.0e-3 / f64::from(cells);
    let packing = block([1.0e-3, 20.0e-3], h)?;
    with_parts!(parts, h, 2.0, steel()?, |method, law| {
        let mut bar = Pcmm::new(method, law, &packing, |_| [0.0, -500.0], Masses::FromElements)?;
        bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
        watch(&mut bar, 9.0e-6, &mut restart.scene(parts.label("bar"))?)
    })
}

/// Simple shear of a copper block, 10 spacings a side, by 4 in 20 microseconds; sides free.
pub fn shear_flow(parts: Parts, cells: u32, restart: &Restart) -> Result<Outcome, CaseError> {
    let h = 1.0e-2 / f64::from(cells);
    let packing = block([1.0e-2; 2], h)?;
    let rate = 2.0e5;
    with_parts!(parts, h, 20.0, copper(), |method, law| {
        let speed = |[_, y]: [f64; 2]| [rate * (y - 0.5e-2), 0.0];
        let mut body = Pcmm::new(method, law, &packing, speed, Masses::FromElements)?;
        // The ends of the block move with the shear flow.
        for (at, side, v) in [(0.0, -1.0, -0.5e-2 * rate), (1.0e-2, 1.0, 0.5e-2 * rate)] {
            body.bound(Boundary::Prescribed {
                region: std::sync::Arc::new(Strip { at, side, half: 0.25 * h }),
                velocity: std::sync::Arc::new(move |_| [Some(v), Some(0.0), None]),
            })?;
        }
        watch(&mut body, 4.0 / rate, &mut restart.scene(parts.label("shear"))?)
    })
}

/// Strip of all x, y within `half` of `at` and beyond it.
struct Strip {
    at: f64,
    side: f64,
    half: f64,
}

impl mpm_core::geometry::Shape<2> for Strip {
    fn signed_distance(&self, x: [f64; 2]) -> f64 {
        -(x[1] - self.at) * self.side - self.half
    }
    fn bounds(&self) -> mpm_core::geometry::Bounds<2> {
        mpm_core::geometry::Bounds { min: [-1.0; 2], max: [1.0; 2] }
    }
}

/// Spinning steel disc with balanced residual stress, for one and a quarter rotations. Return the outcome, and the deviation of the
/// elements' deviators from the rotated initial ones, over their size.
pub fn spinning_disc(parts: Parts, cells: u32, restart: &Restart) -> Result<(Outcome, f64), CaseError> {
    let h = 1.0e-2 / f64::from(cells);
    // Particles on rings, so that the edge is circular.
    let mut positions = vec![[0.0; 2]];
    for ring in 1..=cells {
        for k in 0..6 * ring {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(6 * ring);
            positions.push([h * f64::from(ring) * angle.cos(), h * f64::from(ring) * angle.sin()]);
        }
    }
    let radii = vec![0.5 * h; positions.len()];
    let packing = Packing::of_spheres(positions, radii);
    let omega = 2.0e3;
    let spin = |[x, y]: [f64; 2]| [-omega * y, omega * x];
    with_parts!(parts, h, 2.0, steel()?, |method, law| disc(
        method,
        law,
        &packing,
        spin,
        omega,
        restart.scene(parts.label("disc"))?
    ))
}

fn disc<R: ObjectiveRate, M: Composition<2>>(
    method: M,
    law: impl IntoMaterial<f64, Law = Steel<R>>,
    packing: &Packing<2>,
    spin: impl Fn([f64; 2]) -> [f64; 2],
    omega: f64,
    mut simulation: Simulation,
) -> Result<(Outcome, f64), CaseError> {
    let radius: f64 = 1.0e-2;
    // Equilibrium, d(r sigma_r)/dr = sigma_t, with zero traction at R; invariant under rotation.
    let residual = move |[x, y]: [f64; 2]| {
        let part = (x * x + y * y) / (radius * radius);
        let (radial, hoop) = (200e6 * (1.0 - part), 200e6 * (1.0 - 3.0 * part));
        let r = x.hypot(y).max(f64::MIN_POSITIVE);
        let (n, t) = (x / r, y / r);
        let (xx, yy) = (radial * n * n + hoop * t * t, radial * t * t + hoop * n * n);
        Sym3([xx, yy, 0.3 * (xx + yy), 0.0, 0.0, (radial - hoop) * n * t])
    };
    let bulk = 206e9 / (3.0 * 0.4);
    let mut body = Pcmm::new(method, law, packing, spin, Masses::FromElements)?;
    body.set_revision_interval(10)?;
    body.set_states::<Steel<R>>(|x, mut state| {
        state.stress = residual(x);
        state.volume_ratio = (residual(x).mean() / bulk).exp();
        state
    })?;
    let turns = 1.25;
    let outcome = watch(&mut body, turns * std::f64::consts::TAU / omega, &mut simulation)?;
    let (mut off, mut size) = (0.0, 0.0);
    for (e, nodes) in body.element_nodes().chunks_exact(3).enumerate() {
        let mut centre = [0.0; 2];
        for &n in nodes {
            for d in 0..2 {
                centre[d] += body.particles()[n as usize].position[d] / 3.0;
            }
        }
        let wanted = residual(centre).deviator();
        if let Some(said) = body.describe_element(e) {
            off += (Sym3(said.stress).deviator() + wanted * -1.0).equivalent();
            size += wanted.equivalent();
        }
    }
    Ok((outcome, off / size))
}

/// Stretching of a copper strip, 20 mm x 5 mm, with the initial velocities of a constant rate. Return the outcome, and the overall stretch
/// at which the matter first separates, or at the end.
pub fn stretch(parts: Parts, cells: u32, restart: &Restart) -> Result<(Outcome, f64), CaseError> {
    let h = 0.5e-2 / f64::from(cells);
    let packing = block([2.0e-2, 0.5e-2], h)?;
    let (rate, most) = (5.0e4, 5.0);
    with_parts!(parts, h, 20.0, copper(), |method, law| {
        let speed = |[x, _]: [f64; 2]| [rate * (x - 1.0e-2), 0.0];
        let mut body = Pcmm::new(method, law, &packing, speed, Masses::FromElements)?;
        let mut simulation = restart.scene(parts.label("strip"))?;
        for step in 1..=40 {
            let free = (most - 1.0) * f64::from(step) / 40.0;
            let broke = match simulation.until(&mut body, [], free / rate) {
                Ok(()) => false,
                Err(RunError::Step(_)) => true,
                Err(error) => return Err(error.into()),
            };
            let [parted] = simulation.note(|| Ok([f64::from(u8::from(has_parted(&body)))]))?;
            if broke || parted > 0.0 {
                break;
            }
        }
        let places = || body.particles().iter().map(|p| p.position[0]);
        let parted = (places().fold(f64::MIN, f64::max) - places().fold(f64::MAX, f64::min)) / 2.0e-2;
        let start = body.time();
        let mut outcome = watch(&mut body, start.max(1e-9), &mut simulation)?;
        outcome.reached = 1.0;
        outcome.covered =
            body.coverage().mass / (8930.0 * 1.0e-4 * if parts == Parts::Printed { 2.0 } else { 1.0 });
        Ok((outcome, parted))
    })
}

/// True if the body has separated, except for pieces of at most a twentieth of the elements.
fn has_parted<M: Composition<2>>(body: &Pcmm<2, M>) -> bool {
    let least = body.elements() / 20;
    pieces::<2>(body.element_nodes(), body.particles().len()).iter().filter(|p| p.len() > least).count() > 1
}

/// Coverage of a random packing.
#[derive(Clone, Copy, Debug)]
pub struct Cover {
    /// Area without an element, and area under two, of the inner square, over its area.
    pub holes: f64,
    pub double: f64,
}

/// Random circles (radii from 0.015 to 0.03) in a unit square: coverage, and impact of such a copper body on a wall at 200 m/s until the
/// wave has crossed it.
pub fn random_packing(parts: Parts, seed: u64, restart: &Restart) -> Result<(Outcome, Cover), CaseError> {
    let packing = thrown(seed);
    let simulation = restart.scene(parts.label(&format!("packing_{seed}")))?;
    // The widest gap of such packings is near two of the largest radii.
    let delta = 0.06;
    match parts {
        Parts::Printed => {
            let method = Method::printed(PlaneStrain, AzimuthFan::new(delta)?);
            packed(method, copper().with_rate(NoRotation).compiled(), &packing, simulation)
        }
        Parts::Consistent => {
            let method = Method::consistent(PlaneStrain, LocalDelaunay::new(delta, 2.0)?);
            packed(method, copper(), &packing, simulation)
        }
    }
}

fn packed<M: Composition<2>>(
    method: M,
    law: impl IntoMaterial<f64>,
    packing: &Packing<2>,
    mut simulation: Simulation,
) -> Result<(Outcome, Cover), CaseError> {
    let mut body = Pcmm::new(method, law, packing, |_| [0.0, -200.0], Masses::FromElements)?;
    let corners: Vec<[[f64; 2]; 4]> = body
        .element_nodes()
        .chunks_exact(3)
        .map(|n| {
            let x = |k: usize| body.particles()[n[k] as usize].position;
            [x(0), x(1), x(2), [0.0; 2]]
        })
        .collect();
    let halves =
        [[[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.0; 2]], [[0.1, 0.1], [0.9, 0.9], [0.1, 0.9], [0.0; 2]]];
    let (mut covered, mut double) = (0.0, 0.0);
    for (k, x) in corners.iter().enumerate() {
        let inside: f64 = halves.iter().map(|half| overlap(half, x, false)).sum();
        covered += inside;
        if inside > 0.0 {
            double += corners[..k].iter().map(|y| overlap(x, y, false)).sum::<f64>();
        }
    }
    let cover = Cover { holes: 1.0 - (covered - double) / 0.64, double: double / 0.64 };
    body.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    Ok((watch(&mut body, 2.5e-4, &mut simulation)?, cover))
}

/// Return a number in [0, 1) from a seed and an index.
fn random(seed: u64, place: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ place.wrapping_mul(0xD1B5_4A32_D192_ED03);
    for _ in 0..3 {
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z ^= z >> 27;
    }
    (z >> 11) as f64 / (1u64 << 53) as f64
}

fn thrown(seed: u64) -> Packing<2> {
    let (mut positions, mut radii): (Vec<[f64; 2]>, Vec<f64>) = (Vec::new(), Vec::new());
    let (mut place, mut failed) = (0, 0);
    while failed < 4000 {
        let x = [random(seed, place), random(seed, place + 1)];
        let r = 0.015 + 0.015 * random(seed, place + 2);
        place += 3;
        let free = positions
            .iter()
            .zip(&radii)
            .all(|(y, s)| (x[0] - y[0]).powi(2) + (x[1] - y[1]).powi(2) >= (r + s).powi(2));
        failed = if free { 0 } else { failed + 1 };
        if free {
            positions.push(x);
            radii.push(r);
        }
    }
    Packing::of_spheres(positions, radii)
}
