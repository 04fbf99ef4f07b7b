//! Runs with these conditions are bitwise identical for any number of threads, and after a restart from a checkpoint.

use super::*;
use impactite_simd::Team;
use mpm_core::{Flip, Linear, Method, Musl, PlaneStrain, Usf};

/// Create a block that slides over a rough floor towards an absorbing plane, in a periodic box.
fn sliding(make: &dyn Fn(Lattice<2>) -> Mpm<2>, friction: f64, threads: usize) -> Mpm<2> {
    let h = 0.1;
    let (lattice, seeds) = block([0.6, 0.0], [1.4, 1.2], h);
    let mut mpm = make(lattice);
    mpm.bound(Boundary::Periodic { axis: 0, low: 0.0, high: 16.0 * h }).expect("periodic");
    let velocity = [0.3, 0.0];
    mpm.bound(Boundary::FrictionWall { axis: 1, at: 0.0, side: Side::Above, velocity, friction })
        .expect("floor");
    let lid = Boundary::Absorbing {
        axis: 1,
        at: 1.2,
        side: Side::Below,
        longitudinal: longitudinal(),
        shear: shear(),
    };
    mpm.bound(lid).expect("lid");
    mpm.set_body_force(|_| [1.0, -10.0]);
    mpm.set_team(Team::new(threads).expect("threads"));
    mpm.add("block", law(), &seeds, |x| [0.5 + 0.2 * x[1], 0.1 * (x[0] - 1.0)]).expect("block");
    mpm
}

fn methods() -> [Made; 3] {
    [
        ("last", Box::new(|l| Mpm::new(Method::contact_at_rest(PlaneStrain), BlockGrid::new(l)))),
        ("again", Box::new(|l| Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(l)))),
        (
            "first",
            Box::new(|l| Mpm::new(Method::new(Linear, Flip, Usf, PlaneStrain).compiled(), BlockGrid::new(l))),
        ),
    ]
}

#[test]
fn threads_and_checkpoints_change_no_bit() {
    for (name, make) in methods() {
        let mut plain = sliding(&*make, 0.5, 1);
        plain.run_until(0.5).expect("a run");
        assert!(plain.exchange().friction > 0.0 && plain.exchange().work != 0.0);
        for threads in 2..=4 {
            let mut other = sliding(&*make, 0.5, threads);
            other.run_until(0.5).expect("a run");
            assert!(bits(&plain) == bits(&other), "{name}: {threads} threads");
            assert_eq!(plain.exchange(), other.exchange(), "{name}: {threads} threads");
        }
        let file = std::env::temp_dir().join(format!("impactite-conditions-{name}-{}", std::process::id()));
        let mut saved = sliding(&*make, 0.5, 1);
        while saved.time() < 0.2 {
            saved.step_towards(0.5).expect("a step");
        }
        saved.save(&file).expect("a checkpoint");
        let mut resumed = sliding(&*make, 0.5, 1).resumed(&file).expect("resumed");
        let other =
            sliding(&*make, 0.4, 1).resumed(&file).map(|_| ()).expect_err("another friction").to_string();
        std::fs::remove_file(&file).expect("removed");
        resumed.run_until(0.5).expect("a run");
        assert!(bits(&plain) == bits(&resumed), "{name}: resumed");
        assert_eq!(plain.exchange(), resumed.exchange(), "{name}: resumed");
        assert!(other.contains("boundary 1"), "{other}");
    }
}
