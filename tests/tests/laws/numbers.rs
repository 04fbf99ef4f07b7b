//! Vector lanes, tensors and objective rates.

use approx::assert_relative_eq;
use mpm_materials::rate::{rotation, turn};
use mpm_materials::tensor::{Mat3, Sym3};
use mpm_materials::*;

type Four = Wide<f64, 4>;

const VALUES: [f64; 4] = [0.25, 1.0, 2.5, 700.0];

#[test]
fn packs_compute_lane_by_lane() {
    let (a, b) = (Wide(VALUES), Four::of(3.0));
    for i in 0..4 {
        let x = VALUES[i];
        for (pack, one) in [
            (a + b, x + 3.0),
            (a - b, x - 3.0),
            (a * b, x * 3.0),
            (a / b, x / 3.0),
            (-a, -x),
            (a.mul_add(b, b), x * 3.0 + 3.0),
            (a.sqrt(), x.sqrt()),
            (a.ln(), x.ln()),
            ((-a).exp(), (-x).exp()),
            ((-a).abs(), x),
            (a.min(b), x.min(3.0)),
            (a.max(b), x.max(3.0)),
            (a.recip(), 1.0 / x),
            (a.clamp(Four::one(), b), x.clamp(1.0, 3.0)),
            (Four::select(a.lt(b), a, b), if x < 3.0 { x } else { 3.0 }),
        ] {
            assert_eq!(pack.lane(i), one);
        }
        assert_relative_eq!(a.powf(Four::of(0.3)).lane(i), x.powf(0.3), max_relative = 1e-14);
    }
}

#[test]
fn masks_treat_what_is_not_a_number_as_false() {
    let a = Wide([1.0, f64::NAN, f64::INFINITY, -1.0]);
    assert_eq!([0, 1, 2, 3].map(|i| a.is_finite().lane(i)), [true, false, false, true]);
    assert_eq!([0, 1, 2, 3].map(|i| a.gt(Four::zero()).lane(i)), [true, false, true, false]);
    assert!(a.lt(Four::zero()).any() && !a.lt(Four::zero()).all());
    assert!((a.lt(Four::zero()) | !a.lt(Four::zero())).all());
}

#[test]
fn the_first_fault_of_a_lane_stays() {
    let a = Wide([1.0, -1.0, f64::NAN, 1.0]);
    let fault = Fault::<Four>::none()
        .require(a.gt(Four::zero()), Breakdown::InvertedVolume)
        .require(a.is_finite(), Breakdown::NotFinite)
        .or(Fault::none().require(a.gt(Four::of(2.0)), Breakdown::Law));
    let causes = [0, 1, 2, 3].map(|i| fault.cause(i));
    let (inverted, law) = (Some(Breakdown::InvertedVolume), Some(Breakdown::Law));
    assert_eq!(causes, [law, inverted, inverted, law]);
    assert!(fault.any() && !Fault::<Four>::none().any());
}

#[test]
fn tensor_algebra() {
    let s = Sym3([3.0, -1.0, 2.0, 0.5, -0.7, 1.1]);
    let (m, n) = (s.to_mat(), nalgebra::Matrix3::from_fn(|i, j| s.at(i, j)));
    assert_relative_eq!(s.determinant(), n.determinant(), max_relative = 1e-13);
    assert_relative_eq!(m.determinant(), n.determinant(), max_relative = 1e-13);
    assert_relative_eq!(s.dot(&s), n.dot(&n), max_relative = 1e-14);
    assert!(s.deviator().trace().abs() < 1e-15);
    assert_relative_eq!(s.deviator().equivalent(), (1.5 * s.deviator().dot(&s.deviator())).sqrt());
    let [a, b, c] = s.principal();
    assert!(a >= b && b >= c);
    assert_relative_eq!(a + b + c, s.trace(), max_relative = 1e-13);
    assert_relative_eq!(a * b * c, s.determinant(), max_relative = 1e-12);
    let f = Mat3([[1.0, 0.2, -0.1], [0.3, 0.9, 0.4], [0.0, -0.5, 1.2]]);
    assert_eq!(f.times_transpose().to_mat(), f.times(&f.transpose()));
    // Axial vector: W x = w cross x.
    let (w, x) = (f.axial(), [1.0, -2.0, 0.5]);
    let skew = |i: usize, j: usize| 0.5 * (f.0[i][j] - f.0[j][i]);
    let cross = [w[1] * x[2] - w[2] * x[1], w[2] * x[0] - w[0] * x[2], w[0] * x[1] - w[1] * x[0]];
    for i in 0..3 {
        assert_relative_eq!(
            skew(i, 0) * x[0] + skew(i, 1) * x[1] + skew(i, 2) * x[2],
            cross[i],
            epsilon = 1e-15
        );
    }
}

#[test]
fn rotations_are_orthogonal_and_rates_agree_with_them() {
    let w = [0.02, -0.03, 0.01];
    let q = rotation(w);
    let unit = q.times_transpose();
    for i in 0..6 {
        assert_relative_eq!(unit.0[i], if i < 3 { 1.0 } else { 0.0 }, epsilon = 1e-15);
    }
    assert_relative_eq!(q.determinant(), 1.0, epsilon = 1e-15);

    // Increment of pure spin.
    let increment = Mat3([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]]);
    let kinematics = Kinematics { increment, dt: 1.0, length: 1.0 };
    let small = SmallRotation.increments(&kinematics);
    assert_eq!(small.spin, w);
    let stress = Sym3([3.0, -1.0, 2.0, 0.5, -0.7, 1.1]);
    let exact = HughesWinget.rotate(&small, &stress);
    let first_order = SmallRotation.rotate(&small, &stress);
    // First-order rotation: s + W s - s W.
    let spin = increment.times(&stress.to_mat());
    for i in 0..3 {
        for j in 0..3 {
            let expected = stress.at(i, j) + spin.0[i][j] + spin.0[j][i];
            assert_relative_eq!(first_order.at(i, j), expected, epsilon = 1e-15);
            assert!((first_order.at(i, j) - exact.at(i, j)).abs() < 2.0 * 1.4e-3 * 4.0);
        }
    }
    // Invariants are preserved under rotation.
    assert_relative_eq!(exact.trace(), stress.trace(), max_relative = 1e-14);
    assert_relative_eq!(exact.determinant(), stress.determinant(), max_relative = 1e-13);
}

/// Deterministic motion increment X of size about one.
fn direction(n: usize) -> Mat3<f64> {
    let mut x = Mat3::zero();
    for i in 0..3 {
        for j in 0..3 {
            x.0[i][j] = ((7 * n + 3 * i + j) as f64 * 1.7).sin();
        }
    }
    x
}

#[test]
fn strain_and_spin_of_the_middle_are_exact_at_any_size() {
    for n in 0..20 {
        for size in [1e-12, 1e-9, 1e-6, 1e-3, 0.03, 0.3, 0.6] {
            let increment = direction(n) * size;
            let Increments { strain, spin, volume_factor } =
                Kinematics { increment, dt: 1.0, length: 1.0 }.increments();
            let a = strain.to_mat() + cross(spin);
            let whole = (increment + Mat3::identity()).determinant();
            assert_relative_eq!(volume_factor, whole, max_relative = 1e-14, epsilon = 1e-15);
            // Check A (I + X/2) = X within round-off of numbers of the size of A: an ill-conditioned mid-step
            // configuration, det(I + X/2) far below one, makes A large.
            let half = Mat3::identity() + increment * 0.5;
            if half.determinant() < 0.05 {
                continue;
            }
            let back = a.times(&half);
            let largest = a.0.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
            for i in 0..3 {
                for j in 0..3 {
                    let error = (back.0[i][j] - increment.0[i][j]).abs();
                    assert!(error < 32.0 * f64::EPSILON * largest, "{error:e} of {largest:e} at {size:e}");
                }
            }
        }
    }
}

/// Skew matrix of an axial vector.
fn cross([x, y, z]: [f64; 3]) -> Mat3<f64> {
    Mat3([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
}

#[test]
fn a_rotation_has_a_spin_and_no_strain() {
    for angle in [1e-12_f64, 1e-8, 1e-4, 0.01, 0.5, 2.0, 3.0] {
        for axis in [[1.0, 0.0, 0.0], [0.6, 0.0, -0.8], [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0]] {
            let w = axis.map(|n| n * 2.0 * (0.5 * angle).tan());
            let kinematics = Kinematics { increment: turn(w), dt: 1.0, length: 1.0 };
            let Increments { strain, spin, .. } = kinematics.increments();
            // Round-off of the increment, magnified by 1/cos^2 near half a turn.
            let large = 1.0 + w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
            let rounding = 8.0 * f64::EPSILON * (2.0 * (0.5 * angle).tan()) * large;
            for i in 0..6 {
                assert!(strain.0[i].abs() <= rounding, "{:e} at {angle}", strain.0[i]);
            }
            for i in 0..3 {
                assert!((spin[i] - w[i]).abs() <= rounding, "{spin:?} {w:?}");
            }
            // Exact rotation of the motion.
            let stress = Sym3([3.0, -1.0, 2.0, 0.5, -0.7, 1.1]);
            let turned = HughesWinget.rotate(&kinematics.increments(), &stress);
            let expected = (kinematics.increment + Mat3::identity()).congruence(&stress);
            for i in 0..6 {
                assert!((turned.0[i] - expected.0[i]).abs() < 64.0 * f64::EPSILON * large);
            }
        }
    }
}

#[test]
fn a_step_without_a_middle_is_not_a_number() {
    // Half a turn; a stretch through zero and back along two axes.
    for increment in [
        Mat3([[-2.0, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0; 3]]),
        Mat3([[-3.0, 0.0, 0.0], [0.0, -1.5, 0.0], [0.0; 3]]),
    ] {
        let kinematics: Kinematics<f64> = Kinematics { increment, dt: 1.0, length: 1.0 };
        assert!(kinematics.volume_factor() > 0.0 && f64::is_nan(kinematics.strain().trace()));
        let law = LinearElastic::new(7800.0, Moduli::young_poisson(200e9, 0.3).unwrap()).unwrap();
        let update = law.update(&kinematics, &law.virgin());
        assert_eq!(update.fault.cause(0), Some(Breakdown::NotFinite));
    }
}

#[test]
fn a_spinning_solid_stays_as_it_is() {
    // A hundred turns in steps of one degree. With first-order rotation each step has a strain of 1.5e-4, and the steel
    // yields in the first turn.
    let law = Solid::new(J2::linear(80e9, 500e6, 1e9).unwrap(), MieGruneisen::steel_4340())
        .with_bulk_viscosity(0.06, 1.5)
        .unwrap();
    let w = [0.0, 0.0, 2.0 * 0.5_f64.to_radians().tan()];
    let kinematics = Kinematics { increment: turn(w), dt: 1e-8, length: 1e-3 };
    fn spun<C: Constitutive<f64>>(law: &C, kinematics: &Kinematics<f64>) -> C::State<f64> {
        let mut state = law.virgin();
        for _ in 0..36_000 {
            let update = law.update(kinematics, &state);
            assert!(!update.fault.any());
            state = update.state;
        }
        state
    }
    let end = spun(&law, &kinematics);
    // Tolerance: round-off of the increment, 4e-18, and of its determinant, 1e-16, per step.
    assert!(end.stress.0.iter().all(|s| s.abs() < 36_000.0 * 2e-16 * 160e9), "{:?}", end.stress);
    assert!(end.strength.plastic_strain == 0.0 && end.energy.abs() < 1e-3, "{end:?}");
    let first_order = spun(&law.with_rate(SmallRotation), &kinematics);
    assert!(first_order.strength.plastic_strain > 1.0, "{first_order:?}");
}

#[test]
fn volume_factor_is_exact_for_the_increment() {
    let h = Mat3([[0.1, 0.2, -0.1], [0.3, -0.2, 0.4], [0.05, -0.3, 0.2]]);
    let kinematics = Kinematics { increment: h, dt: 1.0, length: 1.0 };
    let f = nalgebra::Matrix3::from_fn(|i, j| h.0[i][j] + if i == j { 1.0 } else { 0.0 });
    assert_relative_eq!(kinematics.volume_factor(), f.determinant(), max_relative = 1e-14);
}

#[test]
fn states_are_lists_with_names() {
    let law = Solid::new(JohnsonCook::<f64>::copper(), MieGruneisen::copper());
    let one = law.virgin();
    let pack = spread::<f64, Four, _, SolidState<Four, strength::Hardened<Four, Four>, Nothing>>(&one);
    assert_eq!(
        lane_of::<f64, Four, SolidState<f64, strength::Hardened<f64, f64>, Nothing>, _>(&pack, 3),
        one
    );
    let list = point::flatten(&one);
    assert_eq!(point::unflatten(&list), Ok(one));
    assert_eq!(
        point::unflatten::<f64, SolidState<f64, strength::Hardened<f64, f64>, Nothing>>(&list[1..]),
        Err(9)
    );
}

/// Work of a closed strain cycle of amplitude `strain` on a body that rotates by `turn` rad per step, over the largest stored energy.
fn work_of_a_cycle<C: Constitutive<f64>>(law: &C, strain: f64, turn: f64) -> f64 {
    const STEPS: usize = 2000;
    let gradient = |n: usize| {
        let phase = std::f64::consts::TAU * n as f64 / STEPS as f64;
        let shear = 0.5 * (1.0 - phase.cos());
        let stretch = nalgebra::Matrix3::new(
            1.0 + strain * phase.sin(),
            strain * shear,
            0.0,
            strain * shear,
            1.0 - 0.6 * strain * (2.0 * phase).sin(),
            0.0,
            0.0,
            0.0,
            1.0,
        );
        nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), turn * n as f64) * stretch
    };
    // First Piola-Kirchhoff stress, work-conjugate to the deformation gradient.
    let nominal = |state: &C::State<f64>, f: &nalgebra::Matrix3<f64>| {
        let [xx, yy, zz, yz, xz, xy] = law.stress(state).0;
        let stress = nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        stress * f.try_inverse().expect("a gradient").transpose() * f.determinant()
    };
    let (mut state, mut old) = (law.virgin(), gradient(0));
    let (mut work, mut most) = (0.0, 0.0_f64);
    for n in 1..=STEPS {
        let new = gradient(n);
        let x = new * old.try_inverse().expect("a gradient") - nalgebra::Matrix3::identity();
        let increment = Mat3(std::array::from_fn(|i| std::array::from_fn(|j| x[(i, j)])));
        let before = nominal(&state, &old);
        let update = law.update(&Kinematics { increment, dt: 1e-6, length: 1e-3 }, &state);
        assert!(!update.fault.any());
        state = update.state;
        work += 0.5 * (before + nominal(&state, &new)).dot(&(new - old));
        most = most.max(work);
        old = new;
    }
    work / most
}

#[test]
fn a_cycle_of_elastic_strain_on_a_body_that_turns_gives_its_work_back() {
    let moduli = Moduli::young_poisson(200e9, 0.3).expect("moduli");
    let elastic = LinearElastic::new(7800.0, moduli).expect("a law");
    let strong = Solid::new(J2::linear(80e9, 50e9, 1e9).expect("a law"), MieGruneisen::steel_4340());
    for (strain, turn) in [(1e-4, 1e-3), (1e-3, 1e-3), (1e-3, 1e-2), (1e-2, 1e-3)] {
        let lost = [work_of_a_cycle(&elastic, strain, turn), work_of_a_cycle(&strong, strain, turn)];
        println!("{strain:e} {turn:e}: {lost:?}");
        // Second order in the rotation of a step. A rate form with constant moduli is conservative to the square of the strain; a
        // deviatoric rate form without the volume is conservative to the strain.
        let turned = 1e-6 + 0.3 * turn * turn;
        assert!(lost[0].abs() < turned + 0.3 * strain * strain, "{strain:e} {turn:e}: {lost:?}");
        assert!(lost[1].abs() < turned + 3.0 * strain, "{strain:e} {turn:e}: {lost:?}");
    }
    let first_order = work_of_a_cycle(&elastic.with_rate(SmallRotation), 1e-3, 1e-2);
    assert!(first_order.abs() > 0.01, "{first_order:e}");
}
