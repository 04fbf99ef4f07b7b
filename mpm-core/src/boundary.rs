//! Boundary conditions on the nodes, and loads.

use std::sync::Arc;

use crate::geometry::{Lattice, Shape};

/// On which side of a plane the material is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// At coordinates above the plane's.
    Above,
    /// At coordinates below the plane's.
    Below,
}

impl Side {
    /// +1 if the inward normal points along the axis, else -1.
    fn sign(self) -> f64 {
        match self {
            Side::Above => 1.0,
            Side::Below => -1.0,
        }
    }
}

/// A velocity over time: `[v_x, v_y, v_z]` in m/s at time t in s; `None` leaves a component free.
pub type VelocityHistory = Arc<dyn Fn(f64) -> [Option<f64>; 3] + Send + Sync>;

/// A condition on the velocity of nodes.
#[derive(Clone)]
pub enum Boundary<const D: usize> {
    /// A plane of symmetry: no velocity across it, everything else free. With wide stencils the nodes behind
    /// the plane mirror those in front, so that half a model gives what the whole one would. Particles behind it are refused.
    Symmetry {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position, m; must lie on a plane of nodes.
        at: f64,
        /// Where the material is.
        side: Side,
    },
    /// A rigid frictionless wall that only pushes, moving along its normal: a plane of symmetry that lets go. Matter that comes within
    /// a cell of it is stopped by its own stress, and let go when the wall no longer carries it; a wall at rest does no work
    /// (book, "Where contact is applied"). Bodies without stress on the scene's nodes (free rigid ones, those mapped in their reference
    /// configuration) are stopped by impulses on their nodes.
    Wall {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position at t = 0, m.
        at: f64,
        /// Where the material is.
        side: Side,
        /// Velocity along the axis, m/s.
        velocity: f64,
    },
    /// All nodes on and behind a plane stand still.
    Fixed {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position, m; with [`crate::BoundaryModified`] best on a plane of nodes.
        at: f64,
        /// Where the material is.
        side: Side,
    },
    /// Nodes inside a region have a prescribed velocity.
    Prescribed {
        /// The region, fixed in space.
        region: Arc<dyn Shape<D>>,
        /// The velocity over time.
        velocity: VelocityHistory,
    },
}

impl<const D: usize> std::fmt::Debug for Boundary<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Boundary::Symmetry { axis, at, side } => write!(f, "Symmetry(axis {axis} at {at} {side:?})"),
            Boundary::Wall { axis, at, side, velocity } => {
                write!(f, "Wall(axis {axis} at {at} {side:?} moving {velocity} m/s)")
            }
            Boundary::Fixed { axis, at, side } => write!(f, "Fixed(axis {axis} at {at} {side:?})"),
            Boundary::Prescribed { .. } => write!(f, "Prescribed(region)"),
        }
    }
}

/// A boundary that a scene cannot have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundaryError {
    /// The axis does not exist.
    #[error("boundary axis = {axis} is not allowed; it must be below the dimension {dimension}")]
    Axis {
        /// Given axis.
        axis: usize,
        /// Dimension.
        dimension: usize,
    },
    /// A symmetry plane between nodes.
    #[error(
        "symmetry plane at = {at} m is not allowed; it must lie on a plane of nodes (the nearest is {nearest} m)"
    )]
    OffNode {
        /// Given position, m.
        at: f64,
        /// Nearest plane of nodes, m.
        nearest: f64,
    },
    /// A wall where the grid lies in the reference configuration.
    #[error(
        "a wall is not allowed with a total-Lagrangian method, whose nodes do not know where material is; it must \
         be a symmetry plane, a fixed plane or a prescribed velocity"
    )]
    WallInReference,
    /// Not a finite number.
    #[error("boundary {field} = {value} is not allowed; it must be finite")]
    NotFinite {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
    },
}

/// A plane of nodes that a boundary lies on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// Normal axis.
    pub axis: usize,
    /// Node index along it.
    pub node: i32,
    /// +1 if the material is at larger indices, else -1.
    pub sign: i32,
}

/// Round-off allowed for a plane to count as lying on nodes, in cells.
const ON_NODE: f64 = 1e-6;

impl<const D: usize> Boundary<D> {
    /// Refuse what cannot be.
    pub(crate) fn check(&self, lattice: &Lattice<D>) -> Result<(), BoundaryError> {
        let (axis, at, velocity) = match *self {
            Boundary::Symmetry { axis, at, .. } | Boundary::Fixed { axis, at, .. } => (axis, at, 0.0),
            Boundary::Wall { axis, at, velocity, .. } => (axis, at, velocity),
            Boundary::Prescribed { .. } => return Ok(()),
        };
        if axis >= D {
            return Err(BoundaryError::Axis { axis, dimension: D });
        }
        for (field, value) in [("at", at), ("velocity", velocity)] {
            if !value.is_finite() {
                return Err(BoundaryError::NotFinite { field, value });
            }
        }
        if let Boundary::Symmetry { side, .. } = self
            && plane(lattice, axis, at, *side).is_none()
        {
            let node = (at - lattice.origin()[axis]) / lattice.spacing();
            let nearest = lattice.origin()[axis] + node.round() * lattice.spacing();
            return Err(BoundaryError::OffNode { at, nearest });
        }
        Ok(())
    }

    /// The plane of nodes to mirror at, if this is a symmetry.
    pub(crate) fn mirror(&self, lattice: &Lattice<D>) -> Option<Plane> {
        match *self {
            Boundary::Symmetry { axis, at, side } => plane(lattice, axis, at, side),
            _ => None,
        }
    }

    /// The plane of nodes where material ends, if this is a resting wall or a fixed plane that lies on one.
    pub(crate) fn edge(&self, lattice: &Lattice<D>) -> Option<Plane> {
        match *self {
            Boundary::Fixed { axis, at, side } => plane(lattice, axis, at, side),
            Boundary::Wall { axis, at, side, velocity: 0.0 } => plane(lattice, axis, at, side),
            _ => None,
        }
    }

    /// Can it touch nodes whose indices lie in `low..=high`?
    pub(crate) fn reaches(&self, low: &[f64; D], high: &[f64; D], time: f64, tolerance: f64) -> bool {
        match *self {
            Boundary::Symmetry { axis, at, side } | Boundary::Fixed { axis, at, side } => {
                behind(low[axis], high[axis], at, side, tolerance)
            }
            Boundary::Wall { axis, at, side, velocity } => {
                behind(low[axis], high[axis], at + velocity * time, side, tolerance)
            }
            Boundary::Prescribed { ref region, .. } => {
                let b = region.bounds();
                (0..D).all(|d| low[d] <= b.max[d] + tolerance && high[d] >= b.min[d] - tolerance)
            }
        }
    }

    /// Make the velocity of a node at `x` obey, at `time`. Nodes less than `copies` behind a symmetry plane
    /// mirror those in front already.
    pub(crate) fn constrain(&self, x: &[f64; D], v: &mut [f64; 3], time: f64, tolerance: f64, copies: f64) {
        match *self {
            Boundary::Symmetry { axis, at, side } => {
                let depth = (at - x[axis]) * side.sign();
                if depth >= -tolerance && !(tolerance < depth && depth < copies) {
                    v[axis] = 0.0;
                }
            }
            Boundary::Wall { axis, at, side, velocity } => {
                if (x[axis] - at - velocity * time) * side.sign() <= tolerance {
                    let approach = (v[axis] - velocity) * side.sign();
                    if approach < 0.0 {
                        v[axis] = velocity;
                    }
                }
            }
            Boundary::Fixed { axis, at, side } => {
                if (x[axis] - at) * side.sign() <= tolerance {
                    *v = [0.0; 3];
                }
            }
            Boundary::Prescribed { ref region, ref velocity } => {
                if region.signed_distance(*x) <= tolerance {
                    let prescribed = velocity(time);
                    for d in 0..D {
                        if let Some(value) = prescribed[d] {
                            v[d] = value;
                        }
                    }
                }
            }
        }
    }
}

/// The plane of nodes at `at`, if there is one.
fn plane<const D: usize>(lattice: &Lattice<D>, axis: usize, at: f64, side: Side) -> Option<Plane> {
    let node = (at - lattice.origin()[axis]) / lattice.spacing();
    let on_node = (node - node.round()).abs() <= ON_NODE;
    on_node.then(|| Plane { axis, node: node.round() as i32, sign: side.sign() as i32 })
}

fn behind(low: f64, high: f64, at: f64, side: Side, tolerance: f64) -> bool {
    match side {
        Side::Above => low <= at + tolerance,
        Side::Below => high >= at - tolerance,
    }
}

/// An acceleration of all material, m/s^2, over time.
pub type BodyForce<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;
