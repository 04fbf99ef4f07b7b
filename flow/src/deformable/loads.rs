//! Impulses of the liquid on the nodes of surfaces: the transpose of what the velocities of the nodes are for cells.
//!
//! A surface cuts the area vector a from a cell, by the parts of its faces beyond the surface alone. With the mean velocity w of the surface in the
//! cell, the net outflow of the cell is a . w, and the pressure has the impulse rho h^D q a, which the weights of the mean divide among
//! the nodes. (The flow of w through the closed parts of faces equals it for rigid motion; for others it
//! contains the divergence of w within the body, and forces along the surface.) Liquid at closed faces takes the velocity of the surface
//! along its normal. These answers are reciprocal: work of the liquid is work on the body.
//!
//! The momentum of the particles near the surface says more, since the particles at faces beside a surface are less than the mass
//! that the pressure equation has there. That rest acts on a body as a whole, divided by the wetted surface. What is found at the end of the
//! step acts in the next one.

use std::collections::BTreeMap;

use super::skin::Skin;
use crate::blocks::{Blocks, NONE, SIDE, local};
use crate::couple::{DEEP, REACH, hosts};
use crate::cuts::{CutBlock, NODES, ON_WALL, SLIT, corners, open_side};
use crate::extrapolate::{CLOSED, SOLVED};
use crate::grid::Grid;
use crate::particles::Frame;
use crate::transfer::face_centre;
use crate::wall::Walls;

/// Face near a surface.
#[derive(Clone, Copy, Debug)]
struct Face<const D: usize> {
    axis: usize,
    slot: u32,
    below: u32,
    /// Liquid cells whose pressure acts on the closed part from above and below.
    sides: [u32; 2],
    closed: f64,
    body: usize,
    /// Nodes among those of all surfaces, and their weights.
    nodes: [u32; D],
    weights: [f64; D],
    normal: [f64; D],
}

/// Points along an edge of a facet as long as a cell.
const PARTS: f64 = 4.0;
/// Largest number of points along the edge of a facet.
const MOST_PARTS: f64 = 256.0;
/// Distance of the points from their facets, in cells.
const OUTSIDE: f64 = 1e-6;

/// Shares of the nodes of `bodies` bodies in the wetted surface; where liquid wets none, in the faces near it.
fn shares<const D: usize>(
    (pieces, weights): (&[Piece<D>], &[(u32, f64)]),
    faces: &[Face<D>],
    bodies: usize,
) -> Vec<Vec<(u32, f64)>> {
    let mut all = Vec::new();
    for body in 0..bodies {
        let mut sums = BTreeMap::new();
        for piece in pieces.iter().filter(|piece| piece.body == body) {
            let area = piece.area.iter().map(|a| a * a).sum::<f64>().sqrt();
            for (n, w) in piece.of(weights) {
                *sums.entry(*n).or_insert(0.0) += area * w;
            }
        }
        if sums.is_empty() {
            for face in faces.iter().filter(|face| face.body == body) {
                for (n, w) in face.nodes.iter().zip(&face.weights) {
                    *sums.entry(*n).or_insert(0.0) += w;
                }
            }
        }
        let total: f64 = sums.values().sum();
        all.push(sums.into_iter().map(|(n, sum)| (n, sum / total)).collect());
    }
    all
}

impl<const D: usize> Piece<D> {
    /// Nodes and weights of the piece.
    fn of<'a>(&self, weights: &'a [(u32, f64)]) -> &'a [(u32, f64)] {
        &weights[self.nodes[0] as usize..self.nodes[1] as usize]
    }
}

/// Points of a surface: cell, facet, barycentric weights of its nodes, and measure.
type Points<const D: usize> = Vec<(u32, u32, [f64; D], f64)>;

/// Divide the facets of a surface into points, by which the mean velocity of the part in a cell is found; sorted by cell.
fn points<const D: usize>(skin: &Skin<D>, grid: &Grid<D>, frame: &Frame<D>) -> Points<D> {
    let (cells, mut points) = (Blocks::<D>::CELLS, Vec::new());
    for facet in 0..skin.facets() {
        let corners = skin.nodes(facet).map(|n| skin.places()[n as usize]);
        let edge =
            |a: usize, b: usize| (0..D).map(|d| (corners[a][d] - corners[b][d]).powi(2)).sum::<f64>().sqrt();
        let longest = (0..D).map(|k| edge(k, (k + 1) % D)).fold(0.0, f64::max);
        let parts = (longest * PARTS / frame.h).ceil().clamp(1.0, MOST_PARTS) as usize;
        let (normal, share) = (skin.facet(facet).1, skin.measure(facet) / parts.pow(D as u32 - 1) as f64);
        let mut add = |weights: [f64; D]| {
            // On a plane of the grid the liquid is outside.
            let x: [f64; D] = std::array::from_fn(|d| {
                let at: f64 = weights.iter().zip(&corners).map(|(w, x)| w * x[d]).sum();
                at + OUTSIDE * frame.h * normal[d]
            });
            let Some(key) = frame.block(&x) else { return };
            let b = grid.blocks.find(&key);
            if b != NONE {
                let at = frame.local(&x, &key);
                let i = (0..D).rev().fold(0, |sum, d| sum * SIDE + (at[d] as usize).min(SIDE - 1));
                points.push((b * cells as u32 + i as u32, facet as u32, weights, share));
            }
        };
        let part = |n: usize, by: f64| (n as f64 + by) / parts as f64;
        for i in 0..parts {
            if D == 2 {
                let t = part(i, 0.5);
                add(std::array::from_fn(|k| if k == 0 { 1.0 - t } else { t }));
                continue;
            }
            // Centres of the triangles of a regular division, of both orientations.
            for j in 0..parts - i {
                let (a, b) = (part(i, 1.0 / 3.0), part(j, 1.0 / 3.0));
                add(std::array::from_fn(|k| [1.0 - a - b, a, b][k]));
                if i + j + 1 < parts {
                    let (a, b) = (part(i, 2.0 / 3.0), part(j, 2.0 / 3.0));
                    add(std::array::from_fn(|k| [1.0 - a - b, a, b][k]));
                }
            }
        }
    }
    points.sort_by_key(|p| p.0);
    points
}

/// Find the parts of surfaces in the cells of block `b`. `points` has those of each surface.
fn cut_pieces<const D: usize>(
    (b, cut): (usize, &CutBlock<D>),
    (grid, frame): (&Grid<D>, &Frame<D>),
    (walls, points): (&Walls<'_, D>, &[Points<D>]),
    host: &impl Fn(u32) -> u32,
    (pieces, weights): (&mut Vec<Piece<D>>, &mut Vec<(u32, f64)>),
) {
    let mut solids: Vec<usize> =
        cut.nearest.iter().filter_map(|n| walls.list[usize::from(*n)].solid).collect();
    solids.sort_unstable();
    solids.dedup();
    let (key, cells) = (&grid.blocks.keys[b], Blocks::<D>::CELLS);
    for k in solids {
        let (skin, first) = &walls.skins[k];
        let gap: Vec<f64> = (0..NODES.pow(D as u32))
            .map(|n| {
                let mut rest = n;
                let at = std::array::from_fn(|_| {
                    let x = rest % NODES;
                    rest /= NODES;
                    x as f64
                });
                let gap = skin.nearest(&frame.place(key, &at)).gap / frame.h;
                if gap.abs() < ON_WALL { 0.0 } else { gap }
            })
            .collect();
        for i in 0..cells {
            let at = local::<D>(i);
            let v = corners(&gap, &at);
            let mut area = [0.0; D];
            for (d, area) in area.iter_mut().enumerate() {
                let closed = |side| {
                    let open = open_side::<D>(&v, d, side);
                    if open < SLIT { 1.0 } else { 1.0 - open }
                };
                *area = closed(1) - closed(0);
            }
            let host = if area == [0.0; D] { NONE } else { host((b * cells + i) as u32) };
            if host == NONE {
                continue;
            }
            let from = weights.len();
            let slot = (b * cells + i) as u32;
            let all = &points[k];
            let mut total = 0.0;
            for (_, facet, parts, share) in
                &all[all.partition_point(|p| p.0 < slot)..all.partition_point(|p| p.0 <= slot)]
            {
                let facet = *facet as usize;
                let normal = skin.facet(facet).1;
                // The other side of a plate may be in the cell too.
                if (0..D).map(|d| normal[d] * area[d]).sum::<f64>() < 0.0 {
                    total += share;
                    let nodes = skin.nodes(facet).iter().zip(parts);
                    weights.extend(nodes.map(|(n, w)| (n + *first as u32, share * w)));
                }
            }
            if total > 0.0 {
                weights[from..].iter_mut().for_each(|(_, w)| *w /= total);
            } else {
                let nearest = skin.nearest(&frame.place(key, &at.map(|x| x as f64 + 0.5)));
                let nodes = skin.nodes(nearest.facet).iter().zip(nearest.weights);
                weights.extend(nodes.map(|(n, w)| (n + *first as u32, w)));
            }
            pieces.push(Piece { host, body: k, area, nodes: [from as u32, weights.len() as u32] });
        }
    }
}

/// Part of a surface in a cell.
#[derive(Clone, Copy, Debug)]
struct Piece<const D: usize> {
    /// Liquid cell whose pressure acts on it.
    host: u32,
    body: usize,
    /// Area vector out of the cell, in areas of a face.
    area: [f64; D],
    /// First and last node and weight in the list.
    nodes: [u32; 2],
}

/// Cells and faces near the surfaces of deformable bodies in a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wetted<const D: usize> {
    pieces: Vec<Piece<D>>,
    /// Nodes of the pieces, with their weights in the mean velocity of the piece.
    weights: Vec<(u32, f64)>,
    faces: Vec<Face<D>>,
    /// Shares of the nodes of each body in its wetted surface.
    shares: Vec<Vec<(u32, f64)>>,
}

impl<const D: usize> Wetted<D> {
    /// Find the parts of surfaces in cells, and the faces near them.
    pub fn new(grid: &Grid<D>, frame: &Frame<D>, walls: &Walls<'_, D>) -> Self {
        let cells = Blocks::<D>::CELLS;
        let host = hosts(grid, frame, walls);
        let (mut faces, mut pieces, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        let points: Vec<_> = walls.skins.iter().map(|(skin, _)| points(skin, grid, frame)).collect();
        for (b, cut) in grid.cuts.iter().enumerate() {
            let Some(cut) = cut else { continue };
            let into = (&mut pieces, &mut weights);
            cut_pieces((b, cut), (grid, frame), (walls, &points), &host, into);
            for (i, d) in (0..cells).flat_map(|i| (0..D).map(move |d| (i, d))) {
                let at = face_centre::<D>(i, d);
                let (gap, _, wall) = cut.sample(&at);
                let slot = b * cells + i;
                let closed = 1.0 - grid.open[d][slot];
                let Some(k) = walls.list[wall].solid else { continue };
                if (gap > REACH && closed <= 0.0) || gap < -DEEP {
                    continue;
                }
                let (skin, first) = &walls.skins[k];
                let nearest = skin.nearest(&frame.place(&grid.blocks.keys[b], &at));
                let below = grid.blocks.beside(b, i, d, false).map_or(NONE, |s| s as u32);
                let sides = [slot as u32, below].map(|cell| if closed > 0.0 { host(cell) } else { NONE });
                faces.push(Face {
                    axis: d,
                    slot: slot as u32,
                    below,
                    sides,
                    closed,
                    body: k,
                    nodes: skin.nodes(nearest.facet).map(|n| n + *first as u32),
                    weights: nearest.weights,
                    normal: skin.facet(nearest.facet).1,
                });
            }
        }
        let shares = shares((&pieces, &weights), &faces, walls.skins.len());
        Wetted { pieces, weights, faces, shares }
    }

    /// Liquid cells beside the surfaces.
    pub fn hosts(&self) -> impl Iterator<Item = usize> + '_ {
        self.pieces.iter().map(|piece| piece.host as usize)
    }

    /// Set the values of the cells beside the surfaces to zero.
    pub fn clear(&self, values: &mut [f64]) {
        for cell in self.faces.iter().flat_map(|face| [face.slot, face.below]).filter(|cell| *cell != NONE) {
            values[cell as usize] = 0.0;
        }
    }

    /// Net outflow of cells by these velocities of the nodes.
    pub fn sweep(&self, velocities: &[[f64; D]], into: &mut Vec<(u32, f64)>) {
        into.clear();
        into.extend(self.pieces.iter().map(|piece| {
            let of = |d: usize| {
                piece.of(&self.weights).iter().map(|(n, w)| w * velocities[*n as usize][d]).sum::<f64>()
            };
            (piece.host, (0..D).map(|d| piece.area[d] * of(d)).sum())
        }));
    }

    /// Add the impulses of the liquid to the nodes: of the pressure, of the liquid at closed faces, whose velocity changes from `before` to
    /// `velocities`, and of the rest of the momentum at solved faces, or at all faces if the step has `ended`. `unit` is rho h^D, kg.
    pub fn add(
        &self,
        (grid, unit): (&Grid<D>, f64),
        (before, velocities): (&[[f64; D]], &[[f64; D]]),
        ended: bool,
        into: &mut [[f64; D]],
    ) {
        let mut rest = vec![[0.0; D]; self.shares.len()];
        for piece in &self.pieces {
            let impulse = piece.area.map(|a| unit * a * grid.pressure[piece.host as usize]);
            for (n, w) in piece.of(&self.weights) {
                (0..D).for_each(|d| into[*n as usize][d] += w * impulse[d]);
            }
            (0..D).for_each(|d| rest[piece.body][d] -= impulse[d]);
        }
        for face in &self.faces {
            let (d, slot) = (face.axis, face.slot as usize);
            let mark = grid.marks[d][slot];
            let rest = &mut rest[face.body];
            rest[d] += unit * face.closed * face.push(&grid.pressure);
            if mark == CLOSED {
                // Liquid at closed faces takes the change of the velocity along the normal.
                let of = |n: &u32| {
                    let (new, old) = (&velocities[*n as usize], &before[*n as usize]);
                    (0..D).map(|e| (new[e] - old[e]) * face.normal[e]).sum::<f64>()
                };
                let change: f64 = face.nodes.iter().zip(&face.weights).map(|(n, w)| w * of(n)).sum();
                let along = -unit * grid.volume[d][slot] * face.normal[d].powi(2) * change;
                for (n, w) in face.nodes.iter().zip(&face.weights) {
                    (0..D).for_each(|e| into[*n as usize][e] += w * along * face.normal[e]);
                }
                if ended {
                    (0..D).for_each(|e| rest[e] -= along * face.normal[e]);
                }
            }
            if mark == SOLVED || ended {
                rest[d] -= unit * face.gained(grid);
            }
        }
        for (rest, shares) in rest.iter().zip(&self.shares) {
            for (n, share) in shares {
                (0..D).for_each(|d| into[*n as usize][d] += share * rest[d]);
            }
        }
    }
}

impl<const D: usize> Face<D> {
    /// Difference of q over the closed part, from below to above.
    fn push(&self, q: &[f64]) -> f64 {
        let [up, low] = self.sides.map(|cell| q.get(cell as usize).copied().unwrap_or(0.0));
        low - up
    }

    /// Gain of the liquid at the face beside the difference of q over the open part, of a mass of a cell times m/s.
    fn gained(&self, grid: &Grid<D>) -> f64 {
        let q = |cell: u32| grid.pressure.get(cell as usize).copied().unwrap_or(0.0);
        let (d, slot) = (self.axis, self.slot as usize);
        grid.volume[d][slot] * (grid.velocity[d][slot] - grid.before[d][slot])
            + grid.open[d][slot] * (q(self.slot) - q(self.below))
    }
}
