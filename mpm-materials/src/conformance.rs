//! Conformance tests of constitutive laws, exported for laws of other crates (feature `conformance`).
//!
//! One macro call in a test file expands to a module of `#[test]`s for a law:
//!
//! ```
//! use mpm_materials::conformance::Options;
//! use mpm_materials::{Moduli, NeoHookean, conformance_suite};
//!
//! fn rubber() -> NeoHookean<f64> {
//!     let moduli = Moduli::young_poisson(1.0e7, 0.4).unwrap();
//!     NeoHookean::new(1000.0, moduli).unwrap()
//! }
//! conformance_suite!(rubber_conforms, rubber(), Options::strain(0.2), hyperelastic);
//! ```
//!
//! The capabilities to test follow the options: `hyperelastic`, `yields`, `fails` ([`crate::capability`]). [`check`]
//! runs the tests without capabilities as a function. All random cases are drawn from a fixed seed.
//!
//! Paths are sequences of constant velocity gradients, so that they can be refined: properties that hold in
//! the limit of small steps are extrapolated from two refinements.

use std::fmt::Debug;

use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

use crate::capability::{Hyperelastic, Yields};
use crate::eos::{EnergyColumn, Eos, balance};
use crate::lane::{Lane, Wide};
use crate::point::{
    Breakdown, Constitutive, Kinematics, State, Update, first_broken, flatten, lane_of, spread, unflatten,
};
use crate::tensor::{Mat3, Sym3};

/// Result of a property test: success, or a message with property and law.
pub type Verdict = Result<(), String>;

/// Options of the conformance tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest component of the displacement gradient of one leg of a path.
    pub strain: f64,
    /// Number of legs of a path.
    pub legs: usize,
    /// Number of steps of a leg; refined properties use twice as many too.
    pub steps: usize,
    /// Duration of a leg, s; with `strain` it sets the strain rates.
    pub duration: f64,
    /// Size of the cell, m.
    pub length: f64,
    /// Number of random cases per property.
    pub cases: u32,
    /// True if the virgin state is free of stress, unlike that of a gas.
    pub stress_free: bool,
    /// True if rotations of any size rotate the stress exactly, to rounding; false for laws with
    /// [`SmallRotation`](crate::SmallRotation).
    pub exact_rotation: bool,
    /// Allowed difference of stress work and internal energy, relative to the work done. Hypoelastic laws
    /// whose energy is computed from the stress need more than the default 2e-3.
    pub work_tolerance: f64,
    /// Allowed relative excess of the numerical tangent over rho c^2. Heating by shear work adds gamma s to the tangent
    /// of a solid, which its wave speed leaves out: a percent or two for strong metals in compression, more in strong
    /// tension, where rho c^2 is small.
    pub wave_tolerance: f64,
}

impl Options {
    /// Default options: two legs of this strain, one microsecond each.
    pub fn strain(strain: f64) -> Self {
        Options {
            strain,
            legs: 2,
            steps: 400,
            duration: 1.0e-6,
            length: 1.0e-3,
            cases: 12,
            stress_free: true,
            exact_rotation: true,
            work_tolerance: 2.0e-3,
            wave_tolerance: 1.0e-3,
        }
    }
}

/// Proptest strategies for the motion of a point.
pub mod strategies {
    use super::{Mat3, Options, Sym3};
    use crate::rate::rotation as rotation_of;
    use proptest::array::{uniform3, uniform6};
    use proptest::strategy::Strategy;

    /// Rotations about any axis, up to about 150 degrees.
    pub fn rotation() -> impl Strategy<Value = Mat3<f64>> {
        uniform3(-4.0..4.0_f64).prop_map(rotation_of)
    }
    /// Symmetric tensors with components up to `size`.
    pub fn symmetric(size: f64) -> impl Strategy<Value = Sym3<f64>> {
        uniform6(-size..size).prop_map(Sym3)
    }
    /// Displacement-gradient increments with components up to `size`, spin included.
    pub fn increment(size: f64) -> impl Strategy<Value = Mat3<f64>> {
        uniform3(uniform3(-size..size)).prop_map(Mat3)
    }
    /// Deformation gradients I + increment; `size` below 0.3 keeps the determinant positive.
    pub fn deformation(size: f64) -> impl Strategy<Value = Mat3<f64>> {
        increment(size).prop_map(|h| h + Mat3::identity())
    }
    /// Right stretch tensors I + symmetric.
    pub fn stretch(size: f64) -> impl Strategy<Value = Sym3<f64>> {
        symmetric(size).prop_map(|e| e.plus_isotropic(1.0))
    }
    /// Legs of a path, each a displacement gradient applied in equal steps.
    pub fn path(options: &Options) -> impl Strategy<Value = Vec<Mat3<f64>>> + use<> {
        proptest::collection::vec(increment(options.strain), options.legs)
    }
}

/// Run the tests that need no capability.
///
/// # Errors
/// The first property that the law violates.
pub fn check<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    virgin(law, options)?;
    rest(law, options)?;
    isotropy(law, options)?;
    objectivity(law, options)?;
    spinning(law, options)?;
    superposed(law, options)?;
    work(law, options)?;
    cycles(law, options)?;
    purity(law, options)?;
    lanes(law, options)?;
    wave_speed(law, options)?;
    inversion(law, options)?;
    not_a_number(law, options)
}

/// Expand to a module of `#[test]`s of a law and its listed capabilities; see [`crate::conformance`]. `single = law32`
/// also compares the law in `f32` with the law in `f64`.
#[macro_export]
macro_rules! conformance_suite {
    ($name:ident, $law:expr, $options:expr $(, $capability:ident)* $(,)? $(; single = $single:expr)?) => {
        mod $name {
            #[allow(unused_imports)]
            use super::*;
            $crate::conformance_suite!(@tests $law, $options,
                virgin rest isotropy objectivity spinning superposed work cycles purity lanes wave_speed inversion not_a_number
                $($capability)*);
            $(
                #[test]
                fn single_precision() {
                    let verdict = $crate::conformance::single_precision(&$law, &$single, &$options);
                    if let Err(message) = verdict { panic!("{message}") }
                }
            )?
        }
    };
    (@tests $law:expr, $options:expr, $($property:ident)*) => {$(
        #[test]
        fn $property() {
            if let Err(message) = $crate::conformance::$property(&$law, &$options) { panic!("{message}") }
        }
    )*};
}

/// Check the virgin state: a point at rest stays virgin, and is free of stress if the options require it.
///
/// # Errors
/// The violation.
pub fn virgin<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    let old = law.virgin();
    let stress = law.stress(&old);
    let modulus = modulus(law, &old);
    if options.stress_free && largest(&stress) > 1e-14 * modulus {
        return fail("virgin", law, format!("the virgin stress is {stress:?}"));
    }
    let new = step(law, &old, &Mat3::zero(), options)?;
    same_state("virgin", law, &new.state, &old, 1e-14)?;
    same_stress("virgin", law, &new.stress, &stress, 1e-14 * modulus)
}

/// Check a point at rest: its state stays constant without motion, and its update returns the stress of the state.
///
/// # Errors
/// The violation.
pub fn rest<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    for_all("rest", law, options, strategies::path(options), |path| {
        let mut settled = walk(law, &path, options.steps, options)?.state;
        // Relax viscous stress, rate-dependent flow stress and softening by the last heating first.
        for _ in 0..10 {
            settled = step(law, &settled, &Mat3::zero(), options)?.state;
        }
        let again = step(law, &settled, &Mat3::zero(), options)?;
        let rounding = 1e-13 * modulus(law, &settled);
        same_state("rest", law, &again.state, &settled, 1e-10)?;
        same_stress("rest", law, &again.stress, &law.stress(&settled), rounding)?;
        same_stress("rest (stress of the state)", law, &again.stress, &law.stress(&again.state), rounding)
    })
}

/// Check isotropy: a fixed rotation of the whole motion rotates the stress and changes nothing else.
///
/// # Errors
/// The violation.
pub fn isotropy<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    let strategy = (strategies::path(options), strategies::rotation());
    for_all("isotropy", law, options, strategy, |(path, q)| {
        let turned: Vec<_> = path.iter().map(|g| q.times(g).times(&q.transpose())).collect();
        let plain = walk(law, &path, 50, options)?;
        let other = walk(law, &turned, 50, options)?;
        let expected = q.congruence(&plain.stress);
        let tolerance = 1e-9 * (largest(&expected) + 1e-3 * modulus(law, &plain.state));
        same_stress("isotropy", law, &other.stress, &expected, tolerance)?;
        let (a, b) = (law.energy(&plain.state), law.energy(&other.state));
        within("isotropy: energy", law, a, b, 1e-8 * (a.abs() + b.abs()) + 1e-14 * modulus(law, &plain.state))
    })
}

/// Check objectivity: a superposed rotation rotates the stress, in the limit of small steps.
///
/// # Errors
/// The violation.
pub fn objectivity<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    let axis = proptest::array::uniform3(-0.5..0.5_f64);
    for_all("objectivity", law, options, (strategies::path(options), axis), |(path, axis)| {
        let steps = options.steps * 4;
        let coarse = turning_error(law, &path, axis, steps, options)?;
        let fine = turning_error(law, &path, axis, 2 * steps, options)?;
        let limit = fine.0 * 2.0 - coarse.0;
        let scale = fine.1 + 1e-4 * options.strain * modulus(law, &law.virgin());
        if largest(&limit) > 1e-2 * scale {
            let message = format!("stress differs from the turned stress by {limit:?} Pa of {scale:e} Pa");
            return fail("objectivity", law, message);
        }
        Ok(())
    })
}

/// Stress under a superposed rotation, rotated back, minus the stress without; and the size of the latter.
fn turning_error<M: Constitutive<f64>>(
    law: &M,
    path: &[Mat3<f64>],
    axis: [f64; 3],
    steps: usize,
    options: &Options,
) -> Result<(Sym3<f64>, f64), String> {
    let total = (steps * path.len()) as f64;
    let each = crate::rate::rotation(axis.map(|a| a / total));
    let options = with_steps(options, steps);
    let (mut plain, mut turned) = (law.virgin(), law.virgin());
    let mut q = Mat3::identity();
    for leg in path {
        let increment = *leg * (1.0 / steps as f64);
        for _ in 0..steps {
            let next = each.times(&q);
            let moved = next.times(&(increment + Mat3::identity())).times(&q.transpose());
            plain = step(law, &plain, &increment, &options)?.state;
            turned = step(law, &turned, &(moved + Mat3::identity() * -1.0), &options)?.state;
            q = next;
        }
    }
    let stress = law.stress(&plain);
    Ok((q.transpose().congruence(&law.stress(&turned)) - stress, largest(&stress)))
}

/// Rotation angles per step, rad.
const ANGLES: [f64; 4] = [1e-6, 1e-3, 0.05, 0.3];

/// Spin vector of a rotation by `angle`, rad, about a direction.
fn spin_of(direction: [f64; 3], angle: f64) -> [f64; 3] {
    let [x, y, z] = direction;
    let length = (x * x + y * y + z * z).sqrt();
    direction.map(|d| d / length * 2.0 * (0.5 * angle).tan())
}

/// Return the virgin state and a stressed state at rest.
fn resting<M: Constitutive<f64>>(
    law: &M,
    path: &[Mat3<f64>],
    options: &Options,
) -> Result<[M::State<f64>; 2], String> {
    let mut settled = walk(law, path, 50, options)?.state;
    // Relax viscous stress, rate-dependent flow stress and softening by the last heating first.
    for _ in 0..10 {
        settled = step(law, &settled, &Mat3::zero(), options)?.state;
    }
    Ok([law.virgin(), settled])
}

/// Check rotation in finite steps, X = R - I, with and without stress: only the stress rotates, compared with a point
/// at rest; no work, no plastic strain, no damage. To rounding, for steps of 1e-6 to 0.3 rad about any axis. A half
/// turn in one step, which has a singular midpoint, must be exact or reported.
///
/// # Errors
/// The violation.
pub fn spinning<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    if !options.exact_rotation {
        return Ok(());
    }
    let direction = proptest::array::uniform3(0.1..1.0_f64);
    for_all("spinning", law, options, (strategies::path(options), direction), |(path, direction)| {
        const STEPS: usize = 40;
        let [x, y, z] = direction;
        let directions = [direction, [-x, y, 0.0], [0.0, 0.0, z], [x, -y, -z]];
        for start in resting(law, &path, options)? {
            for (direction, angle) in directions.into_iter().zip(ANGLES) {
                let w = spin_of(direction, angle);
                let (increment, each) = (crate::rate::turn(w), crate::rate::rotation(w));
                let (mut turned, mut still, mut q) = (start, start, Mat3::identity());
                for _ in 0..STEPS {
                    turned = step(law, &turned, &increment, options)?.state;
                    still = step(law, &still, &Mat3::zero(), options)?.state;
                    q = each.times(&q);
                }
                let modulus = modulus(law, &still);
                let stress = q.congruence(&law.stress(&still));
                // Rounding of an increment, relative to its components, acts as a strain; each step adds one.
                let rounding = 8.0 * STEPS as f64 * f64::EPSILON;
                let size = largest(&stress) + modulus;
                same_stress("spinning", law, &law.stress(&turned), &stress, rounding * size)?;
                let (a, b) = (law.energy(&turned), law.energy(&still));
                within("spinning: energy", law, a, b, rounding * (b.abs() + size))?;
                let (a, b) = (law.volume_ratio(&turned), law.volume_ratio(&still));
                within("spinning: volume ratio", law, a, b, rounding * b)?;
                let mut names = Vec::new();
                M::State::<f64>::names("state", &mut names);
                let numbers = flatten(&turned).into_iter().zip(flatten(&still));
                for (name, (a, b)) in names.iter().zip(numbers) {
                    if name.ends_with("strain") || name.ends_with("damage") {
                        within(&format!("spinning: {name}"), law, a, b, 1e-12 * (1.0 + b.abs()))?;
                    }
                }
            }
            let half = Mat3([[-2.0, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0; 3]]);
            let update = law.update(&still(&half, options), &start);
            if first_broken(&update).is_none() {
                let signs = Sym3([1.0, 1.0, 1.0, -1.0, -1.0, 1.0]);
                let mut stress = law.stress(&start);
                for i in 0..6 {
                    stress.0[i] *= signs.0[i];
                }
                let rounding = 1e-13 * (largest(&stress) + modulus(law, &start));
                same_stress("spinning: half a turn", law, &update.stress, &stress, rounding)?;
            }
        }
        Ok(())
    })
}

/// Check a step Q U, a small stretch and then a rotation of up to 0.3 rad: its stress is that of the stretch, rotated
/// by Q, up to the angle times the stress increment; the volume ratio is equal to rounding.
///
/// # Errors
/// The violation.
pub fn superposed<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    if !options.exact_rotation {
        return Ok(());
    }
    let direction = proptest::array::uniform3(0.1..1.0_f64);
    let stretch = strategies::symmetric(options.strain / 200.0);
    let strategy = (strategies::path(options), direction, stretch);
    for_all("superposed rotation", law, options, strategy, |(path, direction, stretch)| {
        for start in resting(law, &path, options)? {
            for angle in ANGLES {
                let w = spin_of(direction, angle);
                let (turn, q) = (crate::rate::turn(w), crate::rate::rotation(w));
                let plain = step(law, &start, &stretch.to_mat(), options)?;
                let moved = step(law, &start, &(turn + q.times(&stretch.to_mat())), options)?;
                let modulus = modulus(law, &plain.state);
                let added = largest(&(plain.stress - law.stress(&start))) + modulus * largest(&stretch);
                let rounding = 64.0 * f64::EPSILON * (largest(&plain.stress) + modulus);
                // The midpoint is half a rotation before the end of the step, and larger by alpha^2/4.
                let tolerance = 2.0 * angle * added + rounding;
                let stress = q.congruence(&plain.stress);
                same_stress("superposed rotation", law, &moved.stress, &stress, tolerance)?;
                let (a, b) = (law.volume_ratio(&moved.state), law.volume_ratio(&plain.state));
                within("superposed rotation: volume ratio", law, a, b, 64.0 * f64::EPSILON * b)?;
            }
        }
        Ok(())
    })
}

/// Check the energy balance: the internal energy grows by the stress work, in the limit of small steps.
///
/// # Errors
/// The violation.
pub fn work<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    for_all("work", law, options, strategies::path(options), |path| {
        let coarse = walk(law, &path, options.steps, options)?;
        let fine = walk(law, &path, 2 * options.steps, options)?;
        let gap = |end: &Walked<M>| law.energy(&end.state) - end.work;
        let limit = 2.0 * gap(&fine) - gap(&coarse);
        if limit.abs() > options.work_tolerance * fine.effort {
            let effort = fine.effort;
            return fail(
                "work",
                law,
                format!("energy exceeds the stress work by {limit:e} of {effort:e} J/m^3"),
            );
        }
        Ok(())
    })
}

/// Check closed strain cycles: none yields work.
///
/// # Errors
/// The violation.
pub fn cycles<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    for_all("cycles", law, options, strategies::path(options), |path| {
        let there_and_back: Vec<_> =
            path.iter().copied().chain(path.iter().rev().map(|g| *g * -1.0)).collect();
        let end = walk(law, &there_and_back, options.steps, options)?;
        if end.work < -options.work_tolerance.max(1e-2) * end.effort {
            let message = format!("a closed cycle gave {:e} of {:e} J/m^3", -end.work, end.effort);
            return fail("cycles", law, message);
        }
        Ok(())
    })
}

/// Check purity: the same call returns the same bits.
///
/// # Errors
/// The violation.
pub fn purity<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    let strategy = (strategies::path(options), strategies::increment(options.strain / 50.0));
    for_all("purity", law, options, strategy, |(path, increment)| {
        let state = walk(law, &path, 50, options)?.state;
        let bits = |_: u8| -> Result<Vec<u64>, String> {
            let update = step(law, &state, &increment, options)?;
            Ok(flatten(&update.state).iter().chain(&update.stress.0).map(|x: &f64| x.to_bits()).collect())
        };
        if bits(0)? == bits(1)? { Ok(()) } else { fail("purity", law, "two equal calls differ".into()) }
    })
}

/// Check lanes: points in a pack equal points computed alone, to the rounding of `powf`, and points in another pack bit
/// by bit. Code that a law skips if no lane needs it must change no lane.
///
/// # Errors
/// The violation.
pub fn lanes<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    let four = proptest::array::uniform4(strategies::path(options));
    for_all("lanes", law, options, four, |paths| {
        let part = 1.0 / options.steps as f64;
        let mut pack: M::State<Wide<f64, 4>> = spread(&law.virgin());
        // Packs of four copies of the first and of the last point.
        let mut among_equals: [M::State<Wide<f64, 4>>; 2] = [spread(&law.virgin()), spread(&law.virgin())];
        let mut alone = [law.virgin(); 4];
        for leg in 0..options.legs {
            // The last lane rests in the first leg: yielding and resting lanes must not affect each other.
            let share = [part, part, 0.1 * part, if leg == 0 { 0.0 } else { part }];
            let mut increment: Mat3<Wide<f64, 4>> = Mat3::zero();
            for lane in 0..4 {
                for (r, c) in positions() {
                    let value = paths[lane][leg].0[r][c] * share[lane];
                    increment.0[r][c] = increment.0[r][c].with_lane(lane, value);
                }
            }
            for _ in 0..options.steps {
                let kinematics = still(&increment, options);
                let update = law.update(&kinematics, &pack);
                if let Some(broken) = first_broken(&update) {
                    return fail("lanes", law, format!("lane {} broke down: {}", broken.lane, broken.cause));
                }
                pack = update.state;
                for (state, lane) in among_equals.iter_mut().zip([0, 3]) {
                    let mut kinematics = kinematics;
                    for (r, c) in positions() {
                        kinematics.increment.0[r][c] = Wide::splat(increment.0[r][c].lane(lane));
                    }
                    *state = law.update(&kinematics, state).state;
                }
                for lane in 0..4 {
                    alone[lane] = step(law, &alone[lane], &(paths[lane][leg] * share[lane]), options)?.state;
                }
            }
        }
        for (state, lane) in among_equals.iter().zip([0, 3]) {
            let [one, other]: [M::State<f64>; 2] = [lane_of(&pack, lane), lane_of(state, lane)];
            if flatten(&one).iter().zip(&flatten(&other)).any(|(a, b)| a.to_bits() != b.to_bits()) {
                return fail("lanes", law, format!("lane {lane} depends on what other lanes hold"));
            }
        }
        let lists: Vec<Vec<f64>> = alone.iter().map(flatten).collect();
        for lane in 0..4 {
            let one: M::State<f64> = lane_of(&pack, lane);
            for (i, value) in flatten(&one).into_iter().enumerate() {
                let scale = lists.iter().map(|list| list[i].abs()).fold(0.0, f64::max);
                if (value - lists[lane][i]).abs() > 1e-10 * scale {
                    let message =
                        format!("number {i} is {value:e} in lane {lane} and {:e} alone", lists[lane][i]);
                    return fail("lanes", law, message);
                }
            }
        }
        Ok(())
    })
}

/// Check the wave speed: rho c^2 bounds the tangent modulus under a small uniaxial strain in any direction.
///
/// # Errors
/// The violation.
pub fn wave_speed<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    let strategy = (strategies::path(options), strategies::rotation());
    for_all("wave speed", law, options, strategy, |(path, q)| {
        let reached = walk(law, &path, options.steps, options)?.state;
        // Slow enough for negligible viscosity.
        let slow = Options { duration: 1e3, steps: 1, ..*options };
        for mut state in [law.virgin(), reached] {
            // Relax viscous stress and softening at rest first.
            for _ in 0..5 {
                state = step(law, &state, &Mat3::zero(), &slow)?.state;
            }
            let base = step(law, &state, &Mat3::zero(), &slow)?;
            let bound = modulus(law, &state);
            for axis in 0..3 {
                let small = 1e-6;
                let mut strain = Sym3::zero();
                strain.0[axis] = small;
                let pull = q.congruence(&strain).to_mat();
                let pulled = step(law, &state, &pull, &slow)?;
                let change = q.transpose().congruence(&(pulled.stress - base.stress));
                let tangent = change.0[axis] / small;
                if tangent > bound * (1.0 + options.wave_tolerance) {
                    let message =
                        format!("the tangent modulus {tangent:e} Pa exceeds rho c^2 = {bound:e} Pa");
                    return fail("wave speed", law, message);
                }
            }
        }
        Ok(())
    })
}

/// Check that a step that inverts the point is reported as [`Breakdown::InvertedVolume`].
///
/// # Errors
/// The violation.
pub fn inversion<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    for axis in 0..3 {
        let mut increment = Mat3::zero();
        increment.0[axis][axis] = -1.5;
        let update = law.update(&still(&increment, options), &law.virgin());
        if update.fault.cause(0) != Some(Breakdown::InvertedVolume) {
            let message = format!("a stretch of -0.5 is reported as {:?}", update.fault.cause(0));
            return fail("inversion", law, message);
        }
    }
    Ok(())
}

/// Check NaN handling: a NaN in the motion or in a state variable that the law reads is reported in its lane and in no
/// other.
///
/// # Errors
/// The violation.
pub fn not_a_number<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    let virgin: M::State<Wide<f64, 4>> = spread(&law.virgin());
    let only_lane_two = |update: &Update<Wide<f64, 4>, M::State<Wide<f64, 4>>>, what: String| {
        for lane in 0..4 {
            if update.fault.cause(lane).is_some() != (lane == 2) {
                let found = update.fault.cause(lane);
                return fail("not a number", law, format!("{what} in lane 2: lane {lane} reports {found:?}"));
            }
        }
        Ok(())
    };
    for (r, c) in positions() {
        let mut increment: Mat3<Wide<f64, 4>> = Mat3::identity() * Wide::of(1e-6);
        increment.0[r][c] = increment.0[r][c].with_lane(2, f64::NAN);
        let update = law.update(&still(&increment, options), &virgin);
        only_lane_two(&update, format!("NaN in the increment at ({r}, {c})"))?;
    }
    let healthy = flatten(&virgin);
    for i in 0..healthy.len() {
        let mut list = healthy.clone();
        list[i] = list[i].with_lane(2, f64::NAN);
        let state = unflatten(&list).map_err(|n| format!("{n} numbers do not make a state"))?;
        let motion = still(&(Mat3::identity() * Wide::of(1e-6)), options);
        let update = law.update(&motion, &state);
        // A number that the law does not read has no effect.
        let healthy = law.update(&motion, &virgin);
        let [is, was] = [&update, &healthy].map(|u| (flatten(&u.state), u.stress.0));
        let same =
            |a: &[Wide<f64, 4>], b: &[Wide<f64, 4>]| a.iter().zip(b).all(|(a, b)| a.lane(2) == b.lane(2));
        let unread = !update.fault.any() && same(&is.0, &was.0) && same(&is.1, &was.1);
        if !unread {
            only_lane_two(&update, format!("NaN in number {i} of the old state"))?;
        }
    }
    Ok(())
}

/// Check single precision: the law stays near the law in double precision.
///
/// # Errors
/// The violation.
pub fn single_precision<M, N>(double: &M, single: &N, options: &Options) -> Verdict
where
    M: Constitutive<f64>,
    N: Constitutive<f32>,
{
    for_all("single precision", double, options, strategies::path(options), |path| {
        let options = with_steps(options, 50);
        let mut a = double.virgin();
        let mut b = single.virgin();
        for leg in &path {
            let increment = *leg * 0.02;
            for _ in 0..50 {
                a = step(double, &a, &increment, &options)?.state;
                let kinematics = Kinematics {
                    increment: Mat3(increment.0.map(|row| row.map(|x| x as f32))),
                    dt: (options.duration / 50.0) as f32,
                    length: options.length as f32,
                };
                let update = single.update(&kinematics, &b);
                if let Some(broken) = first_broken(&update) {
                    return fail("single precision", double, format!("f32 broke down: {}", broken.cause));
                }
                b = update.state;
            }
        }
        let (exact, rounded) = (double.stress(&a), Sym3(single.stress(&b).0.map(f64::from)));
        let tolerance = 1e-5 * modulus(double, &a) + 2e-3 * largest(&exact);
        same_stress("single precision", double, &rounded, &exact, tolerance)
    })
}

/// Check that the stress is the derivative of the energy: sigma = (1/J) dW/dF F^T by central differences.
///
/// # Errors
/// The violation.
pub fn hyperelastic<M: Hyperelastic<f64>>(law: &M, options: &Options) -> Verdict {
    let strategy = strategies::deformation(options.strain.min(0.25));
    for_all("hyperelastic", law, options, strategy, |f| {
        let h = 1e-5;
        let mut slope = Mat3::zero();
        for (r, c) in positions() {
            let (mut up, mut down) = (f, f);
            up.0[r][c] += h;
            down.0[r][c] -= h;
            slope.0[r][c] = (law.energy(&law.deformed(&up)) - law.energy(&law.deformed(&down))) / (2.0 * h);
        }
        let expected = slope.times(&f.transpose()) * f.determinant().recip();
        let stress = law.stress(&law.deformed(&f));
        let tolerance = 1e-7 * modulus(law, &law.deformed(&f));
        for (r, c) in positions() {
            within("hyperelastic", law, stress.at(r, c), expected.0[r][c], tolerance)?;
        }
        Ok(())
    })
}

/// Check the yield surface: after the return mapping the equivalent stress does not exceed the flow stress and equals
/// it after plastic flow; the plastic strain never decreases.
///
/// # Errors
/// The violation; also paths without any plastic flow, which test nothing.
pub fn yields<M: Yields<f64>>(law: &M, options: &Options) -> Verdict {
    let flowed = std::cell::Cell::new(false);
    for_all("yields", law, options, strategies::path(options), |path| {
        for steps in [5, 50, options.steps] {
            let options = with_steps(options, steps);
            let mut old = law.virgin();
            for leg in &path {
                let increment = *leg * (1.0 / steps as f64);
                for _ in 0..steps {
                    let new = step(law, &old, &increment, &options)?.state;
                    let limit = law.flow_stress(&still(&increment, &options), &old, &new);
                    let equivalent = law.stress(&new).deviator().equivalent();
                    let grown = law.plastic_strain(&new) - law.plastic_strain(&old);
                    let rounding = 2e-9 * limit + 1e-13 * modulus(law, &new);
                    if grown < 0.0 || equivalent > limit + rounding {
                        let message = format!(
                            "equivalent stress {equivalent:e} Pa, flow stress {limit:e} Pa, plastic strain by {grown:e}"
                        );
                        return fail("yields", law, message);
                    }
                    if grown > 0.0 {
                        flowed.set(true);
                        within("yields: flow below the surface", law, equivalent, limit, rounding)?;
                    }
                    old = new;
                }
            }
        }
        Ok(())
    })?;
    if flowed.get() { Ok(()) } else { fail("yields", law, "no path flowed; take a larger strain".into()) }
}

/// Check failure: a failed point stays failed, carries no shear and no tension, and still carries compression.
///
/// # Errors
/// The violation; also paths without any failure, which test nothing.
pub fn fails<M: Constitutive<f64>>(law: &M, options: &Options) -> Verdict {
    let broken = std::cell::Cell::new(false);
    for_all("fails", law, options, strategies::path(options), |path| {
        let options = with_steps(options, 200);
        let mut state = law.virgin();
        let mut was = false;
        let twice = path.iter().chain(path.iter().rev());
        for leg in twice {
            for sign in [1.0, -1.0] {
                for _ in 0..200 {
                    state = step(law, &state, &(*leg * (sign / 200.0)), &options)?.state;
                    let now = law.failed(&state);
                    if was && !now {
                        return fail("fails", law, "a failed point healed".into());
                    }
                    was = now;
                    let stress = law.stress(&state);
                    let rounding = 1e-13 * modulus(law, &state);
                    if now && (largest(&stress.deviator()) > rounding || stress.mean() > rounding) {
                        return fail("fails", law, format!("a failed point carries {stress:?}"));
                    }
                }
            }
        }
        if was {
            broken.set(true);
            let squeeze = Mat3::identity() * -0.01;
            for _ in 0..12 {
                state = step(law, &state, &squeeze, &options)?.state;
            }
            if law.volume_ratio(&state) < 1.0 && law.stress(&state).mean() >= 0.0 {
                return fail("fails", law, "a compressed failed point carries no pressure".into());
            }
        }
        Ok(())
    })?;
    if broken.get() { Ok(()) } else { fail("fails", law, "no path failed; take a larger strain".into()) }
}

/// Check an equation of state over volume ratios `range` and energies up to `energy`, J/m^3: the squared sound speed is
/// dp/drho at constant entropy; a barotropic law has no thermal term and its stored energy is the integral of its
/// pressure; the virgin pressure is zero unless there is initial energy; the implicit balance solves its own equation.
/// For J from 0.01 to 100 pressure and sound speed are finite, and in compression the pressure grows with the density.
///
/// # Errors
/// The violation.
pub fn eos<E: Eos<f64>>(eos: &E, range: std::ops::Range<f64>, energy: f64) -> Verdict {
    let name = eos.name();
    let report = |what: String| Err(format!("equation of state \"{name}\": {what}"));
    let rest = eos.pressure(1.0, 0.0);
    let bulk = eos.density() * eos.speed_squared(1.0, eos.initial_energy());
    if eos.initial_energy() == 0.0 && rest.abs() > 1e-12 * bulk {
        return report(format!("the pressure at rest without energy is {rest:e} Pa"));
    }
    run_cases(name, 500, (-2.0..2.0_f64, 0.0..=energy), |(decade, e)| {
        let j = 10.0_f64.powf(decade);
        let (p, denser) = (eos.pressure(j, e), eos.pressure(j * (1.0 - 1e-4), e));
        let squared = eos.speed_squared(j, e);
        if !(p.is_finite() && squared.is_finite()) || j < 1.0 && !(denser > p && squared > 0.0) {
            return report(format!(
                "p = {p:e} Pa, denser {denser:e}, c^2 = {squared:e} at J = {j}, e = {e:e}"
            ));
        }
        Ok(())
    })?;
    let kept = <E::Energy<f64> as EnergyColumn<f64>>::KEPT;
    let strategy = (range, 0.0..=energy);
    run_cases(name, 200, strategy, |(j, e)| {
        if !eos.in_range::<f64>(j) {
            return report(format!("the volume ratio {j} is beyond the range"));
        }
        let h = 1e-5;
        let p = eos.pressure(j, e);
        let slope = (eos.pressure(j + h, e - p * h) - eos.pressure(j - h, e + p * h)) / (2.0 * h);
        let expected = -slope * j * j / eos.density();
        let given = eos.speed_squared(j, e);
        // A law may have a kink at J = 1.
        if (j - 1.0).abs() > 2.0 * h && (given - expected).abs() > 1e-6 * (given.abs() + expected.abs()) {
            return report(format!(
                "c^2 = {given:e}, but dp/drho = {expected:e} m^2/s^2 at J = {j}, e = {e:e}"
            ));
        }
        if !kept {
            let fall = (eos.stored_energy(j + h) - eos.stored_energy(j - h)) / (2.0 * h);
            if eos.terms(j).thermal != 0.0 || (fall + p).abs() > 1e-6 * (p.abs() + 1e-3 * bulk) {
                return report(format!("dW/dJ = {fall:e}, but p = {p:e} Pa at J = {j}"));
            }
        }
        let (change, worked) = (-0.01 * j, e);
        let found = balance(eos.terms(j), worked, change);
        let residual = found.pressure - eos.pressure(j, worked - 0.5 * change * found.pressure);
        if residual.abs() > 1e-10 * (p.abs() + bulk) {
            return report(format!("the balance leaves {residual:e} Pa at J = {j}"));
        }
        Ok(())
    })
}

/// State at the end of a path.
struct Walked<M: Constitutive<f64>> {
    state: M::State<f64>,
    stress: Sym3<f64>,
    /// Stress work per reference volume, J/m^3, by the trapezoidal rule.
    work: f64,
    /// Sum of the magnitudes of the stress work.
    effort: f64,
}

// Not inlined: otherwise each property of each law recompiles the law.
#[inline(never)]
fn walk<M: Constitutive<f64>>(
    law: &M,
    path: &[Mat3<f64>],
    steps: usize,
    options: &Options,
) -> Result<Walked<M>, String> {
    let options = with_steps(options, steps);
    let state = law.virgin();
    let mut at = Walked { state, stress: law.stress(&state), work: 0.0, effort: 0.0 };
    for leg in path {
        let increment = *leg * (1.0 / steps as f64);
        let strain = still(&increment, &options).strain();
        for _ in 0..steps {
            let new = step(law, &at.state, &increment, &options)?;
            let power = |stress: &Sym3<f64>, state| law.volume_ratio(state) * stress.dot(&strain);
            let work = 0.5 * (power(&at.stress, &at.state) + power(&new.stress, &new.state));
            at = Walked {
                state: new.state,
                stress: new.stress,
                work: at.work + work,
                effort: at.effort + work.abs(),
            };
        }
    }
    Ok(at)
}

#[inline(never)]
fn step<M: Constitutive<f64>>(
    law: &M,
    old: &M::State<f64>,
    increment: &Mat3<f64>,
    options: &Options,
) -> Result<Update<f64, M::State<f64>>, String> {
    let update = law.update(&still(increment, options), old);
    match first_broken(&update) {
        None => Ok(update),
        Some(broken) => Err(format!("{}: broke down: {}; increment {increment:?}", law.name(), broken.cause)),
    }
}

fn still<L: Lane<Real = f64>>(increment: &Mat3<L>, options: &Options) -> Kinematics<L> {
    let dt = options.duration / options.steps as f64;
    Kinematics { increment: *increment, dt: L::of(dt), length: L::of(options.length) }
}

fn with_steps(options: &Options, steps: usize) -> Options {
    Options { steps, ..*options }
}

#[inline(never)]
fn modulus<M: Constitutive<f64>>(law: &M, state: &M::State<f64>) -> f64 {
    let speed: f64 = law.wave_speed(state);
    law.density() / law.volume_ratio(state) * speed * speed
}

fn largest(stress: &Sym3<f64>) -> f64 {
    stress.0.iter().fold(0.0, |m, x| m.max(x.abs()))
}

fn positions() -> impl Iterator<Item = (usize, usize)> {
    (0..9).map(|k| (k / 3, k % 3))
}

fn fail<M: Constitutive<f64>>(property: &str, law: &M, what: String) -> Verdict {
    Err(format!("{property}, law \"{}\": {what}", law.name()))
}

fn within<M: Constitutive<f64>>(property: &str, law: &M, a: f64, b: f64, tolerance: f64) -> Verdict {
    // NaN fails this comparison.
    if (a - b).abs() <= tolerance { Ok(()) } else { fail(property, law, format!("{a:e} against {b:e}")) }
}

fn same_stress<M: Constitutive<f64>>(
    property: &str,
    law: &M,
    a: &Sym3<f64>,
    b: &Sym3<f64>,
    tolerance: f64,
) -> Verdict {
    for i in 0..6 {
        within(property, law, a.0[i], b.0[i], tolerance)?;
    }
    Ok(())
}

/// Check that all numbers agree within `tolerance`, relative to the number itself plus 1e-6 of the largest number of
/// the state.
fn same_state<M: Constitutive<f64>>(
    property: &str,
    law: &M,
    a: &M::State<f64>,
    b: &M::State<f64>,
    tolerance: f64,
) -> Verdict {
    let (a, b): (Vec<f64>, Vec<f64>) = (flatten(a), flatten(b));
    let top = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for i in 0..a.len() {
        within(property, law, a[i], b[i], tolerance * (b[i].abs() + 1e-6 * top))?;
    }
    Ok(())
}

fn for_all<M: Constitutive<f64>, S: Strategy>(
    property: &str,
    law: &M,
    options: &Options,
    strategy: S,
    holds: impl Fn(S::Value) -> Verdict,
) -> Verdict
where
    S::Value: Debug,
{
    run_cases(&format!("{property} of {}", law.name()), options.cases, strategy, holds)
}

fn run_cases<S: Strategy>(name: &str, cases: u32, strategy: S, holds: impl Fn(S::Value) -> Verdict) -> Verdict
where
    S::Value: Debug,
{
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 100, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    runner
        .run(&strategy, |value| holds(value).map_err(TestCaseError::fail))
        .map_err(|error| format!("{name}: {error}"))
}

/// Number of state variables of a law.
pub fn state_length<M: Constitutive<f64>>(_: &M) -> usize {
    <M::State<f64> as State<f64>>::LEN
}
