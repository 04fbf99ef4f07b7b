//! Plate under end tension: one-dimensional waves (case 2.1 of the method's paper) against the exact solution.

use std::f64::consts::PI;
use std::sync::Arc;

use fpm::{Composition, Fpm, Method};
use impactite_scene::{PlaneStrain, Solver};
use mpm_materials::{LinearElastic, Moduli};

use crate::common::lattice;

const LENGTH: f64 = 4.0;
const YOUNG: f64 = 8e4;
const DENSITY: f64 = 1.0;
/// End tension, Pa, low enough for small strains.
const PULL: f64 = 1e-3;
/// Duration of the half sine, s: three quarters of the travel time of a wave there and back.
const DURATION: f64 = 0.0212;

fn speed() -> f64 {
    (YOUNG / DENSITY).sqrt()
}

/// End tension over time.
#[derive(Clone, Copy, Debug)]
enum Pull {
    /// Half sine: its rate jumps at the start and the end, and errors fall with the power 5/3 of the spacing at best.
    HalfSine,
    /// Sine squared: smooth.
    Squared,
}

impl Pull {
    /// Return the tension at a time, Pa.
    fn at(self, t: f64) -> f64 {
        let sine = if (0.0..DURATION).contains(&t) { (PI * t / DURATION).sin() } else { 0.0 };
        PULL * match self {
            Pull::HalfSine => sine,
            Pull::Squared => sine * sine,
        }
    }
    /// Return the time integral of the tension, Pa s.
    fn sum(self, t: f64) -> f64 {
        let t = t.clamp(0.0, DURATION);
        PULL * match self {
            Pull::HalfSine => DURATION / PI * (1.0 - (PI * t / DURATION).cos()),
            Pull::Squared => 0.5 * t - 0.25 * DURATION / PI * (2.0 * PI * t / DURATION).sin(),
        }
    }
}

/// Return the sum over images, with `sign` between the two waves of each.
fn images(x: f64, t: f64, sign: f64, of: impl Fn(f64) -> f64) -> f64 {
    let c = speed();
    (0..)
        .map(|n| (f64::from(n), (2.0 * f64::from(n) + 1.0) * LENGTH))
        .take_while(|(_, far)| far - LENGTH <= c * t)
        .map(|(n, far)| {
            let both = of(t - (far - x) / c) + sign * of(t - (far + x) / c);
            if n % 2.0 == 0.0 { both } else { -both }
        })
        .sum()
}

struct Run {
    /// Relative root mean square errors of displacement and stress.
    displacement: f64,
    stress: f64,
    /// Relative errors of the highest displacements at end and middle, and of the highest stresses at middle and clamp.
    peaks: [f64; 4],
    energy: f64,
}

fn run<M: Composition<2>>(method: M, pull: Pull, along: usize) -> Run {
    let (force, pulled) = (move |t: f64| pull.at(t), move |t: f64| pull.sum(t));
    let h = LENGTH / along as f64;
    let cells = lattice([0.0; 2], [along, 3], h);
    let law = LinearElastic::new(DENSITY, Moduli::young_poisson(YOUNG, 0.0).unwrap()).unwrap();
    let mut plate = Fpm::new(method, law, &cells, |_| [0.0; 2]).unwrap();
    plate.hold_faces(|f| f.normal[0] < -0.5, Arc::new(|_| [Some(0.0), None])).unwrap();
    plate.load_faces(|f| f.normal[0] > 0.5, Arc::new(move |t| [force(t), 0.0])).unwrap();
    let (mut wrong, mut all) = ([0.0; 2], [0.0; 2]);
    let (mut found, mut exact) = ([0.0f64; 4], [0.0f64; 4]);
    let near = |x: f64| {
        let off = |i: &usize| (plate.reference()[*i][0] - x).abs() + 1e-3 * plate.reference()[*i][1];
        (0..plate.reference().len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
    };
    let (end, middle, clamp) = (near(LENGTH), near(0.5 * LENGTH), near(0.0));
    while plate.time() < 0.12 {
        plate.step_towards(0.12).unwrap();
        let t = plate.time();
        for (i, x) in plate.reference().iter().enumerate() {
            let u = images(x[0], t, -1.0, pulled) / (DENSITY * speed());
            let s = images(x[0], t, 1.0, force);
            wrong[0] += (plate.displacements()[i][0] - u).powi(2);
            wrong[1] += (plate.nominal_stresses()[i][0][0] - s).powi(2);
            all[0] += u * u;
            all[1] += s * s;
        }
        let place = |i: usize| plate.reference()[i][0];
        let now = [
            plate.displacement_at(end, [LENGTH, 0.5 * h])[0],
            plate.displacements()[middle][0],
            plate.nominal_stresses()[middle][0][0],
            plate.nominal_stresses()[clamp][0][0],
        ];
        let there = [
            images(LENGTH, t, -1.0, pulled) / (DENSITY * speed()),
            images(place(middle), t, -1.0, pulled) / (DENSITY * speed()),
            images(place(middle), t, 1.0, force),
            images(place(clamp), t, 1.0, force),
        ];
        for k in 0..4 {
            (found[k], exact[k]) = (found[k].max(now[k]), exact[k].max(there[k]));
        }
    }
    Run {
        displacement: (wrong[0] / all[0]).sqrt(),
        stress: (wrong[1] / all[1]).sqrt(),
        peaks: std::array::from_fn(|k| found[k] / exact[k] - 1.0),
        energy: plate.account().energy_error(),
    }
}

/// Convergence orders of displacement from 40 to 80 and 160 cells along the plate.
fn orders<M: Composition<2>>(method: M, pull: Pull) -> [f64; 2] {
    let runs = [40, 80, 160].map(|along| run(method, pull, along));
    for run in &runs {
        println!(
            "{}, {pull:?}: u {:.3e}, s {:.3e}, peaks {:?}, energy {:.1e}",
            method.describe(),
            run.displacement,
            run.stress,
            run.peaks,
            run.energy
        );
        assert!(run.energy.abs() < 1e-3, "{:e}", run.energy);
    }
    assert!(runs[0].displacement < 5e-3 && runs[2].displacement < 5e-4);
    let peaks = &runs[0].peaks;
    assert!(
        peaks[..2].iter().all(|p| p.abs() < 0.015) && peaks[2..].iter().all(|p| p.abs() < 0.035),
        "{peaks:?}"
    );
    let order = |a: &Run, b: &Run| (a.displacement / b.displacement).log2();
    [order(&runs[0], &runs[1]), order(&runs[1], &runs[2])]
}

/// With the incomplete flux phase errors of both signs nearly cancel: the remaining error is small and falls unevenly.
#[test]
fn waves_converge_with_the_printed_flux() {
    let half = orders(Method::printed(PlaneStrain), Pull::HalfSine);
    assert!(half.iter().all(|order| *order > 1.35), "{half:?}");
    let smooth = orders(Method::printed(PlaneStrain), Pull::Squared);
    assert!(smooth[1] > 1.7, "{smooth:?}");
}

#[test]
fn waves_converge_with_the_symmetric_flux() {
    let half = orders(Method::symmetric(PlaneStrain), Pull::HalfSine);
    assert!(half.iter().all(|order| *order > 1.65), "{half:?}");
    let smooth = orders(Method::symmetric(PlaneStrain), Pull::Squared);
    assert!(smooth.iter().all(|order| *order > 1.95), "{smooth:?}");
}
