//! Which elements of a body leave their mesh, and what they take with them.

use impactite_geometry::ElementKind;
use mpm_materials::material::Material;

use crate::erosion::{Test, met};
use crate::sweep::{Batch, Reason, Scratch};

/// An element that left its mesh, as it was then.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvertedElement<const D: usize> {
    /// Its number in the body.
    pub number: usize,
    /// Its kind.
    pub kind: ElementKind,
    /// The number of the criterion that it met, or was marked with ([`ElementBody::mark`](crate::ElementBody::mark)).
    pub criterion: usize,
    /// Its nodes.
    pub nodes: Vec<u32>,
    /// Where they were at rest, m.
    pub rest: Vec<[f64; D]>,
    /// Where they are, m.
    pub positions: Vec<[f64; D]>,
    /// Their velocities, m/s.
    pub velocities: Vec<[f64; D]>,
    /// What they weigh by this element, kg: they weigh that less from then on.
    pub masses: Vec<f64>,
    /// Reference volume of each integration point, m^3 (per metre of depth, per radian): of 2^D points the first axis changes fastest.
    pub volumes: Vec<f64>,
    /// The states of those, one behind the other.
    pub states: Vec<f64>,
    /// Internal energy by the law and of hourglass forces, J.
    pub energy: f64,
    /// That of hourglass forces, J.
    pub hourglass: f64,
}

/// What makes elements of a body leave, and those that did.
#[derive(Debug, Default)]
pub(crate) struct Converting<const D: usize> {
    pub tests: Vec<Test>,
    /// Of each element: zero, or one more than the criterion it is to leave by.
    pub marks: Vec<u32>,
    pub marked: bool,
    /// Which elements are not there any more.
    pub gone: Vec<bool>,
    /// Elements at each node.
    pub elements_at: Vec<u32>,
    /// Beyond each facet of each element, six an element: the element and its facet, or nobody.
    pub beyond: Vec<Option<(u32, u8)>>,
    /// Those that left and were not taken yet.
    pub left: Vec<ConvertedElement<D>>,
}

impl<const D: usize> Converting<D> {
    /// The elements of a batch that leave, with their criterion.
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

    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        (self.marks.capacity() + self.elements_at.capacity()) * 4
            + self.beyond.capacity() * size_of::<Option<(u32, u8)>>()
    }

    /// After marks were read.
    pub(crate) fn see_marks(&mut self) {
        self.marked = self.marks.iter().any(|mark| *mark > 0);
    }
}
