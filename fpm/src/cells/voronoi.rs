//! Voronoi cells in a convex domain: the domain, cut by the bisecting planes of neighbours.

use impactite_geometry::search::{BoxTree, NeighbourSearch, Points, Reach};

use super::domain::Domain;
use super::error::CellsError;
use super::polytope::{Beyond, Polytope};
use crate::vector::{difference, dot, norm};

/// Return the Voronoi cells of points in a domain.
///
/// # Errors
/// A point outside the domain; a duplicate point.
pub(crate) fn tessellate<const D: usize>(
    points: &[[f64; D]],
    domain: &Domain<D>,
) -> Result<Vec<Polytope<D>>, CellsError> {
    let tree = BoxTree::new(&Points::of_positions(points)?, Reach::uniform(0.0))?;
    let bounds = domain.bounds();
    let whole = norm(&difference(&bounds.max, &bounds.min));
    let spacing = (domain.volume() / points.len() as f64).powf(1.0 / D as f64);
    let mut reach = spacing;
    let mut cells = Vec::with_capacity(points.len());
    let mut near: Vec<(f64, u32)> = Vec::new();
    for (i, x) in points.iter().enumerate() {
        if !domain.contains(*x) {
            let allowed = "inside the domain, and not on a side";
            return Err(refused(i, x, "place", f64::NAN, allowed));
        }
        let mut cell = domain.polytope.clone();
        // Successive points are mostly near each other: the last reach is the first guess.
        let (mut seen, mut radius) = (0.0, 1.5 * reach.min(4.0 * spacing).max(1e-3 * spacing));
        loop {
            near.clear();
            tree.visit_within(x, radius, &mut |j, distance| {
                if j as usize != i && distance >= seen {
                    near.push((distance, j));
                }
            })?;
            near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            reach = cell.reach(x);
            for &(distance, j) in &near {
                if distance > 2.0 * reach {
                    break;
                }
                if distance == 0.0 {
                    return Err(refused(i, x, "distance to another point", 0.0, "positive"));
                }
                let y = &points[j as usize];
                let normal = difference(y, x);
                let offset = 0.5 * (dot(y, y) - dot(x, x));
                cell.cut(&normal, offset, reach, Beyond::Cell(j));
                reach = cell.reach(x);
            }
            if radius >= 2.0 * reach || radius >= whole {
                break;
            }
            (seen, radius) = (radius, (2.0 * reach * (1.0 + 1e-9)).min(2.0 * radius));
        }
        cells.push(cell);
    }
    Ok(cells)
}

pub(crate) fn refused<const D: usize>(
    cell: usize,
    x: &[f64; D],
    field: &'static str,
    value: f64,
    allowed: &'static str,
) -> CellsError {
    CellsError::Cell { cell, position: x.to_vec(), field, value, allowed }
}
