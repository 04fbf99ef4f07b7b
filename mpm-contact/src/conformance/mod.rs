//! Conformance tests of contact laws, bodies of particles and contact methods, built-in or custom, one line each. Behind the feature
//! `conformance`. Detectors are tested by a method: `mpm_core::conformance::detector`.
//!
//! ```
//! use mpm_contact::{Coulomb, Frictionless, conformance};
//! conformance::law(&Frictionless)?;
//! conformance::law(&Coulomb::new(0.3).unwrap())?;
//! # Ok::<(), mpm_contact::conformance::Broken>(())
//! ```
//! [`particle_body`] tests bodies of particles ([`crate::particles`]); [`Balls`] are a contact partner for tests.

mod balls;
mod particles;

pub use balls::Balls;
pub use particles::particle_body;

use crate::law::{Contact, ContactLaw, Outcome, Remembers};
use crate::vector::{difference, dot, length, sum, times};

/// Violated property.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{property} does not hold: {detail}")]
pub struct Broken {
    /// Name of the property.
    pub property: &'static str,
    /// Place and amount of the violation.
    pub detail: String,
}

fn require(holds: bool, property: &'static str, detail: impl FnOnce() -> String) -> Result<(), Broken> {
    if holds { Ok(()) } else { Err(Broken { property, detail: detail() }) }
}

/// Pseudorandom number in -1..1 from a seed.
fn random(seed: &mut u64) -> f64 {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn vector(seed: &mut u64) -> [f64; 3] {
    [random(seed), random(seed), random(seed)]
}

/// Round-off of the dozens of operations of a law, with a margin.
const ROUND_OFF: f64 = 1e-13;

/// Test a contact law: symmetry in the bodies, dependence on relative velocities alone, objectivity, no tension (unless the law pulls), no
/// approach left beyond rounding, no energy gain, bodies of infinite mass; and all this after a history of contacts for laws with memory. A
/// law that springs must instead stop two colliding bodies, which separate with at most their initial energy.
///
/// # Errors
/// First violated property.
pub fn law(law: &impl ContactLaw<f64>) -> Result<(), Broken> {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let longest = if law.remembers() == Remembers::Nothing { 1 } else { 4 };
    for case in 0..1000 {
        let normal = vector(&mut seed);
        let normal = times(normal, 1.0 / length(normal));
        let area = random(&mut seed).abs();
        let masses = [0, 1].map(|_| 10.0_f64.powf(6.0 * random(&mut seed)));
        let masses = [masses[0], if random(&mut seed) > 0.8 { f64::INFINITY } else { masses[1] }];
        let history: Vec<_> = (0..1 + case % longest)
            .map(|_| {
                let velocities = [vector(&mut seed), vector(&mut seed)];
                Contact { gap: Some(-1e-3), area, ..Contact::new(normal, masses, velocities, 1e-3) }
            })
            .collect();
        one_history(law, &history, vector(&mut seed))?;
        if law.springs() {
            bounce(law, normal, masses, history[0].velocities)?;
        }
    }
    Ok(())
}

/// Continuing contact, with the memory of its law.
struct Kept<'a, L> {
    law: &'a L,
    slip: f64,
    memory: Vec<f64>,
}

impl<'a, L: ContactLaw<f64>> Kept<'a, L> {
    fn new(law: &'a L) -> Self {
        let own = law.remembers().numbers().saturating_sub(1);
        Kept { law, slip: 0.0, memory: vec![0.0; own] }
    }

    /// Compute the impulse of a step, and the velocities after it.
    fn step(&mut self, contact: Contact<'_, f64>) -> ([f64; 3], [[f64; 3]; 2]) {
        let before = self.memory.clone();
        let slip = if self.law.remembers() == Remembers::Nothing { 0.0 } else { self.slip };
        let contact = Contact { slip, memory: &before, ..contact };
        let impulse = self.law.impulse(&contact);
        let ([v, w], [m, n]) = (contact.velocities, contact.masses);
        let after = [difference(v, times(impulse, 1.0 / m)), sum(w, times(impulse, 1.0 / n))];
        let relative = difference(after[0], after[1]);
        let across = difference(relative, times(contact.normal, dot(relative, contact.normal)));
        let slid = times(across, contact.dt);
        self.slip += length(slid);
        self.law.advance(&contact, &Outcome { impulse, slid }, &mut self.memory);
        (impulse, after)
    }
}

/// Collide two bodies, in steps so short beside the spring period that their length has no effect.
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
    let overlap =
        Contact { gap: Some(-1.0), area: 1.0, ..Contact::new(normal, masses, [[0.0; 3]; 2], 1e-12) };
    let push = dot(Kept::new(law).step(overlap).0, normal) / (mass * 1e-12);
    require(push > 0.0, "a push on bodies that overlap", || format!("{push} per mass"))?;
    let (begun, dt, mut gap) = (energy(v, w), 1e-3 / push.sqrt(), 0.0);
    let mut kept = Kept::new(law);
    for _ in 0..100_000 {
        let contact = Contact { gap: Some(gap), area: 1.0, ..Contact::new(normal, masses, [v, w], dt) };
        [v, w] = kept.step(contact).1;
        gap -= closing(v, w) * dt;
        if gap >= 0.0 {
            break;
        }
    }
    let show = || format!("energy {begun} before, {} after, gap {gap}", energy(v, w));
    require(gap >= 0.0, "bodies that run into each other part", show)?;
    require(energy(v, w) <= begun * (1.0 + 1e-3), "no energy gained", show)
}

/// Check the last step of a contact history, and its symmetries.
fn one_history(
    law: &impl ContactLaw<f64>,
    history: &[Contact<'_, f64>],
    drift: [f64; 3],
) -> Result<(), Broken> {
    let Some(&contact) = history.last() else { return Ok(()) };
    let Contact { masses, velocities: [v, w], .. } = contact;
    let seen = |change: &dyn Fn(Contact<'static, f64>) -> Contact<'static, f64>| {
        let mut kept = Kept::new(law);
        let mut last = ([0.0; 3], [[0.0; 3]; 2]);
        for step in history {
            last = kept.step(change(Contact { memory: &[], ..*step }));
        }
        (last, kept)
    };
    let ((impulse, [v_after, w_after]), kept) = seen(&|contact| contact);
    let show = || format!("impulse {impulse:?} for {contact:?} after {} contacts", history.len() - 1);
    let finite = impulse.iter().chain(&kept.memory).all(|x| x.is_finite());
    require(finite, "a finite impulse and memory", show)?;
    // Each contact of a history adds its round-off, which memory may amplify.
    let round_off = ROUND_OFF * if history.len() > 1 { 100.0 } else { 1.0 };
    let scale = masses[0].min(masses[1]) * 4.0;
    let near = |a: [f64; 3], b: [f64; 3]| length(difference(a, b)) <= round_off * scale;

    let exchanged = |c: Contact<'static, f64>| {
        let ([m, n], [v, w]) = (c.masses, c.velocities);
        Contact { normal: times(c.normal, -1.0), masses: [n, m], velocities: [w, v], ..c }
    };
    require(near(seen(&exchanged).0.0, times(impulse, -1.0)), "symmetry in the bodies", show)?;
    let moving = |c: Contact<'static, f64>| Contact { velocities: c.velocities.map(|v| sum(v, drift)), ..c };
    require(near(seen(&moving).0.0, impulse), "no influence of a common velocity", show)?;
    let permute = |[x, y, z]: [f64; 3]| [y, -z, -x];
    let rotated = |c: Contact<'static, f64>| Contact {
        normal: permute(c.normal),
        velocities: c.velocities.map(permute),
        ..c
    };
    require(near(seen(&rotated).0.0, permute(impulse)), "turning with space", show)?;

    let along = dot(impulse, contact.normal);
    require(law.pulls() || along >= -ROUND_OFF * scale, "no pull", show)?;
    if law.springs() {
        return Ok(());
    }
    let after = difference(v_after, w_after);
    require(dot(after, contact.normal) <= ROUND_OFF * 8.0, "no approach left", show)?;
    let mean = times(sum(after, difference(v, w)), 0.5);
    require(dot(impulse, mean) >= -ROUND_OFF * scale, "no energy gained", show)
}

/// Results of colliding discs, by any method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Collision {
    /// Positions of the particles, body by body.
    pub positions: Vec<Vec<[f64; 3]>>,
    /// Largest change of momentum, over the sum of m |v|.
    pub drift: f64,
    /// All contacts of all steps: unit normal from the first body to the second, impulse on the second.
    pub contacts: Vec<[[f64; 3]; 2]>,
}

/// Friction coefficient of the discs.
pub const FRICTION: f64 = 0.3;

/// Radius of the discs, m.
pub const DISC: f64 = 0.17;

/// Centre, m, and velocity, m/s, of disc `n` of `discs` colliding discs.
pub fn disc(n: usize, discs: usize) -> ([f64; 2], [f64; 2]) {
    let angle = 0.3 + std::f64::consts::TAU * n as f64 / discs as f64;
    let (sine, cosine) = angle.sin_cos();
    ([0.5 + 0.22 * cosine, 0.5 + 0.22 * sine], [-3.0 * cosine - 0.4, -3.0 * sine])
}

/// Test a contact method by collisions of two or three discs: conservation of momentum, compressive impulses along unit normals, friction
/// cone, effect of the body order only to rounding, bitwise equality for any number of threads. `run` runs the discs with these numbers
/// ([`disc`]), in this order, on this number of threads, by any method.
///
/// # Errors
/// First violated property.
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
                // A decision sensitive to rounding would show as 1e-3.
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
