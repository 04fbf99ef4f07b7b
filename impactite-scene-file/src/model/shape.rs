//! Geometric shapes.

use std::path::PathBuf;

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;

use super::Vector;
use super::parts::parts;
use crate::quantity::{Angle, Length, Plain, Quantity};

/// A shape. Coordinates are x, y, z; in plane scenes x, y; around an axis r, z.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Box between two opposite corners; in the plane a rectangle.
    Box(BoxShape),
    /// Ball; in the plane a disc.
    Ball(BallShape),
    /// Hollow ball; in the plane a ring.
    Shell(ShellShape),
    /// Cylinder; in the plane a bar.
    Cylinder(CylinderShape),
    /// Hollow cylinder.
    Tube(TubeShape),
    /// Truncated cone.
    Frustum(FrustumShape),
    /// Rod with an ogive nose.
    OgiveRod(OgiveRodShape),
    /// Polygon of the plane; around an axis of (r, z).
    Polygon(PolygonShape),
    /// Half space behind a plane, to cut other shapes.
    HalfSpace(HalfSpaceShape),
    /// Closed surface of triangles from an STL, OBJ or PLY file, in three dimensions.
    Surface(SurfaceShape),
    /// Union: points in any of these shapes.
    #[schemars(extend("examples" = [{"union": [{"ball": {"centre": [0, 0], "radius": "5 mm"}}, {"box": {"from": [0, 0], "to": ["9 mm", "2 mm"]}}]}]))]
    Union(Vec<Shape>),
    /// Intersection: points in all of these shapes.
    #[schemars(extend("examples" = [{"intersection": [{"ball": {"centre": [0, 0], "radius": "5 mm"}}, {"half_space": {"point": [0, 0], "outward": [-1, 0]}}]}]))]
    Intersection(Vec<Shape>),
    /// Difference: points in the first shape and in none of the others.
    #[schemars(extend("examples" = [{"difference": [{"box": {"from": [0, 0], "to": ["9 mm", "9 mm"]}}, {"ball": {"centre": [0, 0], "radius": "5 mm"}}]}]))]
    Difference(Vec<Shape>),
    /// Shape that is turned about a place, then shifted.
    Moved(Box<MovedShape>),
    /// Shape of another body at the start, by its name; of a body with `repeat` that of all its copies.
    #[schemars(extend("examples" = [{"body": "rod"}]))]
    Body(String),
}

impl Shape {
    /// Replace references to bodies by their shapes. References to a missing body, to a body without a shape, and circular ones stay.
    pub(crate) fn resolve(&mut self, bodies: &mut Bodies<'_>) {
        match self {
            Shape::Union(list) | Shape::Intersection(list) | Shape::Difference(list) => {
                list.iter_mut().for_each(|shape| shape.resolve(bodies));
            }
            Shape::Moved(moved) => moved.shape.resolve(bodies),
            Shape::Body(name) if bodies.left > 0 && !bodies.trail.contains(name) => {
                let Some(Some(shape)) = bodies.shapes.get(name) else { return };
                let mut shape = shape.clone();
                bodies.left -= 1;
                bodies.trail.push(name.clone());
                shape.resolve(bodies);
                bodies.trail.pop();
                *self = shape;
            }
            _ => {}
        }
    }
}

/// Shapes of bodies by name, during resolution of references.
pub(crate) struct Bodies<'a> {
    pub shapes: &'a IndexMap<String, Option<Shape>>,
    /// Names under resolution.
    pub trail: Vec<String>,
    /// Remaining number of references to resolve: nested shapes could double without end.
    pub left: usize,
}

parts! {
    /// Two corners.
    BoxShape {
        /// Corner.
        #[schemars(example = (0, 0))]
        from: Vector<Length>,
        /// Opposite corner.
        #[schemars(example = ("10 mm", "30 mm"))]
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
        #[schemars(example = "30 mm")]
        inner: Quantity<Length>,
        /// Outer radius.
        #[schemars(example = "40 mm")]
        outer: Quantity<Length>,
    }
    /// An axis and a radius.
    CylinderShape {
        /// Centre of one end.
        start: Vector<Length>,
        /// Direction of the axis, of any length.
        #[schemars(example = (0, 1))]
        direction: Vector<Plain>,
        /// Length.
        #[schemars(example = "25.4 mm")]
        length: Quantity<Length>,
        /// Radius.
        radius: Quantity<Length>,
    }
    /// An axis and two radii.
    TubeShape {
        /// Centre of one end.
        start: Vector<Length>,
        /// Direction of the axis, of any length.
        #[schemars(example = (0, 1))]
        direction: Vector<Plain>,
        /// Length.
        #[schemars(example = "25.4 mm")]
        length: Quantity<Length>,
        /// Inner radius.
        #[schemars(example = "30 mm")]
        inner: Quantity<Length>,
        /// Outer radius.
        #[schemars(example = "40 mm")]
        outer: Quantity<Length>,
    }
    /// An axis and the radii of the ends.
    FrustumShape {
        /// Centre of one end.
        start: Vector<Length>,
        /// Direction of the axis, of any length.
        #[schemars(example = (0, 1))]
        direction: Vector<Plain>,
        /// Length.
        #[schemars(example = "25.4 mm")]
        length: Quantity<Length>,
        /// Radii at the start and at the other end.
        #[schemars(example = ("5 mm", "2 mm"))]
        radii: [Quantity<Length>; 2],
    }
    /// A rod.
    OgiveRodShape {
        /// Centre of the flat end.
        tail: Vector<Length>,
        /// Direction from tail to tip, of any length.
        #[schemars(example = (0, -1))]
        direction: Vector<Plain>,
        /// Diameter.
        #[schemars(example = "12.9 mm")]
        diameter: Quantity<Length>,
        /// Length from tail to tip.
        #[schemars(example = "88.9 mm")]
        length: Quantity<Length>,
        /// Radius of the ogive over the diameter (caliber radius head).
        #[schemars(example = 3, extend("minimum" = 0.5))]
        crh: Quantity<Plain>,
    }
    /// Corners.
    PolygonShape {
        /// Corners, in order around the polygon.
        #[schemars(example = ((0, 0), ("25 m", 0), ("10 m", "7 m")))]
        corners: Vec<[Quantity<Length>; 2]>,
    }
    /// A plane.
    HalfSpaceShape {
        /// Place on the plane.
        #[schemars(example = (0, 0))]
        point: Vector<Length>,
        /// Outward normal, of any length: the half space is on the other side.
        #[schemars(example = (0, 1))]
        outward: Vector<Plain>,
    }
    /// A file.
    SurfaceShape {
        /// Path of the STL, OBJ or PLY file, relative to the folder of the scene file.
        #[schemars(example = "part.stl")]
        file: PathBuf,
        /// Length of a unit of the file.
        #[schemars(example = "1 mm")]
        unit: Quantity<Length>,
    }
    /// Rotation about a place, then a shift.
    MovedShape {
        /// The shape.
        shape: Shape,
        /// Shift.
        #[serde(default)]
        #[schemars(example = ("10 mm", 0))]
        by: Option<Vector<Length>>,
        /// Angle of the turn: in the plane from x to y; around an axis there is none.
        #[serde(default)]
        turn: Option<Quantity<Angle>>,
        /// Axis of the turn, in three dimensions.
        #[serde(default)]
        #[schemars(example = (0, 0, 1))]
        axis: Option<Vector<Plain>>,
        /// Centre of the turn; the origin if not given.
        #[serde(default)]
        about: Option<Vector<Length>>,
    }
}
