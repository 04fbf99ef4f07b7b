//! Fragments of a body: particles nearer to each other than a given reach belong together.

use std::collections::HashMap;

/// Fragments of a set of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fragments {
    /// Fragment of each point, 0 for the heaviest; `None` for points that connect to no other.
    pub of: Vec<Option<usize>>,
    /// Masses of the fragments, kg, in descending order.
    pub masses: Vec<f64>,
}

impl Fragments {
    /// Group points at these positions, m, with these masses, kg, within `reach`, m; only points with `holds` connect.
    #[must_use]
    pub fn new(places: &[[f64; 3]], masses: &[f64], holds: &[bool], reach: f64) -> Self {
        let cell = |x: &[f64; 3]| x.map(|c| (c / reach).floor() as i64);
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (n, x) in places.iter().enumerate().filter(|&(n, _)| holds[n]) {
            cells.entry(cell(x)).or_default().push(n);
        }
        let mut of = vec![None; places.len()];
        let mut sums: Vec<(f64, usize)> = Vec::new();
        for first in (0..places.len()).filter(|&n| holds[n]) {
            if of[first].is_some() {
                continue;
            }
            let piece = sums.len();
            let (mut open, mut mass) = (vec![first], 0.0);
            of[first] = Some(piece);
            while let Some(n) = open.pop() {
                mass += masses[n];
                let at = cell(&places[n]);
                for k in 0..27_i64 {
                    let near = [at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1];
                    for &m in cells.get(&near).map_or(&[][..], Vec::as_slice) {
                        let square = |d: usize| (places[m][d] - places[n][d]).powi(2);
                        if of[m].is_none() && square(0) + square(1) + square(2) <= reach * reach {
                            of[m] = Some(piece);
                            open.push(m);
                        }
                    }
                }
            }
            sums.push((mass, piece));
        }
        sums.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut rank = vec![0; sums.len()];
        for (place, &(_, piece)) in sums.iter().enumerate() {
            rank[piece] = place;
        }
        let of = of.into_iter().map(|piece| piece.map(|p: usize| rank[p])).collect();
        Fragments { of, masses: sums.into_iter().map(|(mass, _)| mass).collect() }
    }

    /// Count the fragments heavier than `mass`, kg.
    #[must_use]
    pub fn heavier(&self, mass: f64) -> usize {
        self.masses.iter().filter(|&&m| m > mass).count()
    }
}

/// Sample failure strains of `count` sections of a body after Mott: the hazard grows with the strain as exp(g eps), g =
/// `rate`; most sections fail near `mode`, none below a hundredth of it. Deterministic for a given seed.
#[must_use]
pub fn mott_strains(mode: f64, rate: f64, seed: u64, count: usize) -> Vec<f64> {
    let strain = |k: usize| mode + (-random(seed, k as u64).ln()).ln() / rate;
    (0..count).map(|k| strain(k).max(0.01 * mode)).collect()
}

/// Return a pseudo-random number in (0, 1) from a seed and an index (SplitMix64).
fn random(seed: u64, place: u64) -> f64 {
    let mut z = seed.wrapping_add((place + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + 0.5 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of the strains lie below the median of Gumbel's distribution, ln(ln 2) / g from the mode.
    #[test]
    fn strains_are_scattered_as_mott_has_them() {
        let strains = mott_strains(0.5, 20.0, 7, 4000);
        let median = 0.5 + std::f64::consts::LN_2.ln() / 20.0;
        let below = strains.iter().filter(|&&s| s < median).count() as f64 / 4000.0;
        // Three standard deviations of a fair coin.
        assert!((below - 0.5).abs() < 1.5 / 4000f64.sqrt(), "{below}");
    }

    /// Row of ten points at unit distance, one of which connects to no other, and a distant point.
    #[test]
    fn a_row_breaks_where_a_point_holds_nothing() {
        let mut places: Vec<[f64; 3]> = (0..10).map(|n| [f64::from(n) - 4.0, 0.0, 0.5]).collect();
        places.push([0.0, 3.0, 0.0]);
        let mut holds = vec![true; 11];
        let pieces = Fragments::new(&places, &[1.0; 11], &holds, 1.4);
        assert_eq!(pieces.masses, [10.0, 1.0]);
        holds[3] = false;
        let pieces = Fragments::new(&places, &[1.0; 11], &holds, 1.4);
        assert_eq!(pieces.masses, [6.0, 3.0, 1.0]);
        assert_eq!(pieces.of[2..5], [Some(1), None, Some(0)]);
        assert_eq!(pieces.heavier(2.0), 2);
        assert_eq!(Fragments::new(&places, &[1.0; 11], &holds, 2.1).masses, [9.0, 1.0]);
    }
}
