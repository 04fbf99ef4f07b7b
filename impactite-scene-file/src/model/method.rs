//! Numerical methods.

use std::borrow::Cow;
use std::fmt::Formatter;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::Vector;
use super::parts::parts;
use super::several::Several;
use super::shape::Shape;
use crate::quantity::{Length, Plain, Pressure, Quantity, SurfaceEnergy, Time};

/// Default penalty of the fluxes over Young's modulus.
pub const PENALTY: f64 = 5.0;
/// Default tolerance of particle contact over the spacing, in two and three dimensions: diagonals of a square lattice touch from 0.42,
/// those of a cubic lattice from 0.74.
pub const TOLERANCES: [f64; 2] = [0.5, 0.8];
/// Default gap, in tolerances, beyond which an element is a crack.
pub const STRETCH: f64 = 2.0;
/// Default maximum number of subcycles.
pub const SUBCYCLES: u32 = 1;

/// The method of a scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Material point method: large deformation, many bodies, fragments.
    Mpm(Mpm),
    /// Finite elements: moderate deformation, exact surfaces.
    Fem(Fem),
    /// Smoothed particles.
    Sph(Sph),
    /// Fragile points: cracks between cells.
    Fpm(Fpm),
    /// Particle-contact meshfree method.
    Pcmm(Pcmm),
    /// Incompressible flow of a liquid with a free surface, by particles on a staggered grid; `plane strain` and `3d`.
    Flow(Flow),
}

parts! {
    /// Material point method.
    Mpm {
        /// Edge of a cell of the background grid; or `{ coarse, fine }`: cells of `coarse`, halved down to `fine` near walls and other bodies
        /// while the scene runs.
        #[schemars(example = &"5 mm")]
        cell: CellSize,
        /// Purpose, which chooses the parts of the method. Instead of it `parts`.
        #[serde(default, rename = "for")]
        #[schemars(example = "contact at rest", extend("default" = Purpose::default()))]
        purpose: Option<Purpose>,
        /// Shape function, transfer and stress update, of the combinations that are compiled (`impactite list parts`).
        #[serde(default)]
        parts: Option<Parts>,
        /// Particles in a cell along each axis.
        #[serde(default = "two")]
        #[schemars(example = 3, extend("minimum" = 1, "maximum" = 8))]
        particles_per_cell: u32,
        /// Place of a node of the grid; the origin if not given.
        #[serde(default)]
        #[schemars(example = ("0.5 mm", 0))]
        origin: Option<Vector<Length>>,
        /// Smaller cells in regions, or where a state variable has reached a value: one, or a list. For B-splines with `apic` or `aflip`,
        /// as `for = "impact"` has them.
        #[serde(default)]
        refine: Several<Refine>,
        /// Storage of the grid.
        #[serde(default)]
        #[schemars(extend("default" = "blocks"))]
        grid: Grid,
        /// Local damping towards rest: part of the unbalanced nodal force, contact included, that is taken away. 0.05 for slow processes, 0.7 to come to rest soonest. Soonest with linear shape functions, `flip` and `musl`; not with the transfers `apic` and `mls`.
        #[serde(default)]
        #[schemars(example = 0.7, extend("minimum" = 0, "exclusiveMaximum" = 1))]
        local_damping: Option<Quantity<Plain>>,
        /// Kinetic damping: all velocities become zero whenever the kinetic energy has passed a peak.
        #[serde(default)]
        kinetic_damping: bool,
        /// Steps between filterings of the velocities that nodes do not see (null space). Never if not given.
        #[serde(default)]
        #[schemars(example = 10)]
        null_space_filter: Option<u64>,
    }
    /// Smaller cells in a `region` or by `state`. Particles in them are smaller, too; one that enters them is divided.
    Refine {
        /// Region: the blocks of four cells an axis that it touches are refined. At rest, and there from the start, unless it `moves_with` a
        /// body.
        #[serde(default)]
        region: Option<Shape>,
        /// Body whose centre of mass the region follows; its place is that at the start. Cells that it has left remain small.
        #[serde(default)]
        #[schemars(example = &"rod")]
        moves_with: Option<String>,
        /// Instead of a region: where a state variable of the law has reached a value, decided while the scene runs.
        #[serde(default)]
        state: Option<StateFrom>,
        /// Number of halvings of the cells.
        #[serde(default = "once")]
        #[schemars(example = 2, extend("minimum" = 1, "maximum" = 7))]
        halvings: u32,
    }
    /// State variable, and the value from which cells become smaller.
    StateFrom {
        /// Name of the state variable, as `plastic_strain` or `damage`.
        #[schemars(example = &"plastic_strain")]
        name: String,
        /// Least value, in SI units.
        #[schemars(example = 0.05)]
        least: f64,
    }
    /// Edges of the largest and the smallest cells. Halved cells are for B-splines with `apic` or `aflip`, as `for = "impact"` has them.
    CellRange {
        /// Edge of the largest cells.
        #[schemars(example = &"0.8 mm")]
        coarse: Quantity<Length>,
        /// Largest edge of the smallest cells: cells of `coarse` are halved as often as needed, 7 times at most.
        #[schemars(example = &"0.2 mm")]
        fine: Quantity<Length>,
    }
    /// Incompressible flow of a liquid with a free surface.
    Flow {
        /// Edge of a cell of the grid.
        cell: Quantity<Length>,
        /// Particles in a cell along each axis at the start.
        #[serde(default = "two")]
        #[schemars(example = 2, extend("minimum" = 1, "maximum" = 8))]
        particles_per_cell: u32,
        /// Share of the density error of a cell that a step removes; 0 switches the correction of volumes off.
        #[serde(default)]
        #[schemars(example = 0.25, extend("minimum" = 0, "maximum" = 1, "default" = 0.25))]
        density_correction: Option<Quantity<Plain>>,
        /// Semi-staggered scheme, as printed, for comparison with the staggered one: velocities at nodes. It has no correction of the
        /// density; walls are lines of the grid that do not move, and no bodies are in the liquid.
        #[serde(default)]
        semi_staggered: Option<SemiStaggered>,
        /// Material points of the bodies of solids without a `mesh`. If not given, cells of the size of those of the liquid.
        #[serde(default)]
        solids: Option<Solids>,
    }
    /// Parameters of the semi-staggered scheme of incompressible flow.
    SemiStaggered {
        /// Share of the hourglass modes that a step filters from the velocities of nodes.
        #[serde(default)]
        #[schemars(example = 0.05, extend("minimum" = 0, "maximum" = 0.25, "default" = 0.05))]
        hourglass: Option<Quantity<Plain>>,
        /// Share of PIC in the velocities of particles; the rest is FLIP.
        #[serde(default)]
        #[schemars(example = 0.03, extend("minimum" = 0, "maximum" = 1, "default" = 0.03))]
        pic: Option<Quantity<Plain>>,
    }
    /// Material points in an incompressible liquid.
    Solids {
        /// Edge of a cell of their grid.
        #[schemars(example = &"5 mm")]
        cell: Quantity<Length>,
        /// Purpose, which chooses the parts of the method: `impact` damps vibrations; not `contact at rest` and `large elastic`. Instead of it
        /// `parts`.
        #[serde(default, rename = "for")]
        #[schemars(example = "machine parts", extend("default" = Purpose::MachineParts))]
        purpose: Option<Purpose>,
        /// Shape function, transfer and stress update; the transfers `flip` and `blend`, or `aflip`.
        #[serde(default)]
        parts: Option<Parts>,
        /// Particles in a cell along each axis.
        #[serde(default = "two")]
        #[schemars(example = 3, extend("minimum" = 1, "maximum" = 8))]
        particles_per_cell: u32,
    }
    /// A grid that holds all nodes of a box.
    Dense {
        /// Lower corner.
        #[schemars(example = (0, 0))]
        from: Vector<Length>,
        /// Upper corner.
        #[schemars(example = ("0.2 m", "0.1 m"))]
        to: Vector<Length>,
    }
    /// Finite elements.
    Fem {
        /// Bodies with self-contact.
        #[serde(default)]
        #[schemars(example = ("body",))]
        touch_themselves: Vec<String>,
        /// Most steps of the scene that a body with a longer stable step makes as one.
        #[serde(default)]
        #[schemars(example = 8, extend("default" = SUBCYCLES, "minimum" = 1))]
        subcycles: Option<u32>,
        /// Local damping towards rest: part of the unbalanced nodal force, contact included, that is taken away. 0.05 for slow processes, 0.7 to come to rest soonest.
        #[serde(default)]
        #[schemars(example = 0.7, extend("minimum" = 0, "exclusiveMaximum" = 1))]
        local_damping: Option<Quantity<Plain>>,
    }
    /// Smoothed particles.
    Sph {
        /// Distance of particles.
        spacing: Quantity<Length>,
        /// Configuration of the kernels; if not given `updated` for liquids and `total_lagrangian` for other bodies.
        #[serde(default)]
        #[schemars(extend("default" = SphForm::default()))]
        form: Option<SphForm>,
        /// Local damping towards rest: part of the unbalanced force of particles, contact included, that is taken away. 0.05 for slow processes, 0.7 to come to rest soonest.
        #[serde(default)]
        #[schemars(example = 0.7, extend("minimum" = 0, "exclusiveMaximum" = 1))]
        local_damping: Option<Quantity<Plain>>,
    }
    /// Fragile points.
    Fpm {
        /// Distance of points.
        spacing: Quantity<Length>,
        /// Positions of points, for bodies without a mesh.
        #[serde(default)]
        points: Points,
        /// Seed of random points.
        #[serde(default = "one")]
        #[schemars(example = 7)]
        seed: u64,
        /// Numerical flux between cells.
        #[serde(default)]
        flux: Flux,
        /// Penalty of the flux over Young's modulus.
        #[serde(default)]
        #[schemars(example = 5, extend("default" = PENALTY, "exclusiveMinimum" = 0))]
        penalty: Option<Quantity<Plain>>,
        /// Criterion at which faces open; never if not given.
        #[serde(default)]
        cracks: Option<Cracks>,
        /// Coefficient of friction of cracks that close; frictionless if not given.
        #[serde(default)]
        #[schemars(example = 0.3)]
        friction: Option<Quantity<Plain>>,
        /// Local damping towards rest: part of the unbalanced force of points, contact included, that is taken away. 0.05 for slow processes, 0.7 to come to rest soonest.
        #[serde(default)]
        #[schemars(example = 0.7, extend("minimum" = 0, "exclusiveMaximum" = 1))]
        local_damping: Option<Quantity<Plain>>,
    }
    /// Particle-contact meshfree method.
    Pcmm {
        /// Distance of particles.
        spacing: Quantity<Length>,
        /// Gap between the radii of particles that still touch, in spacings; 0.5 in the plane and 0.8 in space if not given. Where particles begin
        /// on a lattice at least 0.42 in the plane and 0.74 in space.
        #[serde(default)]
        #[schemars(example = 0.45, extend("default" = TOLERANCES[0], "exclusiveMinimum" = 0))]
        tolerance: Option<Quantity<Plain>>,
        /// Gap beyond which an element is a crack, in tolerances: 20 for metal that flows.
        #[serde(default)]
        #[schemars(example = 20, extend("default" = STRETCH))]
        stretch: Option<Quantity<Plain>>,
    }
    /// A combination of parts.
    Parts {
        /// Shape function.
        #[schemars(example = &"linear")]
        shape_function: ShapeFunction,
        /// Transfer between particles and grid.
        #[schemars(example = &"flip")]
        transfer: Transfer,
        /// Time of the stress update in a step.
        #[schemars(example = &"musl")]
        stress_update: StressUpdate,
        /// Time constant with which FLIP relaxes towards PIC: for the transfer `blend`, which needs it.
        #[serde(default)]
        #[schemars(example = "2 us")]
        relaxation: Option<Quantity<Time>>,
    }
    /// Steps by a bound of the highest frequency.
    Gershgorin {
        /// Part of the stable step.
        #[schemars(example = 0.8)]
        factor: Quantity<Plain>,
        /// Steps for which a bound is kept.
        #[serde(default = "ten")]
        #[schemars(example = 5)]
        every: u64,
    }
    /// A tension.
    MaximumTension {
        /// Tensile strength.
        #[schemars(example = "3 MPa")]
        strength: Quantity<Pressure>,
    }
    /// Tension and shear.
    MixedTensionShear {
        /// Tensile strength.
        #[schemars(example = "3 MPa")]
        tension: Quantity<Pressure>,
        /// Shear strength.
        #[schemars(example = "6 MPa")]
        shear: Quantity<Pressure>,
    }
    /// Strength and fracture energy.
    Cohesive {
        /// Tensile strength.
        #[schemars(example = "3 MPa")]
        strength: Quantity<Pressure>,
        /// Fracture energy of an area.
        energy: Quantity<SurfaceEnergy>,
        /// Cells of a face part as it begins to soften. Otherwise they stay joined until the face carries nothing.
        #[serde(default)]
        parted: bool,
    }
}

/// Edge of a cell, or of the largest and the smallest cells.
#[derive(Clone, Copy, Debug)]
pub struct CellSize {
    /// Edge of a cell, or of the largest ones, m.
    pub value: f64,
    /// Largest edge of the smallest cells, m, if a range is given.
    pub fine: Option<f64>,
}

impl<'de> Deserialize<'de> for CellSize {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads;
        impl Reads {
            fn one<'de, D: Deserializer<'de>>(from: D) -> Result<CellSize, D::Error> {
                Quantity::<Length>::deserialize(from).map(|cell| CellSize { value: cell.value, fine: None })
            }
        }
        impl<'de> Visitor<'de> for Reads {
            type Value = CellSize;
            fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
                write!(f, "a length: a number in m, a text with a unit as \"3 m\", or `{{ coarse, fine }}`")
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<CellSize, E> {
                Reads::one(value.into_deserializer())
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<CellSize, E> {
                Reads::one(value.into_deserializer())
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<CellSize, E> {
                Reads::one(value.into_deserializer())
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<CellSize, E> {
                Reads::one(text.into_deserializer())
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<CellSize, A::Error> {
                CellRange::deserialize(MapAccessDeserializer::new(map))
                    .map(|range| CellSize { value: range.coarse.value, fine: Some(range.fine.value) })
            }
        }
        from.deserialize_any(Reads)
    }
}

impl JsonSchema for CellSize {
    fn schema_name() -> Cow<'static, str> {
        "CellSize".into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (one, range) =
            (generator.subschema_for::<Quantity<Length>>(), generator.subschema_for::<CellRange>());
        json_schema!({ "anyOf": [one, range] })
    }
}

fn once() -> u32 {
    1
}

fn two() -> u32 {
    2
}
fn ten() -> u64 {
    10
}
fn one() -> u64 {
    1
}

/// Storage of the background grid.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Grid {
    /// Blocks of nodes where particles are; no bounds.
    #[default]
    Blocks,
    /// All nodes of a box, for scenes that fill it. A particle that leaves the box stops the run.
    Dense(Dense),
}

impl Flow {
    /// Material point method of the bodies of solids.
    #[must_use]
    pub fn method_of_solids(&self) -> Mpm {
        let solids = self.solids.as_ref();
        let parts = solids.and_then(|solids| solids.parts.clone());
        let purpose = solids.and_then(|solids| solids.purpose);
        Mpm {
            cell: CellSize { value: solids.map_or(self.cell, |solids| solids.cell).value, fine: None },
            purpose: purpose.or_else(|| parts.is_none().then_some(Purpose::MachineParts)),
            parts,
            particles_per_cell: solids.map_or_else(two, |solids| solids.particles_per_cell),
            origin: None,
            refine: Several::default(),
            grid: Grid::default(),
            local_damping: None,
            kinetic_damping: false,
            null_space_filter: None,
        }
    }
}

/// Purpose of a scene of material points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub enum Purpose {
    /// Impact, penetration, fragments.
    #[default]
    #[serde(rename = "impact")]
    Impact,
    /// Bodies that rest on each other, piles, slopes.
    #[serde(rename = "contact at rest")]
    ContactAtRest,
    /// Elastic bodies that bounce and roll on others.
    #[serde(rename = "machine parts")]
    MachineParts,
    /// Large elastic deformation of bodies that neither break nor flow.
    #[serde(rename = "large elastic")]
    LargeElastic,
}

/// A shape function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShapeFunction {
    /// Linear: cheapest and narrowest; noise when particles cross cell faces.
    Linear,
    /// cpGIMP: linear, averaged over a domain of the particle that follows the strain.
    Cpgimp,
    /// Quadratic B-splines: smooth.
    QuadraticBSpline,
}

/// A transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Transfer {
    /// FLIP: no dissipation of its own, keeps the noise.
    Flip,
    /// Blend of FLIP and PIC: forgets noise within the time `relaxation`.
    Blend,
    /// APIC: filters noise, conserves angular momentum.
    Apic,
    /// AFLIP: FLIP with the affine field of APIC and a share of PIC; less damping than APIC.
    Aflip,
    /// MLS-MPM: APIC in moving-least-squares form, the cheapest affine step.
    Mls,
}

/// Time of the stress update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StressUpdate {
    /// Stress last, by velocities mapped a second time (MUSL).
    Musl,
    /// Stress last (USL).
    Usl,
}

/// Reference configuration of smoothed particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SphForm {
    /// Initial configuration: for bodies that stay whole.
    #[default]
    TotalLagrangian,
    /// Current configuration: for bodies that flow and tear.
    Updated,
}

/// Positions of points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Points {
    /// Random, made even by three Lloyd steps: cracks find their way.
    #[default]
    Random,
    /// Lattice: squares and cubes.
    Lattice,
}

/// A numerical flux.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Flux {
    /// Derivative of an energy: keeps energy and momentum.
    #[default]
    Symmetric,
    /// Original formulation, without the symmetric term.
    Incomplete,
}

/// Criterion at which faces open.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Cracks {
    /// Tension at a strength.
    MaximumTension(MaximumTension),
    /// Tension and shear together at their strengths.
    MixedTensionShear(MixedTensionShear),
    /// Cohesive: strength and fracture energy.
    Cohesive(Cohesive),
}

/// Time step.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TimeStep {
    /// Part of the stable step (Courant number).
    #[schemars(extend("examples" = [{"factor": 0.5}]))]
    Factor(Quantity<Plain>),
    /// Step of fixed size, for convergence studies.
    #[schemars(extend("examples" = [{"fixed": "10 ns"}]))]
    Fixed(Quantity<Time>),
    /// Part of Gershgorin's bound of the step, by the highest frequency of the nodes (`mpm`).
    Gershgorin(Gershgorin),
}
