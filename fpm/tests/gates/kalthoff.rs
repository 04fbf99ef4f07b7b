//! Plate of Kalthoff and Winkler (case 2.3 of the method's paper): a crack runs up from a notch, with the impact below it.

use std::sync::Arc;

use fpm::{Cells, Cohesive, Domain, Fpm, Method, Notch, TipPath, relaxed, scattered};
use impactite_scene::{Boundary, PlaneStrain, Side, Solver};
use mpm_materials::{LinearElastic, Moduli, PlaneStress};

/// Fracture energy, J/m^2, and Rayleigh wave speed, m/s.
const WORK: f64 = 2.213e4;
const RAYLEIGH: f64 = 2799.0;
const TIP: [f64; 2] = [0.05, 0.025];

struct Found {
    /// Time at a crack length of 2 mm, s, angle of the chord after 60 mm, degrees, and highest speed, m/s.
    begun: f64,
    chord: f64,
    fastest: f64,
    /// Work of the crack over its area, J/m^2.
    work: f64,
}

/// Run the half model of random cells of 1 mm, with rows of points along the notch of 0.3 mm, in plane stress. If the sides of the notch
/// are in contact from the start, the crack begins some 4 us earlier.
fn run(seed: u64) -> Found {
    let (h, domain) = (1e-3, Domain::cuboid([0.0; 2], [0.1; 2]).unwrap());
    let notch = Notch::segment([0.0, TIP[1]], TIP).unwrap().with_gap(0.3e-3).unwrap();
    let points = relaxed(scattered(&domain, seed, |_| h).unwrap(), &domain, 3).unwrap();
    let points = notch.lined(points, &domain, h).unwrap();
    let cells = Cells::voronoi(&points, &domain).unwrap().with_notch(&notch).unwrap();
    let steel = LinearElastic::new(8000.0, Moduli::young_poisson(190e9, 0.3).unwrap()).unwrap();
    let cracks = Cohesive::new(1773e6, WORK).unwrap();
    let method = Method::symmetric(PlaneStrain).with_cracks(cracks);
    let mut plate = Fpm::new(method, PlaneStress::new(steel), &cells, |_| [0.0; 2]).unwrap();
    let strike = |t: f64| [Some(16.5 * (t / 1e-6).min(1.0)), None];
    plate.drive_faces(|f| f.normal[0] < -0.5 && f.centroid[1] < TIP[1], Arc::new(strike)).unwrap();
    plate.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
    plate.run_until(90e-6).unwrap();
    let open: Vec<_> = plate.cracks().into_iter().filter(|c| c.damage > 0.99).collect();
    // No cracks from the free edges: all come from the notch and are above it.
    assert!(
        open.iter().filter(|c| c.opened.is_some()).all(|c| c.reference[1] > 0.02 && c.reference[0] > 0.04)
    );
    let path = TipPath::new(&plate.cracks(), TIP, |c| c.opened.filter(|_| c.damage > 0.99));
    let at =
        |far: f64| path.tips().iter().find(|t| t.distance > far).copied().expect("the crack went so far");
    let end = at(0.06);
    let times = (25..70).map(|t| f64::from(t) * 1e-6);
    let error = plate.account().energy_error();
    assert!(error.abs() < 1e-3, "{error:e}");
    Found {
        begun: at(0.002).time,
        chord: (end.position[1] - TIP[1]).atan2(end.position[0] - TIP[0]).to_degrees(),
        fastest: times.filter_map(|t| path.speed(t, 8e-6)).fold(0.0, f64::max),
        work: plate.dissipated() / plate.crack_area(),
    }
}

#[test]
fn a_crack_runs_up_from_the_notch_as_observed() {
    for seed in [1, 2] {
        let found = run(seed);
        println!(
            "seed {seed}: begun at {:.1} us, chord {:.1} degrees, {:.0} m/s, {:.0} J/m2",
            1e6 * found.begun,
            found.chord,
            found.fastest,
            found.work
        );
        assert!((23e-6..28e-6).contains(&found.begun), "{:e}", found.begun);
        assert!((62.0..70.0).contains(&found.chord), "{}", found.chord);
        assert!(found.fastest < 0.75 * RAYLEIGH, "{}", found.fastest);
        assert!((found.work / WORK - 1.0).abs() < 0.1, "{}", found.work);
    }
}
