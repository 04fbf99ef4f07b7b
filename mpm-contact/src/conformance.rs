//! What every law and detector must do, as tests that one line applies to any of them, ours or yours. Behind the
//! feature `conformance`.
//!
//! ```
//! use mpm_contact::{Coulomb, Frictionless, conformance};
//! conformance::law(&Frictionless)?;
//! conformance::law(&Coulomb::new(0.3).unwrap())?;
//! conformance::detector(mpm_contact::Approach::<mpm_contact::Gradients>::default)?;
//! # Ok::<(), mpm_contact::conformance::Broken>(())
//! ```

use mpm_core::geometry::{Ball, Filling, Lattice, fill};
use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, Team, TimeControl};
use mpm_materials::{Moduli, NeoHookean};

use crate::detect::ContactDetector;
use crate::law::{Contact, ContactLaw, Coulomb, Pairs};
use crate::meet::GridContact;
use crate::vector::{difference, dot, length, sum, times};

/// A property that does not hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{property} does not hold: {detail}")]
pub struct Broken {
    /// The property, in words.
    pub property: &'static str,
    /// Where and by how much.
    pub detail: String,
}

fn require(holds: bool, property: &'static str, detail: impl FnOnce() -> String) -> Result<(), Broken> {
    if holds { Ok(()) } else { Err(Broken { property, detail: detail() }) }
}

/// A number in -1..1 from a seed.
fn random(seed: &mut u64) -> f64 {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn vector(seed: &mut u64) -> [f64; 3] {
    [random(seed), random(seed), random(seed)]
}

/// Round-off of a law's dozens of operations, with room.
const ROUND_OFF: f64 = 1e-13;

/// The law is symmetric in the bodies, sees relative velocities alone, turns with space, does not pull (unless
/// it says so), leaves no approach beyond rounding, never adds energy, and holds for a body of infinite mass. One that
/// springs instead stops two bodies that run into each other, and they part with at most the energy that they had.
///
/// # Errors
/// The first property that does not hold.
pub fn law(law: &impl ContactLaw<f64>) -> Result<(), Broken> {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..1000 {
        let normal = vector(&mut seed);
        let normal = times(normal, 1.0 / length(normal));
        let contact = Contact { normal, gap: Some(-1e-3), area: random(&mut seed).abs() };
        let masses = [0, 1].map(|_| 10.0_f64.powf(6.0 * random(&mut seed)));
        let masses = [masses[0], if random(&mut seed) > 0.8 { f64::INFINITY } else { masses[1] }];
        let velocities = [vector(&mut seed), vector(&mut seed)];
        one_contact(law, contact, masses, velocities, &mut seed)?;
        if law.springs() {
            bounce(law, normal, masses, velocities)?;
        }
    }
    Ok(())
}

/// Two bodies run into each other, in steps so short beside the spring's period that their length does not show.
fn bounce(
    law: &impl ContactLaw<f64>,
    normal: [f64; 3],
    masses: [f64; 2],
    velocities: [[f64; 3]; 2],
) -> Result<(), Broken> {
    let [mut v, mut w] = velocities;
    let closing = |v: [f64; 3], w: [f64; 3]| dot(difference(v, w), normal);
    if closing(v, w) < 0.0 {
        (v, w) = (w, v);
    }
    let mass = 1.0 / (1.0 / masses[0] + 1.0 / masses[1]);
    let energy = |v: [f64; 3], w: [f64; 3]| 0.5 * mass * dot(difference(v, w), difference(v, w));
    let overlap = Contact { normal, gap: Some(-1.0), area: 1.0 };
    let push = dot(law.impulse(&overlap, masses, [[0.0; 3]; 2], 1e-12), normal) / (mass * 1e-12);
    require(push > 0.0, "a push on bodies that overlap", || format!("{push} per mass"))?;
    let (begun, dt, mut gap) = (energy(v, w), 1e-3 / push.sqrt(), 0.0);
    for _ in 0..100_000 {
        let contact = Contact { normal, gap: Some(gap), area: 1.0 };
        let impulse = law.impulse(&contact, masses, [v, w], dt);
        v = difference(v, times(impulse, 1.0 / masses[0]));
        w = sum(w, times(impulse, 1.0 / masses[1]));
        gap -= closing(v, w) * dt;
        if gap >= 0.0 {
            break;
        }
    }
    let show = || format!("energy {begun} before, {} after, gap {gap}", energy(v, w));
    require(gap >= 0.0, "bodies that run into each other part", show)?;
    require(energy(v, w) <= begun * (1.0 + 1e-3), "no energy gained", show)
}

fn one_contact(
    law: &impl ContactLaw<f64>,
    contact: Contact<f64>,
    masses: [f64; 2],
    velocities: [[f64; 3]; 2],
    seed: &mut u64,
) -> Result<(), Broken> {
    let dt = 1e-3;
    let impulse = law.impulse(&contact, masses, velocities, dt);
    let show =
        || format!("impulse {impulse:?} for {contact:?}, masses {masses:?}, velocities {velocities:?}");
    require(impulse.iter().all(|x| x.is_finite()), "a finite impulse", show)?;
    let scale = masses[0].min(masses[1]) * 4.0;
    let near = |a: [f64; 3], b: [f64; 3]| length(difference(a, b)) <= ROUND_OFF * scale;

    let turned = Contact { normal: times(contact.normal, -1.0), ..contact };
    let [m, n] = masses;
    let [v, w] = velocities;
    let other = law.impulse(&turned, [n, m], [w, v], dt);
    require(near(other, times(impulse, -1.0)), "symmetry in the bodies", show)?;

    let drift = vector(seed);
    let moving = law.impulse(&contact, masses, [sum(v, drift), sum(w, drift)], dt);
    require(near(moving, impulse), "no influence of a common velocity", show)?;

    let permute = |[x, y, z]: [f64; 3]| [y, -z, -x];
    let rotated = Contact { normal: permute(contact.normal), ..contact };
    let rotated = law.impulse(&rotated, masses, [permute(v), permute(w)], dt);
    require(near(rotated, permute(impulse)), "turning with space", show)?;

    let along = dot(impulse, contact.normal);
    require(law.pulls() || along >= -ROUND_OFF * scale, "no pull", show)?;
    let after =
        difference(difference(v, times(impulse, 1.0 / masses[0])), sum(w, times(impulse, 1.0 / masses[1])));
    if law.springs() {
        return Ok(());
    }
    require(dot(after, contact.normal) <= ROUND_OFF * 8.0, "no approach left", show)?;
    let mean = times(sum(after, difference(v, w)), 0.5);
    require(dot(impulse, mean) >= -ROUND_OFF * scale, "no energy gained", show)
}

/// What discs that met show, by any method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Collision {
    /// Positions of the particles, body by body.
    pub positions: Vec<Vec<[f64; 3]>>,
    /// The largest change of momentum, over the sum of m |v|.
    pub drift: f64,
    /// Every contact of every step: unit normal from the first body to the second, impulse on the second.
    pub contacts: Vec<[[f64; 3]; 2]>,
}

/// The friction coefficient of the discs.
pub const FRICTION: f64 = 0.3;

/// Radius of the discs, m.
pub const DISC: f64 = 0.17;

/// Centre, m, and velocity, m/s, of disc `n` of `discs` that meet.
pub fn disc(n: usize, discs: usize) -> ([f64; 2], [f64; 2]) {
    let angle = 0.3 + std::f64::consts::TAU * n as f64 / discs as f64;
    let (sine, cosine) = angle.sin_cos();
    ([0.5 + 0.22 * cosine, 0.5 + 0.22 * sine], [-3.0 * cosine - 0.4, -3.0 * sine])
}

/// A scene of two or three discs conserves momentum, contacts push along unit normals and obey the friction cone, the
/// order of the bodies changes only rounding, and threads change nothing. `run` runs the discs with these
/// numbers ([`disc`]), in this order, on so many threads, by any method.
///
/// # Errors
/// The first property that does not hold.
pub fn collision(run: impl Fn(&[usize], usize) -> Result<Collision, Broken>) -> Result<(), Broken> {
    for bodies in [2, 3] {
        let order: Vec<usize> = (0..bodies).collect();
        let mut turned = order.clone();
        turned.rotate_left(1);
        let one = run(&order, 1)?;
        let same = run(&order, 2)?;
        let other = run(&turned, 1)?;
        require(one == same, "equal bits for any number of threads", || format!("{bodies} discs"))?;
        for run in [&one, &other] {
            require(run.drift <= 1e-12, "conservation of momentum", || format!("{:e}", run.drift))?;
            require(!run.contacts.is_empty(), "contact of discs that meet", || "none was found".into())?;
            run.contacts.iter().try_for_each(pushes)?;
        }
        for (n, &name) in turned.iter().enumerate() {
            for (a, b) in one.positions[name].iter().zip(&other.positions[n]) {
                // A decision that hangs on rounding would show as 1e-3.
                let error = length(difference(*a, *b));
                require(error < 1e-9, "no influence of numbering", || format!("{a:?} against {b:?}"))?;
            }
        }
    }
    Ok(())
}

fn pushes([normal, impulse]: &[[f64; 3]; 2]) -> Result<(), Broken> {
    let show = || format!("impulse {impulse:?}, normal {normal:?}");
    require((length(*normal) - 1.0).abs() < 1e-12, "a unit normal", show)?;
    let along = dot(*normal, *impulse);
    require(along > 0.0, "no pull", show)?;
    let across = length(difference(*impulse, times(*normal, along)));
    require(across <= (FRICTION + ROUND_OFF.sqrt()) * along, "the friction cone", show)
}

/// The properties of [`collision`] for the material point method with the detector that `make` makes.
///
/// # Errors
/// The first property that does not hold.
pub fn detector<S: ContactDetector<f64, 2>>(make: impl Fn() -> S) -> Result<(), Broken> {
    let friction = Coulomb::new(FRICTION).map_err(|e| stop(e.to_string()))?;
    detector_and_law(make, &friction)
}

/// The same with a law of the friction coefficient [`FRICTION`].
///
/// # Errors
/// The first property that does not hold.
pub fn detector_and_law<S: ContactDetector<f64, 2>>(
    make: impl Fn() -> S,
    law: &(impl ContactLaw<f64> + Clone),
) -> Result<(), Broken> {
    collision(|order, threads| run(make(), law.clone(), order, threads))
}

fn stop(why: String) -> Broken {
    Broken { property: "a run", detail: why }
}

fn run<S: ContactDetector<f64, 2>>(
    detector: S,
    law: impl ContactLaw<f64>,
    order: &[usize],
    threads: usize,
) -> Result<Collision, Broken> {
    let lattice = Lattice::new([0.0; 2], 0.05).map_err(|e| stop(e.to_string()))?;
    let moduli = Moduli::young_poisson(1.0e6, 0.3).map_err(|e| stop(e.to_string()))?;
    let rubber = NeoHookean::new(1000.0, moduli).map_err(|e| stop(e.to_string()))?;
    let contact = GridContact::new(detector, Pairs::new(law));
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    for &n in order {
        let (centre, velocity) = disc(n, order.len());
        let ball = Ball::new(centre, DISC).map_err(|e| stop(e.to_string()))?;
        let seeds = fill(&ball, &lattice, 2, &Filling::new()).map_err(|e| stop(e.to_string()))?;
        mpm.add(&format!("disc {n}"), rubber, &seeds, |_| velocity).map_err(|e| stop(e.to_string()))?;
    }
    mpm.set_team(Team::new(threads).map_err(|e| stop(e.to_string()))?);
    mpm.set_time_control(TimeControl::Fixed(2.5e-4)).map_err(|e| stop(e.to_string()))?;
    let start = mpm.totals();
    let mut all = Collision::default();
    for _ in 0..80 {
        mpm.step().map_err(|e| stop(e.to_string()))?;
        let drift = length(difference(mpm.totals().momentum, start.momentum));
        all.drift = all.drift.max(drift / start.momentum_scale);
        all.contacts.extend(mpm.contact_nodes().iter().map(|n| [n.normal, n.impulse]));
    }
    for body in mpm.bodies() {
        let mut list = vec![[0.0; 3]; body.len()];
        body.for_each(&mut |p| list[p.number] = p.position);
        all.positions.push(list);
    }
    Ok(all)
}
