//! Gates by all methods: errors within 2 % of what they were, and within what theory and references allow.

use verification::fragile::{Flux, Fragile};
use verification::problems::gates::{Gate, Passage, Way, stored};
use verification::stored::{Runs, judged, order, series};

/// A measure of a way over its grids, coarse first.
fn over_grids(runs: &Runs<Passage>, way: Way, quantity: &str) -> Vec<f64> {
    series(runs, quantity, |passage| passage.way == way).into_iter().map(|(_, error)| error).collect()
}

/// The ways that are stored.
fn ways(runs: &Runs<Passage>) -> Vec<Way> {
    let mut ways: Vec<Way> = runs.iter().map(|(passage, _)| passage.way).collect();
    ways.dedup();
    ways
}

/// Fragile points with the symmetric flux.
fn is_symmetric(way: Way) -> bool {
    matches!(way, Way::Fragile(Fragile { flux: Flux::Symmetric, .. }))
}

/// A: the velocity comes nearer to d'Alembert's fronts with every grid, and the bar leaves the wall with 10 m/s, but for what is left in waves
/// as short as a cell, which is less with every grid: 2.5 % of the speed on the finest, 2.7 % with the symmetric flux of fragile points, with
/// which short waves are fastest.
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

/// B: the end nearer to its path with every grid, at least as fast as first order has it, and its lowest place within 1.5 % on the finest. Material
/// points by splines meet the clamp and the load half a cell beside them and stay at first order; random cells with the symmetric flux, which
/// is stiff, have 31 % on six through the beam and 7 % on twelve.
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

/// C: the frequency within 2 % on the finest grid. Not by updated smoothed particles with kernels of 2.6 spacings, 6 % slow with eight through
/// the beam and 10 % where artificial stress was not balanced.
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

/// D: Rankine's and Hugoniot's pressure within 1 %, density within 0.1 %, the speed of the shock within 1 %. The profile and the energy that
/// is left behind are of the first order that a shock with viscosity allows: where it started, it heats too much.
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

/// G: lengths within 0.3 % on four cells and on eight, faces within 3 % on eight, but for updated smoothed particles, which hold the rim
/// back by 4.5 %.
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

/// G by elements that become particles, as those before. They are not stored, for the smallest change of rounding may convert an element a step
/// later. Elements lose no energy where they meet the wall, particles from the start do; a joint of both that gave energy would be seen.
#[test]
fn gate_g_by_elements_that_become_particles() {
    // Cells, and errors of the length, the face and the energy allowed. Elements that share nodes with particles are stopped by their own nodes
    // alone, while the wall stops particles at their surfaces: AFEMP stays 2.9 and 0.9 % too long.
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

/// The plate that is pulled: second order where the pull is smooth, about 5/3 where its rate jumps. Not by material points with splines, whose
/// load acts within the end (first order), nor by the incomplete flux of fragile points, whose errors of both signs nearly cancel: they are a
/// third of those of the symmetric one, and fall unevenly.
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
