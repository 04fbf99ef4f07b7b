//! Boundary conditions of nodes.

use mpm_core::geometry::Lattice;
use mpm_core::{Boundary, Side};

pub(super) fn sign(side: Side) -> f64 {
    match side {
        Side::Above => 1.0,
        Side::Below => -1.0,
    }
}

/// Apply the boundary conditions at `time` to a nodal velocity in their order, except walls.
pub(super) fn constrain<const D: usize>(
    boundaries: &[Boundary<D>],
    lattice: &Lattice<D>,
    x: &[f64; D],
    v: &mut [f64; D],
    time: f64,
) {
    let tolerance = 1e-6 * lattice.spacing();
    for boundary in boundaries {
        match *boundary {
            // Off the plane, images enforce symmetry.
            Boundary::Symmetry { axis, at, .. } => {
                if (x[axis] - at).abs() <= tolerance {
                    v[axis] = 0.0;
                }
            }
            Boundary::Wall { .. } | Boundary::FrictionWall { .. } => {}
            Boundary::Fixed { axis, at, side } => {
                if sign(side) * (x[axis] - at) <= tolerance {
                    *v = [0.0; D];
                }
            }
            Boundary::Prescribed { ref region, ref velocity } => {
                if region.signed_distance(*x) <= tolerance {
                    for (c, value) in velocity(time).into_iter().take(D).enumerate() {
                        v[c] = value.unwrap_or(v[c]);
                    }
                }
            }
            _ => panic!("the reference does not know {boundary:?}"),
        }
    }
}

/// Return true if a boundary condition other than a wall prescribes component `c` of the velocity of the node at
/// `x`.
pub(super) fn held<const D: usize>(
    boundaries: &[Boundary<D>],
    lattice: &Lattice<D>,
    x: &[f64; D],
    c: usize,
    time: f64,
) -> bool {
    let tolerance = 1e-6 * lattice.spacing();
    boundaries.iter().any(|boundary| match *boundary {
        Boundary::Symmetry { axis, at, .. } => c == axis && (x[axis] - at).abs() <= tolerance,
        Boundary::Wall { .. } | Boundary::FrictionWall { .. } => false,
        Boundary::Fixed { axis, at, side } => sign(side) * (x[axis] - at) <= tolerance,
        Boundary::Prescribed { ref region, ref velocity } => {
            region.signed_distance(*x) <= tolerance && velocity(time)[c].is_some()
        }
        _ => panic!("the reference does not know {boundary:?}"),
    })
}
