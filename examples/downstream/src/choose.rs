//! Methods and laws selected by name, as in a scene file or on a command line: objects of one type each.

use std::sync::Arc;

use impactite::materials::{IntoMaterial, LinearElastic, Material, Moduli, NeoHookean, library};
use impactite::mpm::geometry::{Ball, Filling, Lattice, fill};
use impactite::mpm::{
    Apic, Blend, BlockGrid, Boundary, CpGimp, Flip, IntoKernels, Kernels, Linear, Method, Mls, Mpm, Musl,
    PlaneStrain, QuadraticBSpline, Side, Usl,
};

use crate::{StandardLinearSolid, tent_apic};

/// Error of a selection or a scene.
pub type Failure = Box<dyn std::error::Error>;

/// Names of methods.
pub const METHODS: [&str; 8] = [
    "linear-flip",
    "linear-blend",
    "linear-flip-reference",
    "cpgimp-flip",
    "quadratic-flip",
    "quadratic-apic",
    "quadratic-mls",
    "tent-apic",
];
/// Names of laws.
pub const LAWS: [&str; 8] =
    ["linear-elastic", "neo-hookean", "copper", "aluminium", "tungsten", "soil", "concrete", "rubber"];

/// Number of cells across the radius of the disk, and cell size, m.
const CELLS: f64 = 8.0;
const SPACING: f64 = 0.005;

/// Time constant of the blend, s.
pub const TAU: f64 = 1e-4;

/// Return a method by its name, in plane strain.
///
/// # Errors
/// Unknown name.
pub fn method(name: &str) -> Result<Kernels<f64, 2>, Failure> {
    Ok(match name {
        "linear-flip" => Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels(),
        "linear-blend" => Method::new(Linear, Blend::new(TAU)?, Musl, PlaneStrain).into_kernels(),
        "linear-flip-reference" => {
            Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian().into_kernels()
        }
        "cpgimp-flip" => Method::new(CpGimp, Flip, Musl, PlaneStrain).into_kernels(),
        "quadratic-flip" => Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).into_kernels(),
        "quadratic-apic" => Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain).into_kernels(),
        "quadratic-mls" => Method::new(QuadraticBSpline, Mls, Usl, PlaneStrain).into_kernels(),
        "tent-apic" => tent_apic(),
        _ => return Err(format!("no method `{name}`; there are {}", METHODS.join(", ")).into()),
    })
}

/// Return a law by its name.
///
/// # Errors
/// Unknown name.
pub fn law(name: &str) -> Result<Arc<dyn Material<f64>>, Failure> {
    Ok(match name {
        "linear-elastic" => linear_elastic()?.into_material(),
        "neo-hookean" => neo_hookean()?.into_material(),
        "copper" => library::copper_taylor().into_material(),
        "aluminium" => library::aluminium_6061_t6().into_material(),
        "tungsten" => library::tungsten_alloy().with_bulk_viscosity(0.06, 1.5)?.into_material(),
        "soil" => library::slope_soil().into_material(),
        "concrete" => library::concrete_48().into_material(),
        "rubber" => StandardLinearSolid::new(1000.0, 2.0e7, 1.0e6, 2.0e6, 1.0e-3)?.material(),
        _ => return Err(format!("no law `{name}`; there are {}", LAWS.join(", ")).into()),
    })
}

/// Return a stiff elastic solid.
///
/// # Errors
/// None.
pub fn linear_elastic() -> Result<LinearElastic<f64>, Failure> {
    Ok(LinearElastic::new(7850.0, Moduli::young_poisson(206e9, 0.3)?)?)
}

/// Return a soft hyperelastic solid.
///
/// # Errors
/// None.
pub fn neo_hookean() -> Result<NeoHookean<f64>, Failure> {
    Ok(NeoHookean::new(1000.0, Moduli::young_poisson(1e7, 0.4)?)?)
}

/// Build a scene: a disk of a law hits a wall at a hundredth of its wave speed. Its type does not depend on method and law.
///
/// # Errors
/// Invalid scene definition.
pub fn scene(method: impl IntoKernels<f64, 2>, law: impl IntoMaterial<f64>) -> Result<Mpm<2>, Failure> {
    let law = law.into_material();
    let wave = law.describe_point(&law.virgin()).ok_or("a law says nothing of its virgin state")?.wave_speed;
    let lattice = Lattice::new([0.0; 2], SPACING)?;
    let radius = CELLS * SPACING;
    let disk = fill(&Ball::new([0.0, 1.02 * radius], radius)?, &lattice, 2, &Filling::new())?;
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("disk", law, &disk, |_| [0.0, -0.01 * wave])?;
    // Impenetrable plane: total Lagrangian bodies do not support walls.
    mpm.bound(Boundary::Fixed { axis: 1, at: 0.0, side: Side::Above })?;
    Ok(mpm)
}

/// Hash position, velocity, stress and state of all particles (FNV-1a).
pub fn fingerprint(mpm: &Mpm<2>) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for body in mpm.bodies() {
        body.for_each(&mut |p| {
            for x in p.position.iter().chain(&p.velocity).chain(&p.stress).chain(&p.state) {
                hash = (hash ^ x.to_bits()).wrapping_mul(0x100_0000_01b3);
            }
        });
    }
    hash
}
