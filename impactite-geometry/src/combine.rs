//! Boolean operations: unions, intersections and differences.

use super::bounds::Bounds;
use super::shape::{Metric, Shape};

/// Relative position of two shapes, where it is known for certain.
#[derive(PartialEq)]
enum Relation {
    Apart,
    FirstHoldsSecond,
    SecondHoldsFirst,
    Unknown,
}

/// True if `outer` certainly contains `inner`.
fn holds<const D: usize>(outer: &impl Shape<D>, inner: &impl Shape<D>) -> bool {
    let b = inner.bounds();
    if b.is_empty() {
        return true;
    }
    if !b.is_finite() {
        return false;
    }
    if outer.convex() && b.corners().all(|x| outer.signed_distance(x) <= 0.0) {
        return true;
    }
    let (mut centre, mut square) = ([0.0; D], 0.0);
    for i in 0..D {
        centre[i] = 0.5 * (b.min[i] + b.max[i]);
        square += (b.max[i] - b.min[i]).powi(2);
    }
    outer.signed_distance(centre) <= -0.5 * square.sqrt()
}

fn relation<const D: usize>(a: &impl Shape<D>, b: &impl Shape<D>) -> Relation {
    if a.bounds().apart(&b.bounds()) {
        Relation::Apart
    } else if holds(a, b) {
        Relation::FirstHoldsSecond
    } else if holds(b, a) {
        Relation::SecondHoldsFirst
    } else {
        Relation::Unknown
    }
}

/// Centroid of two weighted centroids; `None` if the weights sum to zero.
fn mean<const D: usize>(a: (f64, [f64; D]), b: (f64, [f64; D])) -> Option<[f64; D]> {
    let total = a.0 + b.0;
    if total <= 0.0 {
        return None;
    }
    let mut x = [0.0; D];
    for i in 0..D {
        x[i] = (a.0 * a.1[i] + b.0 * b.1[i]) / total;
    }
    Some(x)
}

fn weighted<const D: usize>(s: &impl Shape<D>, sign: f64) -> Option<(f64, [f64; D])> {
    Some((sign * s.measure()?, s.centroid()?))
}

/// Union of two shapes. The distance is a lower bound (exact outside if both distances are exact); the
/// measure is known if the bounding boxes are disjoint or one shape certainly contains the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Union<A, B> {
    a: A,
    b: B,
}

/// Intersection of two shapes. The distance is a lower bound (exact inside if both distances are exact); the measure is
/// known if the bounding boxes are disjoint or one shape certainly contains the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection<A, B> {
    a: A,
    b: B,
}

/// Difference: the first shape without the second. The distance is a lower bound; the measure is known if
/// the bounding boxes are disjoint or one shape certainly contains the other. Particle centres on the surface of the second
/// shape belong to the difference, so that `a.minus(b)` and `a.and(b)` partition the particles of `a`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference<A, B> {
    a: A,
    b: B,
}

macro_rules! parts {
    ($name:ident) => {
        impl<A, B> $name<A, B> {
            pub(super) fn new(a: A, b: B) -> Self {
                Self { a, b }
            }
            /// Operands in the order in which they were combined.
            pub fn parts(&self) -> (&A, &B) {
                (&self.a, &self.b)
            }
        }
    };
}
parts!(Union);
parts!(Intersection);
parts!(Difference);

impl<A, B> Union<A, B> {
    fn value<const D: usize>(&self, metric: Metric) -> Option<f64>
    where
        A: Shape<D>,
        B: Shape<D>,
    {
        match relation(&self.a, &self.b) {
            Relation::Apart => Some(metric.measure(&self.a)? + metric.measure(&self.b)?),
            Relation::FirstHoldsSecond => metric.measure(&self.a),
            Relation::SecondHoldsFirst => metric.measure(&self.b),
            Relation::Unknown => None,
        }
    }
}

impl<const D: usize, A: Shape<D>, B: Shape<D>> Shape<D> for Union<A, B> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        self.a.signed_distance(x).min(self.b.signed_distance(x))
    }
    fn signed_distance_within(&self, x: [f64; D], limit: f64) -> f64 {
        self.a.signed_distance_within(x, limit).min(self.b.signed_distance_within(x, limit))
    }
    fn bounds(&self) -> Bounds<D> {
        self.a.bounds().union(&self.b.bounds())
    }
    fn measure(&self) -> Option<f64> {
        self.value(Metric::Cartesian)
    }
    fn centroid(&self) -> Option<[f64; D]> {
        match relation(&self.a, &self.b) {
            Relation::Apart => mean(weighted(&self.a, 1.0)?, weighted(&self.b, 1.0)?),
            Relation::FirstHoldsSecond => self.a.centroid(),
            Relation::SecondHoldsFirst => self.b.centroid(),
            Relation::Unknown => None,
        }
    }
    fn revolved_measure(&self) -> Option<f64> {
        self.value(Metric::Axisymmetric)
    }
    fn contains(&self, x: [f64; D]) -> bool {
        self.a.contains(x) || self.b.contains(x)
    }
    fn contains_row(&self, first: [f64; D], last: &[f64], inside: &mut [bool]) {
        self.a.contains_row(first, last, inside);
        if inside.iter().all(|i| *i) {
            return;
        }
        let mut other = vec![false; inside.len()];
        self.b.contains_row(first, last, &mut other);
        for (i, o) in inside.iter_mut().zip(other) {
            *i |= o;
        }
    }
}

impl<A, B> Intersection<A, B> {
    fn value<const D: usize>(&self, metric: Metric) -> Option<f64>
    where
        A: Shape<D>,
        B: Shape<D>,
    {
        match relation(&self.a, &self.b) {
            Relation::Apart => Some(0.0),
            Relation::FirstHoldsSecond => metric.measure(&self.b),
            Relation::SecondHoldsFirst => metric.measure(&self.a),
            Relation::Unknown => None,
        }
    }
}

impl<const D: usize, A: Shape<D>, B: Shape<D>> Shape<D> for Intersection<A, B> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        self.a.signed_distance(x).max(self.b.signed_distance(x))
    }
    fn signed_distance_within(&self, x: [f64; D], limit: f64) -> f64 {
        self.a.signed_distance_within(x, limit).max(self.b.signed_distance_within(x, limit))
    }
    fn bounds(&self) -> Bounds<D> {
        self.a.bounds().intersection(&self.b.bounds())
    }
    fn measure(&self) -> Option<f64> {
        self.value(Metric::Cartesian)
    }
    fn centroid(&self) -> Option<[f64; D]> {
        match relation(&self.a, &self.b) {
            Relation::FirstHoldsSecond => self.b.centroid(),
            Relation::SecondHoldsFirst => self.a.centroid(),
            Relation::Apart | Relation::Unknown => None,
        }
    }
    fn revolved_measure(&self) -> Option<f64> {
        self.value(Metric::Axisymmetric)
    }
    fn convex(&self) -> bool {
        self.a.convex() && self.b.convex()
    }
    fn contains(&self, x: [f64; D]) -> bool {
        self.a.contains(x) && self.b.contains(x)
    }
    fn contains_row(&self, first: [f64; D], last: &[f64], inside: &mut [bool]) {
        self.a.contains_row(first, last, inside);
        if !inside.iter().any(|i| *i) {
            return;
        }
        let mut other = vec![false; inside.len()];
        self.b.contains_row(first, last, &mut other);
        for (i, o) in inside.iter_mut().zip(other) {
            *i &= o;
        }
    }
}

impl<A, B> Difference<A, B> {
    fn value<const D: usize>(&self, metric: Metric) -> Option<f64>
    where
        A: Shape<D>,
        B: Shape<D>,
    {
        match relation(&self.a, &self.b) {
            Relation::Apart => metric.measure(&self.a),
            Relation::FirstHoldsSecond => Some(metric.measure(&self.a)? - metric.measure(&self.b)?),
            Relation::SecondHoldsFirst => Some(0.0),
            Relation::Unknown => None,
        }
    }
}

impl<const D: usize, A: Shape<D>, B: Shape<D>> Shape<D> for Difference<A, B> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        self.a.signed_distance(x).max(-self.b.signed_distance(x))
    }
    fn signed_distance_within(&self, x: [f64; D], limit: f64) -> f64 {
        self.a.signed_distance_within(x, limit).max(-self.b.signed_distance_within(x, limit))
    }
    fn bounds(&self) -> Bounds<D> {
        self.a.bounds()
    }
    fn measure(&self) -> Option<f64> {
        self.value(Metric::Cartesian)
    }
    fn centroid(&self) -> Option<[f64; D]> {
        match relation(&self.a, &self.b) {
            Relation::Apart => self.a.centroid(),
            Relation::FirstHoldsSecond => mean(weighted(&self.a, 1.0)?, weighted(&self.b, -1.0)?),
            Relation::SecondHoldsFirst | Relation::Unknown => None,
        }
    }
    fn revolved_measure(&self) -> Option<f64> {
        self.value(Metric::Axisymmetric)
    }
    fn contains(&self, x: [f64; D]) -> bool {
        self.a.contains(x) && !self.b.contains(x)
    }
    fn contains_row(&self, first: [f64; D], last: &[f64], inside: &mut [bool]) {
        self.a.contains_row(first, last, inside);
        if !inside.iter().any(|i| *i) {
            return;
        }
        let mut other = vec![false; inside.len()];
        self.b.contains_row(first, last, &mut other);
        for (i, o) in inside.iter_mut().zip(other) {
            *i &= !o;
        }
    }
}
