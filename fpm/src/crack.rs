//! When faces open, and what they bear then.

use std::fmt::Debug;

use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// What a face is judged by: the true traction on it, Pa, across it (tension positive) and along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceStress {
    /// Across, tension positive.
    pub normal: f64,
    /// Along, its amount.
    pub shear: f64,
}

/// When faces open.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not say when faces open",
    label = "takes `NoCracks`, `MaximumTension`, `MixedTensionShear`, `Cohesive`, or another type that implements `Criterion`"
)]
pub trait Criterion: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    fn name(&self) -> &'static str;
    /// Do faces open at all? What does not is not asked.
    const OPENS: bool = true;
    /// The amount of a traction, Pa, below which no face opens, whatever its direction.
    fn least(&self) -> f64;
    /// Traction over strength: a face opens at one.
    fn utilisation(&self, stress: FaceStress) -> f64;
    /// The work that an area of crack takes after it began to open, J/m^2; none where a face bears nothing from then on.
    fn work(&self) -> Option<f64> {
        None
    }
    /// Do the cells of a face stay joined while it softens? Not asked of faces without work.
    fn stays_joined(&self) -> bool {
        true
    }
}

/// Faces stay closed.
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

/// A face opens at once where the tension on it reaches the strength, as printed \[Shen2022\]. What a crack takes of energy follows from
/// what the cells beside it held, and so from their size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaximumTension(f64);
impl MaximumTension {
    /// At this strength, Pa.
    ///
    /// # Errors
    /// Not positive or not finite.
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

/// A face opens at once where (<t_n> / tension)^2 + (t_s / shear)^2 reaches one, <t_n> zero in compression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixedTensionShear {
    tension: f64,
    shear: f64,
}
impl MixedTensionShear {
    /// At these strengths, Pa.
    ///
    /// # Errors
    /// Not positive or not finite.
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

/// A cohesive face \[Hillerborg1976, CamachoOrtiz1996\]: it begins to open as `S` says and bears from then on a traction that falls in a
/// straight line with the opening, so that an area takes the same work in cells of any size. On the way back traction falls in a straight
/// line to nothing.
///
/// Its cells stay joined while it softens, or part as it begins to:
///
/// - **joined**, the default: cells see each other across the face less its opening, which begins at zero, so that nothing jumps. The traction that it is
///   judged by, and bears, is the whole force between its two cells over its area: what their gradients make of each other's displacement too. Where a
///   stress is the same everywhere that is the traction of the stress. An area takes the work that is given, in bars without a notch as well. Cells shall
///   be smaller than E work / strength^2: where they are wider than ten times that, a face falls faster than matter gives way, and parts at once.
/// - **parted** ([`parted`](Self::parted)): each cell leaves the support of the other's gradient, as behind a crack by the visibility criterion of mesh-free
///   methods, and the traction alone is between them. A cell in the cohesive zone loses stiffness with each face that softens: cracks branch earlier, and an area
///   takes 88 (case `glass_branching`) to 109 per cent of the work (`kalthoff`), and 49 to 107 where stress is uniform. The face begins on a line as steep as
///   the penalty eta, at the strength; what that stores at once, strength^2 h / (2 eta), comes from nowhere and is booked so: a tenth of the work in cells
///   of E work / strength^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cohesive<S = MaximumTension> {
    begins: S,
    work: f64,
    joined: bool,
}
impl Cohesive {
    /// With this strength in tension, Pa, and the work of an area, J/m^2.
    ///
    /// # Errors
    /// Not positive or not finite.
    pub fn new(strength: f64, work: f64) -> Result<Self, SceneError> {
        Cohesive::by(MaximumTension::new(strength)?, work)
    }
}
impl<S: Criterion> Cohesive<S> {
    /// Beginning by another criterion, with the work of an area, J/m^2.
    ///
    /// # Errors
    /// Work that is not positive or not finite.
    pub fn by(begins: S, work: f64) -> Result<Self, SceneError> {
        let work = parameter(work > 0.0, OWNER, "work of an area", work, POSITIVE)?;
        Ok(Cohesive { begins, work, joined: true })
    }
    /// The same with cells that part as a face begins to soften: each leaves the support of the other's gradient. ([`Crack::parted`](crate::Crack::parted)
    /// is when a face bears nothing any more.)
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

/// A criterion chosen at run time: programs that let a reader choose are compiled once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyCriterion {
    /// Faces stay closed.
    None(NoCracks),
    /// At a tension.
    Tension(MaximumTension),
    /// At tension and shear.
    Mixed(MixedTensionShear),
    /// Cohesive from a tension on.
    Cohesive(Cohesive),
    /// Cohesive from tension and shear on.
    CohesiveMixed(Cohesive<MixedTensionShear>),
}

/// The same of whichever it is.
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
