//! Cantilever under an end shear pulse (case 2.2 of the method's paper) against second-order finite elements.

use std::sync::Arc;

use fpm::{Cells, Composition, Fpm, Method};
use impactite_scene::{PlaneStrain, Solver};
use mpm_materials::{LinearElastic, Moduli, PlaneStress};

use crate::common::{lattice, random};

/// Motion of the tip: lowest position under load and its time, displacement at 0.3 s, and frequency after release.
struct Swing {
    lowest: f64,
    at: f64,
    later: f64,
    frequency: f64,
    energy: f64,
}

fn swing<M: Composition<2>>(method: M, cells: &Cells<2>, end: f64) -> Swing {
    let law = PlaneStress::new(LinearElastic::new(1.0, Moduli::young_poisson(30e6, 0.3).unwrap()).unwrap());
    let mut beam = Fpm::new(method, law, cells, |_| [0.0; 2]).unwrap();
    beam.hold_faces(|f| f.normal[0] < -0.5, Arc::new(|_| [Some(0.0); 2])).unwrap();
    let shear = |t: f64| [0.0, if t <= 0.5 { -100.0 } else { 0.0 }];
    beam.load_faces(|f| f.normal[0] > 0.5, Arc::new(shear)).unwrap();
    let far = |i: &usize| (beam.reference()[*i][0] - 48.0).abs() + beam.reference()[*i][1].abs();
    let tip = (0..cells.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap();
    let mut swing = Swing { lowest: 0.0, at: 0.0, later: 0.0, frequency: 0.0, energy: 0.0 };
    let (mut last, mut crossings) = (0.0, Vec::new());
    while beam.time() < end {
        beam.step_towards(end).unwrap();
        let (t, u) = (beam.time(), beam.displacement_at(tip, [48.0, 0.0])[1]);
        if t < 0.2 && u < swing.lowest {
            (swing.lowest, swing.at) = (u, t);
        }
        if t <= 0.3 {
            swing.later = u;
        }
        if t > 0.55 && last < 0.0 && u >= 0.0 {
            crossings.push(t);
        }
        last = u;
    }
    if let [first, .., last] = crossings[..] {
        swing.frequency = (crossings.len() - 1) as f64 / (last - first);
    }
    swing.energy = beam.account().energy_error();
    println!(
        "{method:?}: {:.6} m at {:.4} s, {:.6} m, {:.4} Hz, energy {:.1e}, {} steps",
        swing.lowest,
        swing.at,
        swing.later,
        swing.frequency,
        swing.energy,
        beam.steps()
    );
    swing
}

fn meets<M: Composition<2>>(method: M, cells: &Cells<2>, end: f64, within: f64) {
    let swing = swing(method, cells, end);
    assert!((swing.lowest / -0.021275 - 1.0).abs() < within, "{}", swing.lowest);
    assert!((swing.at - 0.1115).abs() < 0.002, "{}", swing.at);
    assert!((swing.later / -0.015346 - 1.0).abs() < 0.03, "{}", swing.later);
    assert!(swing.energy.abs() < 1e-3, "{:e}", swing.energy);
    if end > 1.0 {
        assert!((swing.frequency / 4.411 - 1.0).abs() < 0.01, "{}", swing.frequency);
    }
}

#[test]
fn a_cantilever_swings_as_elements_say() {
    let cells = lattice([0.0, -6.0], [48, 12], 1.0);
    meets(Method::printed(PlaneStrain), &cells, 1.2, 0.005);
    meets(Method::symmetric(PlaneStrain), &cells, 1.2, 0.005);
}

/// The incomplete flux produces noise on random cells, which is large after 0.6 s, ten thousand wave passages through a cell.
#[test]
fn a_cantilever_of_random_cells_swings_alike() {
    let cells = random([0.0, -6.0], [48.0, 6.0], 1.0, 21);
    meets(Method::printed(PlaneStrain), &cells, 0.3, 0.01);
    meets(Method::symmetric(PlaneStrain), &cells, 1.2, 0.02);
}
