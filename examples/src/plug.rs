//! Projectile and plate of the plug case \[Xiao2015\] as particles around the axis.

use mpm_core::Axisymmetric;
use sph::Layout;

use crate::CaseError;

/// Radius and length of the projectile, m.
pub const PROJECTILE: [f64; 2] = [10e-3, 80e-3];
/// Radius and thickness of the plate, m. Its front is z = 0; the projectile flies along z.
pub const PLATE: [f64; 2] = [250e-3, 8e-3];
/// Radius of the fine region of the plate, m.
const FINE: f64 = 2.0 * PROJECTILE[0];
/// Spacing at the rim, m, and growth factor of columns towards it.
const COARSE: f64 = 1e-3;
const GROWTH: f64 = 1.0105;

/// Layout of both by the number of spacings on the radius of the projectile. The original 100 make 104 008 particles here;
/// the paper has 104 047 and does not state the growth of spacings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plug {
    /// Number of spacings on the radius of the projectile.
    pub cells: usize,
}

impl Plug {
    /// Original layout \[Xiao2015\].
    pub const PRINTED: Plug = Plug { cells: 100 };

    /// Spacing in the projectile and in front of it, m.
    pub fn fine(self) -> f64 {
        PROJECTILE[0] / self.cells as f64
    }

    /// Spacing at the rim of the plate, m.
    pub fn coarse(self) -> f64 {
        COARSE.max(self.fine())
    }

    /// Build the particles of the projectile.
    ///
    /// # Errors
    /// `cells` is zero.
    pub fn projectile(self) -> Result<Layout<2>, CaseError> {
        let edges: Vec<f64> = (0..=self.cells).map(|n| n as f64 * self.fine()).collect();
        Ok(Layout::of_columns(Axisymmetric, &edges, [-PROJECTILE[1], 0.0])?)
    }

    /// Build the particles of the plate: as fine as the projectile within twice its radius, then in columns whose widths
    /// grow to a millimetre.
    ///
    /// # Errors
    /// `cells` is zero.
    pub fn plate(self) -> Result<Layout<2>, CaseError> {
        let mut edges: Vec<f64> = (0..=2 * self.cells).map(|n| n as f64 * self.fine()).collect();
        edges[2 * self.cells] = FINE;
        let (mut at, mut width, coarse) = (FINE, self.fine(), self.coarse());
        loop {
            width = (width * GROWTH).min(coarse);
            if width >= coarse || at + width > PLATE[0] {
                break;
            }
            at += width;
            edges.push(at);
        }
        let rest = ((PLATE[0] - at) / coarse).round().max(1.0);
        edges.extend((1..=rest as usize).map(|n| at + (PLATE[0] - at) * n as f64 / rest));
        Ok(Layout::of_columns(Axisymmetric, &edges, [0.0, PLATE[1]])?)
    }
}
