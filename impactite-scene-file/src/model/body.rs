//! Bodies.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parts::parts;
use super::several::Several;
use super::shape::Shape;
use super::{Axis, Vector};
use crate::formula::Formula;
use crate::quantity::{Acceleration, Area, Density, Length, Plain, Pressure, Quantity, Speed, Spin, Time};

/// A body: a shape or a mesh of a material, with its initial motion and the loads on it alone.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
#[schemars(extend("examples" = [{"material": "steel", "shape": {"ball": {"centre": [0, "5 mm"], "radius": "5 mm"}}}]))]
pub struct Body {
    /// Name of the material, of the table `materials`. A rigid body has none.
    #[serde(default)]
    #[schemars(example = &"steel")]
    pub material: Option<String>,
    /// Shape of the body.
    #[serde(default)]
    pub shape: Option<Shape>,
    /// Elements: a regular mesh of the shape, bars, or a file. For `fem`, `fpm`, bodies of elements in `mpm` (`elements`), and deformable bodies in `flow`.
    #[serde(default)]
    pub mesh: Option<Mesh>,
    /// Finite elements instead of particles for this body of a scene of `mpm`.
    #[serde(default)]
    pub elements: Option<ElementsAmongParticles>,
    /// Initial velocity, a component an axis: numbers, or formulas of place. Instead of it `speed` with `direction`.
    #[serde(default)]
    #[schemars(example = (0, "-190 m/s"))]
    pub velocity: Option<Vec<Formula<Speed>>>,
    /// Initial speed along `direction`.
    #[serde(default)]
    #[schemars(example = "600 m/s")]
    pub speed: Option<Quantity<Speed>>,
    /// Direction of `speed`, of any length.
    #[serde(default)]
    #[schemars(example = (1, -1))]
    pub direction: Option<Vector<Plain>>,
    /// Initial angular velocity about the centre of mass: one number in the plane, three in space, none around an axis.
    #[serde(default)]
    #[schemars(example = ("30 rad/s",))]
    pub spin: Option<Vec<Quantity<Spin>>>,
    /// A rigid body (`mpm`), instead of a `material`.
    #[serde(default)]
    pub rigid: Option<Rigid>,
    /// Deactivation until another body comes near (`mpm`).
    #[serde(default)]
    pub deactivated: bool,
    /// Stretch at which particles are split (`mpm`); 2 is usual. Never if not given.
    #[serde(default)]
    #[schemars(example = 2, extend("exclusiveMinimum" = 1))]
    pub split_at: Option<Quantity<Plain>>,
    /// Particles in a cell above which split ones are merged (`mpm`), with `split_at`.
    #[serde(default)]
    #[schemars(example = 12)]
    pub merge_above: Option<u32>,
    /// Acceleration by place and time, in addition to `gravity`: by the initial place (`mpm`), by the present one of a liquid, the same for all
    /// bodies of liquid (`flow`).
    #[serde(default)]
    #[schemars(example = (0, "= -3 * x * sin(t)"))]
    pub body_force: Option<Vec<Formula<Acceleration>>>,
    /// Integration of elements (`fem`, and elements in `mpm`). If not given, by kind: one point with hourglass stiffness for bricks and quadrilaterals of the plane, mean dilatation for quadrilaterals around an axis, averaged volumes for triangles and tetrahedra.
    #[serde(default)]
    pub integration: Option<Integration>,
    /// Traction or pressure on a part of the surface (not of `pcmm`): a table, or a list of tables.
    #[serde(default)]
    pub traction: Several<Traction>,
    /// Stress at the start, Pa, tension positive: formulas of place, a key a component (`mpm` and `sph`); components that are not given are zero. Points are in
    /// the state of a virgin one that was strained to that stress. What balances it is up to the scene.
    #[serde(default)]
    #[schemars(extend("examples" = [{"xx": "= 4905 * (y - 10)", "yy": "= 9810 * (y - 10)", "zz": "= 4905 * (y - 10)"}]))]
    pub initial_stress: Option<InitialStress>,
    /// Starts of the detonation of an explosive (`mpm`).
    #[serde(default)]
    pub lit: Vec<Lit>,
    /// Erosion of elements (`fem`, and elements in `mpm`): any of its criteria deletes an element.
    #[serde(default)]
    pub erosion: Option<Erosion>,
    /// Faces that are open from the start (`fpm`).
    #[serde(default)]
    pub notches: Vec<Notch>,
    /// Copies of the body on a lattice, named by its name and a number from 1: `ball 1`, `ball 2`.
    #[serde(default)]
    pub repeat: Option<Repeat>,
}

/// Default hourglass stiffness over shear stiffness.
pub const HOURGLASS_STIFFNESS: f64 = 0.05;

parts! {
    /// A rigid body.
    Rigid {
        /// Density.
        density: Quantity<Density>,
        /// Motion as `velocity` and `spin` prescribe, whatever acts on the body. `velocity` may then be formulas of time.
        #[serde(default)]
        prescribed: bool,
        /// Axes along which the velocity stays as it starts.
        #[serde(default)]
        #[schemars(example = ("x",))]
        hold: Vec<Axis>,
        /// Rotation fixed.
        #[serde(default)]
        no_turning: bool,
    }
    /// A load on the surface: a `traction` in a fixed direction on the initial area, or a `pressure` that follows the surface.
    Traction {
        /// The region of the loaded surface: particles, or faces, that start in it. For particles it should contain one layer.
        #[serde(default)]
        region: Option<Shape>,
        /// Named surface of a mesh from a file, instead of `region` (`fem`): a physical group of Gmsh, a set of nodes or a `*SURFACE` of
        /// Abaqus. It has the faces all of whose nodes are in it.
        #[serde(default)]
        #[schemars(example = &"top")]
        surface: Option<String>,
        /// Axis normal to the loaded faces; needed with `region` and `traction`, else faces of any direction are loaded.
        #[serde(default)]
        #[schemars(example = &"y")]
        normal: Option<Axis>,
        /// Traction vector, a component an axis: numbers, or formulas of time.
        #[serde(default)]
        #[schemars(example = (0, "-10 MPa"))]
        traction: Option<Vec<Formula<Pressure>>>,
        /// Pressure, positive inwards, along the present normals on the present areas (`fem`, `fpm`): a number, or a formula of time. Instead of
        /// `traction`.
        #[serde(default)]
        #[schemars(example = &"2 MPa")]
        pressure: Option<Formula<Pressure>>,
    }
    /// Components of a stress.
    InitialStress {
        /// Component along x.
        #[serde(default)]
        #[schemars(example = "-10 kPa")]
        xx: Option<Formula<Pressure>>,
        /// Component along y.
        #[serde(default)]
        #[schemars(example = "= 9810 * (y - 10)")]
        yy: Option<Formula<Pressure>>,
        /// Component along z, in the plane across it; around an axis along that.
        #[serde(default)]
        #[schemars(example = "-10 kPa")]
        zz: Option<Formula<Pressure>>,
        /// Shear stress of y and z.
        #[serde(default)]
        #[schemars(example = "1 kPa")]
        yz: Option<Formula<Pressure>>,
        /// Shear stress of x and z.
        #[serde(default)]
        #[schemars(example = "1 kPa")]
        xz: Option<Formula<Pressure>>,
        /// Shear stress of x and y.
        #[serde(default)]
        #[schemars(example = "1 kPa")]
        xy: Option<Formula<Pressure>>,
        /// Component along r.
        #[serde(default)]
        #[schemars(example = "-10 kPa")]
        rr: Option<Formula<Pressure>>,
        /// Component around the axis.
        #[serde(default)]
        #[schemars(example = "-10 kPa")]
        tt: Option<Formula<Pressure>>,
        /// Shear stress of r and z.
        #[serde(default)]
        #[schemars(example = "1 kPa")]
        rz: Option<Formula<Pressure>>,
    }
    /// A start of a detonation.
    Lit {
        /// Place.
        at: Vector<Length>,
        /// Normal of a plane through the place that is lit at once; without it a point is lit.
        #[serde(default)]
        #[schemars(example = (1, 0))]
        plane: Option<Vector<Plain>>,
        /// Time of lighting.
        #[serde(default)]
        #[schemars(example = "2 us")]
        time: Quantity<Time>,
    }
    /// Criteria of erosion.
    Erosion {
        /// Plastic strain that deletes an element, in half of its integration points.
        #[serde(default)]
        #[schemars(example = 1.5)]
        plastic_strain: Option<Quantity<Plain>>,
        /// Deletion of elements of which half of the integration points have failed.
        #[serde(default)]
        failed: bool,
        /// Volume over reference volume below which an element is deleted.
        #[serde(default)]
        #[schemars(example = 0.1)]
        volume: Option<Quantity<Plain>>,
        /// Stable time step below which an element is deleted.
        #[serde(default)]
        #[schemars(example = "1 ns")]
        step: Option<Quantity<Time>>,
    }
    /// Hourglass control: stiffness or viscosity.
    HourglassControl {
        /// Hourglass stiffness over shear stiffness.
        #[serde(default)]
        #[schemars(example = 0.05, extend("default" = HOURGLASS_STIFFNESS, "exclusiveMinimum" = 0, "maximum" = 1))]
        stiffness: Option<Quantity<Plain>>,
        /// Hourglass viscosity, instead of a stiffness.
        #[serde(default)]
        #[schemars(example = 0.1, extend("exclusiveMinimum" = 0, "maximum" = 0.25))]
        viscosity: Option<Quantity<Plain>>,
    }
    /// Copies on a lattice.
    Repeat {
        /// Number of copies along each axis; at most 100 000 together.
        #[schemars(example = (3, 2))]
        counts: Vec<u32>,
        /// Distance of copies along each axis.
        #[schemars(example = ("10 mm", "10 mm"))]
        step: Vector<Length>,
    }
    /// A straight cut in the plane; in space a flat convex one.
    Notch {
        /// Two ends in the plane, corners in space.
        #[schemars(example = ((0, "5 mm"), ("4 mm", "5 mm")))]
        corners: Vec<Vector<Length>>,
        /// Width of the notch; zero if not given.
        #[serde(default)]
        #[schemars(example = "0.3 mm")]
        gap: Option<Quantity<Length>>,
    }
    /// Finite elements in a scene of particles.
    ElementsAmongParticles {
        /// Contact of elements and particles.
        #[serde(default)]
        by: MeetBy,
        /// Name of the body of particles in which the elements are embedded by perfect bond: bars in concrete. Instead of `by`.
        #[serde(default)]
        #[schemars(example = &"body")]
        within: Option<String>,
    }
    /// Straight bars.
    Bars {
        /// Both ends of each bar.
        #[schemars(example = (((0, 0), ("1 m", 0)),))]
        lines: Vec<[Vector<Length>; 2]>,
        /// Approximate length of an element.
        #[schemars(example = "25 mm")]
        edge: Quantity<Length>,
        /// Area of the section of a bar; in the plane per metre of depth.
        #[schemars(example = "1 cm^2")]
        section: Quantity<Area>,
    }
}

/// Integration of elements.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Integration {
    /// One point with hourglass control, for quadrilaterals and bricks: `integration.one_point = {}` takes the default stiffness.
    OnePoint(HourglassControl),
    /// Two points along each axis; locks where the volume must be kept.
    Full,
    /// Two points along each axis with the mean dilatation of the element.
    MeanDilatation,
    /// Dilatation averaged over nodes, for triangles and tetrahedra.
    AveragedVolumes,
}

/// Contact of elements and particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MeetBy {
    /// Particles against the facets of the mesh: elements of any size. The scene needs a `contact`.
    #[default]
    Surface,
    /// On the grid, with the elements' nodes as particles: elements about as large as cells.
    Grid,
}

/// Elements of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mesh {
    /// Regular mesh of the body's `shape`, with edges of about this length. Of `box` and `ball`, in space also of `cylinder` and `tube`.
    #[schemars(extend("examples" = [{"edge": "1 mm"}]))]
    Edge(Quantity<Length>),
    /// Straight bars.
    Bars(Bars),
    /// File of Gmsh, `.msh`, of versions 2 and 4. Elements of second order are read by their corners.
    Gmsh(MeshFile),
    /// Input file of Abaqus or CalculiX, `.inp`, with the files that it includes.
    #[schemars(extend("examples" = [{"abaqus": {"file": "part.inp", "unit": "1 mm"}}]))]
    Abaqus(MeshFile),
}

parts! {
    /// A file with a mesh.
    MeshFile {
        /// Path of the file, relative to the folder of the scene file.
        #[schemars(example = "part.msh")]
        file: PathBuf,
        /// Length of a unit of the file.
        #[schemars(example = "1 mm")]
        unit: Quantity<Length>,
        /// Groups whose elements the body has: physical groups of Gmsh, element sets and instances of Abaqus; all elements if not given.
        #[serde(default)]
        #[schemars(example = ("steel",))]
        groups: Option<Vec<String>>,
    }
}
