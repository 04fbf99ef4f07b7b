//! Seeding of discs by concentric rings of particles.

use std::f64::consts::{PI, TAU};

use super::error::Check;
use super::{GeometryError, Seeds};
use impactite_simd::memory::{Budget, MOST_BYTES};

/// Seed a full disc by `count` concentric rings of particles, each as wide as its particles are long, with exact
/// area. The edge is as smooth as a circle, whereas a lattice has steps on which a disc would rattle. Consecutive rings are rotated
/// by the golden angle.
///
/// # Errors
/// A centre that is not finite, a radius that is not positive and finite, no ring, areas outside the range of floating-point numbers,
/// or more particles than [`MOST_BYTES`] can store (some 15000 rings).
pub fn rings(centre: [f64; 2], radius: f64, count: usize) -> Result<Seeds<2>, GeometryError> {
    let check = Check("rings");
    let (centre, radius) = (check.point("centre", centre)?, check.positive("radius", radius)?);
    check.that(count > 0, "count", count as f64, "at least 1")?;
    let budget = Budget { what: "a disc of so many rings", allowed: MOST_BYTES, remedy: "use fewer rings" };
    // Ring k has 2 pi (k + 1/2) particles, rounded to a whole number.
    let most = PI * count as f64 * count as f64 + 0.5 * count as f64;
    budget.holds(most * (size_of::<[f64; 2]>() + size_of::<f64>()) as f64)?;
    let width = radius / count as f64;
    check.that(
        (width * width).is_normal() && (radius * radius).is_finite(),
        "radius",
        radius,
        "such that areas of disc and particles are numbers",
    )?;
    let (mut positions, mut volumes) = (budget.room(most as usize)?, budget.room(most as usize)?);
    for ring in 0..count {
        let r = (ring as f64 + 0.5) * width;
        let around = (TAU * r / width).round();
        for n in 0..around as usize {
            let angle = TAU * (n as f64 / around + 0.381_966 * ring as f64);
            positions.push([centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]);
            volumes.push(TAU * r * width / around);
        }
    }
    let area = PI * radius * radius;
    Ok(Seeds { exact_measure: Some(area), ..Seeds::placed(positions, volumes, [0.5 * width; 2]) })
}
