//! Half a scene at a plane of symmetry is equivalent to half of the whole scene, contact included.

use crate::common::{H, WAVE, ball, build, particles, plane};
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::geometry::Seeds;
use mpm_core::{
    Boundary, Flip, GridContact, IntoKernels, Method, Musl, PlaneStrain, PointView, QuadraticBSpline, Side,
    TimeControl,
};

/// Run two discs on the line y = 0.2, above it or whole; the second one is faster along x.
fn run(method: impl IntoKernels<f64, 2>, half: bool) -> Vec<Vec<PointView>> {
    let above = |seeds: Seeds<2>| {
        let keep: Vec<bool> = seeds.positions.iter().map(|x| !half || x[1] > 0.2).collect();
        let of = |n: &usize| keep[*n];
        Seeds {
            positions: (0..keep.len()).filter(of).map(|n| seeds.positions[n]).collect(),
            volumes: (0..keep.len()).filter(of).map(|n| seeds.volumes[n]).collect(),
            ..seeds
        }
    };
    let scene = vec![
        (above(ball([0.2, 0.2], 0.18)), [0.1 * WAVE, 0.0]),
        (above(ball([0.6, 0.2], 0.18)), [-0.2 * WAVE, 0.0]),
    ];
    let laws = Pairs::new(Coulomb::new(0.3).expect("law"));
    let mut mpm = build(method, GridContact::new(SurfaceDistance::default(), laws), &scene);
    mpm.set_time_control(TimeControl::Fixed(0.2 * H / WAVE)).expect("control");
    if half {
        mpm.bound(Boundary::Symmetry { axis: 1, at: 0.2, side: Side::Above }).expect("plane");
    }
    for _ in 0..80 {
        mpm.step().expect("step");
    }
    assert!(mpm.contacts()[0].taken > 0.0, "no contact");
    particles(&mpm)
}

fn half_is_whole(method: impl IntoKernels<f64, 2> + Clone) {
    let (half, whole) = (run(method.clone(), true), run(method, false));
    for (half, whole) in half.iter().zip(&whole) {
        // Seeds of the upper half keep their order.
        let whole: Vec<&PointView> = whole.iter().filter(|p| p.position[1] > 0.2).collect();
        assert_eq!(half.len(), whole.len());
        for (p, q) in half.iter().zip(whole) {
            for d in 0..2 {
                // Round-off of 80 steps, amplified where surfaces are detected by differences.
                assert!(
                    (p.position[d] - q.position[d]).abs() < 1e-9 * H,
                    "{:?} {:?}",
                    p.position,
                    q.position
                );
            }
        }
    }
}

#[test]
fn half_is_whole_with_the_hat() {
    half_is_whole(plane());
}

#[test]
fn half_is_whole_with_a_wide_stencil() {
    half_is_whole(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain));
}
