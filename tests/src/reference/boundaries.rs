//! What boundaries do to a node.

use mpm_core::geometry::Lattice;
use mpm_core::{Boundary, Side};

pub(super) fn sign(side: Side) -> f64 {
    match side {
        Side::Above => 1.0,
        Side::Below => -1.0,
    }
}

/// A wall as a node on it or behind it meets it.
pub(super) struct Wall<const D: usize> {
    pub(super) axis: usize,
    /// +1 if it pushes up the axis, else -1.
    pub(super) sign: f64,
    /// Of which a smooth one has no part along itself.
    pub(super) velocity: [f64; D],
    /// Coefficient of friction.
    pub(super) friction: f64,
}

impl<const D: usize> Wall<D> {
    /// The directions along it.
    pub(super) fn along(&self) -> impl Iterator<Item = usize> + use<D> {
        let axis = self.axis;
        (0..D).filter(move |d| *d != axis)
    }
}

/// The walls that the node at `x` is on or behind at `time`.
pub(super) fn walls<const D: usize>(
    boundaries: &[Boundary<D>],
    lattice: &Lattice<D>,
    x: &[f64; D],
    time: f64,
) -> Vec<Wall<D>> {
    let behind = |boundary: &Boundary<D>| match *boundary {
        Boundary::Wall { axis, at, side, velocity } => {
            let distance = sign(side) * (x[axis] - (at + velocity * time));
            let mut across = [0.0; D];
            across[axis] = velocity;
            let wall = Wall { axis, sign: sign(side), velocity: across, friction: 0.0 };
            (distance <= 1e-6 * lattice.spacing()).then_some(wall)
        }
        Boundary::FrictionWall { axis, at, side, velocity, friction } => {
            let distance = sign(side) * (x[axis] - (at + velocity[axis] * time));
            let wall = Wall { axis, sign: sign(side), velocity, friction };
            (distance <= 1e-6 * lattice.spacing()).then_some(wall)
        }
        _ => None,
    };
    boundaries.iter().filter_map(behind).collect()
}

/// Make a nodal velocity obey the boundaries at `time`, in their order, walls aside.
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
            // Elsewhere the images see to it.
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

/// Does a boundary that is no wall hold component `c` of the velocity of the node at `x`?
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
