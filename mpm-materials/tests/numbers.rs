//! Lanes, tensors and objective rates.

use approx::assert_relative_eq;
use mpm_materials::rate::rotation;
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
    // The axial vector: W x = w cross x.
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

    // An increment that is a spin alone.
    let increment = Mat3([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]]);
    let kinematics = Kinematics { increment, dt: 1.0, length: 1.0 };
    assert_eq!(kinematics.spin(), w);
    let stress = Sym3([3.0, -1.0, 2.0, 0.5, -0.7, 1.1]);
    let exact = HughesWinget.rotate(&kinematics, &stress);
    let first_order = Jaumann.rotate(&kinematics, &stress);
    // Jaumann, spelt out: s + W s - s W.
    let spin = increment.times(&stress.to_mat());
    for i in 0..3 {
        for j in 0..3 {
            let expected = stress.at(i, j) + spin.0[i][j] + spin.0[j][i];
            assert_relative_eq!(first_order.at(i, j), expected, epsilon = 1e-15);
            assert!((first_order.at(i, j) - exact.at(i, j)).abs() < 2.0 * 1.4e-3 * 4.0);
        }
    }
    // A rotation keeps the invariants.
    assert_relative_eq!(exact.trace(), stress.trace(), max_relative = 1e-14);
    assert_relative_eq!(exact.determinant(), stress.determinant(), max_relative = 1e-13);
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
