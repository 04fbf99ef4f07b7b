//! Initial points in the shapes of bodies.

use std::collections::HashMap;

use impactite::geometry::{Lattice, Seeds, Shape, fill};

use super::common::World;
use super::shape::MovedBox;
use super::wrong::{At, Made, Wrong};
use crate::model::body::Body;
use crate::model::shape::Shape as Spec;

/// Distance of a box face from lattice sites, in spacings, up to which the face counts as aligned.
const ALIGNED: f64 = 1e-6;
/// Number of sample positions to find parts of a shape without points.
const LOOKS: usize = 20_000;
/// Volume fraction of a shape that may be without points: tips and edges.
const BARE: f64 = 0.02;
/// Largest number of points along an axis of a box.
const MOST: f64 = 1e9;

/// Cells of a method: lattice, points along a cell edge, and key of the cell size.
pub(super) struct Cells<'a, const D: usize> {
    pub lattice: &'a Lattice<D>,
    pub parts: usize,
    pub key: &'a str,
    /// Number of halvings of the cells of the scene that make these.
    pub halvings: u32,
}

impl<const D: usize> Cells<'_, D> {
    /// Return the point spacing, m.
    fn edge(&self) -> f64 {
        self.lattice.spacing() / self.parts as f64
    }
}

/// Generate the points in the shape of a body. Boxes, rotated ones included, are divided into the best-fitting number of points, so that
/// their faces are exact. Points of other shapes are on the lattice, those beside a face half a spacing below it, with the volumes of their
/// own cells.
pub(super) fn seeds<const D: usize>(
    world: &World<'_, D>,
    key: &str,
    body: &Body,
    cells: &Cells<'_, D>,
) -> Made<Seeds<D>> {
    let (key, shape) = (format!("{key}.shape"), world.shape(key, body)?);
    let cuboid = body.shape.as_ref().and_then(MovedBox::<D>::of);
    if let Some(cuboid) = &cuboid {
        let (low, high) = (&cuboid.low, &cuboid.high);
        let within = |x: f64, d: usize| {
            let sites = (x - cells.lattice.origin()[d]) / cells.edge();
            (sites - sites.round()).abs() <= ALIGNED
        };
        // Points of smaller cells divide those of larger ones.
        let parts = f64::from(1u32 << cells.halvings);
        let counts: [f64; D] =
            std::array::from_fn(|d| ((high[d] - low[d]) / (parts * cells.edge())).round() * parts);
        let aligned = cuboid.along_axes() && (0..D).all(|d| within(low[d], d) && within(high[d], d));
        if !aligned && counts.iter().all(|n| (1.0..MOST).contains(n)) && counts.iter().product::<f64>() < MOST
        {
            return Ok(divided(cuboid, &counts.map(|n| n as usize), world.revolved()));
        }
    }
    let seeds = fill(&*shape, cells.lattice, cells.parts, &world.filling()).at(&key)?;
    if body.shape.as_ref().is_some_and(may_be_thin) {
        thin(&key, &*shape, &seeds, cells)?;
    }
    // Sites of a box along the lattice are whole.
    Ok(if cuboid.is_some() { seeds } else { seeds.with_cell_volumes(&*shape, world.metric()) })
}

/// Divide a box into the given number of points along each axis.
fn divided<const D: usize>(cuboid: &MovedBox<D>, counts: &[usize; D], revolved: bool) -> Seeds<D> {
    let MovedBox { low, high, .. } = cuboid;
    let edges: [f64; D] = std::array::from_fn(|d| (high[d] - low[d]) / counts[d] as f64);
    let (mut positions, mut volumes) = (Vec::new(), Vec::new());
    for site in 0..counts.iter().product() {
        let (mut x, mut rest) = ([0.0; D], site);
        for d in (0..D).rev() {
            x[d] = low[d] + ((rest % counts[d]) as f64 + 0.5) * edges[d];
            rest /= counts[d];
        }
        let volume: f64 = edges.iter().product();
        let place = cuboid.place(x);
        volumes.push(if revolved { place[0] * volume } else { volume });
        positions.push(place);
    }
    Seeds::placed(positions, volumes, cuboid.turned(edges.map(|edge| 0.5 * edge)))
}

/// True if the shape may have parts thinner than the point spacing.
fn may_be_thin(spec: &Spec) -> bool {
    match spec {
        Spec::Moved(moved) => may_be_thin(&moved.shape),
        Spec::Box(_) | Spec::Ball(_) | Spec::Cylinder(_) | Spec::Frustum(_) | Spec::OgiveRod(_) => false,
        _ => true,
    }
}

/// Refuse a shape with parts that contain no point.
fn thin<const D: usize>(key: &str, shape: &dyn Shape<D>, seeds: &Seeds<D>, cells: &Cells<'_, D>) -> Made<()> {
    let (edge, bounds) = (cells.edge(), shape.bounds());
    let site = |x: &[f64; D]| -> [i64; D] { x.map(|c| (c / edge).floor() as i64) };
    let mut at: HashMap<[i64; D], Vec<u32>> = HashMap::new();
    for (n, x) in seeds.positions.iter().enumerate() {
        at.entry(site(x)).or_default().push(n as u32);
    }
    let covered = |x: &[f64; D]| {
        let middle = site(x);
        (0..3usize.pow(D as u32)).any(|n| {
            let beside = std::array::from_fn(|d| middle[d] + (n / 3usize.pow(d as u32) % 3) as i64 - 1);
            at.get(&beside).is_some_and(|list| {
                let near = |p: &u32| {
                    let y = &seeds.positions[*p as usize];
                    (0..D).all(|d| (x[d] - y[d]).abs() <= 1.05 * edge)
                };
                list.iter().any(near)
            })
        })
    };
    let (mut inside, mut bare, mut deepest) = (0usize, 0usize, (0.0, [0.0; D]));
    for n in 0..LOOKS {
        let x: [f64; D] = std::array::from_fn(|d| {
            bounds.min[d] + (bounds.max[d] - bounds.min[d]) * halton(n + 1, [2, 3, 5][d.min(2)])
        });
        let depth = -shape.signed_distance(x);
        if depth <= 0.0 {
            continue;
        }
        inside += 1;
        if !covered(&x) {
            bare += 1;
            if depth > deepest.0 {
                deepest = (depth, x);
            }
        }
    }
    if bare as f64 <= BARE * inside as f64 {
        return Ok(());
    }
    let (depth, place) = deepest;
    Err(Wrong {
        key: key.into(),
        message: format!(
            "{:.0} % of its volume hold no point: at {place:?} it is about {:.3e} m thick, and points are {edge:.3e} m apart",
            100.0 * bare as f64 / inside as f64,
            2.0 * depth
        ),
        help: Some(format!(
            "take `{}` of {:.2e} m or less, or a thicker shape",
            cells.key,
            2.0 * depth * cells.parts as f64
        )),
    })
}

/// Return the n-th number of the Halton sequence with this base, in (0, 1).
fn halton(n: usize, base: usize) -> f64 {
    let (mut rest, mut part, mut sum) = (n, 1.0, 0.0);
    while rest > 0 {
        part /= base as f64;
        sum += part * (rest % base) as f64;
        rest /= base;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_divided_where_they_are() {
        let seeds = divided(&MovedBox::along([5.03, 0.07], [6.03, 0.57]), &[10, 5], false);
        let mean = |d: usize| seeds.positions.iter().map(|x| x[d]).sum::<f64>() / seeds.len() as f64;
        assert!((mean(0) - 5.53).abs() < 1e-14 && (mean(1) - 0.32).abs() < 1e-14);
        assert!((seeds.volumes.iter().sum::<f64>() - 0.5).abs() < 1e-14);
        // Axisymmetric volumes are per radian.
        let tube = divided(&MovedBox::along([1.0, 0.0], [3.0, 1.0]), &[7, 2], true);
        assert!((tube.volumes.iter().sum::<f64>() - 4.0).abs() < 1e-14);
    }

    #[test]
    fn numbers_of_halton_fill_the_unit_interval() {
        let mean = (1..=1000).map(|n| halton(n, 3)).sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.01 && halton(1, 2) == 0.5 && halton(5, 3) == 2.0 / 3.0 + 1.0 / 9.0);
    }
}
