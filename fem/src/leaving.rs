//! Elements removed from their mesh by conversion, and their data.

use impactite_geometry::ElementKind;
use mpm_materials::material::Material;

use crate::erosion::{Test, met};
use crate::sweep::{Batch, Reason, Scratch};

/// Converted element: its data at the time of removal.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvertedElement<const D: usize> {
    /// Number in the body.
    pub number: usize,
    /// Kind of element.
    pub kind: ElementKind,
    /// Number of the criterion: the one satisfied, or that of the mark ([`ElementBody::mark`](crate::ElementBody::mark)).
    pub criterion: usize,
    /// Node numbers.
    pub nodes: Vec<u32>,
    /// Node positions at rest, m.
    pub rest: Vec<[f64; D]>,
    /// Node positions, m.
    pub positions: Vec<[f64; D]>,
    /// Node velocities, m/s.
    pub velocities: Vec<[f64; D]>,
    /// Lumped masses of the element at its nodes, kg, which were subtracted from the nodes.
    pub masses: Vec<f64>,
    /// Reference volume of each integration point, m^3 (per metre of depth, per radian): of 2^D points the first axis changes fastest.
    pub volumes: Vec<f64>,
    /// State variables of the integration points, one point after another.
    pub states: Vec<f64>,
    /// Internal energy, hourglass energy included, J.
    pub energy: f64,
    /// Hourglass energy, J.
    pub hourglass: f64,
}

/// Conversion criteria and marks of a body, and its converted elements.
#[derive(Debug, Default)]
pub(crate) struct Converting<const D: usize> {
    pub tests: Vec<Test>,
    /// Mark of each element: zero, or one plus the number of its conversion criterion.
    pub marks: Vec<u32>,
    pub marked: bool,
    /// True for each removed element.
    pub gone: Vec<bool>,
    /// Number of elements at each node.
    pub elements_at: Vec<u32>,
    /// Neighbour across each facet of each element, six entries an element: the element and its facet, or none.
    pub beyond: Vec<Option<(u32, u8)>>,
    /// Converted elements that were not collected yet.
    pub left: Vec<ConvertedElement<D>>,
}

impl<const D: usize> Converting<D> {
    /// Elements of a batch to convert, each with its criterion.
    pub fn leaving(
        &self,
        material: &dyn Material<f64>,
        points: usize,
        (batch, scratch): (&Batch, &Scratch),
        numbers: &[u32],
    ) -> Vec<(usize, Reason)> {
        if self.tests.is_empty() && !self.marked {
            return Vec::new();
        }
        let first = |e: usize| -> Option<u32> {
            let mark = self.marks.get(numbers[e] as usize).copied().unwrap_or(0);
            if mark > 0 {
                return Some(mark - 1);
            }
            let by = self.tests.iter().position(|t| met(t, e, (material, points), batch, scratch));
            by.map(|by| by as u32)
        };
        let alive = (0..batch.elements).filter(|&e| batch.alive(e, points));
        alive.filter_map(|e| Some((e, Reason::Conversion(first(e)?)))).collect()
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        (self.marks.capacity() + self.elements_at.capacity()) * 4
            + self.beyond.capacity() * size_of::<Option<(u32, u8)>>()
    }

    /// Update `marked` after a change of the marks.
    pub(crate) fn see_marks(&mut self) {
        self.marked = self.marks.iter().any(|mark| *mark > 0);
    }
}
