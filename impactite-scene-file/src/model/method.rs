//! Methods.

use schemars::JsonSchema;
use serde::Deserialize;

use super::Vector;
use super::parts::parts;
use crate::quantity::{Length, Plain, Pressure, Quantity, SurfaceEnergy, Time};

/// The method of a scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Material point method.
    Mpm(Mpm),
    /// Finite elements.
    Fem(Fem),
    /// Smoothed particles.
    Sph(Sph),
    /// Fragile points.
    Fpm(Fpm),
    /// Particle-contact meshfree method.
    Pcmm(Pcmm),
}

parts! {
    /// Material point method.
    Mpm {
        /// Edge of a cell of the background grid.
        cell: Quantity<Length>,
        /// What it is for: the parts of the method follow. Instead of it `parts`.
        #[serde(default, rename = "for")]
        purpose: Option<Purpose>,
        /// Shape function, transfer and stress update.
        #[serde(default)]
        parts: Option<Parts>,
        /// Particles a cell along each axis; 2 if not given.
        #[serde(default = "two")]
        particles_per_cell: u32,
        /// Where a node of the grid lies; at the origin if not given.
        #[serde(default)]
        origin: Option<Vector<Length>>,
        /// How the grid keeps its nodes.
        #[serde(default)]
        grid: Grid,
        /// Local damping towards rest, 0 to below 1: this part of the unbalanced force of nodes; 0.05 for slow processes, 0.7 to come to rest soonest. For linear shape functions: under wide ones it never rests, contact forces are 3 to 5 % too large, and its work is not in the balance of energy.
        #[serde(default)]
        local_damping: Option<Quantity<Plain>>,
        /// Stop everything whenever the kinetic energy has passed a peak, to come to rest?
        #[serde(default)]
        kinetic_damping: bool,
        /// Take out of velocities what nodes do not see, every so many steps.
        #[serde(default)]
        null_space_filter: Option<u64>,
    }
    /// A grid that holds all nodes of a box.
    Dense {
        /// Lower corner.
        from: Vector<Length>,
        /// Upper corner.
        to: Vector<Length>,
    }
    /// Finite elements.
    Fem {
        /// Which bodies also touch themselves.
        #[serde(default)]
        touch_themselves: Vec<String>,
        /// Most steps of the scene that a body with a longer stable step makes as one; 1 if not given.
        #[serde(default)]
        subcycles: Option<u32>,
    }
    /// Smoothed particles.
    Sph {
        /// Distance of particles.
        spacing: Quantity<Length>,
        /// Form.
        #[serde(default)]
        form: SphForm,
    }
    /// Fragile points.
    Fpm {
        /// Distance of points.
        spacing: Quantity<Length>,
        /// Where points are, for bodies without a mesh.
        #[serde(default)]
        points: Points,
        /// Seed of random points.
        #[serde(default = "one")]
        seed: u64,
        /// Flux.
        #[serde(default)]
        flux: Flux,
        /// Penalty over Young's modulus; 5 if not given.
        #[serde(default)]
        penalty: Option<Quantity<Plain>>,
        /// When faces open; never if not given.
        #[serde(default)]
        cracks: Option<Cracks>,
        /// Coefficient of friction of cracks that close.
        #[serde(default)]
        friction: Option<Quantity<Plain>>,
    }
    /// Particle-contact meshfree method.
    Pcmm {
        /// Distance of particles.
        spacing: Quantity<Length>,
        /// Particles touch that are this much further apart than their radii, in spacings; 0.5 if not given. At least 0.42 where they begin on a lattice.
        #[serde(default)]
        tolerance: Option<Quantity<Plain>>,
        /// Elements are cracks where gaps are this many tolerances; 2 if not given, 20 for metal that flows.
        #[serde(default)]
        stretch: Option<Quantity<Plain>>,
    }
    /// A choice of parts.
    Parts {
        /// Shape function.
        shape_function: ShapeFunction,
        /// Transfer.
        transfer: Transfer,
        /// When stress is updated in a step.
        stress_update: StressUpdate,
        /// Time constant with which FLIP relaxes towards PIC: for the transfer `blend`.
        #[serde(default)]
        relaxation: Option<Quantity<Time>>,
    }
    /// Steps by the bound of the highest frequency.
    Gershgorin {
        /// This part of the stable step.
        factor: Quantity<Plain>,
        /// Steps for which a bound is kept; 10 if not given.
        #[serde(default = "ten")]
        every: u64,
    }
    /// A tension.
    MaximumTension {
        /// The strength.
        strength: Quantity<Pressure>,
    }
    /// Tension and shear.
    MixedTensionShear {
        /// Tensile strength.
        tension: Quantity<Pressure>,
        /// Shear strength.
        shear: Quantity<Pressure>,
    }
    /// Strength and fracture energy.
    Cohesive {
        /// Strength.
        strength: Quantity<Pressure>,
        /// Fracture energy.
        energy: Quantity<SurfaceEnergy>,
        /// Do the cells of a face part as it begins to soften? Else they stay joined until it bears nothing.
        #[serde(default)]
        parted: bool,
    }
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

/// How the background grid keeps its nodes.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Grid {
    /// Blocks of nodes where particles are.
    #[default]
    Blocks,
    /// All nodes of a box, for scenes that fill it. What leaves it stops the run.
    Dense(Dense),
}

/// What a method is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
pub enum Purpose {
    /// Impact, penetration, fragments: quadratic B-splines, AFLIP, stress last.
    #[default]
    #[serde(rename = "impact")]
    Impact,
    /// Bodies that rest on each other: quadratic B-splines, APIC, stress last.
    #[serde(rename = "contact at rest")]
    ContactAtRest,
    /// Large elastic deformation of bodies that neither break nor flow: linear, total Lagrangian.
    #[serde(rename = "large elastic")]
    LargeElastic,
}

/// A shape function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShapeFunction {
    /// Linear.
    Linear,
    /// cpGIMP.
    Cpgimp,
    /// Quadratic B-splines.
    QuadraticBSpline,
}

/// A transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Transfer {
    /// FLIP.
    Flip,
    /// A blend of FLIP and PIC.
    Blend,
    /// APIC.
    Apic,
    /// AFLIP.
    Aflip,
    /// MLS-MPM.
    Mls,
}

/// When stress is updated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StressUpdate {
    /// Last, with velocities mapped anew (MUSL).
    Musl,
    /// Last (USL).
    Usl,
}

/// The form of smoothed particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SphForm {
    /// For bodies that stay whole.
    #[default]
    TotalLagrangian,
    /// For what flows and tears.
    Updated,
}

/// Where points of cells are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Points {
    /// At random, made more even by three of Lloyd's steps: cracks find their way.
    #[default]
    Random,
    /// On a lattice: squares and cubes.
    Lattice,
}

/// A flux.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Flux {
    /// The derivative of an energy.
    #[default]
    Symmetric,
    /// As printed.
    Incomplete,
}

/// When faces open.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Cracks {
    /// Where tension reaches a strength.
    MaximumTension(MaximumTension),
    /// Where tension and shear do.
    MixedTensionShear(MixedTensionShear),
    /// With fracture energy.
    Cohesive(Cohesive),
}

/// How steps are chosen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TimeStep {
    /// This part of the stable step.
    Factor(Quantity<Plain>),
    /// Always the same.
    Fixed(Quantity<Time>),
    /// By the bound of the highest frequency of the nodes (`mpm`).
    Gershgorin(Gershgorin),
}
