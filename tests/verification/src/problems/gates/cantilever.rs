//! B: cantilever in plane stress under a shear pulse on its end (case 2.2 of \[Shen2022\]).

use std::sync::Arc;

use mpm_core::{Boundary, Side};
use mpm_materials::{LinearElastic, Moduli, PlaneStress};

use super::Passage;
use super::matter::{Matter, Point, Setup};
use crate::case::Outcome;

const SIZE: [f64; 2] = [48.0, 12.0];
const YOUNG: f64 = 30e6;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 1.0;
/// Traction, Pa, and its duration, s.
const SHEAR: f64 = 100.0;
const DURATION: f64 = 0.5;
/// Reference path: times, s, and displacements of the middle of the end, m, by 96 x 24 elements of eight nodes.
const PATH: [(f64, f64); 9] = [
    (0.05, -0.008_598),
    (0.10, -0.020_24),
    (0.15, -0.016_326),
    (0.20, -0.003_408),
    (0.25, -0.002_668),
    (0.30, -0.015_346),
    (0.40, -0.009_494),
    (0.50, -0.007_759),
    (0.60, 0.003_069),
];
/// Static displacement under the load, m.
const STATIC: f64 = 0.010_682;
/// Minimum displacement under load, m, and its search interval, s.
const LOWEST: f64 = -0.021_275;
const BETWEEN: [f64; 2] = [0.1, 0.125];
const LOOKS: usize = 50;

/// Displacement of the middle of the end, m: least-squares plane fit of the points around it.
fn tip(points: &[Point], h: f64) -> f64 {
    let place = |p: &Point| [p.rest[0] - SIZE[0], p.rest[1] - 0.5 * SIZE[1]];
    let near: Vec<&Point> = points.iter().filter(|p| place(p).iter().all(|c| c.abs() < 1.8 * h)).collect();
    let count = near.len() as f64;
    let row = |p: &Point| [place(p)[0], place(p)[1], p.position[1] - p.rest[1]];
    let mean: [f64; 3] = std::array::from_fn(|k| near.iter().map(|p| row(p)[k]).sum::<f64>() / count);
    let sum = |i: usize, j: usize| -> f64 {
        near.iter().map(|p| row(p)).map(|r| (r[i] - mean[i]) * (r[j] - mean[j])).sum()
    };
    let [xx, xy, yy, xu, yu] = [sum(0, 0), sum(0, 1), sum(1, 1), sum(0, 2), sum(1, 2)];
    let det = xx * yy - xy * xy;
    mean[2] - (mean[0] * (yy * xu - xy * yu) + mean[1] * (xx * yu - xy * xu)) / det
}

pub fn run(passage: Passage) -> Result<Outcome, String> {
    let moduli = Moduli::young_poisson(YOUNG, POISSON).map_err(|e| e.to_string())?;
    let law = PlaneStress::new(LinearElastic::new(DENSITY, moduli).map_err(|e| e.to_string())?);
    let h = SIZE[1] / passage.cells as f64;
    let setup = Setup {
        size: SIZE,
        cells: [(SIZE[0] / SIZE[1]).round() as usize * passage.cells, passage.cells],
        velocity: Arc::new(|_| [0.0; 2]),
        boundaries: vec![Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }],
        load: Some(Arc::new(|t| [0.0, if t <= DURATION { -SHEAR } else { 0.0 }])),
    };
    let mut beam = Matter::in_plane_strain(passage.way, setup, law)?;
    let looks = (0..=LOOKS).map(|n| BETWEEN[0] + (BETWEEN[1] - BETWEEN[0]) * n as f64 / LOOKS as f64);
    let mut times: Vec<(f64, Option<f64>)> = looks.map(|t| (t, None)).collect();
    times.extend(PATH.map(|(t, u)| (t, Some(u))));
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut lowest, mut off) = (0.0f64, 0.0);
    for (time, reference) in times {
        if time > 0.0
            && let Err(failure) = beam.run_until(time)
        {
            return Ok(Outcome { work: beam.work, failure: Some(failure), ..Outcome::default() });
        }
        let now = tip(&beam.points(), h);
        lowest = lowest.min(now);
        off += reference.map_or(0.0, |u| (now - u).powi(2) / PATH.len() as f64);
    }
    let outcome = Outcome { work: beam.work, ..Outcome::default() };
    Ok(outcome
        .with("path", off.sqrt() / STATIC)
        .with("lowest", lowest / LOWEST - 1.0)
        .with("energy", beam.energy_error()))
}
