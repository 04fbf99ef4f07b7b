//! Impulses of the liquid on the nodes of surfaces: the transpose of what the velocities of the nodes are for cells.
//!
//! A surface cuts the area vector a from a cell, by the parts of its faces beyond the surface alone. With the velocity w of the point nearest to
//! the centre, between the nodes of a facet, the net outflow of the cell is a . w, and the pressure has the impulse rho h^D q a on this point,
//! which the same weights divide among the nodes. (The flow of w through the closed parts of faces is as much for bodies that do not deform; else it
//! has the divergence of the surface in it, and forces along it, which drove waves.) Liquid at closed faces takes the velocity of the surface
//! along its normal. These answers are reciprocal: work of the liquid is work on the body.
//!
//! The momentum of the particles near the surface says more, since the particles at faces beside a surface are less than the mass
//! that the pressure equation has there. That rest acts on a body as a whole, divided by the wetted surface. What is found at the end of the
//! step acts in the next one.

use std::collections::BTreeMap;

use crate::blocks::{Blocks, NONE, local};
use crate::cuts::{CutBlock, NODES, ON_WALL, SLIT, corners, open_side};
use crate::couple::{DEEP, REACH, hosts};
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

/// Shares of the nodes of `bodies` bodies in the wetted surface.
fn shares<const D: usize>(pieces: &[Piece<D>], bodies: usize) -> Vec<Vec<(u32, f64)>> {
    let mut all = Vec::new();
    for body in 0..bodies {
        let mut sums = BTreeMap::new();
        for piece in pieces.iter().filter(|piece| piece.body == body) {
            let area = piece.area.iter().map(|a| a * a).sum::<f64>().sqrt();
            for (n, w) in piece.nodes.iter().zip(&piece.weights) {
                *sums.entry(*n).or_insert(0.0) += area * w;
            }
        }
        let total: f64 = sums.values().sum();
        all.push(sums.into_iter().map(|(n, sum)| (n, sum / total)).collect());
    }
    all
}

/// Find the parts of surfaces in the cells of block `b`.
fn cut_pieces<const D: usize>(
    (b, cut): (usize, &CutBlock<D>),
    (grid, frame): (&Grid<D>, &Frame<D>),
    walls: &Walls<'_, D>,
    host: &impl Fn(u32) -> u32,
    pieces: &mut Vec<Piece<D>>,
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
            let nearest = skin.nearest(&frame.place(key, &at.map(|x| x as f64 + 0.5)));
            let nodes = skin.nodes(nearest.facet).map(|n| n + *first as u32);
            pieces.push(Piece { host, body: k, area, nodes, weights: nearest.weights });
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
    nodes: [u32; D],
    weights: [f64; D],
}

/// Cells and faces near the surfaces of deformable bodies in a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wetted<const D: usize> {
    pieces: Vec<Piece<D>>,
    faces: Vec<Face<D>>,
    /// Shares of the nodes of each body in its wetted surface.
    shares: Vec<Vec<(u32, f64)>>,
}

impl<const D: usize> Wetted<D> {
    /// Find the faces. `skins` has the surface of each body and the first of its nodes.
    pub fn new(grid: &Grid<D>, frame: &Frame<D>, walls: &Walls<'_, D>) -> Self {
        let cells = Blocks::<D>::CELLS;
        let host = hosts(grid, frame, walls);
        let (mut faces, mut pieces) = (Vec::new(), Vec::new());
        for (b, cut) in grid.cuts.iter().enumerate() {
            let Some(cut) = cut else { continue };
            cut_pieces((b, cut), (grid, frame), walls, &host, &mut pieces);
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
        let shares = shares(&pieces, walls.skins.len());
        Wetted { pieces, faces, shares }
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
                piece.nodes.iter().zip(&piece.weights).map(|(n, w)| w * velocities[*n as usize][d]).sum::<f64>()
            };
            (piece.host, (0..D).map(|d| piece.area[d] * of(d)).sum())
        }));
    }

    /// Add the impulses of the liquid to the nodes: of the pressure, of the liquid at closed faces that takes these velocities, and what
    /// the momentum at the other faces says, or at all if the velocities are those at the end of the step. `unit` is rho h^D, kg.
    pub fn add(
        &self,
        (grid, unit): (&Grid<D>, f64),
        velocities: &[[f64; D]],
        ended: bool,
        into: &mut [[f64; D]],
    ) {
        let mut rest = vec![[0.0; D]; self.shares.len()];
        for piece in &self.pieces {
            let impulse = piece.area.map(|a| unit * a * grid.pressure[piece.host as usize]);
            give(&piece.nodes, &piece.weights, &impulse, into);
            (0..D).for_each(|d| rest[piece.body][d] -= impulse[d]);
        }
        for face in &self.faces {
            let (d, slot) = (face.axis, face.slot as usize);
            let mark = grid.marks[d][slot];
            let rest = &mut rest[face.body];
            rest[d] += unit * face.closed * face.push(&grid.pressure);
            if mark == CLOSED {
                let of = |n: &u32| (0..D).map(|e| velocities[*n as usize][e] * face.normal[e]).sum::<f64>();
                let own: f64 = face.nodes.iter().zip(&face.weights).map(|(n, w)| w * of(n)).sum();
                let lag = grid.before[d][slot] - own * face.normal[d];
                let along = unit * grid.volume[d][slot] * lag * face.normal[d];
                let impulse = face.normal.map(|n| along * n);
                give(&face.nodes, &face.weights, &impulse, into);
                if ended {
                    (0..D).for_each(|e| rest[e] -= impulse[e]);
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

    /// What the liquid at the face has gained beside the difference of q over the open part, of a mass of a cell times m/s.
    fn gained(&self, grid: &Grid<D>) -> f64 {
        let q = |cell: u32| grid.pressure.get(cell as usize).copied().unwrap_or(0.0);
        let (d, slot) = (self.axis, self.slot as usize);
        grid.volume[d][slot] * (grid.velocity[d][slot] - grid.before[d][slot])
            + grid.open[d][slot] * (q(self.slot) - q(self.below))
    }
}

/// Divide an impulse among nodes.
fn give<const D: usize>(nodes: &[u32; D], weights: &[f64; D], impulse: &[f64; D], into: &mut [[f64; D]]) {
    for (n, w) in nodes.iter().zip(weights) {
        (0..D).for_each(|d| into[*n as usize][d] += w * impulse[d]);
    }
}
