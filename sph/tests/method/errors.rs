//! Invalid input and its error messages.

use impactite_scene::{Axisymmetric, Boundary, PlaneStrain, Side};
use sph::{ArtificialStress, Layout, Method, PairViscosity, Sph, TotalLagrangian, ZeroEnergyPenalty};

use crate::common::{block, linear};

fn said(layout: &Layout<2>) -> String {
    let made = Sph::new(Method::total_lagrangian(Axisymmetric), linear(0.3), layout, |_| [0.0; 2]);
    made.err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn layouts_that_cannot_be_are_refused_by_name() {
    let good = block([0.0; 2], [3.0; 2], 1.0, true);
    assert_eq!(said(&good), "");
    let empty = Layout { positions: Vec::new(), volumes: Vec::new(), spacings: Vec::new(), surface: 1.0 };
    assert!(said(&empty).contains("body"), "{}", said(&empty));
    type Break = fn(&mut Layout<2>);
    let wrong: [(Break, &str); 7] = [
        (|l| l.positions[4][1] = f64::NAN, "position"),
        (|l| l.positions[4][0] = 0.0, "distance from the axis"),
        (|l| l.volumes[2] = -1.0, "volume"),
        (|l| l.spacings[2] = 0.0, "spacing"),
        (|l| l.volumes.truncate(8), "volumes"),
        (|l| l.spacings.truncate(8), "spacings"),
        (|l| l.surface = -1.0, "surface"),
    ];
    for (make, word) in wrong {
        let mut layout = good.clone();
        make(&mut layout);
        let said = said(&layout);
        assert!(said.contains(word), "{word}: {said}");
    }
}

#[test]
fn numbers_and_conditions_that_cannot_be_are_refused_by_name() {
    let layout = block([0.0; 2], [3.0; 2], 1.0, false);
    let mut total =
        Sph::new(Method::total_lagrangian(PlaneStrain), linear(0.3), &layout, |_| [0.0; 2]).unwrap();
    let wall = total.mirror_wall(1, 0.0, Side::Above).expect_err("neighbours never change").to_string();
    assert!(wall.contains("Boundary::Wall"), "{wall}");
    let behind = Boundary::Symmetry { axis: 0, at: 1.0, side: Side::Above };
    let behind = total.bound(behind).expect_err("particles behind").to_string();
    assert!(behind.contains("in front of the plane"), "{behind}");
    let periodic = total.bound(Boundary::Periodic { axis: 0, low: 0.0, high: 3.0 });
    assert!(periodic.is_err());
    let nan = Sph::new(Method::updated(PlaneStrain), linear(0.3), &layout, |_| [f64::NAN, 0.0]);
    assert!(nan.err().expect("refused").to_string().contains("velocity"));
    for said in [
        ZeroEnergyPenalty::new(-1.0).expect_err("refused").to_string(),
        ArtificialStress::new(f64::NAN).expect_err("refused").to_string(),
        PairViscosity::new(0.0, f64::INFINITY).expect_err("refused").to_string(),
        TotalLagrangian::renewed(1.0).expect_err("refused").to_string(),
    ] {
        assert!(said.contains("is not allowed; it must be"), "{said}");
    }
}
