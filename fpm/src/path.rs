//! The way of a crack's tip, from the faces that opened.

use crate::fracture::Crack;
use crate::vector::{difference, norm};

/// Where the tip of a crack was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip<const D: usize> {
    /// When it came there, s.
    pub time: f64,
    /// Where, m, in the reference configuration.
    pub position: [f64; D],
    /// How far that is from the start, m.
    pub distance: f64,
}

/// The way of a crack's tip from a start: every face that opened farther from there than all before.
///
/// Every face of [`Fpm::cracks`](crate::Fpm::cracks) says when it opened, so that this may be asked for at any time, also after a run.
#[derive(Clone, Debug, PartialEq)]
pub struct TipPath<const D: usize> {
    tips: Vec<Tip<D>>,
}

impl<const D: usize> TipPath<D> {
    /// From a place, m, the end of a notch, among those of the `cracks` for which `belongs` holds.
    pub fn new(cracks: &[Crack<D>], start: [f64; D], belongs: impl Fn(&Crack<D>) -> bool) -> Self {
        let mut opened: Vec<(f64, [f64; D])> = Vec::new();
        for crack in cracks.iter().filter(|c| belongs(c)) {
            if let Some(time) = crack.opened {
                opened.push((time, crack.reference));
            }
        }
        opened.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut tips: Vec<Tip<D>> = Vec::new();
        for (time, position) in opened {
            let distance = norm(&difference(&position, &start));
            if tips.last().is_none_or(|tip| distance > tip.distance) {
                // Of those that opened together the farthest.
                if tips.last().is_some_and(|tip| tip.time == time) {
                    tips.pop();
                }
                tips.push(Tip { time, position, distance });
            }
        }
        TipPath { tips }
    }

    /// All of it, in order of time.
    #[must_use]
    pub fn tips(&self) -> &[Tip<D>] {
        &self.tips
    }

    /// The speed of the tip, m/s: the slope of the line of least squares through its distances within half a `window` (s) of a time; nothing
    /// with fewer than three.
    #[must_use]
    pub fn speed(&self, time: f64, window: f64) -> Option<f64> {
        let within: Vec<&Tip<D>> =
            self.tips.iter().filter(|t| (t.time - time).abs() <= 0.5 * window).collect();
        if within.len() < 3 {
            return None;
        }
        let count = within.len() as f64;
        let mean = |of: &dyn Fn(&Tip<D>) -> f64| within.iter().map(|t| of(t)).sum::<f64>() / count;
        let (t, x) = (mean(&|p| p.time), mean(&|p| p.distance));
        let along: f64 = within.iter().map(|p| (p.time - t) * (p.distance - x)).sum();
        let square: f64 = within.iter().map(|p| (p.time - t).powi(2)).sum();
        (square > 0.0).then(|| along / square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tip_goes_on_and_a_branch_behind_it_does_not_count() {
        let crack = |time: f64, x: f64| Crack {
            cells: [0, 1],
            position: [x, 0.0],
            reference: [x, 0.0],
            normal: [0.0, 1.0],
            area: 1.0,
            opened: (time >= 0.0).then_some(time),
            gap: [0.0; 2],
            damage: 1.0,
        };
        let cracks = [(-1.0, 0.0), (1.0, 1.5), (1.5, 2.5), (1.6, 0.7), (2.0, 3.0), (2.0, 3.5), (2.5, 4.5)];
        let cracks: Vec<Crack<2>> = cracks.into_iter().map(|(t, x)| crack(t, x)).collect();
        let path = TipPath::new(&cracks, [0.0, 0.0], |_| true);
        let distances: Vec<f64> = path.tips().iter().map(|t| t.distance).collect();
        assert_eq!(distances, [1.5, 2.5, 3.5, 4.5]);
        assert!((path.speed(1.75, 2.0).expect("a speed") - 2.0).abs() < 1e-12);
        assert_eq!(path.speed(9.0, 1.0), None);
    }
}
