//! Deactivated bodies with contact.

use crate::common::{H, WAVE, ball, build, cuboid, particles, plane, rubber, space};
use mpm_contact::{
    Adhesion, Approach, ContactDetector, Coulomb, Gradients, Pairs, Penalty, Regression, SurfaceDistance,
};
use mpm_core::geometry::Seeds;
use mpm_core::{
    Apic, BlockGrid, Boundary, CpGimp, IntoKernels, Method, Mpm, PlaneStrain, QuadraticBSpline, Rigid, Side,
    Team, Twist, Usf, Usl,
};
use mpm_core::{GridContact, SceneError};

/// Check that a ball that flies to a plate on a plane of symmetry has bitwise identical results with and without deactivation.
fn same<const D: usize>(
    method: impl IntoKernels<f64, D> + Clone,
    detector: &(impl ContactDetector<f64, D> + Clone),
    laws: &Pairs<f64>,
) {
    let (mut centre, mut low, mut high, mut velocity) = ([0.0; D], [0.0; D], [6.0 * H; D], [0.0; D]);
    (centre[0], low[0], high[0]) = (-20.0 * H, 0.0, 4.0 * H);
    (velocity[0], velocity[1]) = (0.4 * WAVE, 0.0);
    centre[1] = 2.0 * H + 0.3 * H;
    let bodies: Vec<(Seeds<D>, [f64; D])> =
        vec![(cuboid(low, high), [0.0; D]), (ball(centre, 2.0 * H), velocity)];
    let scene = || {
        let mut mpm = build(method.clone(), GridContact::new(detector.clone(), laws.clone()), &bodies);
        mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("plane");
        mpm
    };
    for threads in [1, 2] {
        let (mut plain, mut resting) = (scene(), scene());
        resting.deactivate(&["body 0"]).expect("rest");
        resting.set_team(Team::new(threads).expect("threads"));
        let (mut rested, mut met) = (0, 0);
        // Run until some time after the first contact.
        while met < 40 {
            assert!(plain.steps() < 1000, "no hit");
            rested += u32::from(resting.bodies()[0].is_deactivated());
            assert_eq!(plain.step().expect("step"), resting.step().expect("step"));
            met += u32::from(met > 0 || !resting.contact_points().is_empty());
            assert_eq!(plain.contacts(), resting.contacts());
            assert_eq!(plain.contact_points(), resting.contact_points());
            assert_eq!(format!("{:?}", plain.exchange()), format!("{:?}", resting.exchange()));
        }
        assert!(particles(&plain) == particles(&resting), "{}, {threads} threads", plain.facts().description);
        assert!(rested > 20, "it rested for {rested} steps");
    }
}

#[test]
fn no_bit_changes() {
    let coulomb = Pairs::new(Coulomb::new(0.3).expect("law"));
    let distance = SurfaceDistance::default();
    same(plane(), &distance, &coulomb);
    same(space(), &Regression, &coulomb);
    same(Method::new(CpGimp, mpm_core::Flip, Usf, PlaneStrain).compiled(), &distance, &coulomb);
    let affine = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    same(affine, &Approach::<Gradients>::default(), &coulomb);
    let sticky = Pairs::new(Adhesion::new(1e4, 1e4, 0.2).expect("law"));
    same(plane(), &distance, &sticky);
    let penalty = Pairs::new(Penalty::new(300.0, 0.8, 0.3).expect("law"));
    same(plane(), &distance, &penalty);
}

fn scene() -> Mpm<2> {
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).expect("law")));
    Mpm::with_contact(plane(), BlockGrid::new(crate::common::lattice()), contact)
}

/// A rigid punch reactivates a body that it approaches, and cannot be deactivated itself.
#[test]
fn rigid_bodies_wake_others() {
    let build = || {
        let mut mpm = scene();
        mpm.add("block", rubber(), &cuboid([0.0; 2], [4.0 * H, 4.0 * H]), |_| [0.0; 2]).expect("block");
        let punch = Rigid::prescribed(2000.0, |_| Twist::along([0.0, -0.3 * WAVE])).expect("punch");
        let seeds = cuboid([H, 20.0 * H], [3.0 * H, 23.0 * H]);
        mpm.add_rigid("punch", &punch, &seeds).expect("punch");
        mpm
    };
    let (mut plain, mut resting) = (build(), build());
    resting.deactivate(&["block"]).expect("rest");
    assert!(matches!(resting.deactivate(&["punch"]), Err(SceneError::Disturbed { .. })));
    assert!(resting.bodies()[0].is_deactivated());
    while plain.contact_points().is_empty() {
        assert!(plain.steps() < 1000, "no touch");
        assert_eq!(plain.step(), resting.step());
    }
    for _ in 0..20 {
        assert_eq!(plain.step(), resting.step());
    }
    assert!(!resting.bodies()[0].is_deactivated() && particles(&plain) == particles(&resting));
}

/// Contact may act between bodies at rest: two that share blocks stay active.
#[test]
fn neighbours_stay_awake() {
    let mut mpm = scene();
    mpm.add("front", rubber(), &cuboid([0.0; 2], [4.0 * H, 4.0 * H]), |_| [0.0; 2]).expect("front");
    mpm.add("back", rubber(), &cuboid([4.0 * H, 0.0], [8.0 * H, 4.0 * H]), |_| [0.0; 2]).expect("back");
    mpm.add("far", rubber(), &cuboid([40.0 * H, 0.0], [44.0 * H, 4.0 * H]), |_| [0.0; 2]).expect("far");
    mpm.deactivate(&["front", "back", "far"]).expect("rest");
    assert_eq!([0, 1, 2].map(|n| mpm.bodies()[n].is_deactivated()), [false, false, true]);
    mpm.step().expect("step");
}
