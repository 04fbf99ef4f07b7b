//! Uniform background lattice.

use super::bounds::Bounds;
use super::error::{Check, GeometryError};

/// Maximum distance from the origin in cells, 2^53: beyond it, floating-point numbers do not resolve integers.
const FURTHEST: f64 = 9_007_199_254_740_992.0;

/// Uniform unbounded lattice of cubic cells: positions of the background grid nodes.
///
/// Node `i` is at `origin + i h`; cell `i` extends from node `i` to node `i + 1` along every axis.
///
/// ```
/// use impactite_geometry::Lattice;
/// let lattice = Lattice::new([0.0, -1.0], 0.25)?;
/// assert_eq!(lattice.cell_of([0.6, -1.0]), Some([2, 0]));
/// assert_eq!(lattice.node([2, 0]), [0.5, -1.0]);
/// # Ok::<(), impactite_geometry::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice<const D: usize> {
    origin: [f64; D],
    spacing: f64,
}

impl<const D: usize> Lattice<D> {
    /// Create a lattice with node zero at `origin` (m) and cells of edge `spacing` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless `spacing` is positive and both are finite.
    pub fn new(origin: [f64; D], spacing: f64) -> Result<Self, GeometryError> {
        let check = Check("Lattice");
        Ok(Self { origin: check.point("origin", origin)?, spacing: check.positive("spacing", spacing)? })
    }
    /// Position of node zero (m).
    pub fn origin(&self) -> [f64; D] {
        self.origin
    }
    /// Edge of a cell (m).
    pub fn spacing(&self) -> f64 {
        self.spacing
    }
    /// Volume (3D, m3), area (2D, m2) or length (1D, m) of a cell.
    pub fn cell_measure(&self) -> f64 {
        self.spacing.powi(D as i32)
    }
    /// Position of a node (m).
    pub fn node(&self, index: [i64; D]) -> [f64; D] {
        let mut x = self.origin;
        for i in 0..D {
            x[i] += index[i] as f64 * self.spacing;
        }
        x
    }
    /// Centre of a cell (m).
    pub fn cell_centre(&self, cell: [i64; D]) -> [f64; D] {
        let mut x = [0.0; D];
        for i in 0..D {
            x[i] = self.site(i, cell[i], 0, 1);
        }
        x
    }
    /// Cell that contains `x`: a point on a face belongs to the cell above it. `None` if `x` is not finite, or so far away that its
    /// coordinate in cells, 2^53 or more, is not resolved.
    pub fn cell_of(&self, x: [f64; D]) -> Option<[i64; D]> {
        let mut cell = [0; D];
        for i in 0..D {
            let at = self.coordinate(i, x[i]).floor();
            cell[i] = if at.abs() < FURTHEST { at as i64 } else { return None };
        }
        Some(cell)
    }
    /// Position within its cell, in cells; each component is in `[0, 1)` to within rounding.
    pub fn local(&self, x: [f64; D]) -> [f64; D] {
        let mut u = [0.0; D];
        for i in 0..D {
            let c = self.coordinate(i, x[i]);
            u[i] = c - c.floor();
        }
        u
    }
    /// Bounding box of a cell (m).
    pub fn cell_bounds(&self, cell: [i64; D]) -> Bounds<D> {
        let mut max = self.origin;
        for i in 0..D {
            // Floating-point addition, since integers could overflow.
            max[i] += (cell[i] as f64 + 1.0) * self.spacing;
        }
        Bounds { min: self.node(cell), max }
    }
    /// Coordinate along `axis` (m) of the centre of part `part` of `parts` equal parts of a cell's edge:
    /// `origin + (cell + (part + 1/2) / parts) h`, free of accumulated rounding.
    #[inline]
    pub fn site(&self, axis: usize, cell: i64, part: usize, parts: usize) -> f64 {
        self.origin[axis] + (cell as f64 + (part as f64 + 0.5) / parts as f64) * self.spacing
    }
    /// `(x - origin) / h` along one axis.
    #[inline]
    pub(super) fn coordinate(&self, axis: usize, x: f64) -> f64 {
        (x - self.origin[axis]) / self.spacing
    }
}
