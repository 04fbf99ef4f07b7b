//! Points with radii, and which pairs of them are neighbours.

use super::MOST_POINTS;
use super::error::{SearchError, check_length, check_positions, check_radii};

/// Positions and radii of points, checked: every search takes its points in this form.
///
/// ```
/// use impactite_geometry::search::{Points, SearchError};
/// let points = Points::new(&[[0.0, 1.0], [2.0, 0.5]], &[0.1, 0.2])?;
/// assert_eq!(points.len(), 2);
/// let refused = Points::new(&[[0.0, f64::NAN]], &[0.1]).err();
/// let said = "search: y of point 0 = NaN is not allowed; it must be finite, between -1e150 and 1e150";
/// assert_eq!(refused.map(|e| e.to_string()).as_deref(), Some(said));
/// # Ok::<(), SearchError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Points<'a, const D: usize> {
    positions: &'a [[f64; D]],
    radii: Radii<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Radii<'a> {
    Each(&'a [f64]),
    None,
}

impl<'a, const D: usize> Points<'a, D> {
    /// Points at `positions` (m) with `radii` (m), one a point.
    ///
    /// # Errors
    /// Another number of radii than of positions, more than 2^29 points, a coordinate that is not finite or beyond
    /// 1e150 m, a radius that is negative, not finite or beyond 1e150 m.
    pub fn new(positions: &'a [[f64; D]], radii: &'a [f64]) -> Result<Self, SearchError> {
        if positions.len() != radii.len() {
            return Err(SearchError::Lengths { positions: positions.len(), radii: radii.len() });
        }
        check_radii(radii)?;
        Ok(Points { radii: Radii::Each(radii), ..Self::of_positions(positions)? })
    }
    /// Points at `positions` (m), of radius zero.
    ///
    /// # Errors
    /// As [`Points::new`].
    pub fn of_positions(positions: &'a [[f64; D]]) -> Result<Self, SearchError> {
        if positions.len() > MOST_POINTS {
            return Err(SearchError::Points { points: positions.len() });
        }
        check_positions(positions)?;
        Ok(Points { positions, radii: Radii::None })
    }
    /// How many there are.
    pub fn len(&self) -> usize {
        self.positions.len()
    }
    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }
    /// Positions (m).
    pub fn positions(&self) -> &'a [[f64; D]] {
        self.positions
    }
    /// Radius of point `i` (m).
    #[inline]
    pub fn radius(&self, i: usize) -> f64 {
        match self.radii {
            Radii::Each(radii) => radii[i],
            Radii::None => 0.0,
        }
    }
    /// Smallest and largest radius (m); zeros of no points.
    pub(super) fn radii_range(&self) -> [f64; 2] {
        match self.radii {
            Radii::Each(radii) if !radii.is_empty() => {
                radii.iter().fold([f64::INFINITY, 0.0], |[low, high], &r| [low.min(r), high.max(r)])
            }
            _ => [0.0; 2],
        }
    }
}

/// Which pairs are neighbours: those no farther apart than this, by their radii R_i and R_j.
///
/// | | range of a pair |
/// |---|---|
/// | [`Reach::sum`] | factor (R_i + R_j) + tolerance: surfaces that touch |
/// | [`Reach::larger`] | factor max(R_i, R_j) + tolerance: supports of kernels of which the wider one counts |
/// | [`Reach::uniform`] | one distance, whatever the radii |
///
/// A pair at exactly its range is one of neighbours. A range grows with both radii and with nothing else: on that rest
/// all searches.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reach {
    /// factor (R_i + R_j) + tolerance.
    Sum {
        /// Of the sum of radii, zero or positive.
        factor: f64,
        /// m, zero or positive.
        tolerance: f64,
    },
    /// factor max(R_i, R_j) + tolerance.
    Larger {
        /// Of the larger radius, zero or positive.
        factor: f64,
        /// m, zero or positive.
        tolerance: f64,
    },
    /// The same for all pairs.
    Uniform {
        /// m, zero or positive.
        distance: f64,
    },
}

impl Reach {
    /// R_i + R_j + `tolerance` (m).
    pub fn sum(tolerance: f64) -> Self {
        Reach::Sum { factor: 1.0, tolerance }
    }
    /// max(R_i, R_j) + `tolerance` (m).
    pub fn larger(tolerance: f64) -> Self {
        Reach::Larger { factor: 1.0, tolerance }
    }
    /// `distance` (m) for every pair.
    pub fn uniform(distance: f64) -> Self {
        Reach::Uniform { distance }
    }
    /// The range of a pair with radii `a` and `b` (m).
    #[inline]
    pub fn of(&self, a: f64, b: f64) -> f64 {
        match *self {
            Reach::Sum { factor, tolerance } => factor * (a + b) + tolerance,
            Reach::Larger { factor, tolerance } => factor * a.max(b) + tolerance,
            Reach::Uniform { distance } => distance,
        }
    }
    /// The same, wider by `skin` (m).
    pub fn widened(self, skin: f64) -> Self {
        match self {
            Reach::Sum { factor, tolerance } => Reach::Sum { factor, tolerance: tolerance + skin },
            Reach::Larger { factor, tolerance } => Reach::Larger { factor, tolerance: tolerance + skin },
            Reach::Uniform { distance } => Reach::Uniform { distance: distance + skin },
        }
    }
    /// How much wider the range of a pair becomes, at most, for every metre that one of its radii grows.
    pub(super) fn slope(&self) -> f64 {
        match *self {
            Reach::Sum { factor, .. } | Reach::Larger { factor, .. } => factor,
            Reach::Uniform { .. } => 0.0,
        }
    }
    /// Refuses negative numbers, what is not finite, and ranges beyond what distances can be.
    pub(super) fn check(&self, largest: f64) -> Result<(), SearchError> {
        let numbers = match *self {
            Reach::Sum { factor, tolerance } | Reach::Larger { factor, tolerance } => {
                [("factor of the reach", factor), ("tolerance of the reach", tolerance)]
            }
            Reach::Uniform { distance } => [("distance of the reach", distance); 2],
        };
        for (field, value) in numbers {
            check_length(field, value)?;
        }
        check_length("range of the largest pair", self.of(largest, largest))
    }
}

/// A [`Reach`] as a type of its own, so that inner loops do not ask which.
pub(super) trait Pair: Copy + Send + Sync {
    fn range(&self, a: f64, b: f64) -> f64;
}

/// A variant of [`Reach`].
#[derive(Clone, Copy)]
pub(super) struct Sum(pub f64, pub f64);
/// A variant of [`Reach`].
#[derive(Clone, Copy)]
pub(super) struct Larger(pub f64, pub f64);
/// A variant of [`Reach`].
#[derive(Clone, Copy)]
pub(super) struct Uniform(pub f64);

impl Pair for Sum {
    #[inline(always)]
    fn range(&self, a: f64, b: f64) -> f64 {
        self.0 * (a + b) + self.1
    }
}
impl Pair for Larger {
    #[inline(always)]
    fn range(&self, a: f64, b: f64) -> f64 {
        self.0 * a.max(b) + self.1
    }
}
impl Pair for Uniform {
    #[inline(always)]
    fn range(&self, _: f64, _: f64) -> f64 {
        self.0
    }
}

/// `$work` with `$pair` standing for the variant of a reach.
macro_rules! for_pair {
    ($reach:expr, $pair:ident => $work:expr) => {
        match $reach {
            Reach::Sum { factor, tolerance } => {
                let $pair = $crate::search::points::Sum(factor, tolerance);
                $work
            }
            Reach::Larger { factor, tolerance } => {
                let $pair = $crate::search::points::Larger(factor, tolerance);
                $work
            }
            Reach::Uniform { distance } => {
                let $pair = $crate::search::points::Uniform(distance);
                $work
            }
        }
    };
}
pub(super) use for_pair;

#[inline(always)]
pub(super) fn distance_squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for d in 0..D {
        sum += (a[d] - b[d]) * (a[d] - b[d]);
    }
    sum
}

/// Half the edge of a box around a point that holds all that rounding lets pass as within `range`: differences and squares are
/// rounded by parts of 1e-16, and squares vanish below 1e-154.
#[inline(always)]
pub(super) fn half_box(range: f64) -> f64 {
    range * (1.0 + 1e-14) + 1e-150
}

/// Least and largest coordinates; infinite the wrong way round of no points.
pub(super) fn bounds_of<'a, const D: usize>(
    positions: impl Iterator<Item = &'a [f64; D]>,
) -> ([f64; D], [f64; D]) {
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for x in positions {
        for d in 0..D {
            low[d] = low[d].min(x[d]);
            high[d] = high[d].max(x[d]);
        }
    }
    (low, high)
}

/// Distance from `x` to the box; zero within.
pub(super) fn distance_to_box<const D: usize>(x: &[f64; D], low: &[f64; D], high: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for d in 0..D {
        let gap = (low[d] - x[d]).max(x[d] - high[d]).max(0.0);
        sum += gap * gap;
    }
    sum.sqrt()
}
