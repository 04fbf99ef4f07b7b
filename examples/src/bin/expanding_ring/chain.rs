//! Reference ring without grid or elements of the library: masses on a circle, joined by bars of uniaxial stress, elastic
//! and perfectly plastic. A bar is as long as a cell, and breaks at the failure strain of its section of the ring.

use crate::setup::{Break, POISSON};

#[derive(Clone, Copy)]
struct Bar {
    plastic: f64,
    broken: bool,
}

/// Count the pieces at `end`, s, for sections with these failure strains.
pub fn pieces(setup: &Break, strains: &[f64], end: f64) -> usize {
    let parts = setup.cells as usize;
    let strains: Vec<f64> = strains.iter().flat_map(|&s| std::iter::repeat_n(s, parts)).collect();
    let n = strains.len();
    let metal = setup.metal;
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let mut x: Vec<[f64; 2]> =
        (0..n).map(|k| [setup.radius * angle(k).cos(), setup.radius * angle(k).sin()]).collect();
    let mut v: Vec<[f64; 2]> =
        (0..n).map(|k| [metal.speed * angle(k).cos(), metal.speed * angle(k).sin()]).collect();
    let length = |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]).hypot(b[1] - a[1]);
    let first = length(x[0], x[1]);
    let area = setup.thickness * setup.thickness;
    let mass = metal.density * area * first;
    let dt = 0.3 * first / (metal.young / metal.density).sqrt();
    let mut bars = vec![Bar { plastic: 0.0, broken: false }; n];
    let mut time = 0.0;
    while time < end {
        let mut force = vec![[0.0; 2]; n];
        for (k, bar) in bars.iter_mut().enumerate().filter(|(_, bar)| !bar.broken) {
            let other = (k + 1) % n;
            let now = length(x[k], x[other]);
            let elastic = (now / first).ln() - bar.plastic;
            let sigma = (metal.young * elastic).clamp(-metal.yields, metal.yields);
            bar.plastic += elastic - sigma / metal.young;
            if bar.plastic >= strains[k] {
                bar.broken = true;
                continue;
            }
            let volume = ((1.0 - 2.0 * POISSON) * sigma / metal.young).exp() * area * first;
            let pull = sigma * volume / (now * now);
            for d in 0..2 {
                let along = pull * (x[other][d] - x[k][d]);
                force[k][d] += along;
                force[other][d] -= along;
            }
        }
        for k in 0..n {
            for d in 0..2 {
                v[k][d] += dt * force[k][d] / mass;
                x[k][d] += dt * v[k][d];
            }
        }
        time += dt;
    }
    let pieces = (0..n).filter(|&k| bars[k].broken && !bars[(k + 1) % n].broken).count();
    pieces.max(1)
}
