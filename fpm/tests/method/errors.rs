//! Invalid input and its error messages.

use std::sync::Arc;

use fpm::{Cohesive, Fpm, MaximumTension, Method, MixedTensionShear, Penalty};
use impactite_scene::{Boundary, PlaneStrain, Side, Solver};
use mpm_materials::library;

use crate::common::{lattice, linear};

#[test]
fn numbers_and_conditions_that_cannot_be_are_refused_by_name() {
    let cells = lattice([0.0; 2], [3, 3], 1.0);
    let method = Method::printed(PlaneStrain);
    let nan = Fpm::new(method, linear(0.3), &cells, |_| [f64::NAN, 0.0]);
    assert!(nan.err().expect("refused").to_string().contains("velocity"));
    let mut body = Fpm::new(method, linear(0.3), &cells, |_| [0.0; 2]).unwrap();
    assert!(body.bound(Boundary::Periodic { axis: 0, low: 0.0, high: 3.0 }).is_err());
    let off = Boundary::Symmetry { axis: 0, at: 1.0, side: Side::Above };
    let off = body.bound(off).expect_err("no face is there").to_string();
    assert!(off.contains("number chosen = 0"), "{off}");
    assert!(body.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).is_ok());
    let never = body.load_faces(|_| false, Arc::new(|_| [0.0; 2])).expect_err("no face").to_string();
    assert!(never.contains("at least one"), "{never}");
    let infinite =
        body.load_faces(|_| true, Arc::new(|_| [f64::INFINITY, 0.0])).expect_err("no number").to_string();
    assert!(infinite.contains("traction on a face = inf"), "{infinite}");
    assert!(body.set_friction(-0.1).is_err());
    for said in [
        Penalty::new(-1.0).expect_err("refused").to_string(),
        MaximumTension::new(0.0).expect_err("refused").to_string(),
        MixedTensionShear::new(1.0, f64::NAN).expect_err("refused").to_string(),
        Cohesive::new(1e6, -1.0).expect_err("refused").to_string(),
    ] {
        assert!(said.contains("is not allowed; it must be"), "{said}");
    }
}

#[test]
fn what_stops_a_run_names_cell_and_place() {
    let cells = lattice([0.0; 2], [6, 6], 1e-3);
    let apart = |[x, _]: [f64; 2]| [if x < 3e-3 { 4e3 } else { -4e3 }, 0.0];
    let mut body = Fpm::new(Method::symmetric(PlaneStrain), library::copper_taylor(), &cells, apart)
        .unwrap()
        .named("bar");
    body.set_time_control(impactite_scene::TimeControl::Fixed(0.4e-6)).unwrap();
    let said = body.run_until(1e-5).expect_err("halves fly through each other").to_string();
    assert!(said.contains("cell") && said.contains("`bar`") && said.contains("volume"), "{said}");
    let later = Arc::new(|t: f64| [if t > 0.0 { f64::NAN } else { 0.0 }, 0.0]);
    let mut body = Fpm::new(Method::printed(PlaneStrain), linear(0.3), &cells, |_| [0.0; 2]).unwrap();
    body.load_faces(|f| f.normal[0] > 0.5, later).unwrap();
    let said = body.run_until(1e-6).expect_err("no number").to_string();
    assert!(said.contains("traction"), "{said}");
}

#[test]
fn checkpoints_of_joined_cohesive_faces_are_not_of_parted_ones() {
    let cells = lattice([0.0; 2], [3, 3], 1e-3);
    let joined = Cohesive::new(1e6, 1.0).unwrap();
    let [mut saved, mut other] = [joined, joined.parted()].map(|cracks| {
        let method = Method::symmetric(PlaneStrain).with_cracks(cracks);
        Fpm::new(method, linear(0.3), &cells, |_| [0.0; 2]).unwrap()
    });
    let file = std::env::temp_dir().join(format!("impactite-joined-{}", std::process::id()));
    saved.save(&file).unwrap();
    let said = other.resume(&file).expect_err("of another method").to_string();
    let own = saved.resume(&file);
    std::fs::remove_file(&file).unwrap();
    assert!(said.contains("method") && said.contains("parted"), "{said}");
    own.unwrap();
}
