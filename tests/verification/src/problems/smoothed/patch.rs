//! Linear velocity fields, and uniform stress at the axis.

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{Axisymmetric, PlaneStrain};
use sph::Layout;

use super::{By, DENSITY, Setup, outcome, steel, text};
use crate::case::Outcome;
use crate::problems::elements::anywhere;
use crate::work::Stopwatch;

/// Time step far below the stable one, s, for particles one metre apart.
const STEP: f64 = 1e-6;

/// Square block of particles one metre apart.
fn block(cells: usize, filling: &Filling) -> Result<Layout<2>, String> {
    let shape = Cuboid::new([0.0; 2], [cells as f64; 2]).map_err(text)?;
    let lattice = Lattice::new([0.0; 2], 1.0).map_err(text)?;
    Ok(Layout::of_seeds(&fill(&shape, &lattice, 1, filling).map_err(text)?))
}

/// Run particles displaced from their lattice by up to 0.2 m in a linear velocity field: "spread" is the largest deviation of a stress
/// from the mean, over the largest mean.
pub fn linear(by: By, cells: usize) -> Result<Outcome, String> {
    let mut layout = block(cells, &Filling::new())?;
    for (n, x) in (0..).zip(&mut layout.positions) {
        *x = std::array::from_fn(|d| x[d] + 0.2 * anywhere(2 * n + d as u64));
    }
    let field = |[x, y]: [f64; 2]| [100.0 + 3.0 * x - 2.0 * y, -50.0 + x + 4.0 * y];
    let setup = Setup { layout: &layout, velocity: &field, boundaries: Vec::new() };
    let mut march = setup.body(by, PlaneStrain, steel()?)?;
    let watch = Stopwatch::start();
    march.smoothed_step(STEP, None).map_err(text)?;
    let points = march.body.points();
    let mean: [f64; 6] =
        std::array::from_fn(|k| points.iter().map(|p| p.stress[k]).sum::<f64>() / points.len() as f64);
    let size = mean.iter().fold(0.0f64, |m, s| m.max(s.abs()));
    let off = points.iter().flat_map(|p| (0..6).map(|k| (p.stress[k] - mean[k]).abs()));
    Ok(outcome(&march, &watch).with("spread", off.fold(0.0, f64::max) / size))
}

/// Run an axisymmetric block under isotropic, irrotational compression: radial accelerations under a uniform stress s, over s / (rho r), in
/// the first three rows at the axis, and the largest of the next rows outside the influence of free surfaces.
pub fn axis(by: By, cells: usize) -> Result<Outcome, String> {
    let layout = block(cells, &Filling::new().axisymmetric())?;
    let field = |[r, z]: [f64; 2]| [-r, -z];
    let setup = Setup { layout: &layout, velocity: &field, boundaries: Vec::new() };
    let mut march = setup.body(by, Axisymmetric, steel()?)?;
    let watch = Stopwatch::start();
    march.smoothed_step(STEP, None).map_err(text)?;
    let points = march.body.points();
    let outcome = outcome(&march, &watch);
    let accelerations = march.accelerations(STEP).map_err(text)?;
    let middle = 0.5 * (cells as f64 - 1.0);
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for (n, x) in layout.positions.iter().enumerate() {
        if x[0] < 0.5 * cells as f64 && (x[1] - middle).abs() < 0.1 {
            let p = &points[n];
            rows.push((x[0], accelerations[n][0] / (p.stress[0] / (DENSITY * p.position[0]))));
        }
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [first, second, third, ..] = rows[..] else { return Err("too few rows".into()) };
    let beyond = rows[3..].iter().fold(0.0f64, |m, row| m.max(row.1.abs()));
    let outcome = outcome.with("first row", first.1).with("second row", second.1);
    Ok(outcome.with("third row", third.1).with("beyond", beyond))
}
