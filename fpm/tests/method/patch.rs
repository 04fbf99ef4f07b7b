//! Patch test: a uniform strain causes a uniform stress and no forces.

use std::sync::Arc;

use fpm::{Cells, Composition, Fpm, Method};
use impactite_scene::{FullSpace, PlaneStrain, Solver, TimeControl, Watch};
use mpm_materials::IntoMaterial;

use crate::common::{STEEL, linear, random, rubber};

const DT: f64 = 1e-6;

/// Return the body after a step in which every point moved by G X; tractions of this stress then act on its sides.
fn strained<const D: usize, M: Composition<D>>(
    method: M,
    law: impl IntoMaterial<f64>,
    cells: &Cells<D>,
    gradient: [[f64; D]; D],
    stress: [[f64; D]; D],
) -> Fpm<D, M> {
    let move_by = |x: [f64; D]| -> [f64; D] {
        std::array::from_fn(|a| (0..D).map(|c| gradient[a][c] * x[c]).sum::<f64>() / DT)
    };
    let mut body = Fpm::new(method, law, cells, move_by).unwrap();
    body.set_watch(Watch::off());
    body.set_time_control(TimeControl::Fixed(DT)).unwrap();
    for axis in 0..D {
        for side in [-1.0, 1.0] {
            let traction = std::array::from_fn(|a| side * stress[a][axis]);
            let later = move |t: f64| if t > 0.5 * DT { traction } else { [0.0; D] };
            body.load_faces(|f| f.normal[axis] * side > 0.5, Arc::new(later)).unwrap();
        }
    }
    body.step_at_most(f64::INFINITY).unwrap();
    body
}

fn passes<const D: usize, M: Composition<D>>(
    method: M,
    law: impl IntoMaterial<f64> + Copy,
    density: f64,
    gradient: [[f64; D]; D],
    h: f64,
) {
    let cells = random([0.3; D], [1.3; D], h, 7);
    let body = strained(method, law, &cells, gradient, [[0.0; D]; D]);
    let stress = body.nominal_stresses()[0];
    let scale = stress.iter().flatten().fold(0.0f64, |m, p| m.max(p.abs()));
    for p in body.nominal_stresses() {
        let off =
            p.iter().flatten().zip(stress.iter().flatten()).map(|(p, q)| (p - q).abs()).fold(0.0, f64::max);
        assert!(off < 1e-11 * scale, "{off:e} of {scale:e}");
    }
    let body = strained(method, law, &cells, gradient, stress);
    // Relative to the acceleration by a face without a neighbour.
    let free = scale / (density * h);
    let most = body.accelerations().iter().flatten().fold(0.0f64, |m, a| m.max(a.abs()));
    assert!(most < 1e-10 * free, "{}: {most:e} of {free:e}", body.describe());
    assert!(body.penalty_energy() < 1e-20 * body.internal_energy().abs());
}

#[test]
fn small_strains_pass_to_rounding() {
    let plane = [[1e-4, 3e-5], [-2e-5, -5e-5]];
    passes(Method::printed(PlaneStrain), linear(0.3), STEEL, plane, 0.1);
    passes(Method::symmetric(PlaneStrain), linear(0.3), STEEL, plane, 0.1);
    let space = [[1e-4, 3e-5, 2e-5], [-2e-5, -5e-5, 1e-5], [4e-5, 0.0, 7e-5]];
    passes(Method::printed(FullSpace), linear(0.3), STEEL, space, 0.2);
    passes(Method::symmetric(FullSpace), linear(0.3), STEEL, space, 0.2);
}

#[test]
fn large_strains_pass_to_rounding() {
    let plane = [[0.3, 0.4], [-0.2, -0.15]];
    passes(Method::printed(PlaneStrain), rubber(), 1000.0, plane, 0.1);
    passes(Method::symmetric(PlaneStrain), rubber(), 1000.0, plane, 0.1);
    passes(
        Method::symmetric(FullSpace),
        rubber(),
        1000.0,
        [[0.2, 0.3, 0.0], [-0.3, 0.1, 0.1], [0.0, 0.2, -0.1]],
        0.2,
    );
}

#[test]
fn what_turns_as_a_rigid_body_is_not_strained() {
    let cells = random([0.0; 2], [1.0; 2], 0.1, 9);
    let (s, c) = 1.1f64.sin_cos();
    let turn = [[c - 1.0, -s], [s, c - 1.0]];
    let body = strained(Method::symmetric(PlaneStrain), rubber(), &cells, turn, [[0.0; 2]; 2]);
    let most = body.nominal_stresses().iter().flatten().flatten().fold(0.0f64, |m, p| m.max(p.abs()));
    assert!(most < 1e-13 * 1e6, "{most:e}");
}
