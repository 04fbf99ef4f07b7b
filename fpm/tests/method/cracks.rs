//! Opening, closure and friction of faces.

use std::sync::Arc;

use fpm::{Cohesive, Composition, Fpm, MaximumTension, Method, Notch};
use impactite_scene::{PlaneStrain, Solver};
use mpm_materials::{IntoMaterial, NeoHookean};

use crate::common::{STEEL, lattice, linear, moduli, random};

const WORK: f64 = 2e4;

/// Pull a strip with an edge notch apart into two. Return the energy dissipated by cracks over the area of the ligament.
fn strip<M: Composition<2>>(method: M, law: impl IntoMaterial<f64>, h: f64, random_cells: bool) -> f64 {
    let (length, width, depth) = (40e-3, 10e-3, 4e-3);
    let cells = if random_cells {
        random([0.0; 2], [length, width], h, 13)
    } else {
        lattice([0.0; 2], [(length / h).round() as usize, (width / h).round() as usize], h)
    };
    let notch = Notch::segment([0.5 * length, 0.0], [0.5 * length, depth]).unwrap();
    let mut strip = Fpm::new(method, law, &cells.with_notch(&notch).unwrap(), |_| [0.0; 2]).unwrap();
    for side in [-1.0, 1.0] {
        let pull = move |t: f64| [Some(side * (t / 20e-6).min(1.0)), None];
        strip.drive_faces(|f| f.normal[0] * side > 0.5, Arc::new(pull)).unwrap();
    }
    strip.run_until(260e-6).unwrap();
    assert_eq!(strip.fragments().len(), 2, "{:?}", strip.fragments());
    let error = strip.account().energy_error();
    assert!(error.abs() < 1e-3, "{error:e}");
    let ligament = width - depth;
    println!(
        "{method:?} {h}: {:.0} J/m2, crack {:.2} mm of {:.2} mm, energy {error:.1e}",
        strip.dissipated() / ligament,
        1e3 * strip.crack_area(),
        1e3 * ligament
    );
    strip.dissipated() / ligament
}

#[test]
fn cohesive_faces_take_the_same_work_in_cells_of_any_size() {
    let joined = Cohesive::new(200e6, WORK).unwrap();
    for cracks in [joined, joined.parted()] {
        let printed = Method::printed(PlaneStrain).with_cracks(cracks);
        let symmetric = Method::symmetric(PlaneStrain).with_cracks(cracks);
        let [a, b] = [1e-3, 0.5e-3].map(|h| strip(symmetric, linear(0.3), h, false));
        assert!((a / b - 1.0).abs() < 0.1 && (b / WORK - 1.0).abs() < 0.1, "{a} {b}");
        let a = strip(printed, linear(0.3), 1e-3, false);
        assert!((a / WORK - 1.0).abs() < 0.1, "{a}");
        // The crack path through random cells is longer. Loose cells vibrate: a rate-form law would not conserve their energy.
        let law = NeoHookean::new(STEEL, moduli(0.3)).unwrap();
        let a = strip(symmetric, law, 1e-3, true);
        assert!(a / WORK > 0.95 && a / WORK < 1.5, "{a}");
    }
}

/// A bar breaks in the middle, where waves of tension superpose, and its ends fly apart with their momentum.
#[test]
fn a_bar_breaks_where_tension_reaches_the_strength() {
    let cells = lattice([0.0; 2], [60, 4], 1e-3);
    let method = Method::printed(PlaneStrain).with_cracks(MaximumTension::new(300e6).unwrap());
    let away = |speed: f64| move |[x, _]: [f64; 2]| [speed * ((x - 30e-3) / 6e-3).clamp(-1.0, 1.0), 0.0];
    let mut bar = Fpm::new(method, linear(0.0), &cells, away(5.0)).unwrap();
    // 5 m/s causes rho c v = 198 MPa, below the strength.
    bar.run_until(4e-6).unwrap();
    assert_eq!((bar.cracks().len(), bar.fragments().len()), (0, 1));
    let mut bar = Fpm::new(method, linear(0.0), &cells, away(10.0)).unwrap();
    bar.run_until(4e-6).unwrap();
    assert!(bar.fragments().len() >= 2, "{:?}", bar.fragments());
    let cracks = bar.cracks();
    assert!(cracks.iter().all(|c| c.damage == 1.0 && c.opened.is_some()));
    assert!(cracks.iter().any(|c| (c.position[0] - 30e-3).abs() < 1e-3));
    let error = bar.account().energy_error();
    assert!(error.abs() < 1e-3 && bar.dissipated() > 0.0, "{error:e} {}", bar.dissipated());
    let (utilised, _) = bar.utilisation().unwrap();
    assert!(utilised < 1.0, "{utilised}");
}

/// Cut through a bar: compression is transmitted as without a cut, tension is not.
#[test]
fn a_closed_crack_bears_pressure_and_no_tension() {
    let notch = Notch::segment([30e-3, -1.0], [30e-3, 1.0]).unwrap();
    let cells = lattice([0.0; 2], [60, 4], 1e-3).with_notch(&notch).unwrap();
    let speed = (200e9f64 / STEEL).sqrt();
    for (sign, wanted) in [(-1.0, 1.0), (1.0, 0.0)] {
        let mut bar = Fpm::new(Method::symmetric(PlaneStrain), linear(0.0), &cells, |_| [0.0; 2]).unwrap();
        assert_eq!((bar.fragments().len(), bar.cracks().len()), (2, 4));
        // Smooth pulse over 25 cells.
        const DURATION: f64 = 5e-6;
        let pulse = move |t: f64| {
            let part = (t / DURATION).clamp(0.0, 1.0);
            [sign * 1e8 * (std::f64::consts::PI * part).sin().powi(2), 0.0]
        };
        bar.load_faces(|f| f.normal[0] > 0.5, Arc::new(pulse)).unwrap();
        let arrival = 45e-3 / speed + 0.5 * DURATION;
        bar.run_until(arrival).unwrap();
        let far: Vec<usize> =
            (0..cells.len()).filter(|&i| (bar.reference()[i][0] - 15e-3).abs() < 1e-3).collect();
        let mean = far.iter().map(|&i| bar.nominal_stresses()[i][0][0]).sum::<f64>() / far.len() as f64;
        assert!((mean / (sign * 1e8) - wanted).abs() < 0.05, "{sign}: {mean:e}");
        let error = bar.account().energy_error();
        assert!(error.abs() < 1e-3, "{error:e}");
    }
}

/// Block on another one under pressure and shear: it slides when the shear exceeds mu times the pressure, and not before.
#[test]
fn closed_cracks_rub() {
    let cut = Notch::segment([-1.0, 4e-3], [1.0, 4e-3]).unwrap();
    let cells = lattice([0.0; 2], [8, 8], 1e-3).with_notch(&cut).unwrap();
    let pressure = 50e6;
    for (share, slides) in [(0.7, false), (1.5, true)] {
        let mut blocks = Fpm::new(Method::symmetric(PlaneStrain), linear(0.3), &cells, |_| [0.0; 2]).unwrap();
        blocks.set_friction(0.3).unwrap();
        blocks.hold_faces(|f| f.normal[1] < -0.5, Arc::new(|_| [Some(0.0); 2])).unwrap();
        let push = move |t: f64| {
            // Pressure first, then slow shear.
            let (down, along) = ((t / 30e-6).min(1.0), ((t - 30e-6) / 60e-6).clamp(0.0, 1.0));
            [0.3 * share * pressure * along, -pressure * down]
        };
        blocks.load_faces(|f| f.normal[1] > 0.5, Arc::new(push)).unwrap();
        blocks.run_until(110e-6).unwrap();
        let slip = blocks.cracks().iter().map(|c| c.gap[1]).fold(0.0, f64::max);
        assert_eq!(slip > 2e-5, slides, "{share}: {slip:e}");
        let heat = blocks.exchange().friction;
        assert!(if slides { heat > 1.0 } else { heat < 0.05 }, "{heat}");
        let error = blocks.account().energy_error();
        assert!(error.abs() < 1e-3, "{error:e}");
    }
}

/// Cells with open faces only move on as rigid bodies.
#[test]
fn single_cells_are_counted_and_move_as_rigid_ones() {
    let method = Method::printed(PlaneStrain).with_cracks(MaximumTension::new(1e6).unwrap());
    let cells = random([0.0; 2], [8e-3; 2], 1e-3, 8);
    let outwards = |[x, y]: [f64; 2]| [2e4 * (x - 4e-3), 2e4 * (y - 4e-3)];
    let mut dust = Fpm::new(method, linear(0.3), &cells, outwards).unwrap();
    dust.run_until(2e-6).unwrap();
    let fragments = dust.fragments();
    assert!(fragments.len() > cells.len() / 2 && dust.rigid_cells() > cells.len() / 2, "{fragments:?}");
    let totals = Solver::totals(&dust);
    assert!(totals.momentum.iter().all(|p| p.abs() < 1e-12 * totals.momentum_scale));
    assert!(dust.account().energy_error().abs() < 1e-3, "{}", dust.account().energy_error());
}
