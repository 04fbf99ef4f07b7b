//! How a problem in `D` dimensions lies in space: laws are always three-dimensional.

use crate::body::Body;

/// An embedding of `D` coordinates in three dimensions. It lifts a velocity gradient to a 3 x 3 tensor and
/// brings the force of a 3 x 3 stress back.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an embedding of {D} dimensions",
    note = "the dimensions are those of the grid's lattice: in two take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`"
)]
pub trait Embedding<const D: usize>: Copy + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Is the third direction a hoop around the axis x = 0? Then its strain rate is v_x / x, its stress
    /// pushes along x, and masses and volumes are per radian.
    const HOOP: bool = false;
}

/// Three dimensions as they are.
#[derive(Clone, Copy, Debug, Default)]
pub struct FullSpace;
impl Embedding<3> for FullSpace {
    const NAME: &'static str = "3D";
}

/// A line: of bars, whose stress is along it alone. Volumes and forces are those of their sections.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line;
impl Embedding<1> for Line {
    const NAME: &'static str = "line";
}

/// Two dimensions with no strain along the third; masses and forces are per metre of depth.
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

/// Any of them, for what no strain and no force is part of.
#[derive(Clone, Copy, Debug, Default)]
pub struct AnySpace;
impl<const D: usize> Embedding<D> for AnySpace {
    const NAME: &'static str = "any";
}

/// The description of a method with bodies of these laws: "plane stress" for "plane strain" where the stress across the plane is zero. Both
/// have the coordinates of [`PlaneStrain`]; the law makes the difference.
#[must_use]
pub fn described(description: &str, bodies: &[&dyn Body]) -> String {
    let plates = bodies.iter().any(|body| body.is_plane_stress());
    let strain = <PlaneStrain as Embedding<2>>::NAME;
    if plates { description.replacen(strain, "plane stress", 1) } else { description.into() }
}

/// The unit of an extensive quantity (mass, momentum, force, energy) of a scene: `kg`, `kg/rad` around an axis, `kg/m` per metre of depth in the
/// plane, `kg/m^2` per area of cross-section along a line.
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

/// Reference of an extensive quantity of a scene, as written after its unit: " per radian", " per metre of depth"; empty of the whole.
#[must_use]
pub fn part_in_words(dimensions: usize, axisymmetric: bool) -> &'static str {
    match (dimensions, axisymmetric) {
        (_, true) => " per radian",
        (1, _) => " per square metre of cross-section",
        (2, _) => " per metre of depth",
        _ => "",
    }
}
