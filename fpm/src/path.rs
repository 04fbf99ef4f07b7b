//! Path of a crack tip, from the faces that opened.

use std::collections::HashMap;

use crate::fracture::Crack;
use crate::vector::{difference, norm};

/// Position of a crack tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip<const D: usize> {
    /// Time of arrival, s.
    pub time: f64,
    /// Position in the reference configuration, m.
    pub position: [f64; D],
    /// Distance from the start, m.
    pub distance: f64,
}

/// Path of a crack tip from a start: every connected face that was farther from there than all before.
///
/// Every face of [`Fpm::cracks`](crate::Fpm::cracks) has the times of its onset and of its loss of tension, so that a path can be computed
/// at any time, also after a run.
#[derive(Clone, Debug, PartialEq)]
pub struct TipPath<const D: usize> {
    tips: Vec<Tip<D>>,
}

impl<const D: usize> TipPath<D> {
    /// Create a path from a place, m, the end of a notch. `when` returns the time at which a face became part of the crack, s
    /// ([`Crack::opened`] or [`Crack::parted`]); faces with `None` are left out. Notches are part of the crack from the start. Faces are
    /// connected if their centroids are as near as those of adjacent faces; faces ahead of the crack count when it reaches them. Without a
    /// notch the path begins with the first face.
    pub fn new(cracks: &[Crack<D>], start: [f64; D], when: impl Fn(&Crack<D>) -> Option<f64>) -> Self {
        let time = |c: &Crack<D>| if c.opened.is_none() { Some(f64::NEG_INFINITY) } else { when(c) };
        let mut faces: Vec<(f64, &Crack<D>)> = cracks.iter().filter_map(|c| Some((time(c)?, c))).collect();
        faces.sort_by(|a, b| a.0.total_cmp(&b.0));
        let longest = faces.iter().map(|(_, c)| size(c)).fold(0.0, f64::max);
        let mut groups = Groups::<D>::new(NEAR * longest);
        let mut tips = Vec::<Tip<D>>::new();
        for (time, crack) in faces {
            let distance = norm(&difference(&crack.reference, &start));
            let notch = crack.opened.is_none();
            // A notch is behind the tip at any time.
            let face = groups.join(crack, if notch { (0.0, start) } else { (distance, crack.reference) });
            if notch {
                groups.unite(0, face);
            }
            let root = groups.root(0);
            if notch || groups.root(face) != root {
                continue;
            }
            let (distance, position) = groups.farthest[root];
            if tips.last().is_none_or(|tip| distance > tip.distance) {
                // Keep the farthest of simultaneous positions.
                if tips.last().is_some_and(|tip| tip.time == time) {
                    tips.pop();
                }
                tips.push(Tip { time, position, distance });
            }
        }
        TipPath { tips }
    }

    /// All positions, in order of time.
    #[must_use]
    pub fn tips(&self) -> &[Tip<D>] {
        &self.tips
    }

    /// Speed of the tip, m/s: slope of the least-squares line through its distances within half a `window` (s) of a time; `None` with fewer
    /// than three.
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

/// Largest distance of the centroids of adjacent faces over their mean size: below one for faces that share a corner in the plane.
const NEAR: f64 = 1.25;

/// Length of a face, or edge of a square of its area, m.
fn size<const D: usize>(crack: &Crack<D>) -> f64 {
    crack.area.powf(1.0 / (D as f64 - 1.0))
}

/// Groups of connected faces (union-find).
struct Groups<const D: usize> {
    /// Centroids and sizes, m.
    faces: Vec<([f64; D], f64)>,
    /// Parent of each face in its group, itself for a root; farthest place of the group of a root, m.
    parents: Vec<usize>,
    farthest: Vec<(f64, [f64; D])>,
    /// Faces in boxes of this edge, m.
    boxes: HashMap<[i64; D], Vec<usize>>,
    edge: f64,
}

impl<const D: usize> Groups<D> {
    fn new(edge: f64) -> Self {
        let (faces, parents, farthest) = (Vec::new(), Vec::new(), Vec::new());
        Groups { faces, parents, farthest, boxes: HashMap::new(), edge }
    }

    /// Return the root of the group of a face.
    fn root(&mut self, face: usize) -> usize {
        let mut root = face;
        while self.parents[root] != root {
            root = self.parents[root];
        }
        self.parents[face] = root;
        root
    }

    /// Unite two groups.
    fn unite(&mut self, a: usize, b: usize) {
        let [a, b] = [a, b].map(|face| self.root(face));
        self.parents[b] = a;
        if self.farthest[b].0 > self.farthest[a].0 {
            self.farthest[a] = self.farthest[b];
        }
    }

    /// Add a face, with its distance from the start and its place, to the groups of adjacent faces. Return its number.
    fn join(&mut self, crack: &Crack<D>, far: (f64, [f64; D])) -> usize {
        let (x, size, face) = (crack.reference, size(crack), self.faces.len());
        self.faces.push((x, size));
        self.parents.push(face);
        self.farthest.push(far);
        let at: [i64; D] = std::array::from_fn(|d| (x[d] / self.edge).floor() as i64);
        for side in 0..3usize.pow(D as u32) {
            let there = std::array::from_fn(|d| at[d] + (side / 3usize.pow(d as u32) % 3) as i64 - 1);
            for other in self.boxes.get(&there).cloned().unwrap_or_default() {
                let (y, other_size) = self.faces[other];
                if norm(&difference(&x, &y)) <= NEAR * 0.5 * (size + other_size) {
                    self.unite(other, face);
                }
            }
        }
        self.boxes.entry(at).or_default().push(face);
        face
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tip_goes_on_and_neither_branches_behind_nor_faces_ahead_count() {
        let crack = |(time, x): (f64, f64)| Crack {
            cells: [0, 1],
            position: [x, 0.0],
            reference: [x, 0.0],
            normal: [0.0, 1.0],
            area: 1.0,
            opened: (time >= 0.0).then_some(time),
            parted: (time >= 0.0).then_some(time),
            gap: [0.0; 2],
            damage: 1.0,
        };
        // A notch, successive faces, a branch behind, and one far ahead that the crack never reaches; that at 5.5 is there before the
        // crack.
        let faces =
            [(-1.0, 0.5), (0.5, 5.5), (1.0, 1.5), (1.1, 9.0), (1.5, 2.5), (1.6, 0.7), (2.0, 3.0), (2.0, 3.5)];
        let mut cracks: Vec<Crack<2>> = faces.map(crack).to_vec();
        let of = |cracks: &[Crack<2>]| TipPath::new(cracks, [0.0, 0.0], |c| c.opened);
        let distances = |path: &TipPath<2>| path.tips().iter().map(|t| t.distance).collect::<Vec<f64>>();
        assert_eq!(distances(&of(&cracks)), [1.5, 2.5, 3.5]);
        cracks.push(crack((2.5, 4.5)));
        let path = of(&cracks);
        assert_eq!(distances(&path), [1.5, 2.5, 3.5, 5.5]);
        assert_eq!(path.tips()[3].time, 2.5);
        assert!((path.speed(1.5, 1.0).expect("a speed") - 2.0).abs() < 1e-12);
        assert_eq!(path.speed(9.0, 1.0), None);
    }
}
