//! Embedding of a problem in `D` dimensions in space: material laws are always three-dimensional.

use crate::body::Body;

/// Embedding of `D` coordinates in three dimensions. It extends a velocity gradient to a 3 x 3 tensor and reduces the force of a 3 x 3
/// stress to `D` components.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an embedding of {D} dimensions",
    note = "the dimensions are those of the grid's lattice: in two take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`"
)]
pub trait Embedding<const D: usize>: Copy + Send + Sync + 'static {
    /// Name in tables and messages.
    const NAME: &'static str;
    /// True if the third direction is the hoop direction around the axis x = 0. Then its strain rate is v_x / x, its stress acts along x,
    /// and masses and volumes are per radian.
    const HOOP: bool = false;
}

/// Three dimensions.
#[derive(Clone, Copy, Debug, Default)]
pub struct FullSpace;
impl Embedding<3> for FullSpace {
    const NAME: &'static str = "3D";
}

/// Line of bars with uniaxial stress. Volumes and forces are those of the cross-sections.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line;
impl Embedding<1> for Line {
    const NAME: &'static str = "line";
}

/// Two dimensions without strain along the third; masses and forces are per metre of depth.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlaneStrain;
impl Embedding<2> for PlaneStrain {
    const NAME: &'static str = "plane strain";
}

/// Coordinates (r, z) of a body of revolution without swirl; masses, volumes and forces are per radian.
/// Tensor components: x is r, y is z, z is the hoop direction.
#[derive(Clone, Copy, Debug, Default)]
pub struct Axisymmetric;
impl Embedding<2> for Axisymmetric {
    const NAME: &'static str = "axisymmetric";
    const HOOP: bool = true;
}

/// Any embedding, for operations without strain and force.
#[derive(Clone, Copy, Debug, Default)]
pub struct AnySpace;
impl<const D: usize> Embedding<D> for AnySpace {
    const NAME: &'static str = "any";
}

/// Return the description of a method for bodies with these laws: "plane strain" becomes "plane stress" if the stress across the plane is
/// zero. Both have the coordinates of [`PlaneStrain`] and differ by the law.
#[must_use]
pub fn described(description: &str, bodies: &[&dyn Body]) -> String {
    let plates = bodies.iter().any(|body| body.is_plane_stress());
    let strain = <PlaneStrain as Embedding<2>>::NAME;
    if plates { description.replacen(strain, "plane stress", 1) } else { description.into() }
}

/// Return the unit of an extensive quantity (mass, momentum, force, energy) of a scene: `kg`, `kg/rad` around an axis, `kg/m` per metre of
/// depth in the plane, `kg/m^2` per area of cross-section along a line.
///
/// ```
/// use impactite_scene::embedding::unit_of_part;
/// assert_eq!(unit_of_part("kg", 2, true), "kg/rad");
/// assert_eq!(unit_of_part("kg m/s", 2, false), "(kg m/s)/m");
/// assert_eq!(unit_of_part("J", 3, false), "J");
/// ```
#[must_use]
pub fn unit_of_part(unit: &str, dimensions: usize, axisymmetric: bool) -> String {
    let per = match (dimensions, axisymmetric) {
        (_, true) => "rad",
        (1, _) => "m^2",
        (2, _) => "m",
        _ => return unit.into(),
    };
    if unit.contains([' ', '/']) { format!("({unit})/{per}") } else { format!("{unit}/{per}") }
}

/// Return the reference of an extensive quantity, as written after its unit: " per radian", " per metre of depth"; empty in three
/// dimensions.
#[must_use]
pub fn part_in_words(dimensions: usize, axisymmetric: bool) -> &'static str {
    match (dimensions, axisymmetric) {
        (_, true) => " per radian",
        (1, _) => " per square metre of cross-section",
        (2, _) => " per metre of depth",
        _ => "",
    }
}
