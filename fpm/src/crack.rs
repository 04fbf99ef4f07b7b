//! Criteria for the opening of faces, and cohesive laws.

use std::fmt::Debug;

use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// Face stress for a criterion: true traction, Pa, normal (tension positive) and shear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceStress {
    /// Normal traction, Pa, tension positive.
    pub normal: f64,
    /// Magnitude of the shear traction, Pa.
    pub shear: f64,
}

/// Opening criterion of faces.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not say when faces open",
    label = "takes `NoCracks`, `MaximumTension`, `MixedTensionShear`, `Cohesive`, or another type that implements `Criterion`"
)]
pub trait Criterion: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    fn name(&self) -> &'static str;
    /// True if faces can open; otherwise the criterion is not evaluated.
    const OPENS: bool = true;
    /// Smallest magnitude of a traction that may open a face, Pa, in any direction.
    fn least(&self) -> f64;
    /// Traction over strength: a face opens at one.
    fn utilisation(&self, stress: FaceStress) -> f64;
    /// Fracture energy, the work per area of crack from the onset of opening, J/m^2; `None` if an open face carries no tension.
    fn work(&self) -> Option<f64> {
        None
    }
    /// True if the cells of a face stay joined while it softens; not evaluated for faces without fracture energy.
    fn stays_joined(&self) -> bool {
        true
    }
}

/// No opening: faces stay closed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoCracks;
impl Criterion for NoCracks {
    const OPENS: bool = false;
    fn name(&self) -> &'static str {
        "no cracks"
    }
    fn least(&self) -> f64 {
        f64::INFINITY
    }
    fn utilisation(&self, _: FaceStress) -> f64 {
        0.0
    }
}

const OWNER: &str = "criterion of cracks";
const POSITIVE: &str = "positive and finite";

/// Maximum tension, original formulation \[Shen2022\]: a face opens at once when its tension reaches the strength. The energy of a crack is
/// that stored in the adjacent cells, and so depends on their size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaximumTension(f64);
impl MaximumTension {
    /// Create a criterion with this strength, Pa.
    ///
    /// # Errors
    /// A strength that is not positive or not finite.
    pub fn new(strength: f64) -> Result<Self, SceneError> {
        Ok(MaximumTension(parameter(strength > 0.0, OWNER, "strength", strength, POSITIVE)?))
    }
}
impl Criterion for MaximumTension {
    fn name(&self) -> &'static str {
        "maximum tension"
    }
    fn least(&self) -> f64 {
        self.0
    }
    fn utilisation(&self, stress: FaceStress) -> f64 {
        stress.normal / self.0
    }
}

/// Mixed tension and shear: a face opens at once when (<t_n> / tension)^2 + (t_s / shear)^2 reaches one, with <t_n> zero in compression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixedTensionShear {
    tension: f64,
    shear: f64,
}
impl MixedTensionShear {
    /// Create a criterion with these strengths, Pa.
    ///
    /// # Errors
    /// A strength that is not positive or not finite.
    pub fn new(tension: f64, shear: f64) -> Result<Self, SceneError> {
        let tension = parameter(tension > 0.0, OWNER, "strength in tension", tension, POSITIVE)?;
        Ok(MixedTensionShear {
            tension,
            shear: parameter(shear > 0.0, OWNER, "strength in shear", shear, POSITIVE)?,
        })
    }
}
impl Criterion for MixedTensionShear {
    fn name(&self) -> &'static str {
        "mixed tension and shear"
    }
    fn least(&self) -> f64 {
        self.tension.min(self.shear)
    }
    fn utilisation(&self, stress: FaceStress) -> f64 {
        (stress.normal.max(0.0) / self.tension).hypot(stress.shear / self.shear)
    }
}

/// Cohesive face \[Hillerborg1976, CamachoOrtiz1996\]: it begins to open by the criterion `S`. Its traction then falls linearly with the
/// opening, so that the work of an area does not depend on the cell size. Unloading is linear to the origin.
///
/// The cells of the face stay joined while it softens, or part at the onset:
///
/// - **joined**, the default: cells see each other across the face minus its opening, which begins at zero, so that nothing jumps. The
///   traction, for the criterion and for the cohesive law, is the whole force between the two cells over the area, including the effect of
///   each cell's displacement on the gradient of the other. In uniform stress it is the traction of the stress. An area dissipates the
///   given work, in bars without a notch as well. Cells should be smaller than E work / strength^2: in cells wider than ten times that a
///   face softens faster than the material unloads, and parts at once.
/// - **parted** ([`parted`](Self::parted)): each cell leaves the support of the other's gradient, as behind a crack by the visibility
///   criterion of mesh-free methods, and only the traction acts between them. A cell in the cohesive zone loses stiffness with each face
///   that softens: cracks branch earlier, and an area dissipates 88 (case `glass_branching`) to 109 per cent of the work (`kalthoff`), and
///   49 to 107 in uniform stress. The face begins on a line with the slope of the penalty eta, at the strength; the energy stored at once,
///   strength^2 h / (2 eta), has no source and is booked as such: a tenth of the work in cells of E work / strength^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cohesive<S = MaximumTension> {
    begins: S,
    work: f64,
    joined: bool,
}
impl Cohesive {
    /// Create a cohesive face with this tensile strength, Pa, and the work of an area, J/m^2.
    ///
    /// # Errors
    /// A number that is not positive or not finite.
    pub fn new(strength: f64, work: f64) -> Result<Self, SceneError> {
        Cohesive::by(MaximumTension::new(strength)?, work)
    }
}
impl<S: Criterion> Cohesive<S> {
    /// Create a cohesive face with another criterion for the onset, and the work of an area, J/m^2.
    ///
    /// # Errors
    /// Work that is not positive or not finite.
    pub fn by(begins: S, work: f64) -> Result<Self, SceneError> {
        let work = parameter(work > 0.0, OWNER, "work of an area", work, POSITIVE)?;
        Ok(Cohesive { begins, work, joined: true })
    }
    /// Part the cells as a face begins to soften: each leaves the support of the other's gradient. ([`Crack::parted`](crate::Crack::parted)
    /// is the time at which a face loses its tension.)
    pub fn parted(self) -> Self {
        Cohesive { joined: false, ..self }
    }
}
impl<S: Criterion> Criterion for Cohesive<S> {
    const OPENS: bool = S::OPENS;
    fn name(&self) -> &'static str {
        if self.joined { "cohesive faces" } else { "cohesive faces, parted" }
    }
    fn least(&self) -> f64 {
        self.begins.least()
    }
    fn utilisation(&self, stress: FaceStress) -> f64 {
        self.begins.utilisation(stress)
    }
    fn work(&self) -> Option<f64> {
        Some(self.work)
    }
    fn stays_joined(&self) -> bool {
        self.joined
    }
}

/// Criterion chosen at run time, so that programs with such a choice are compiled once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyCriterion {
    /// No opening.
    None(NoCracks),
    /// Maximum tension.
    Tension(MaximumTension),
    /// Mixed tension and shear.
    Mixed(MixedTensionShear),
    /// Cohesive, with onset by tension.
    Cohesive(Cohesive),
    /// Cohesive, with onset by tension and shear.
    CohesiveMixed(Cohesive<MixedTensionShear>),
}

/// Dispatch to the chosen criterion.
macro_rules! chosen {
    ($any:ident, $one:ident => $what:expr) => {
        match $any {
            AnyCriterion::None($one) => $what,
            AnyCriterion::Tension($one) => $what,
            AnyCriterion::Mixed($one) => $what,
            AnyCriterion::Cohesive($one) => $what,
            AnyCriterion::CohesiveMixed($one) => $what,
        }
    };
}

impl Criterion for AnyCriterion {
    fn name(&self) -> &'static str {
        chosen!(self, c => c.name())
    }
    fn least(&self) -> f64 {
        chosen!(self, c => c.least())
    }
    fn utilisation(&self, stress: FaceStress) -> f64 {
        chosen!(self, c => c.utilisation(stress))
    }
    fn work(&self) -> Option<f64> {
        chosen!(self, c => c.work())
    }
    fn stays_joined(&self) -> bool {
        chosen!(self, c => c.stays_joined())
    }
}
