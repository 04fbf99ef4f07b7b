//! Parts of kernels: gather from nodes to lanes, and scatter back.

use impactite_simd::Pack;
use mpm_materials::{Lane, Mat3, Sym3};

use super::batch::{GROUP, MOST_NODES, Moving, Nodes, OCTET, Record, Row, Rows, lane_mut};
use crate::shape::Modes;

/// Gather positions, and velocities into `rate`, at the corners of an octet from the nodes of its batch.
#[inline(always)]
pub(super) fn gather(
    corners: &[u16],
    nodes: &Nodes,
    (n, d): (usize, usize),
    at: &mut [[Rows; 3]; 8],
    mut rate: Option<&mut [[Rows; 3]; 8]>,
) {
    for (c, corners) in corners.chunks_exact(OCTET).take(n).enumerate() {
        for (k, &n) in corners.iter().enumerate() {
            let Moving(node) = &nodes[n as usize % MOST_NODES];
            for d in 0..d {
                *lane_mut(&mut at[c][d], k) = node[d];
                if let Some(rate) = &mut rate {
                    *lane_mut(&mut rate[c][d], k) = node[4 + d];
                }
            }
        }
    }
}

/// Load lanes of gathered vectors.
#[inline(always)]
pub(super) fn load<P: Pack<f64>>(
    from: &[[Rows; 3]; 8],
    (half, lane): (usize, usize),
    n: usize,
    d: usize,
) -> Modes<P> {
    let mut to = [[P::zero(); 3]; 8];
    for c in 0..n {
        for i in 0..d {
            to[c][i] = P::from_pair(&from[c][i], half, lane);
        }
    }
    to
}

/// Scatter vectors at the corners of some elements of an octet to their nodes, in the order of the elements.
#[inline(always)]
pub(super) fn scatter<P: Pack<f64>>(
    vectors: &Modes<P>,
    extra: Option<P>,
    corners: &[u16],
    (half, lane): (usize, usize),
    n: usize,
    slots: &mut [Record],
) {
    let mut records = [[0.0; 4]; OCTET];
    for c in 0..n {
        let [x, y, z] = vectors[c];
        P::records(x, y, z, extra.unwrap_or(P::zero()), &mut records[..P::WIDTH]);
        let first = c * OCTET + half * GROUP + lane;
        for (record, &n) in records[..P::WIDTH].iter().zip(&corners[first..first + P::WIDTH]) {
            let slot = &mut slots[n as usize];
            for d in 0..4 {
                slot[d] += record[d];
            }
        }
    }
}

/// Convert the displacement gradient A of a step, with respect to the midpoint configuration, to X with respect to its start: X = A (I -
/// A/2)^-1. Laws convert back to A, in which a rotation has no strain ([`Kinematics::increments`](mpm_materials::Kinematics::increments)).
#[inline(always)]
pub(super) fn from_middle<P: Lane>(a: &Mat3<P>, d: usize) -> Mat3<P> {
    let (one, half) = (P::one(), P::of(-0.5));
    let mut x = Mat3::zero();
    let mut rows = [[P::zero(); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            rows[i][j] = if i == j { a.0[i][j].mul_add(half, one) } else { a.0[i][j] * half };
        }
    }
    if d == 2 {
        let [xx, yy, xy, yx] = [rows[0][0], rows[1][1], rows[0][1], rows[1][0]];
        let per = (xx * yy - xy * yx).recip();
        for i in 0..2 {
            x.0[i][0] = (a.0[i][0] * yy - a.0[i][1] * yx) * per;
            x.0[i][1] = (a.0[i][1] * xx - a.0[i][0] * xy) * per;
        }
        x.0[2][2] = a.0[2][2] / rows[2][2];
        return x;
    }
    // Columns of the adjugate are cross products of the rows.
    let adjugate = [
        crate::shape::cross(&rows[1], &rows[2]),
        crate::shape::cross(&rows[2], &rows[0]),
        crate::shape::cross(&rows[0], &rows[1]),
    ];
    let per = crate::shape::dot(&rows[0], &adjugate[0]).recip();
    for i in 0..3 {
        for j in 0..3 {
            let sum = a.0[i][0]
                .mul_add(adjugate[j][0], a.0[i][1].mul_add(adjugate[j][1], a.0[i][2] * adjugate[j][2]));
            x.0[i][j] = sum * per;
        }
    }
    x
}

/// Rotate vectors by the rotation of a step with the midpoint gradient `a`.
#[inline(always)]
pub(super) fn turned<P: Lane>(a: &Mat3<P>, vectors: &mut [[P; 3]], d: usize) {
    let half = P::of(0.5);
    if d == 2 {
        let w = (a.0[1][0] - a.0[0][1]) * half;
        let scale = (w * w).mul_add(P::of(0.25), P::one()).recip();
        let (sine, less) = (w * scale, -(w * w * half * scale));
        for v in vectors {
            let [x, y, z] = *v;
            *v = [x + (less * x - sine * y), y + (less * y + sine * x), z];
        }
        return;
    }
    let w = [(a.0[2][1] - a.0[1][2]) * half, (a.0[0][2] - a.0[2][0]) * half, (a.0[1][0] - a.0[0][1]) * half];
    let turn = mpm_materials::rate::turn(w);
    for v in vectors {
        let old = *v;
        for i in 0..3 {
            let t = &turn.0[i];
            v[i] = old[i] + t[0].mul_add(old[0], t[1].mul_add(old[1], t[2] * old[2]));
        }
    }
}

/// Stress of a point by the law.
#[inline(always)]
pub(super) fn stress_of<P: Pack<f64>>(
    from: &[impactite_simd::RowPair<Row>; 6],
    half: usize,
    lane: usize,
) -> Sym3<P> {
    let mut stress = Sym3::zero();
    for i in 0..6 {
        stress.0[i] = P::from_pair(&from[i], half, lane);
    }
    stress
}

/// Half and first lane of a vector of an octet.
#[inline(always)]
pub(super) fn place<P: Pack<f64>>(vector: usize) -> (usize, usize) {
    (vector * P::WIDTH / GROUP, vector * P::WIDTH % GROUP)
}

/// Reference volumes of the lanes; zero in lanes without an element.
#[inline(always)]
pub(super) fn reference<P: Pack<f64>>(reference: &[Rows], place: usize, half: usize, lane: usize) -> P {
    P::from_pair(&reference[place], half, lane)
}

/// Element means of the nodal averages over the corners of an octet.
#[inline(always)]
pub(super) fn mean_of(corners: &[u16], records: &Nodes, n: usize) -> Rows {
    let mut mean = Rows::default();
    for k in 0..OCTET {
        let sum: f64 = (0..n).map(|c| records[corners[c * OCTET + k] as usize % MOST_NODES].0[3]).sum();
        *lane_mut(&mut mean, k) = sum / n as f64;
    }
    mean
}
