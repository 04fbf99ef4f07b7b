//! Contact in a run that is interrupted and resumed.

use crate::common::{H, WAVE, ball, build, cuboid, particles, plane, three};
use mpm_contact::{Coulomb, Frictionless, Pairs, Regression, SlipWeakening, SurfaceDistance};
use mpm_core::{Apic, GridContact, Usl};
use mpm_core::{BlockGrid, Method, Mpm, PlaneStrain, QuadraticBSpline, Rigid, Team, TimeControl, Twist};

/// Return all observable values of a run, bit for bit.
fn told(mpm: &Mpm<2>) -> String {
    let rigid: Vec<_> = mpm.bodies().iter().filter_map(|b| b.rigid()).collect();
    let rigid: Vec<_> =
        rigid.iter().map(|r| (r.centre(), r.rotation(), r.angular_momentum(), r.force())).collect();
    format!(
        "{:?} {:?} {:?} {:?} {:?} {rigid:?} {:?}",
        mpm.time(),
        mpm.totals(),
        mpm.exchange(),
        mpm.contacts(),
        mpm.contact_points(),
        particles(mpm)
    )
}

fn continues(name: &str, scene: impl Fn() -> Mpm<2>, steps: [usize; 2]) {
    let file = std::env::temp_dir().join(format!("impactite-{}-{name}", std::process::id()));
    let advance = |mpm: &mut Mpm<2>, steps| {
        for _ in 0..steps {
            mpm.step().expect("step");
        }
    };
    let mut whole = scene();
    advance(&mut whole, steps[0]);
    assert!(!whole.contact_points().is_empty(), "{name}: nothing touches yet");
    whole.save(&file).expect("checkpoint");
    let mut resumed = scene().resumed(&file).expect("scene");
    std::fs::remove_file(&file).expect("file");
    assert!(told(&whole) == told(&resumed), "{name}: not as it was saved");
    resumed.set_team(Team::new(2).expect("threads"));
    advance(&mut whole, steps[1]);
    advance(&mut resumed, steps[1]);
    assert!(told(&whole) == told(&resumed), "{name}: resumed it goes elsewhere");
}

/// Three discs that collide at once: state of pairs, and data kept from step to step, are part of the checkpoint.
#[test]
fn deformable_bodies() {
    let laws = || Pairs::new(Coulomb::new(0.3).expect("law"));
    let scene = || {
        let mut mpm =
            build(plane(), GridContact::new(SurfaceDistance::default(), laws()), &three(0.05 * WAVE));
        mpm.set_time_control(TimeControl::Fixed(0.2 * H / WAVE)).expect("control");
        mpm
    };
    continues("discs", scene, [60, 60]);
    let regression = || build(plane(), GridContact::new(Regression, laws()), &three(0.05 * WAVE));
    continues("regression", regression, [35, 40]);
    // State variables of contact laws.
    let weakening = || Pairs::new(SlipWeakening::new(0.5, 0.1, 0.002).expect("law")).with(0, 1, Frictionless);
    let scene =
        || build(plane(), GridContact::new(SurfaceDistance::default(), weakening()), &three(0.05 * WAVE));
    continues("weakening", scene, [60, 60]);
}

/// Four discs that leave common blocks: a checkpoint can be read at any step.
#[test]
fn at_every_step() {
    let file = std::env::temp_dir().join(format!("impactite-{}-crowd", std::process::id()));
    let mut scene = three(0.3 * WAVE);
    scene.push((ball([0.5, 0.5], 0.04), [0.2 * WAVE, 0.1 * WAVE]));
    let laws = || Pairs::new(Frictionless).with(0, 1, SlipWeakening::new(0.5, 0.1, 0.01).expect("law"));
    let build = || build(plane(), GridContact::new(SurfaceDistance::default(), laws()), &scene);
    let mut mpm = build();
    for _ in 0..90 {
        mpm.step().expect("step");
        mpm.save(&file).expect("checkpoint");
        let resumed = build().resumed(&file).expect("scene");
        assert!(told(&mpm) == told(&resumed), "step {}", mpm.steps());
    }
    std::fs::remove_file(&file).expect("file");
}

/// A free rigid disc that rolls between a shaken floor and a rubber block.
#[test]
fn rigid_bodies() {
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let coulomb = || Pairs::new(Coulomb::new(0.4).expect("law"));
    let weakening = || Pairs::new(SlipWeakening::new(0.4, 0.1, 0.01).expect("law"));
    let scene = |laws: &dyn Fn() -> Pairs<f64>| {
        let contact = GridContact::new(SurfaceDistance::default(), laws());
        let mut mpm = Mpm::with_contact(method, BlockGrid::new(crate::common::lattice()), contact);
        let swing = |t: f64| Twist::along([0.3 * (90.0 * t).cos(), 0.0]);
        let floor = Rigid::prescribed(2000.0, swing).expect("floor");
        mpm.add_rigid("floor", &floor, &cuboid([-0.5, -2.0 * H], [1.5, 0.0])).expect("floor");
        let disc = Rigid::free(3000.0).expect("disc").with_velocity([0.5, -0.4]).with_spin([0.0, 0.0, 3.0]);
        mpm.add_rigid("disc", &disc, &ball([0.2, 0.2], 0.2)).expect("disc");
        let law = crate::common::rubber();
        mpm.add("block", law, &cuboid([0.45, 0.0], [0.8, 0.4]), |_| [0.0; 2]).expect("block");
        mpm.set_body_force(|_| [0.0, -10.0]);
        mpm
    };
    continues("rigid", || scene(&coulomb), [150, 60]);
    continues("rigid weakening", || scene(&weakening), [150, 60]);
}
