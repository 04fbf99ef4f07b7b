//! Smoothed motion of the surfaces of deformable bodies.

use std::collections::BTreeMap;

use impactite_solve::least_squares_weights;

use super::skin::Skin;

/// Distance along the surface, in cells of the liquid, of the nodes that the motion of a node is averaged over.
pub(crate) const RADIUS: f64 = 2.0;
/// Variance, over the square of the distance, below which the surface is flat.
const FLAT: f64 = 1e-6;

/// Weights of the nodes of surfaces, node by node: the liquid has the surface X + sum w_k (x_k - X_k) for the places X at the start, and the
/// nodes have the impulses of the liquid by the same weights.
///
/// The weights of a moving least squares fit over two cells of the liquid are exact for rigid and affine motion. Momentum, angular momentum and
/// work of the liquid are then those of the bodies, and the pressure neither moves nor resists a wave of the surface that its cells do not resolve.
/// Without it meshes finer than the cells gain energy from the liquid in such waves. Nodes farther apart than that keep their motion.
#[derive(Debug, Default)]
pub(crate) struct Smoothing {
    starts: Vec<usize>,
    entries: Vec<(u32, f64)>,
}

impl Smoothing {
    /// Find the weights for surfaces whose first nodes are `first` among all, with averages over the distance `radius`, m.
    pub fn new<const D: usize>(skins: &[(Skin<D>, usize)], radius: f64) -> Self {
        let mut all = Smoothing { starts: vec![0], entries: Vec::new() };
        for (skin, first) in skins {
            let places = skin.places();
            let mut beside = vec![Vec::new(); places.len()];
            for facet in 0..skin.facets() {
                let nodes = skin.nodes(facet);
                for (a, b) in
                    nodes.iter().flat_map(|a| nodes.iter().map(move |b| (a, b))).filter(|(a, b)| a != b)
                {
                    beside[*a as usize].push(*b);
                }
            }
            for from in 0..places.len() {
                let near = within(from as u32, radius, places, &beside);
                let points: Vec<[f64; D]> = near.keys().map(|n| places[*n as usize]).collect();
                let mut weights: Vec<f64> =
                    near.values().map(|distance| (1.0 - (distance / radius).powi(2)).powi(2)).collect();
                least_squares_weights(&places[from], FLAT * radius * radius, &points, &mut weights);
                all.entries.extend(near.keys().map(|n| *n + *first as u32).zip(weights));
                all.starts.push(all.entries.len());
            }
        }
        all
    }

    fn of(&self, node: usize) -> &[(u32, f64)] {
        &self.entries[self.starts[node]..self.starts[node + 1]]
    }

    /// Averages of vectors at the nodes.
    pub fn average<const D: usize>(&self, vectors: &[[f64; D]]) -> Vec<[f64; D]> {
        (0..vectors.len())
            .map(|node| {
                self.of(node).iter().fold([0.0; D], |sum, (n, w)| {
                    std::array::from_fn(|d| sum[d] + w * vectors[*n as usize][d])
                })
            })
            .collect()
    }

    /// Impulses on the nodes by those on their averages.
    pub fn spread<const D: usize>(&self, impulses: &[[f64; D]]) -> Vec<[f64; D]> {
        let mut out = vec![[0.0; D]; impulses.len()];
        for (node, impulse) in impulses.iter().enumerate() {
            for (n, w) in self.of(node) {
                (0..D).for_each(|d| out[*n as usize][d] += w * impulse[d]);
            }
        }
        out
    }

    pub fn bytes(&self) -> usize {
        self.starts.capacity() * size_of::<usize>() + self.entries.capacity() * size_of::<(u32, f64)>()
    }
}

/// Nodes less than `radius` away along edges, with their distances, m.
fn within<const D: usize>(
    from: u32,
    radius: f64,
    places: &[[f64; D]],
    beside: &[Vec<u32>],
) -> BTreeMap<u32, f64> {
    let mut found = BTreeMap::from([(from, 0.0)]);
    let mut front = vec![from];
    while let Some(node) = front.pop() {
        let (here, at) = (places[node as usize], found[&node]);
        for &next in &beside[node as usize] {
            let there = &places[next as usize];
            let edge = (0..D).map(|d| (there[d] - here[d]).powi(2)).sum::<f64>().sqrt();
            let distance = at + edge;
            if distance < radius && found.get(&next).is_none_or(|known| distance < *known) {
                found.insert(next, distance);
                front.push(next);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn affine_motion_stays_and_short_waves_vanish() {
        // A disc of 64 nodes.
        let places: Vec<[f64; 2]> = (0..64)
            .map(|n| {
                let (sin, cos) = (f64::from(n) * std::f64::consts::PI / 32.0).sin_cos();
                [cos, sin]
            })
            .collect();
        let skin = Skin::new((0..64).map(|n| [n, (n + 1) % 64]).collect(), places.clone()).unwrap();
        let smoothing = Smoothing::new(&[(skin, 0)], 0.4);
        let affine: Vec<[f64; 2]> =
            places.iter().map(|x| [0.3 - x[0] + 2.0 * x[1], 0.5 * x[0] + x[1] - 1.0]).collect();
        for (a, b) in smoothing.average(&affine).iter().zip(&affine) {
            assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9, "{a:?} {b:?}");
        }
        let wave: Vec<[f64; 2]> = (0..64).map(|n| [if n % 2 == 0 { 1.0 } else { -1.0 }, 0.0]).collect();
        let left = smoothing.average(&wave).iter().map(|v| v[0].abs()).fold(0.0, f64::max);
        assert!(left < 0.1, "{left}");
        // The work is the same.
        let impulses: Vec<[f64; 2]> = (0..64).map(|n| [f64::from(n % 7), f64::from(n % 5)]).collect();
        let work = |a: &[[f64; 2]], b: &[[f64; 2]]| {
            a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum::<f64>()
        };
        let (liquid, body) =
            (work(&impulses, &smoothing.average(&affine)), work(&smoothing.spread(&impulses), &affine));
        assert!((liquid - body).abs() < 1e-9 * liquid.abs());
    }
}
