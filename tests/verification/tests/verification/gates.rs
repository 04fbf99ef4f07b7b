//! Gates by all methods: errors within 2 % of the stored ones, and within the limits of theory and references.

use verification::fragile::{Flux, Fragile};
use verification::problems::gates::{Gate, Passage, Way, stored};
use verification::stored::{Runs, judged, order, series};

/// Measure of a method over its grids, coarse first.
fn over_grids(runs: &Runs<Passage>, way: Way, quantity: &str) -> Vec<f64> {
    series(runs, quantity, |passage| passage.way == way).into_iter().map(|(_, error)| error).collect()
}

/// Stored methods.
fn ways(runs: &Runs<Passage>) -> Vec<Way> {
    let mut ways: Vec<Way> = runs.iter().map(|(passage, _)| passage.way).collect();
    ways.dedup();
    ways
}

/// True for fragile points with the symmetric flux.
fn is_symmetric(way: Way) -> bool {
    matches!(way, Way::Fragile(Fragile { flux: Flux::Symmetric, .. }))
}

/// A: the velocity error decreases on every grid refinement. The bar rebounds at 10 m/s except for residual waves as short as a cell, which
/// decrease with every refinement: 2.5 % of the speed on the finest grid, 2.7 % with the symmetric flux of fragile points, for which short
/// waves are fastest.
#[test]
fn gate_a_bar_on_a_wall() {
    let runs = judged(stored(Gate::Bar));
    for way in ways(&runs) {
        for quantity in ["velocity", "rebound"] {
            let error = over_grids(&runs, way, quantity);
            assert!(error.windows(2).all(|pair| pair[1] < 0.85 * pair[0]), "{way:?}: {quantity} {error:?}");
        }
        let rebound = over_grids(&runs, way, "rebound");
        assert!(rebound[2] < if is_symmetric(way) { 0.027 } else { 0.025 }, "{way:?}: rebound {rebound:?}");
    }
}

/// B: the path error of the end decreases at least with first order, and its minimum is within 1.5 % on the finest grid. Spline material
/// points apply clamp and load half a cell off and are of first order; random cells with the stiff symmetric flux have errors of 31 % with
/// six cells through the beam and 7 % with twelve.
#[test]
fn gate_b_cantilever() {
    let runs = judged(stored(Gate::Cantilever));
    for way in ways(&runs) {
        let path = over_grids(&runs, way, "path");
        assert!(path.windows(2).all(|pair| pair[1] < 0.55 * pair[0]), "{way:?}: path {path:?}");
        let allowed = match way {
            Way::Impact => 0.11,
            Way::Fragile(Fragile { flux: Flux::Symmetric, random: true }) => 0.07,
            _ => 0.035,
        };
        assert!(path[2] < allowed, "{way:?}: path {path:?}");
        let lowest = over_grids(&runs, way, "lowest");
        assert!(lowest[2] < 0.015, "{way:?}: lowest {lowest:?}");
        let allowed = if way == Way::Impact { 3e-3 } else { 1e-3 };
        assert!(over_grids(&runs, way, "energy")[2] < allowed, "{way:?}");
    }
}

/// C: the frequency error is below 2 % on the finest grid. Exception: updated smoothed particles with kernels of 2.6 spacings are 6 % too
/// slow with eight particles through the beam, and 10 % with unbalanced artificial stress.
#[test]
fn gate_c_beam() {
    let runs = judged(stored(Gate::Beam));
    for way in ways(&runs) {
        let error = over_grids(&runs, way, "frequency");
        let allowed = if way == Way::Updated { 0.06 } else { 0.02 };
        assert!(error[2] < allowed && error[2] < error[0], "{way:?}: {error:?}");
        assert!(over_grids(&runs, way, "energy")[2] < 1e-3, "{way:?}");
    }
}

/// D: Rankine-Hugoniot pressure within 1 %, density within 0.1 %, shock speed within 1 %. The profile and the energy behind the shock are
/// of first order, as for any shock with artificial viscosity, with wall heating where it started.
#[test]
fn gate_d_plate() {
    let runs = judged(stored(Gate::Plate));
    for way in ways(&runs) {
        for (quantity, allowed) in [("pressure", 0.01), ("density", 1e-3), ("shock", 0.01), ("energy", 2e-3)]
        {
            let error = over_grids(&runs, way, quantity)[2];
            assert!(error < allowed, "{way:?}: {quantity} {error}");
        }
        let profile = over_grids(&runs, way, "profile");
        assert!(profile.windows(2).all(|pair| pair[1] < 0.67 * pair[0]), "{way:?}: {profile:?}");
        let energy = over_grids(&runs, way, "specific energy");
        let allowed = if is_symmetric(way) { 0.032 } else { 0.03 };
        assert!(energy[2] < allowed && energy[2] < 0.52 * energy[0], "{way:?}: {energy:?}");
    }
}

/// G: length errors below 0.3 % with four and eight cells, face errors below 3 % with eight, except for updated smoothed particles,
/// whose face radius is 4.5 % too small.
#[test]
fn gate_g_bars_of_steel() {
    let runs = judged(stored(Gate::Taylor));
    for way in ways(&runs) {
        let length = over_grids(&runs, way, "length");
        assert!(length.iter().all(|error| *error < 3e-3), "{way:?}: length {length:?}");
        let face = over_grids(&runs, way, "face")[1];
        assert!(face < if way == Way::Updated { 0.05 } else { 0.03 }, "{way:?}: face {face}");
    }
}

/// G by elements with conversion to particles. Errors are not stored, since round-off may shift a conversion by a step. Elements lose no
/// energy at the wall, initial particles do; the test would detect an energy gain of the coupling.
#[test]
fn gate_g_by_elements_that_become_particles() {
    // Cells, and allowed errors of length, face and energy. The wall stops elements that share nodes with particles at their nodes only,
    // but particles at their surfaces: AFEMP is 2.9 and 0.9 % too long.
    let mpfem = [(4, [4e-3, 0.035, 0.02]), (8, [3e-3, 0.03, 0.007])];
    let afemp = [(4, [0.032, 0.045, 3e-3]), (8, [0.01, 0.045, 3e-3])];
    for (way, rows) in [(Way::Mpfem, mpfem), (Way::Afemp, afemp)] {
        for (cells, allowed) in rows {
            let outcome = Passage { gate: Gate::Taylor, way, cells }.run();
            assert_eq!(outcome.failure, None, "{way:?}");
            for (name, allowed) in ["length", "face", "energy"].into_iter().zip(allowed) {
                let error = outcome.measures.iter().find(|m| m.0 == name).map_or(f64::NAN, |m| m.1);
                println!("{way:?}, {cells} cells: {name} {error}");
                assert!(error < allowed, "{way:?}, {cells} cells: {name} {error}");
            }
        }
    }
}

/// Pulled plate: second order for the smooth traction, about 5/3 for the traction with jumps in its rate. Exceptions: spline material
/// points, whose load acts within the end (first order), and the incomplete flux of fragile points, whose errors of both signs nearly
/// cancel: they are a third of those of the symmetric flux, and converge unevenly.
#[test]
fn a_plate_that_is_pulled() {
    let runs = judged(stored(Gate::Pull));
    for way in ways(&runs) {
        let of = |quantity| order(&series(&runs, quantity, |passage| passage.way == way));
        let [smooth, half] = ["smooth", "half sine"].map(of);
        let least = match way {
            Way::Impact => [0.95, 0.95],
            Way::Fragile(Fragile { flux: Flux::Incomplete, .. }) => [1.55, 1.4],
            _ => [1.95, 1.65],
        };
        assert!(smooth > least[0] && half > least[1], "{way:?}: orders {smooth} and {half}");
        let finest = over_grids(&runs, way, "smooth")[2];
        assert!(finest < if way == Way::Impact { 0.016 } else { 5e-4 }, "{way:?}: {finest}");
    }
}
