//! H: Kalthoff-Winkler plate: a crack propagates from a notch after impact below it (case 2.3 of \[Shen2022\]).
//!
//! Half model, 0.1 m x 0.1 m, in plane stress, of random cells, with rows of points along the notch. The reference is the range of
//! published computations, an independent peridynamics computation and the experiment: its centre, and half its width.

use std::sync::Arc;

use fpm::{
    Cells, Cohesive, Criterion, Domain, Fpm, MaximumTension, Method, Notch, TipPath, relaxed, scattered,
};
use mpm_core::{Boundary, PlaneStrain, Side, Solver};
use mpm_materials::{LinearElastic, Moduli, PlaneStress};

use super::Passage;
use crate::case::Outcome;
use crate::fragile::{Cracks, Opening};
use crate::work::{Stopwatch, Work};

const SIZE: f64 = 0.1;
/// Notch tip, m.
const TIP: [f64; 2] = [0.05, 0.025];
/// Width of the notch, m.
const GAP: f64 = 0.3e-3;
/// Velocity of the edge below the notch, m/s, after a ramp of `RAMP` s.
const SPEED: f64 = 16.5;
const RAMP: f64 = 1e-6;
const END: f64 = 90e-6;
/// Tensile strength of a face, Pa.
const STRENGTH: f64 = 1773e6;
/// Fracture energy, J/m^2.
const WORK: f64 = 2.213e4;
/// Rayleigh wave speed, m/s.
const RAYLEIGH: f64 = 2799.0;
/// Crack extension at which its chord is measured, m.
const FAR: f64 = 0.06;
/// Centres of the accepted ranges: chord angle, 64 to 70 degrees, and initiation time, 23 to 28 us.
const CHORD: f64 = 67.0;
const START: f64 = 25.5e-6;
/// Crack extension that counts as initiation, m.
const BEGUN: f64 = 2e-3;

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Build the cells of the plate with its notch.
fn cells(h: f64, seed: u64) -> Result<Cells<2>, String> {
    let domain = Domain::cuboid([0.0; 2], [SIZE; 2]).map_err(text)?;
    let notch = Notch::segment([0.0, TIP[1]], TIP).and_then(|n| n.with_gap(GAP)).map_err(text)?;
    let points = relaxed(scattered(&domain, seed, |_| h).map_err(text)?, &domain, 3).map_err(text)?;
    let points = notch.lined(points, &domain, h).map_err(text)?;
    Cells::voronoi(&points, &domain).map_err(text)?.with_notch(&notch).map_err(text)
}

pub fn run(passage: Passage, cracks: Cracks) -> Result<Outcome, String> {
    match cracks.opening {
        Opening::Strength => opened(passage, cracks, MaximumTension::new(STRENGTH).map_err(text)?),
        // Stored errors and charts refer to parted cells.
        Opening::Cohesive => opened(passage, cracks, Cohesive::new(STRENGTH, WORK).map_err(text)?.parted()),
    }
}

fn opened(passage: Passage, cracks: Cracks, criterion: impl Criterion) -> Result<Outcome, String> {
    let cells = cells(SIZE / passage.cells as f64, cracks.seed)?;
    let moduli = Moduli::young_poisson(190e9, 0.3).map_err(text)?;
    let steel = PlaneStress::new(LinearElastic::new(8000.0, moduli).map_err(text)?);
    let method = Method::symmetric(PlaneStrain).with_cracks(criterion);
    let mut plate = Fpm::new(method, steel, &cells, |_| [0.0; 2]).map_err(text)?;
    let strike = |t: f64| [Some(SPEED * (t / RAMP).min(1.0)), None];
    let struck = plate.drive_faces(|f| f.normal[0] < -0.5 && f.centroid[1] < TIP[1], Arc::new(strike));
    struck.map_err(text)?;
    plate.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).map_err(text)?;
    let watch = Stopwatch::start();
    let made = plate.run_until(END);
    let work = Work {
        particles: cells.len() as u64,
        steps: plate.steps(),
        nodes: passage.way.nodes(),
        seconds: watch.seconds(),
        bytes: plate.bytes() as u64,
    };
    let outcome = Outcome { work, failure: made.err().map(text), ..Outcome::default() };
    if outcome.failure.is_some() {
        return Ok(outcome);
    }
    let path = TipPath::new(&plate.cracks(), TIP, |crack| crack.opened.filter(|_| crack.damage > 0.99));
    let beyond = |far: f64| path.tips().iter().find(|tip| tip.distance > far);
    let (Some(start), Some(end)) = (beyond(BEGUN), beyond(FAR)) else {
        return Ok(Outcome { failure: Some("the crack stops on its way".into()), ..outcome });
    };
    let chord = (end.position[1] - TIP[1]).atan2(end.position[0] - TIP[0]).to_degrees();
    let times = (25..70).map(|t| f64::from(t) * 1e-6);
    let fastest = times.filter_map(|t| path.speed(t, 8e-6)).fold(0.0, f64::max);
    Ok(outcome
        .with("angle", chord / CHORD - 1.0)
        .with("work of the crack", plate.dissipated() / plate.crack_area() / WORK - 1.0)
        .with("start", start.time / START - 1.0)
        .with("speed over that of Rayleigh waves", fastest / RAYLEIGH)
        .with("energy", plate.account().energy_error()))
}
