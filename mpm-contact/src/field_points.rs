//! Particles near the nodes of a block, field by field, for normals.

use std::ops::Range;

use impactite_simd::Float;

use crate::places::Places;
use crate::vector::{difference, dot, length, times};

/// Run of particles that are near the same nodes.
#[derive(Clone, Copy, Debug)]
struct Run {
    nodes: u64,
    start: usize,
    end: usize,
    /// Sum of the centres.
    sum: [f64; 3],
}

/// End of a field in the list of runs, and the largest half size of its particles, in cells.
#[derive(Clone, Copy, Debug)]
struct Field {
    runs: usize,
    radius: f64,
}

/// Particles of the fields of a block near their selected nodes, visited once for all nodes and pairs. Scratch memory of a [`NormalRule`],
/// cleared for every block, kept allocated.
///
/// [`NormalRule`]: crate::NormalRule
#[derive(Clone, Debug, Default)]
pub struct FieldPoints {
    /// Centres in cells.
    centres: Vec<[f64; 3]>,
    runs: Vec<Run>,
    fields: Vec<Field>,
}

impl FieldPoints {
    /// Collect the particles of every field near its `nodes` (bit set).
    pub(crate) fn collect<T: Float, const D: usize>(&mut self, at: &dyn Places<T, D>, nodes: &[u64]) {
        let FieldPoints { centres, runs, fields } = self;
        centres.clear();
        runs.clear();
        fields.clear();
        let per_cell = 1.0 / at.spacing();
        for (field, &nodes) in nodes.iter().enumerate() {
            let (first, mut radius) = (runs.len(), T::of(0.0));
            if nodes != 0 {
                at.near_points(field, nodes, &mut |nodes, near| {
                    let start = centres.len();
                    let x = near.offset.map(|x| x.to_double() * per_cell);
                    centres.push(x);
                    radius = if near.radius > radius { near.radius } else { radius };
                    match runs[first..].last_mut().filter(|r| r.nodes == nodes) {
                        Some(run) => {
                            run.end = start + 1;
                            (0..3).for_each(|d| run.sum[d] += x[d]);
                        }
                        None => runs.push(Run { nodes, start, end: start + 1, sum: x }),
                    }
                });
            }
            fields.push(Field { runs: runs.len(), radius: radius.to_double() * per_cell });
        }
    }

    /// Particles of a field.
    pub(crate) fn of(&self, field: usize) -> PointsOf<'_> {
        let first = if field == 0 { 0 } else { self.fields[field - 1].runs };
        let Field { runs, radius } = self.fields[field];
        PointsOf { centres: &self.centres, runs: &self.runs[first..runs], radius }
    }

    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        self.centres.capacity() * size_of::<[f64; 3]>()
            + self.runs.capacity() * size_of::<Run>()
            + self.fields.capacity() * size_of::<Field>()
    }
}

/// Particles of one field.
#[derive(Clone, Copy)]
pub(crate) struct PointsOf<'a> {
    centres: &'a [[f64; 3]],
    runs: &'a [Run],
    /// Largest half size of the particles, in cells.
    pub radius: f64,
}

/// Particles of one field near a node: ranges of its centres.
#[derive(Default)]
pub(crate) struct NearNode {
    ranges: Vec<Range<usize>>,
    /// Mean of the centres; zero without any.
    middle: [f64; 3],
}

impl<'a> PointsOf<'a> {
    /// Select the particles near a node.
    pub fn select(self, node: usize, near: &mut NearNode) {
        near.ranges.clear();
        let (mut sum, mut count) = ([0.0; 3], 0);
        for run in self.runs.iter().filter(|r| r.nodes >> node & 1 != 0) {
            (0..3).for_each(|d| sum[d] += run.sum[d]);
            count += run.end - run.start;
            near.ranges.push(run.start..run.end);
        }
        near.middle = times(sum, 1.0 / count.max(1) as f64);
    }
    /// Centres of selected particles, run by run.
    pub fn runs(self, near: &NearNode) -> impl Iterator<Item = &'a [[f64; 3]]> {
        near.ranges.iter().map(move |range| &self.centres[range.clone()])
    }
    /// Largest x . direction of the centres x of selected particles.
    fn end(self, near: &NearNode, direction: [f64; 3]) -> f64 {
        let mut end = f64::NEG_INFINITY;
        for range in &near.ranges {
            for x in &self.centres[range.clone()] {
                let along = dot(*x, direction);
                end = if along > end { along } else { end };
            }
        }
        end
    }
}

/// True if the hulls of two fields' centres near a node are farther apart than `room`, in cells, since a slab as thick across the line of
/// their middles separates them. False says nothing.
pub(crate) fn are_apart(sides: &[PointsOf<'_>; 2], near: &[NearNode; 2], room: f64) -> bool {
    if near.iter().any(|near| near.ranges.is_empty()) {
        return false;
    }
    let v = difference(near[1].middle, near[0].middle);
    let slab = -sides[1].end(&near[1], times(v, -1.0)) - sides[0].end(&near[0], v);
    slab > 0.0 && slab.is_finite() && slab > room * length(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_see_the_particles_of_their_runs_alone() {
        let run = |nodes, start: usize, x: &[[f64; 3]]| Run {
            nodes,
            start,
            end: start + x.len(),
            sum: x.iter().fold([0.0; 3], |sum, x| crate::vector::sum(sum, *x)),
        };
        let centres = [[0.0; 3], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let first = [run(0b11, 0, &centres[..2])];
        let second = [run(0b01, 2, &centres[2..3]), run(0b10, 3, &centres[3..])];
        let side = |runs| PointsOf { centres: &centres, runs, radius: 0.0 };
        let sides = [side(&first[..]), side(&second[..])];
        let mut near = [NearNode::default(), NearNode::default()];
        let mut apart = |node: usize, room: f64| {
            (0..2).for_each(|s| sides[s].select(node, &mut near[s]));
            are_apart(&sides, &near, room)
        };
        assert!(apart(1, 0.999) && !apart(1, 1.001));
        // The slab across the line of the middles is thinner than the distance of 2.
        assert!(apart(0, 1.93) && !apart(0, 1.95));
        assert!(!apart(2, 0.1), "no particles");
    }
}
