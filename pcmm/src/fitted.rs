//! Packings whose outermost particles are on the surface of a shape.

use std::collections::BTreeMap;

use impactite_geometry::{Lattice, Shape};
use impactite_scene::SceneError;

use crate::particles::{MOST, Packing, too_many};

/// Distance from the surface, in spacings, up to which a node is moved to it.
const BAND: f64 = 0.5;
/// Step of the difference quotient of the distance, in spacings.
const STEP: f64 = 1e-4;
/// Iterations of the projection onto the surface.
const ITERATIONS: usize = 8;
/// Distance from the surface, in spacings, of a point on it.
const ON_SURFACE: f64 = 1e-6;
/// Least distance of two particles on the surface, in spacings.
const APART: f64 = 0.6;
/// Least distance of a particle within the shape from those on its surface, in spacings.
const WITHIN: f64 = 0.55;
/// Depth, in spacings, from which particles stay on the lattice.
const DEEP: f64 = 2.5;
/// Rounds in which particles spread, distance up to which they repel each other, in spacings, and part of the overlap by which they move.
const ROUNDS: usize = 40;
const REST: f64 = 1.1;
const PUSH: f64 = 0.15;
/// Distance to the nearest particle, in spacings, from which there is a gap.
const GAP: f64 = 0.72;
/// Radius of particles that spread, in spacings.
const WIDE: f64 = 0.7;
/// Least depth of a particle within the shape while particles spread, in spacings.
const SKIN: f64 = 0.4;
/// Cosine of the angle between the normals of two faces that meet at an edge or a corner.
const EDGE: f64 = 0.85;
/// Distance, in spacings, within which particles of two faces are neighbours, and over which one is moved to their edge.
const BESIDE: f64 = 1.6;

impl<const D: usize> Packing<D> {
    /// Create particles at the lattice nodes in a shape, those within half a spacing of its surface moved to the surface, and those
    /// nearest to an edge or a corner to that. Radii are half the spacing; there are no volumes. The elements between the particles then
    /// end at the surface, whatever its place and direction: a curved one is cut by chords, which take h^2 / (8 R) of its radius R.
    ///
    /// # Errors
    /// More than 2^29 nodes in the bounds of the shape.
    pub fn fitted(shape: &(impl Shape<D> + ?Sized), lattice: &Lattice<D>) -> Result<Self, SceneError> {
        let h = lattice.spacing();
        let mut surface: Vec<OnSurface<D>> = Vec::new();
        let mut inside: Vec<[f64; D]> = Vec::new();
        for_each_node(shape, lattice, |x| {
            let distance = shape.signed_distance_within(x, h);
            if distance < -BAND * h {
                inside.push(x);
            } else if distance <= BAND * h
                && let Some(point) = OnSurface::beside(shape, x, h)
            {
                surface.push(point);
            }
        })?;
        move_to_edges(shape, &mut surface, h);
        // Corners and edges come first, so that they stay where particles are too near to each other.
        let mut kept: Vec<Place<D>> = Vec::new();
        let mut cells = Cells::new(h);
        for faces in (0..=D).rev() {
            for point in surface.iter().filter(|point| point.faces == faces) {
                if !cells.any_within(|n| kept[n].position, &point.position, APART * h) {
                    cells.add(kept.len(), &point.position);
                    let kind = if faces == 0 { Kind::Face } else { Kind::Edge };
                    kept.push(Place { position: point.position, kind });
                }
            }
        }
        inside.retain(|x| !cells.any_within(|n| kept[n].position, x, WITHIN * h));
        kept.extend(inside.into_iter().map(|position| Place::within(shape, position, h)));
        for _ in 0..2 {
            spread(shape, &mut kept, h);
            fill_gaps(shape, lattice, &mut kept)?;
        }
        spread(shape, &mut kept, h);
        let positions: Vec<[f64; D]> = kept.iter().map(|place| place.position).collect();
        // Spread particles are up to a seventh farther apart than those of the lattice.
        let radius = |place: &Place<D>| if place.kind == Kind::Deep { 0.5 * h } else { WIDE * h };
        let radii = kept.iter().map(radius).collect();
        Ok(Packing { positions, radii, volumes: Vec::new(), surface: 0.0 })
    }
}

/// Freedom of a particle while particles spread.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// On an edge or a corner, where it stays.
    Edge,
    /// So deep that it stays on the lattice.
    Deep,
    /// On a face, along which it moves.
    Face,
    /// Within the shape.
    Inside,
}

/// Particle of a packing while particles spread.
#[derive(Clone, Copy)]
struct Place<const D: usize> {
    position: [f64; D],
    kind: Kind,
}

impl<const D: usize> Place<D> {
    fn within(shape: &(impl Shape<D> + ?Sized), position: [f64; D], h: f64) -> Self {
        let deep = shape.signed_distance_within(position, 2.0 * DEEP * h) < -DEEP * h;
        Place { position, kind: if deep { Kind::Deep } else { Kind::Inside } }
    }
}

/// Spread the particles beside the surface evenly: those nearer than a spacing repel each other, those on a face stay on it.
fn spread<const D: usize>(shape: &(impl Shape<D> + ?Sized), places: &mut [Place<D>], h: f64) {
    let mut near = Vec::new();
    for _ in 0..ROUNDS {
        let mut cells = Cells::new(REST * h);
        places.iter().enumerate().for_each(|(n, place)| cells.add(n, &place.position));
        let before: Vec<[f64; D]> = places.iter().map(|place| place.position).collect();
        for (n, place) in
            places.iter_mut().enumerate().filter(|(_, place)| matches!(place.kind, Kind::Face | Kind::Inside))
        {
            cells.near(&before[n], &mut near);
            let mut by = [0.0; D];
            for other in near.iter().filter(|other| **other != n) {
                let apart = difference(&before[n], &before[*other]);
                let distance = square(&apart).sqrt();
                if distance < REST * h && distance > 0.0 {
                    let push = PUSH * (REST * h - distance) / distance;
                    (0..D).for_each(|d| by[d] += push * apart[d]);
                }
            }
            let moved: [f64; D] = std::array::from_fn(|d| before[n][d] + by[d]);
            match place.kind {
                Kind::Face => {
                    if let Some(point) = OnSurface::beside(shape, moved, h) {
                        place.position = point.position;
                    }
                }
                _ if shape.signed_distance_within(moved, h) < -SKIN * h => place.position = moved,
                _ => {}
            }
        }
    }
}

/// Add particles where none is within [`GAP`] spacings of a node of a lattice twice as fine.
fn fill_gaps<const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    lattice: &Lattice<D>,
    places: &mut Vec<Place<D>>,
) -> Result<(), SceneError> {
    let h = lattice.spacing();
    let mut cells = Cells::new(h);
    places.iter().enumerate().for_each(|(n, place)| cells.add(n, &place.position));
    let corners = 1usize << D;
    for_each_node(shape, lattice, |node| {
        for corner in 0..corners {
            let x: [f64; D] =
                std::array::from_fn(|d| node[d] + if corner >> d & 1 == 1 { 0.5 * h } else { 0.0 });
            let distance = shape.signed_distance_within(x, 2.0 * DEEP * h);
            let on_face = if distance.abs() <= BAND * h { OnSurface::beside(shape, x, h) } else { None };
            let place = match on_face {
                Some(point) => Place { position: point.position, kind: Kind::Face },
                None if (-DEEP * h..-SKIN * h).contains(&distance) => {
                    Place { position: x, kind: Kind::Inside }
                }
                None => continue,
            };
            if !cells.any_within(|n| places[n].position, &place.position, GAP * h) {
                cells.add(places.len(), &place.position);
                places.push(place);
            }
        }
    })
}

/// Visit the lattice nodes in the bounds of a shape, a spacing beyond them included.
fn for_each_node<const D: usize>(
    shape: &(impl Shape<D> + ?Sized),
    lattice: &Lattice<D>,
    mut visit: impl FnMut([f64; D]),
) -> Result<(), SceneError> {
    let (bounds, h) = (shape.bounds(), lattice.spacing());
    let (mut first, mut counts) = ([0i64; D], [0i64; D]);
    for d in 0..D {
        let index = |x: f64| (x - lattice.origin()[d]) / h;
        let (low, high) = (index(bounds.min[d]).floor() - 1.0, index(bounds.max[d]).ceil() + 1.0);
        first[d] = low as i64;
        counts[d] = (high - low + 1.0).max(0.0) as i64;
    }
    let sites = counts.iter().fold(1.0, |n, &c| n * c as f64);
    if sites >= MOST {
        return Err(too_many(sites as usize));
    }
    for site in 0..sites as i64 {
        let (mut node, mut rest) = (first, site);
        for d in (0..D).rev() {
            node[d] += rest % counts[d];
            rest /= counts[d];
        }
        visit(lattice.node(node));
    }
    Ok(())
}

/// Particle on the surface of a shape.
#[derive(Clone, Copy)]
struct OnSurface<const D: usize> {
    position: [f64; D],
    /// Outward unit normal.
    normal: [f64; D],
    /// Number of faces that meet there, less one: 0 on a face, 1 on an edge, in the plane at a corner.
    faces: usize,
}

impl<const D: usize> OnSurface<D> {
    /// Project a point onto the surface, if the projection is within a spacing.
    fn beside(shape: &(impl Shape<D> + ?Sized), start: [f64; D], h: f64) -> Option<Self> {
        let mut x = start;
        for _ in 0..ITERATIONS {
            let distance = shape.signed_distance(x);
            let normal = gradient(shape, &x, h)?;
            if distance.abs() <= ON_SURFACE * h {
                let near = square(&difference(&x, &start)) <= h * h;
                return near.then_some(OnSurface { position: x, normal, faces: 0 });
            }
            (0..D).for_each(|d| x[d] -= distance * normal[d]);
        }
        None
    }
}

/// Unit gradient of the signed distance; `None` on a ridge.
fn gradient<const D: usize>(shape: &(impl Shape<D> + ?Sized), x: &[f64; D], h: f64) -> Option<[f64; D]> {
    let step = STEP * h;
    let slope = |d: usize| {
        let at = |by: f64| {
            let mut moved = *x;
            moved[d] += by;
            shape.signed_distance(moved)
        };
        at(step) - at(-step)
    };
    let slopes: [f64; D] = std::array::from_fn(slope);
    let length = square(&slopes).sqrt();
    (length > step).then(|| slopes.map(|s| s / length))
}

/// Move particles beside an edge or a corner, where faces of different normals meet, to it.
fn move_to_edges<const D: usize>(shape: &(impl Shape<D> + ?Sized), surface: &mut Vec<OnSurface<D>>, h: f64) {
    let mut cells = Cells::new(BESIDE * h);
    surface.iter().enumerate().for_each(|(n, point)| cells.add(n, &point.position));
    let mut moved = Vec::new();
    let mut near = Vec::new();
    for point in surface.iter() {
        cells.near(&point.position, &mut near);
        let mut normals = vec![point.normal];
        let mut offsets = vec![0.0];
        let mut others: Vec<(f64, usize)> = near
            .iter()
            .map(|&n| (square(&difference(&surface[n].position, &point.position)), n))
            .filter(|(q, _)| *q <= (BESIDE * h).powi(2))
            .collect();
        others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, n) in others {
            let other = &surface[n];
            if normals.len() < D && normals.iter().all(|normal| dot(normal, &other.normal) < EDGE) {
                normals.push(other.normal);
                offsets.push(dot(&difference(&other.position, &point.position), &other.normal));
                if let Some(x) = common(&point.position, &normals, &offsets)
                    && square(&difference(&x, &point.position)) <= (BESIDE * h).powi(2)
                    && shape.signed_distance(x).abs() <= 1e-3 * h
                {
                    moved.push(OnSurface { position: x, normal: point.normal, faces: normals.len() - 1 });
                }
            }
        }
    }
    surface.extend(moved);
}

/// Point nearest to `x` on the planes through `x` plus the offsets along the normals, from the equations of the Gram matrix; `None` for
/// parallel planes.
fn common<const D: usize>(x: &[f64; D], normals: &[[f64; D]], offsets: &[f64]) -> Option<[f64; D]> {
    let count = normals.len();
    let mut rows: Vec<Vec<f64>> = (0..count)
        .map(|i| normals.iter().map(|n| dot(&normals[i], n)).chain([offsets[i]]).collect())
        .collect();
    for i in 0..count {
        let pivot = rows[i][i];
        if pivot < 1e-2 {
            return None;
        }
        for j in 0..count {
            if j != i {
                let factor = rows[j][i] / pivot;
                let row = rows[i].clone();
                rows[j].iter_mut().zip(&row).for_each(|(a, b)| *a -= factor * b);
            }
        }
    }
    let mut at = *x;
    for (i, normal) in normals.iter().enumerate() {
        let share = rows[i][count] / rows[i][i];
        (0..D).for_each(|d| at[d] += share * normal[d]);
    }
    Some(at)
}

/// Points by cell of a size.
struct Cells<const D: usize> {
    size: f64,
    points: BTreeMap<[i64; D], Vec<usize>>,
}

impl<const D: usize> Cells<D> {
    fn new(size: f64) -> Self {
        Cells { size, points: BTreeMap::new() }
    }
    fn cell(&self, x: &[f64; D]) -> [i64; D] {
        x.map(|c| (c / self.size).floor() as i64)
    }
    fn add(&mut self, n: usize, x: &[f64; D]) {
        self.points.entry(self.cell(x)).or_default().push(n);
    }
    /// Find the points of the cell of `x` and of those beside it.
    fn near(&self, x: &[f64; D], out: &mut Vec<usize>) {
        out.clear();
        let middle = self.cell(x);
        for n in 0..3usize.pow(D as u32) {
            let beside: [i64; D] =
                std::array::from_fn(|d| middle[d] + (n / 3usize.pow(d as u32) % 3) as i64 - 1);
            out.extend(self.points.get(&beside).into_iter().flatten());
        }
    }
    /// True if any of the points, with these positions, is within a distance of at most the size.
    fn any_within(&self, position: impl Fn(usize) -> [f64; D], x: &[f64; D], distance: f64) -> bool {
        let mut near = Vec::new();
        self.near(x, &mut near);
        near.iter().any(|&n| square(&difference(&position(n), x)) < distance * distance)
    }
}

fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|d| a[d] - b[d])
}
fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| a[d] * b[d]).sum()
}
fn square<const D: usize>(a: &[f64; D]) -> f64 {
    dot(a, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use impactite_geometry::{Ball, Cylinder, Polygon};

    fn least_distance<const D: usize>(positions: &[[f64; D]]) -> f64 {
        let mut least = f64::INFINITY;
        for (n, x) in positions.iter().enumerate() {
            for y in &positions[..n] {
                least = least.min(square(&difference(x, y)).sqrt());
            }
        }
        least
    }

    #[test]
    fn corners_of_a_turned_square_have_particles() {
        let (sin, cos) = 0.4f64.sin_cos();
        let corners: Vec<[f64; 2]> = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .iter()
            .map(|[x, y]| [0.013 + cos * x - sin * y, sin * x + cos * y])
            .collect();
        let square = Polygon::new(corners.clone()).unwrap();
        let packing = Packing::fitted(&square, &Lattice::new([0.0; 2], 0.1).unwrap()).unwrap();
        for corner in corners {
            let near = |x: &[f64; 2]| super::square(&difference(x, &corner)).sqrt() < 1e-6;
            assert!(packing.positions.iter().any(near), "no particle at {corner:?}");
        }
        assert!(least_distance(&packing.positions) > 0.05);
        assert!(packing.positions.iter().all(|x| square.signed_distance(*x) < 1e-6));
    }

    #[test]
    fn edges_of_a_cylinder_and_a_ball_are_met() {
        let rod = Cylinder::<3>::new([0.01, 0.02, 0.033], [1.0, 2.0, 2.0], 1.0, 0.4).unwrap();
        let packing = Packing::fitted(&rod, &Lattice::new([0.0; 3], 0.1).unwrap()).unwrap();
        let axis = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
        let rim = packing.positions.iter().filter(|x| {
            let from = difference(x, &[0.01, 0.02, 0.033]);
            let along = dot(&from, &axis);
            let across = (square(&from) - along * along).sqrt();
            (across - 0.4).abs() < 2e-3 && along.abs().min((along - 1.0).abs()) < 2e-3
        });
        // Two rims of 2.5 m: at least every 0.15 m a particle.
        assert!(rim.count() > 32);
        assert!(least_distance(&packing.positions) > 0.05);
        let ball = Ball::new([0.02, 0.01], 0.55).unwrap();
        let packing = Packing::fitted(&ball, &Lattice::new([0.0; 2], 0.1).unwrap()).unwrap();
        let outer = packing.positions.iter().filter(|x| ball.signed_distance(**x).abs() < 1e-6).count();
        assert!((30..50).contains(&outer), "{outer} on the circle");
    }
}
