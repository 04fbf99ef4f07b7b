//! Beams that bend far (gate 3.5).

use std::sync::Arc;

use impactite_scene::{Boundary, PlaneStrain, Side, Solver};
use mpm_materials::{Elastic, LogarithmicBulk, Moduli, Solid};
use sph::{Layout, Method, Sph};

/// Rows on both ends, so that the clamp is where it is.
fn beam(length: f64, height: f64, through: usize) -> Layout<2> {
    let h = height / through as f64;
    let along = (length / h).round() as usize;
    let mut layout = Layout { positions: vec![], volumes: vec![], spacings: vec![], surface: 0.0 };
    for i in 0..=along {
        for j in 0..through {
            let share = if i == 0 || i == along { 0.5 } else { 1.0 };
            layout.positions.push([i as f64 * h, (j as f64 + 0.5) * h]);
            layout.volumes.push(share * h * h);
            layout.spacings.push(h);
        }
    }
    layout
}

/// Turek and Hron's CSM3: a beam of 0.35 x 0.02 m falls under gravity of 2 m/s^2 and swings, its tip down by 129.73 mm.
#[test]
fn a_beam_swings_as_far_as_turek_and_hron_say() {
    let moduli = Moduli::young_poisson(1.4e6, 0.4).unwrap();
    let law =
        Solid::new(Elastic::new(moduli.shear).unwrap(), LogarithmicBulk::new(1000.0, moduli.bulk).unwrap());
    let layout = beam(0.35, 0.02, 12);
    let mut beam = Sph::new(Method::total_lagrangian(PlaneStrain), law, &layout, |_| [0.0; 2]).unwrap();
    beam.bound(Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    beam.set_body_force(Arc::new(|_| [0.0, -2.0]));
    let tip: Vec<usize> = (0..layout.len())
        .filter(|&i| layout.positions[beam.numbers()[i] as usize][0] > 0.35 - 1e-9)
        .collect();
    let (mut down, mut back) = (0.0f64, 0.0f64);
    while beam.time() < 0.7 {
        beam.step_towards(0.7).unwrap();
        let mean = |d: usize| tip.iter().map(|&i| beam.positions()[i][d]).sum::<f64>() / tip.len() as f64;
        down = down.min(mean(1) - 0.01);
        back = back.min(mean(0) - 0.35);
    }
    assert!((down / -129.73e-3 - 1.0).abs() < 0.03, "{down}");
    assert!((back / -29.30e-3 - 1.0).abs() < 0.06, "{back}");
}
