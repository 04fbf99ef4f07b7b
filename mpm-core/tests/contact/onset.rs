//! Onset of contact: bodies that approach face to face must be in contact when their surfaces touch.

use crate::common::{H, WAVE, build, cuboid};
use mpm_contact::{Approach, ContactDetector, Frictionless, Gradients, Pairs, Regression, SurfaceDistance};
use mpm_core::geometry::Seeds;
use mpm_core::{
    CpGimp, Flip, GridContact, IntoKernels, Linear, Method, Musl, PlaneStrain, QuadraticBSpline, TimeControl,
};

/// Initial distance of the surfaces, in cells.
const APART: f64 = 3.0;

/// Create a disc of particles in circles, so that the outermost ones touch the surface.
fn disc(centre: [f64; 2], cells: u32) -> Seeds<2> {
    let mut seeds = crate::common::ball([0.0, 0.0], H);
    (seeds.positions, seeds.volumes) = (Vec::new(), Vec::new());
    for ring in 0..2 * cells {
        let r = (f64::from(ring) + 0.5) * 0.5 * H;
        let count = (std::f64::consts::TAU * r / (0.5 * H)).round();
        for n in 0..count as usize {
            let angle = std::f64::consts::TAU * (n as f64 + 0.5) / count;
            seeds.positions.push([centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]);
            seeds.volumes.push(0.25 * H * H);
        }
    }
    seeds
}

/// Return names, bodies and direction of the second body: discs with a line of centres at 45 degrees, and blocks.
fn scenes() -> Vec<(String, [Seeds<2>; 2], [f64; 2])> {
    let mut scenes = Vec::new();
    for (name, cells) in [("small discs", 8), ("large discs", 16)] {
        for (turned, angle) in [("", 0.5), (", turned", 0.25)] {
            let (y, x) = (angle * std::f64::consts::PI).sin_cos();
            let far = (2.0 * f64::from(cells) + APART) * H;
            scenes.push((
                format!("{name}{turned}"),
                [disc([0.0; 2], cells), disc([far * x, far * y], cells)],
                [x, y],
            ));
        }
    }
    let high = cuboid([0.0, 0.4 + APART * H], [0.4, 0.8 + APART * H]);
    scenes.push(("blocks".to_string(), [cuboid([0.0, 0.0], [0.4, 0.4]), high], [0.0, 1.0]));
    scenes
}

fn onset(
    method: impl IntoKernels<f64, 2>,
    detector: impl ContactDetector<f64, 2>,
    bodies: &[Seeds<2>; 2],
    to: [f64; 2],
) -> f64 {
    let scene = vec![(bodies[0].clone(), to), (bodies[1].clone(), to.map(|c| -c))];
    let mut mpm = build(method, GridContact::new(detector, Pairs::new(Frictionless)), &scene);
    mpm.set_time_control(TimeControl::Fixed(0.1 * H / WAVE)).expect("control");
    let mut before = 0.0;
    while mpm.contacts().is_empty() {
        before = mpm.time();
        mpm.step().expect("step");
        assert!(mpm.time() < 0.2, "never met");
    }
    APART - 2.0 * before / H
}

/// Check that the gaps at onset of a detector, in all scenes and with three shape functions, are at most `most` cells.
fn meets<S: ContactDetector<f64, 2>>(name: &str, most: f64, detector: impl Fn() -> S) {
    for (scene, bodies, to) in scenes() {
        let gaps = [
            onset(Method::new(Linear, Flip, Musl, PlaneStrain), detector(), &bodies, to),
            onset(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain), detector(), &bodies, to),
            onset(Method::new(CpGimp, Flip, Musl, PlaneStrain), detector(), &bodies, to),
        ];
        assert!(gaps.iter().all(|gap| gap.abs() <= most), "{name}, {scene}: gaps at onset {gaps:?} cells");
    }
}

/// The regression plane between the particles finds the gap within a tenth of a cell, for any shape function and
/// position on the grid.
#[test]
fn regression_finds_where_surfaces_meet() {
    meets("regression", 0.1, || Regression);
}

#[test]
fn so_does_its_plane_with_the_local_distance() {
    meets("regression, local", 0.1, || SurfaceDistance::new(Regression, 0.0).expect("detector").locally());
}

/// Oblique gradients detect contact a little early (T6: within a quarter of a cell).
#[test]
fn the_local_distance_along_gradients_is_within_a_quarter() {
    meets("gradients, local", 0.25, || SurfaceDistance::default().locally());
}

/// Without the distance, contact starts when bodies share a node.
#[test]
fn approach_alone_is_early() {
    for (scene, bodies, to) in scenes() {
        let method = Method::new(CpGimp, Flip, Musl, PlaneStrain);
        let gap = onset(method, Approach::<Gradients>::default(), &bodies, to);
        assert!(gap > 0.9, "{scene}: {gap} cells");
    }
}
