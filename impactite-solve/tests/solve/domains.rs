//! Fluid domains on a grid of cells, for tests and measurements.

use std::sync::Arc;

use impactite_simd::Team;
use impactite_solve::{CellBlocks, Operator, Stencil};

/// Names of the domains.
pub const NAMES: [&str; 10] = [
    "open box",
    "closed tank",
    "ball",
    "dam column",
    "splash",
    "obstacle",
    "random theta",
    "random faces",
    "jump 1000",
    "foam 1000",
];

/// Domains of fluids of one density.
pub const FLUIDS: [&str; 7] =
    ["open box", "closed tank", "ball", "dam column", "splash", "obstacle", "random theta"];

/// Number in [0, 1) from an integer.
pub fn hash(mut x: u64) -> f64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Number in [0, 1) from a cell and a salt.
fn at<const D: usize>(cell: [i32; D], salt: u64) -> f64 {
    hash(cell.iter().fold(salt, |h, x| h.wrapping_mul(0x1_0000_01b3).wrapping_add((*x + 1000) as u64)))
}

fn ball<const D: usize>(p: [f64; D], centre: [f64; 3], radius: f64) -> f64 {
    (0..D).map(|a| (p[a] - centre[a]).powi(2)).sum::<f64>().sqrt() - radius
}

/// Signed distance to the fluid, negative in it, of a point of the unit cube. The last axis is vertical.
fn fluid<const D: usize>(name: &str, p: [f64; D]) -> f64 {
    let up = p[D - 1];
    match name {
        "ball" | "random theta" => ball(p, [0.503, 0.497, 0.501], 0.43),
        "dam column" => (p[0] - 0.41).max(up - 0.63),
        "splash" => {
            let mut d = up - 0.3 - 0.05 * (12.0 * p[0]).sin();
            for k in 0..200 {
                let place = [0, 1, 2].map(|a| hash(7 + 3 * k + a));
                let centre = if D == 2 {
                    [place[0], 0.4 + 0.55 * place[1], 0.0]
                } else {
                    [place[0], place[1], 0.4 + 0.55 * place[2]]
                };
                d = d.min(ball(p, centre, 0.004 + 0.05 * hash(9000 + k).powi(3)));
            }
            d
        }
        "obstacle" => up - 0.71 - 0.05 * (9.0 * p[0]).cos(),
        _ => -1.0,
    }
}

/// Open part of the face between two points.
fn opening<const D: usize>(name: &str, cell: [i32; D], axis: usize, h: f64) -> f64 {
    let solid = |p: [f64; D]| ball(p, [0.55, 0.45, 0.4], 0.23).min(ball(p, [0.1, 0.2, 0.1], 0.3));
    match name {
        "obstacle" => {
            let mut p: [f64; D] = std::array::from_fn(|a| (f64::from(cell[a]) + 0.5) * h);
            p[axis] += 0.5 * h;
            let f = (0.5 + solid(p) / h).clamp(0.0, 1.0);
            if f < 1e-3 { 0.0 } else { f }
        }
        "random faces" => {
            let f = at(cell, 17 + axis as u64);
            if f < 0.1 { 0.0 } else { f * f }
        }
        _ => 1.0,
    }
}

/// Specific volume of a cell relative to that of the light fluid.
fn lightness<const D: usize>(name: &str, cell: [i32; D], h: f64) -> f64 {
    let p: [f64; D] = std::array::from_fn(|a| (f64::from(cell[a]) + 0.5) * h);
    match name {
        "jump 1000" if ball(p, [0.5, 0.45, 0.52], 0.27) < 0.0 => 1e-3,
        "foam 1000" if hash(cell.iter().fold(3, |h, x| h * 977 + (x / 5) as u64)) < 0.5 => 1e-3,
        _ => 1.0,
    }
}

/// Matrix of the domain `name` on a unit cube of n^D cells.
pub fn stencil<const D: usize>(team: &Team, name: &str, n: i32) -> Stencil<D> {
    let h = 1.0 / f64::from(n);
    let count = (n as usize).pow(D as u32);
    let cell_of = |i: usize| -> [i32; D] {
        std::array::from_fn(|a| (i / (n as usize).pow(a as u32) % n as usize) as i32)
    };
    let phi: Vec<f64> =
        (0..count).map(|i| fluid(name, cell_of(i).map(|x| (f64::from(x) + 0.5) * h))).collect();
    let cells = Arc::new(CellBlocks::of_cells((0..count).filter(|i| phi[*i] < 0.0).map(cell_of)));
    let mut weights: [Vec<f64>; D] = std::array::from_fn(|_| vec![0.0; cells.cells()]);
    let mut diagonal = vec![0.0; cells.cells()];
    for i in (0..count).filter(|i| phi[*i] < 0.0) {
        let cell = cell_of(i);
        let slot = cells.find(cell).expect("a fluid cell");
        // A drop in a cell that walls enclose is coupled with nothing: keep it an unknown by a floor of its diagonal.
        for axis in 0..D {
            for up in [false, true] {
                let (step, mut beside) = ((n as usize).pow(axis as u32), cell);
                beside[axis] += if up { 1 } else { -1 };
                let mut w = opening(name, if up { cell } else { beside }, axis, h);
                if !(0..n).contains(&beside[axis]) {
                    let open = name == "open box";
                    diagonal[slot] += if open { 2.0 } else { 0.0 };
                    continue;
                }
                let j = if up { i + step } else { i - step };
                w *= 0.5 * (lightness(name, cell, h) + lightness(name, beside, h));
                if phi[j] < 0.0 {
                    diagonal[slot] += w;
                    if up {
                        weights[axis][slot] = w;
                    }
                } else {
                    let theta = if name == "random theta" {
                        0.01 + 0.99 * at(cell, 91 + axis as u64)
                    } else {
                        (phi[i] / (phi[i] - phi[j])).max(0.01)
                    };
                    diagonal[slot] += w / theta;
                }
            }
        }
    }
    Stencil::new(team, cells, weights, diagonal).expect("a stencil")
}

/// Right-hand side: noise, or smooth.
pub fn source<const D: usize>(team: &Team, stencil: &Stencil<D>, n: i32, smooth: bool) -> Vec<f64> {
    let cells = stencil.cells();
    let value = |slot: usize| {
        let cell = cells.place(slot);
        if stencil.diagonal()[slot] == 0.0 {
            return 0.0;
        }
        if smooth {
            let p: [f64; D] = cell.map(|x| (f64::from(x) + 0.5) / f64::from(n));
            1.0 + (3.0 * p[0]).cos() * (4.0 * p[1]).sin()
        } else {
            2.0 * at(cell, 5) - 1.0
        }
    };
    let mut b: Vec<f64> = (0..cells.cells()).map(value).collect();
    stencil.project(team, &mut b);
    b
}
