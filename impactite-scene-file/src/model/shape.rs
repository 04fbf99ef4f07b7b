//! Shapes.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

use super::Vector;
use super::parts::parts;
use crate::quantity::{Angle, Length, Plain, Quantity};

/// A solid. Coordinates are x, y, z; in plane scenes x, y; around an axis r, z.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A box between two corners; in the plane a rectangle.
    Box(BoxShape),
    /// A ball; in the plane a disc.
    Ball(BallShape),
    /// A hollow ball; in the plane a ring.
    Shell(ShellShape),
    /// A cylinder; in the plane a bar.
    Cylinder(CylinderShape),
    /// A hollow cylinder.
    Tube(TubeShape),
    /// A cone that is cut off.
    Frustum(FrustumShape),
    /// A rod with an ogive nose.
    OgiveRod(OgiveRodShape),
    /// A polygon of the plane; around an axis of (r, z).
    Polygon(PolygonShape),
    /// All behind a plane.
    HalfSpace(HalfSpaceShape),
    /// A closed surface of triangles from a file.
    Surface(SurfaceShape),
    /// What is in any of these.
    Union(Vec<Shape>),
    /// What is in all of these.
    Intersection(Vec<Shape>),
    /// What is in the first and in none of the others.
    Difference(Vec<Shape>),
    /// A shape elsewhere.
    Moved(Box<MovedShape>),
}

parts! {
    /// Two corners.
    BoxShape {
        /// A corner.
        from: Vector<Length>,
        /// The corner opposite.
        to: Vector<Length>,
    }
    /// Centre and radius.
    BallShape {
        /// Centre.
        centre: Vector<Length>,
        /// Radius.
        radius: Quantity<Length>,
    }
    /// Centre and two radii.
    ShellShape {
        /// Centre.
        centre: Vector<Length>,
        /// Inner radius.
        inner: Quantity<Length>,
        /// Outer radius.
        outer: Quantity<Length>,
    }
    /// An axis and a radius.
    CylinderShape {
        /// Centre of one end.
        start: Vector<Length>,
        /// Direction of the axis; of any length.
        direction: Vector<Plain>,
        /// Length.
        length: Quantity<Length>,
        /// Radius.
        radius: Quantity<Length>,
    }
    /// An axis and two radii.
    TubeShape {
        /// Centre of one end.
        start: Vector<Length>,
        /// Direction of the axis; of any length.
        direction: Vector<Plain>,
        /// Length.
        length: Quantity<Length>,
        /// Inner radius.
        inner: Quantity<Length>,
        /// Outer radius.
        outer: Quantity<Length>,
    }
    /// An axis and the radii of the ends.
    FrustumShape {
        /// Centre of one end.
        start: Vector<Length>,
        /// Direction of the axis; of any length.
        direction: Vector<Plain>,
        /// Length.
        length: Quantity<Length>,
        /// Radii at the start and at the other end.
        radii: [Quantity<Length>; 2],
    }
    /// A rod.
    OgiveRodShape {
        /// Centre of the flat end.
        tail: Vector<Length>,
        /// From tail to tip; of any length.
        direction: Vector<Plain>,
        /// Diameter.
        diameter: Quantity<Length>,
        /// Length from tail to tip.
        length: Quantity<Length>,
        /// Radius of the ogive over the diameter (caliber radius head), at least 1/2.
        crh: Quantity<Plain>,
    }
    /// Corners.
    PolygonShape {
        /// The corners, in order.
        corners: Vec<[Quantity<Length>; 2]>,
    }
    /// A plane.
    HalfSpaceShape {
        /// A place on the plane.
        point: Vector<Length>,
        /// Outwards; of any length.
        outward: Vector<Plain>,
    }
    /// A file.
    SurfaceShape {
        /// An STL or OBJ file; beside the scene's file unless the path is absolute.
        file: PathBuf,
        /// Length of a unit of the file.
        unit: Quantity<Length>,
    }
    /// Scaled and turned about a place, then shifted.
    MovedShape {
        /// The shape.
        shape: Shape,
        /// Shift.
        #[serde(default)]
        by: Option<Vector<Length>>,
        /// Turn by this angle: in the plane from x to y, around an axis not at all.
        #[serde(default)]
        turn: Option<Quantity<Angle>>,
        /// The axis of the turn, in three dimensions.
        #[serde(default)]
        axis: Option<Vector<Plain>>,
        /// The place that a turn leaves where it is; the origin if none is given.
        #[serde(default)]
        about: Option<Vector<Length>>,
    }
}
