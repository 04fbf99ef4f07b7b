//! Points with radii, and the criterion for neighbours.

use super::MOST_POINTS;
use super::error::{SearchError, check_length, check_positions, check_radii};

/// Validated positions and radii of points, the input of every search.
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
    /// Points at `positions` (m) with `radii` (m), one per point.
    ///
    /// # Errors
    /// Different numbers of positions and radii, more than 2^29 points, a coordinate that is not finite or beyond
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
    /// Errors of [`Points::new`].
    pub fn of_positions(positions: &'a [[f64; D]]) -> Result<Self, SearchError> {
        if positions.len() > MOST_POINTS {
            return Err(SearchError::Points { points: positions.len() });
        }
        check_positions(positions)?;
        Ok(Points { positions, radii: Radii::None })
    }
    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }
    /// True if there are no points.
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
    /// Smallest and largest radius (m); zero without points.
    pub(super) fn radii_range(&self) -> [f64; 2] {
        match self.radii {
            Radii::Each(radii) if !radii.is_empty() => {
                radii.iter().fold([f64::INFINITY, 0.0], |[low, high], &r| [low.min(r), high.max(r)])
            }
            _ => [0.0; 2],
        }
    }
}

/// Criterion for neighbours: maximum distance of a pair as a function of the radii R_i and R_j.
///
/// | | range of a pair |
/// |---|---|
/// | [`Reach::sum`] | factor (R_i + R_j) + tolerance: surfaces in contact |
/// | [`Reach::larger`] | factor max(R_i, R_j) + tolerance: kernel supports, of which the wider one counts |
/// | [`Reach::uniform`] | constant distance, whatever the radii |
///
/// A pair at exactly its range counts as neighbours. All searches rely on this: the range is monotonic in both radii and
/// depends on nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reach {
    /// factor (R_i + R_j) + tolerance.
    Sum {
        /// Factor of the sum of radii, zero or positive.
        factor: f64,
        /// Tolerance, m, zero or positive.
        tolerance: f64,
    },
    /// factor max(R_i, R_j) + tolerance.
    Larger {
        /// Factor of the larger radius, zero or positive.
        factor: f64,
        /// Tolerance, m, zero or positive.
        tolerance: f64,
    },
    /// Constant range for all pairs.
    Uniform {
        /// Range, m, zero or positive.
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
    /// Range of a pair with radii `a` and `b` (m).
    #[inline]
    pub fn of(&self, a: f64, b: f64) -> f64 {
        match *self {
            Reach::Sum { factor, tolerance } => factor * (a + b) + tolerance,
            Reach::Larger { factor, tolerance } => factor * a.max(b) + tolerance,
            Reach::Uniform { distance } => distance,
        }
    }
    /// Increase the range by `skin` (m).
    pub fn widened(self, skin: f64) -> Self {
        match self {
            Reach::Sum { factor, tolerance } => Reach::Sum { factor, tolerance: tolerance + skin },
            Reach::Larger { factor, tolerance } => Reach::Larger { factor, tolerance: tolerance + skin },
            Reach::Uniform { distance } => Reach::Uniform { distance: distance + skin },
        }
    }
    /// Maximum derivative of the range of a pair with respect to one of its radii.
    pub(super) fn slope(&self) -> f64 {
        match *self {
            Reach::Sum { factor, .. } | Reach::Larger { factor, .. } => factor,
            Reach::Uniform { .. } => 0.0,
        }
    }
    /// Check that all parameters are finite and not negative, and that ranges of radii up to `largest` are representable.
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

/// [`Reach`] as a type parameter, to avoid branches in inner loops.
pub(super) trait Pair: Copy + Send + Sync {
    fn range(&self, a: f64, b: f64) -> f64;
}

/// Variant `Sum` of [`Reach`]: factor and tolerance.
#[derive(Clone, Copy)]
pub(super) struct Sum(pub f64, pub f64);
/// Variant `Larger` of [`Reach`]: factor and tolerance.
#[derive(Clone, Copy)]
pub(super) struct Larger(pub f64, pub f64);
/// Variant `Uniform` of [`Reach`]: distance.
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

/// Expand `$work` for each variant of a reach, with `$pair` of the type of that variant.
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

/// Half the edge of a box that contains all points which pass as within `range` in spite of rounding: differences and squares have
/// relative rounding errors of 1e-16, and squares underflow below 1e-154.
#[inline(always)]
pub(super) fn half_box(range: f64) -> f64 {
    range * (1.0 + 1e-14) + 1e-150
}

/// Smallest and largest coordinates; +infinity and -infinity without points.
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

/// Distance from `x` to the box; zero inside.
pub(super) fn distance_to_box<const D: usize>(x: &[f64; D], low: &[f64; D], high: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for d in 0..D {
        let gap = (low[d] - x[d]).max(x[d] - high[d]).max(0.0);
        sum += gap * gap;
    }
    sum.sqrt()
}
