//! Inverted elements, and erosion.

use fem::{Criterion, Erosion, Fem, MeshBody, Technology};
use impactite_geometry::ElementKind::{Hexa8, Quad4};
use impactite_scene::{Body, Boundary, FullSpace, PlaneStrain, Side, Solver};
use mpm_materials::{Moduli, NeoHookean};

use crate::common::{elastic, flowing, mesh};

/// Soft bar that a fast wall crushes.
fn crushed(erosion: Erosion) -> Fem<2> {
    let mut fem = Fem::new(PlaneStrain);
    let bar = mesh(Quad4, [0.0; 2], [4e-3, 8e-3], [4, 8]);
    fem.add(MeshBody::new("bar", bar, elastic(1000.0, 1e6, 0.3)).eroding(erosion)).unwrap();
    fem.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 200.0 }).unwrap();
    fem
}

#[test]
fn an_inverted_element_stops_the_run_and_says_what_to_do() {
    let mut fem = crushed(Erosion::none());
    let said = fem.run_until(1e-4).expect_err("it is crushed").to_string();
    for part in [
        "element ",
        "body `bar`",
        "linear elastic",
        "inside out",
        "det J <= 0",
        "Erosion::volume",
        "particles",
        "finer mesh",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(fem.step_at_most(1.0).is_err());
}

/// Law without failure: the element flattens, and the stable time step vanishes.
#[test]
fn a_step_that_shrinks_to_nothing_stops_the_run_and_says_what_to_do() {
    let rubber = NeoHookean::new(1000.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
    let mut fem = Fem::new(PlaneStrain);
    fem.add(MeshBody::new("square", mesh(Quad4, [0.0; 2], [1e-3; 2], [1, 1]), rubber)).unwrap();
    for (set, velocity) in [("low y", 0.0), ("high y", -3.0)] {
        fem.prescribe(0, set, std::sync::Arc::new(move |_| [Some(0.0), Some(velocity), None])).unwrap();
    }
    let said = fem.run_until(1e-3 / 3.0).expect_err("it is squeezed to nothing").to_string();
    for part in ["element 0 of body `square`", "so flat", "Erosion::step", "particles", "finer mesh"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(fem.step_at_most(1.0).is_err());
}

#[test]
fn crushed_elements_leave_where_they_may_and_the_books_close() {
    let mut fem = crushed(Erosion::volume(0.2));
    let start = fem.totals();
    fem.run_until(4e-5).unwrap();
    let (end, eroded) = (fem.totals(), fem.body(0).eroded());
    assert!(eroded.elements >= 4, "{eroded:?}");
    // Mass and momentum are conserved, and the lost energy is booked.
    assert_eq!(start.mass, end.mass);
    assert!((fem.exchange().conversion + eroded.energy).abs() <= 1e-12 * eroded.energy.abs());
    let account = fem.account();
    assert!(account.missing() < 1e-12 * account.momentum_scale, "{account:?}");
    assert!(account.energy_error().abs() < 0.05, "{account:?}");
    // Points are the remaining elements, and the nodes with the mass of eroded elements.
    let points = fem.body(0).points();
    let elements = points.iter().filter(|p| p.number < 32).count();
    assert_eq!(elements as u64, 32 - eroded.elements);
    let mass: f64 = points.iter().filter(|p| p.number >= 32).map(|p| p.mass).sum();
    assert!((mass - eroded.mass).abs() < 1e-12 * mass);
    assert!(points.iter().filter(|p| p.number >= 32).all(|p| p.failed && p.stress == [0.0; 6]));
}

#[test]
fn surfaces_follow_and_free_nodes_fly_on() {
    // The middle third of a bar is stretched until it erodes.
    let mut fem = Fem::new(FullSpace);
    let bar = mesh(Hexa8, [0.0; 3], [6e-3, 2e-3, 2e-3], [6, 2, 2]);
    let body = MeshBody::new("bar", bar, flowing(8930.0, 117e9, 0.35, 100e6)).with(Hexa8, Technology::Full);
    let pull = |x: [f64; 3]| {
        [
            if x[0] < 2.5e-3 {
                -75.0
            } else if x[0] > 3.5e-3 {
                75.0
            } else {
                0.0
            },
            0.0,
            0.0,
        ]
    };
    fem.add(body.eroding(Erosion::plastic_strain(0.15)).moving(pull)).unwrap();
    let (start, facets) = (fem.totals(), fem.body(0).surface().len());
    assert_eq!(facets, 2 * (6 * 2 + 6 * 2 + 2 * 2));
    assert_eq!(fem.body(0).surface_revision(), 0);
    fem.run_until(1.5e-5).unwrap();
    let eroded = fem.body(0).eroded();
    assert!(eroded.elements >= 8 && eroded.elements < 24, "{eroded:?}");
    assert!(fem.body(0).surface_revision() > 0);
    assert_ne!(fem.body(0).surface().len(), facets);
    // Facets belong to remaining elements.
    let there: Vec<usize> = fem.body(0).points().iter().map(|p| p.number).collect();
    assert!(fem.body(0).surface().iter().all(|f| there.contains(&(f.element as usize))));
    // A node in the middle without elements keeps its velocity.
    let free = (0..fem.body(0).nodes().len()).find(|&n| fem.body(0).force(n) == [0.0; 3]);
    let free = free.expect("a free node");
    let velocity = fem.body(0).nodes()[free].velocity;
    fem.run_until(1.6e-5).unwrap();
    assert_eq!(fem.body(0).nodes()[free].velocity, velocity);
    let end = fem.totals();
    assert!((start.mass - end.mass).abs() < 1e-14 * start.mass);
    assert!(fem.account().energy_error().abs() < 0.03, "{:?}", fem.account());
    assert!((0..3).all(|d| (end.momentum[d] - start.momentum[d]).abs() < 1e-12 * start.momentum_scale));
}

#[test]
fn criteria_that_cannot_be_are_refused() {
    let refused = |erosion| {
        let body = MeshBody::new("bar", mesh(Quad4, [0.0; 2], [1.0; 2], [1; 2]), elastic(1.0, 1.0, 0.3));
        Fem::new(PlaneStrain).add(body.eroding(erosion)).expect_err("refused").to_string()
    };
    assert!(refused(Erosion::plastic_strain(0.1)).contains(
        "erosion by `plastic_strain` is not allowed with `the law linear elastic, whose state has "
    ));
    assert!(refused(Erosion::volume(1.5)).contains("part of the volume = 1.5"));
    assert!(refused(Erosion::step(-1.0)).contains("step = -1"));
    let all = Criterion::All(vec![Criterion::Failed, Criterion::Volume(0.1)]);
    assert!(refused(Erosion::none().or(all)).contains("criterion of its own"));
}

#[test]
fn all_criteria_of_a_list_must_hold() {
    let run = |erosion| {
        let mut fem = Fem::new(PlaneStrain);
        let bar = mesh(Quad4, [0.0; 2], [2e-3, 6e-3], [2, 6]);
        let body = MeshBody::new("bar", bar, flowing(8930.0, 117e9, 0.35, 100e6)).moving(|_| [0.0, -200.0]);
        fem.add(body.eroding(erosion)).unwrap();
        fem.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
        fem.run_until(4e-6).unwrap();
        fem.body(0).eroded().elements
    };
    let strain = || Criterion::State { name: "plastic_strain".into(), at_least: 0.1 };
    let alone = run(Erosion::none().or(strain()));
    assert!(alone > 0);
    assert_eq!(run(Erosion::none().or(Criterion::All(vec![strain(), Criterion::Step(1e-12)]))), 0);
    assert_eq!(run(Erosion::none().or(Criterion::All(vec![strain(), Criterion::Step(1.0)]))), alone);
}
