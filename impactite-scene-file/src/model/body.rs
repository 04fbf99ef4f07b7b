//! Bodies.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

use super::parts::parts;
use super::shape::Shape;
use super::{Axis, Vector};
use crate::formula::Formula;
use crate::quantity::{Acceleration, Area, Density, Length, Plain, Pressure, Quantity, Speed, Spin, Time};

/// A body: a shape (or a mesh) of a material, with its motion at the start and what acts on it alone.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Name of its material; none of a rigid body.
    #[serde(default)]
    pub material: Option<String>,
    /// What it fills.
    #[serde(default)]
    pub shape: Option<Shape>,
    /// Elements of a file or a regular mesh: for `fem`, for bodies of elements among particles (`elements`), and for `fpm`.
    #[serde(default)]
    pub mesh: Option<Mesh>,
    /// In a scene of `mpm`, compute this body by finite elements.
    #[serde(default)]
    pub elements: Option<ElementsAmongParticles>,
    /// Velocity at the start: numbers, or formulas of place. Instead of it `speed` with `direction`.
    #[serde(default)]
    pub velocity: Option<Vec<Formula<Speed>>>,
    /// Speed at the start, along `direction`.
    #[serde(default)]
    pub speed: Option<Quantity<Speed>>,
    /// Direction of `speed`; of any length.
    #[serde(default)]
    pub direction: Option<Vector<Plain>>,
    /// Angular velocity at the start, about the centre of the shape's bounds; in the plane one number, in space three.
    #[serde(default)]
    pub spin: Option<Vec<Quantity<Spin>>>,
    /// A rigid body (`mpm`).
    #[serde(default)]
    pub rigid: Option<Rigid>,
    /// Deactivated until another body comes near (`mpm`).
    #[serde(default)]
    pub deactivated: bool,
    /// Split particles at this stretch (`mpm`); 2 is usual.
    #[serde(default)]
    pub split_at: Option<Quantity<Plain>>,
    /// Merge particles that were split in cells that hold more than this (`mpm`), with `split_at`.
    #[serde(default)]
    pub merge_above: Option<u32>,
    /// Acceleration by the place where matter started and by time, beside `gravity` (`mpm`).
    #[serde(default)]
    pub body_force: Option<Vec<Formula<Acceleration>>>,
    /// How elements are integrated (`fem`, and elements in `mpm`); as their kind asks for if not given.
    #[serde(default)]
    pub integration: Option<Integration>,
    /// A load on a part of its surface.
    #[serde(default)]
    pub traction: Option<Traction>,
    /// Where an explosive is lit.
    #[serde(default)]
    pub lit: Vec<Lit>,
    /// Elements leave (`fem`).
    #[serde(default)]
    pub erosion: Option<Erosion>,
    /// Faces that are open from the start (`fpm`).
    #[serde(default)]
    pub notches: Vec<Notch>,
    /// As many such bodies, by their names and a number from 1.
    #[serde(default)]
    pub repeat: Option<Repeat>,
}

parts! {
    /// What a rigid body is like.
    Rigid {
        /// Density.
        density: Quantity<Density>,
        /// Does it move as its velocity and spin say, whatever meets it? Then these may be formulas of time.
        #[serde(default)]
        prescribed: bool,
        /// Axes along which its velocity stays as it starts.
        #[serde(default)]
        hold: Vec<Axis>,
        /// Does it not turn?
        #[serde(default)]
        no_turning: bool,
    }
    /// A dead load.
    Traction {
        /// It acts on the particles, or faces of the surface, that start in this shape. For particles it should hold one layer.
        region: Shape,
        /// The axis that the loaded faces are normal to.
        normal: Axis,
        /// Traction: numbers, or formulas of time.
        traction: Vec<Formula<Pressure>>,
    }
    /// A start of a detonation.
    Lit {
        /// A place.
        at: Vector<Length>,
        /// Lit in the whole plane through the place with this normal.
        #[serde(default)]
        plane: Option<Vector<Plain>>,
        /// When.
        #[serde(default)]
        time: Quantity<Time>,
    }
    /// When elements leave: by any of these.
    Erosion {
        /// Plastic strain.
        #[serde(default)]
        plastic_strain: Option<Quantity<Plain>>,
        /// Points that failed.
        #[serde(default)]
        failed: bool,
        /// Part of the reference volume.
        #[serde(default)]
        volume: Option<Quantity<Plain>>,
        /// Stable step below which they leave.
        #[serde(default)]
        step: Option<Quantity<Time>>,
    }
    /// What holds the deformations that one point does not see: one of these; a stiffness of 0.05 if none is given.
    HourglassControl {
        /// Springs, this part of the shear stiffness: above 0, at most 1.
        #[serde(default)]
        stiffness: Option<Quantity<Plain>>,
        /// Dashpots: above 0, at most 0.25.
        #[serde(default)]
        viscosity: Option<Quantity<Plain>>,
    }
    /// Bodies in rows.
    Repeat {
        /// How many along each axis.
        counts: Vec<u32>,
        /// Their distance along each axis.
        step: Vector<Length>,
    }
    /// A straight cut in the plane; in space a flat convex one.
    Notch {
        /// Ends, or corners in space.
        corners: Vec<Vector<Length>>,
        /// How wide it is.
        #[serde(default)]
        gap: Option<Quantity<Length>>,
    }
    /// How elements and particles meet.
    ElementsAmongParticles {
        /// The way.
        #[serde(default)]
        by: MeetBy,
        /// Instead of it, the body of particles that they are a part of, by perfect bond: bars in concrete.
        #[serde(default)]
        within: Option<String>,
    }
    /// Bars between points.
    Bars {
        /// Ends of each.
        lines: Vec<[Vector<Length>; 2]>,
        /// Length of their elements, about.
        edge: Quantity<Length>,
        /// Area of the section of one, in the plane per metre of depth.
        section: Quantity<Area>,
    }
}

/// How elements are integrated.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Integration {
    /// Quadrilaterals and bricks: one point with hourglass control.
    OnePoint(HourglassControl),
    /// Two points along each axis; locks where the volume must be kept.
    Full,
    /// Two points along each axis with the mean dilatation of the element.
    MeanDilatation,
    /// Triangles and tetrahedra: the change of volume averaged over nodes.
    AveragedVolumes,
}

/// How elements and particles meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MeetBy {
    /// Particles meet the facets of the mesh: elements of any size.
    #[default]
    Surface,
    /// On the grid: elements about as large as cells.
    Grid,
}

/// Where elements are from.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mesh {
    /// A regular mesh of the body's `shape` (box, ball, cylinder, tube, shell of the plane) with edges of about this length.
    Edge(Quantity<Length>),
    /// Straight bars.
    Bars(Bars),
    /// A file of Gmsh.
    Gmsh(MeshFile),
    /// A file of Abaqus.
    Abaqus(MeshFile),
}

parts! {
    /// A file with elements.
    MeshFile {
        /// The file; beside the scene's file unless the path is absolute.
        file: PathBuf,
        /// Length of a unit of the file.
        unit: Quantity<Length>,
    }
}
