//! Conformance tests of boundary conditions, built-in or custom, in one line each. Behind the feature `conformance`.
//!
//! ```
//! use impactite_scene::{Boundary, Side};
//!
//! let rough = Boundary::FrictionWall { axis: 0, at: 0.0, side: Side::Above, velocity: [0.0, 0.5], friction: 0.3 };
//! impactite_scene::condition_conforms! {
//!     a_rough_wall: 2, rough, [-1.0, -1.0], [1.0, 1.0];
//! }
//! ```
//! Each line becomes a `#[test]`: its name, the dimensions, the condition, and the corners of a box, m, in whose middle the condition acts.

use std::fmt::{Debug, Display};

use super::Broken;
use crate::condition::{Condition, Place, Reaction};

/// Number of trial places.
const TRIALS: u64 = 2000;
/// Relative rounding error of a few operations.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Test the contract of a condition at random places in and around the box from `low` to `high`, m, its middle planes included, with
/// masses, velocities and steps of all sizes:
///
/// - it accepts its own parameters, and its description for checkpoints is reproducible;
/// - its reaction is finite and reproducible: it depends on the place only;
/// - the heat of friction is zero or positive;
/// - in constrained directions the impulse is the momentum change to the velocity of the boundary;
/// - acting alone and without constraints, it adds no energy beyond its work: the kinetic energy of the matter rises by no more than work
///   minus heat;
/// - it has no impulse outside of the reach that it declares;
/// - it acts somewhere in the box.
///
/// # Errors
/// The first property that does not hold.
pub fn condition<const D: usize>(
    condition: &impl Condition<D>,
    low: [f64; D],
    high: [f64; D],
) -> Result<(), Broken> {
    let subject = format!("{condition:?}");
    let require = |holds: bool, property: &'static str, detail: &dyn Display| {
        let subject = subject.clone();
        if holds { Ok(()) } else { Err(Broken { subject, property, detail: detail.to_string() }) }
    };
    let checked = condition.check();
    require(checked.is_ok(), "accepting its own numbers", &debug(&checked))?;
    let named = condition.constants([0.0, 1.0]);
    require(
        named == condition.constants([0.0, 1.0]) && !named.is_empty(),
        "one name for checkpoints",
        &named,
    )?;
    let mut acts = false;
    for trial in 0..TRIALS {
        let place = place(trial, &low, &high);
        let reaction = condition.react(&place);
        let detail = format!("{reaction:?} at {place:?}");
        let numbers = reaction.impulse.iter().chain(&reaction.velocity).chain([&reaction.heat]);
        require(numbers.clone().all(|x| x.is_finite()), "a finite reaction", &detail)?;
        let again = condition.react(&place);
        require(again == reaction, "the same reaction each time", &detail)?;
        require(reaction.heat >= 0.0, "heat that is zero or positive", &detail)?;
        held(&place, &reaction, &require, &detail)?;
        let alone = Place { start: Some(place.trial), ..place };
        energy(&alone, &condition.react(&alone), &require, &detail)?;
        let x = place.position;
        let reached =
            condition.reaches(&x.map(|x| x - place.tolerance), &x.map(|x| x + place.tolerance), place.time);
        require(reached || reaction.impulse == [0.0; D], "no impulse out of its reach", &detail)?;
        acts |= reaction.impulse != [0.0; D];
    }
    require(acts, "acting somewhere in the box", &format!("{low:?} .. {high:?}"))
}

fn debug(x: &impl Debug) -> String {
    format!("{x:?}")
}

type Requires<'a> = dyn Fn(bool, &'static str, &dyn Display) -> Result<(), Broken> + 'a;

/// Check that constrained matter moves with the boundary.
fn held<const D: usize>(
    place: &Place<D>,
    reaction: &Reaction<D>,
    require: &Requires<'_>,
    detail: &str,
) -> Result<(), Broken> {
    let after = place.after(&reaction.impulse);
    for d in (0..D).filter(|d| reaction.held[*d]) {
        let size = place.trial[d].abs() + reaction.velocity[d].abs();
        let off = (after[d] - reaction.velocity[d]).abs();
        require(off <= ROUNDING * size, "moving with the boundary where it is held", &detail)?;
    }
    Ok(())
}

/// Check that the energy of unconstrained matter rises by no more than work minus heat.
fn energy<const D: usize>(
    place: &Place<D>,
    reaction: &Reaction<D>,
    require: &Requires<'_>,
    detail: &str,
) -> Result<(), Broken> {
    if reaction.held.contains(&true) {
        return Ok(());
    }
    let mean = place.mean(&place.after(&reaction.impulse));
    let (mut rise, mut size) = (0.0, reaction.heat);
    for d in 0..D {
        rise += reaction.impulse[d] * mean[d];
        size +=
            reaction.impulse[d].abs() * (mean[d].abs() + place.trial[d].abs() + reaction.velocity[d].abs());
    }
    let said = reaction.work() - reaction.heat;
    require(rise <= said + ROUNDING * size, "giving no more energy than its work", &detail)
}

/// Return the place of a trial: positions in and around the box, a third on its middle planes; reproducible by number.
fn place<const D: usize>(trial: u64, low: &[f64; D], high: &[f64; D]) -> Place<D> {
    let mut random = Random(trial.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66_D1CE_4E5B);
    let position = std::array::from_fn(|d| {
        let (middle, half) = (0.5 * (low[d] + high[d]), 0.5 * (high[d] - low[d]));
        let u = random.next();
        if random.next() < -1.0 / 3.0 { middle } else { middle + 1.5 * half * u }
    });
    let size = (0..D).map(|d| high[d] - low[d]).fold(f64::INFINITY, f64::min);
    let scale = 10f64.powf(3.0 * random.next());
    let start = std::array::from_fn(|_| scale * random.next());
    let trial = std::array::from_fn(|d| start[d] + scale * random.next());
    let known = random.next() < 0.5;
    Place {
        position,
        mass: 10f64.powf(4.0 * random.next()),
        depth: 0.05 * size,
        tolerance: 1e-6 * size,
        start: known.then_some(start),
        trial,
        time: 0.0,
        dt: 10f64.powf(-4.0 + 3.0 * random.next()),
    }
}

/// Random numbers in -1 .. 1 (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Make a `#[test]` of each line `name: dimensions, condition, low, high;` that calls [`condition`].
#[macro_export]
macro_rules! condition_conforms {
    ($($name:ident: $d:literal, $condition:expr, $low:expr, $high:expr;)*) => {$(
        #[test]
        fn $name() {
            if let Err(broken) = $crate::conformance::condition::<$d>(&$condition, $low, $high) {
                panic!("{broken}");
            }
        }
    )*};
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU64, Ordering};

    use impactite_geometry::Cuboid;

    use super::*;
    use crate::boundary::{Boundary, Side};

    fn wall(friction: f64) -> Boundary<3> {
        Boundary::FrictionWall { axis: 1, at: 0.0, side: Side::Below, velocity: [0.2, -0.1, 0.3], friction }
    }
    fn absorbing(shear: f64) -> Boundary<2> {
        Boundary::Absorbing { axis: 0, at: 0.0, side: Side::Above, longitudinal: 5e3, shear }
    }
    fn prescribed() -> Boundary<2> {
        let region = Cuboid::new([-0.5; 2], [0.5; 2]).expect("region");
        Boundary::Prescribed { region: Arc::new(region), velocity: Arc::new(|t| [Some(1.0 + t), None, None]) }
    }

    condition_conforms! {
        smooth_wall: 3, wall(0.0), [-1.0; 3], [1.0; 3];
        rough_wall: 3, wall(0.4), [-1.0; 3], [1.0; 3];
        rougher_wall: 3, wall(40.0), [-1.0; 3], [1.0; 3];
        wall_of_all_methods: 2, Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 0.3 }, [-1.0; 2], [1.0; 2];
        plane_of_symmetry: 2, Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }, [-1.0; 2], [1.0; 2];
        fixed_plane: 2, Boundary::Fixed { axis: 1, at: 0.0, side: Side::Below }, [-1.0; 2], [1.0; 2];
        absorbing_plane: 2, absorbing(3e3), [-1.0; 2], [1.0; 2];
        absorbing_plane_of_a_fluid: 2, absorbing(0.0), [-1.0; 2], [1.0; 2];
        prescribed_velocity: 2, prescribed(), [-1.0; 2], [1.0; 2];
    }

    /// Fault of a test condition.
    #[derive(Debug)]
    enum Fault {
        Pushes,
        Cools,
        SlipsWhereHeld,
        ReachesFurther,
        Remembers(AtomicU64),
        NotANumber,
        Nothing,
    }

    impl Condition<2> for Fault {
        fn reaches(&self, low: &[f64; 2], _: &[f64; 2], _: f64) -> bool {
            !matches!(self, Fault::ReachesFurther) || low[0] <= 0.0
        }
        fn react(&self, place: &Place<2>) -> Reaction<2> {
            let none = Reaction::none();
            let along = |by: f64| Reaction { impulse: place.trial.map(|v| by * place.mass * v), ..none };
            match self {
                Fault::Pushes => along(0.5),
                Fault::Cools => Reaction { heat: -1.0, ..along(-0.5) },
                Fault::SlipsWhereHeld => Reaction { held: [true, false], ..along(-0.5) },
                Fault::ReachesFurther => along(-0.5),
                Fault::Remembers(calls) => along(-1.0 / (2 + calls.fetch_add(1, Ordering::Relaxed)) as f64),
                Fault::NotANumber => along(f64::NAN),
                Fault::Nothing => none,
            }
        }
    }

    #[test]
    fn faults_are_found() {
        let faults = [
            (Fault::Pushes, "giving no more energy than its work"),
            (Fault::Cools, "heat that is zero or positive"),
            (Fault::SlipsWhereHeld, "moving with the boundary where it is held"),
            (Fault::ReachesFurther, "no impulse out of its reach"),
            (Fault::Remembers(AtomicU64::new(0)), "the same reaction each time"),
            (Fault::NotANumber, "a finite reaction"),
            (Fault::Nothing, "acting somewhere in the box"),
        ];
        for (fault, property) in faults {
            let broken = condition::<2>(&fault, [-1.0; 2], [1.0; 2]).expect_err(property);
            assert_eq!(broken.property, property, "{broken}");
        }
    }

    #[test]
    fn numbers_are_refused_by_name() {
        let refused = |boundary: Boundary<2>| Condition::check(&boundary).expect_err("a number").to_string();
        let rough = |friction, velocity| Boundary::FrictionWall {
            axis: 1,
            at: 0.0,
            side: Side::Above,
            velocity,
            friction,
        };
        for (boundary, message) in [
            (
                rough(-0.1, [0.0; 2]),
                "friction wall: friction = -0.1 is not allowed; it must be zero or positive, and finite",
            ),
            (rough(0.1, [f64::NAN, 0.0]), "boundary velocity = NaN is not allowed; it must be finite"),
            (
                Boundary::Absorbing { axis: 0, at: 0.0, side: Side::Above, longitudinal: 0.0, shear: 1.0 },
                "absorbing plane: longitudinal = 0 is not allowed; it must be positive and finite",
            ),
            (
                Boundary::Periodic { axis: 0, low: 1.0, high: 0.0 },
                "periodic planes: high = 0 is not allowed; it must be above the lower plane, and finite",
            ),
            (
                Boundary::Periodic { axis: 2, low: 0.0, high: 1.0 },
                "boundary axis = 2 is not allowed; it must be below the dimension 2",
            ),
        ] {
            assert_eq!(refused(boundary), message);
        }
    }
}
