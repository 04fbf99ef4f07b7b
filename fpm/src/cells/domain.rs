//! Convex domain of a body.

use impactite_geometry::{Bounds, Polygon};

use super::error::{CellsError, parameter};
use super::polytope::{Beyond, Polytope};
use crate::vector::{difference, norm};

/// Bounded convex domain with flat sides, in the plane or in space. Its cells end at the sides.
///
/// ```
/// use fpm::Domain;
/// // A plate with a corner cut off.
/// let plate = Domain::cuboid([0.0, 0.0], [0.1, 0.1])?.cut([1.0, 1.0], 0.15)?;
/// assert!((plate.volume() - (0.01 - 0.5 * 0.05 * 0.05)).abs() < 1e-15);
/// # Ok::<(), fpm::CellsError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Domain<const D: usize> {
    pub(crate) polytope: Polytope<D>,
    bounds: Bounds<D>,
    volume: f64,
}

const OWNER: &str = "domain of cells";

impl<const D: usize> Domain<D> {
    /// Create a box between two corners, m.
    ///
    /// # Errors
    /// Corners that do not rise or are not finite; other than two or three dimensions.
    pub fn cuboid(low: [f64; D], high: [f64; D]) -> Result<Self, CellsError> {
        parameter(D == 2 || D == 3, OWNER, "number of dimensions", D as f64, "2 or 3")?;
        for d in 0..D {
            parameter(true, OWNER, "corner", low[d], "finite")?;
            parameter(
                high[d] > low[d],
                OWNER,
                "opposite corner",
                high[d],
                "above the first one, and finite",
            )?;
        }
        Self::of(Polytope::cuboid(&low, &high))
    }

    /// Cut off the part beyond a plane: keep n . x <= offset.
    ///
    /// # Errors
    /// A normal that is zero or not finite; a plane that leaves nothing.
    pub fn cut(self, normal: [f64; D], offset: f64) -> Result<Self, CellsError> {
        let length = norm(&normal);
        parameter(length > 0.0, OWNER, "length of the normal", length, "positive and finite")?;
        parameter(true, OWNER, "offset", offset, "finite")?;
        let size = norm(&difference(&self.bounds.max, &self.bounds.min));
        let planes = self.polytope.facets.iter().map(|f| match f.beyond {
            Beyond::Outside(n) | Beyond::Cell(n) => n + 1,
        });
        let next = planes.max().unwrap_or(0);
        let mut polytope = self.polytope;
        polytope.cut(&normal, offset, size, Beyond::Outside(next));
        Self::of(polytope)
    }

    fn of(polytope: Polytope<D>) -> Result<Self, CellsError> {
        let bounds = Bounds::around(polytope.corners().copied());
        let enough = polytope.facets.len() > D;
        let middle = std::array::from_fn(|d| 0.5 * (bounds.min[d] + bounds.max[d]));
        let volume = if enough { polytope.volume_and_centroid(&middle).0 } else { 0.0 };
        parameter(volume > 0.0, OWNER, "volume", volume, "positive and finite")?;
        Ok(Domain { polytope, bounds, volume })
    }

    /// Volume, m^3 (area in the plane, m^2).
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.volume
    }
    /// Bounding box.
    #[must_use]
    pub fn bounds(&self) -> Bounds<D> {
        self.bounds
    }
    /// True if a place is inside, and not on a side.
    #[must_use]
    pub fn contains(&self, x: [f64; D]) -> bool {
        self.polytope.facets.iter().all(|f| {
            let (area, _) = f.measure();
            crate::vector::dot(&area, &difference(&x, &f.corners[0])) < 0.0
        })
    }
}

impl Domain<2> {
    /// Create a convex polygon, in either orientation.
    ///
    /// # Errors
    /// A polygon that is not convex.
    pub fn polygon(polygon: &Polygon) -> Result<Self, CellsError> {
        let corners = polygon.corners();
        let signed: f64 = (0..corners.len())
            .map(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
                a[0] * b[1] - a[1] * b[0]
            })
            .sum();
        let bounds = Bounds::around(corners.iter().copied());
        let mut domain = Domain::cuboid(bounds.min, bounds.max)?;
        for (i, a) in corners.iter().enumerate() {
            let b = &corners[(i + 1) % corners.len()];
            let normal = [(b[1] - a[1]) * signed.signum(), (a[0] - b[0]) * signed.signum()];
            domain = domain.cut(normal, normal[0] * a[0] + normal[1] * a[1])?;
        }
        // Cuts along the edges of a polygon that is not convex remove area.
        let (given, kept) = (0.5 * signed.abs(), domain.volume);
        let missing = (1.0 - kept / given).abs();
        parameter(
            missing < 1e-9,
            OWNER,
            "area cut off a polygon, over its own",
            missing,
            "zero, as it is of a convex one",
        )?;
        Ok(domain)
    }
}
