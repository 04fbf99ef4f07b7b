//! Stabilisation of zero-energy modes and of the tensile instability.

use std::fmt::Debug;

use crate::form::{TotalLagrangian, Updated};

/// Stabilisation for a form `F`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not go with the form `{F}`",
    note = "`ZeroEnergyPenalty` is by the deformation gradient of the reference configuration: it is for `TotalLagrangian`",
    note = "`ArtificialStress`, `PairViscosity` and `DensityDiffusion` are for `Updated`: under kernels of the reference configuration there is no tensile instability"
)]
pub trait Stabilisation<F>: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// True with a zero-energy penalty.
    const PENALTY: bool = false;
    /// True with artificial stress.
    const STRESS: bool = false;
    /// True if the effect of the artificial stress on linear velocity fields is subtracted.
    const BALANCE: bool = false;
    /// True with pair viscosity.
    const VISCOSITY: bool = false;
    /// True with density diffusion.
    const DIFFUSION: bool = false;
    /// Stiffness of the penalty over the longitudinal modulus.
    fn penalty(&self) -> f64 {
        0.0
    }
    /// Factor of the artificial stress over the tensile stress, and exponent of the kernel over its value at the spacing.
    fn artificial(&self) -> (f64, i32) {
        (0.0, 4)
    }
    /// Linear and quadratic coefficient of the pair viscosity.
    fn viscosity(&self) -> [f64; 2] {
        [0.0; 2]
    }
    /// Coefficient of the density diffusion.
    fn diffusion(&self) -> f64 {
        0.0
    }
}

/// Invalid number of a stabilisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilisationError {
    what: &'static str,
    value: f64,
}
impl std::fmt::Display for StabilisationError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let StabilisationError { what, value } = self;
        write!(f, "stabilisation: {what} = {value} is not allowed; it must be zero or positive, and finite")
    }
}
impl std::error::Error for StabilisationError {}

fn not_negative(what: &'static str, value: f64) -> Result<f64, StabilisationError> {
    if value >= 0.0 && value.is_finite() { Ok(value) } else { Err(StabilisationError { what, value }) }
}

/// No stabilisation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unstabilised;
macro_rules! nothing {
    ($($form:ident),*) => {$(
        impl Stabilisation<$form> for Unstabilised {
            const NAME: &'static str = "no stabilisation";
        }
    )*};
}
nothing!(TotalLagrangian, Updated);

/// Springs against deviations of the positions of neighbours from the deformation gradient of a particle, with the energy
///
/// U = 1/2 sum_i sum_j alpha rho0 c^2 V_i V_j (-W'/R) |x_ij - F_i X_ij|^2,
///
/// with c the speed of longitudinal waves at rest. F_i minimises the sum over j, so that the force of a pair is the whole derivative of the
/// energy; \[Ganzenmueller2015\] chose it along the line of the pair. The energy is booked, momentum and angular momentum are conserved to
/// rounding, and linear deformation causes no force. By default alpha is 0.02: the springs do not yield, and far stiffer ones restrain the
/// spreading of plastic metal (book, "Taylor bars of 4340 steel").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZeroEnergyPenalty(f64);
impl Default for ZeroEnergyPenalty {
    fn default() -> Self {
        ZeroEnergyPenalty(0.02)
    }
}
impl ZeroEnergyPenalty {
    /// Create a penalty with this alpha.
    ///
    /// # Errors
    /// A negative or non-finite alpha.
    pub fn new(alpha: f64) -> Result<Self, StabilisationError> {
        Ok(ZeroEnergyPenalty(not_negative("alpha of the zero-energy penalty", alpha)?))
    }
}
impl Stabilisation<TotalLagrangian> for ZeroEnergyPenalty {
    const NAME: &'static str = "zero-energy penalty";
    const PENALTY: bool = true;
    fn penalty(&self) -> f64 {
        self.0
    }
}

/// Artificial stress against the clumping of particles in tension \[Gray2001\]: the tensile principal stresses s of a pair add R = -eps s
/// times (W(r) / W(d))^4, d the spacing, with a quotient of at most one: a larger quotient would feed motion where one principal stress is
/// tensile and particles are compressed along another one. By default eps is 0.3. R follows the stress with a delay of twenty wave passages
/// through the smoothing length: without delay it would be a non-symmetric stiffness, under which particles flutter and gain energy in
/// tension. It is not a part of the law; its energy is booked ([`Exchange::viscosity`](impactite_scene::Exchange::viscosity)).
///
/// It is balanced: with T = sum_j V_j (-W'/r) (W(r) / W(d))^4 d (x) d and M the same sum without the quotient, a pair receives
/// R_i ((W(r) / W(d))^4 - T_i M_i^-1), repulsive at short distance and attractive at long distance. This does no work in a linear velocity
/// field and conserves the angular momentum. [`PrintedArtificialStress`] is not balanced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArtificialStress(f64);

/// [`ArtificialStress`] without balance, the original formulation: a part of every tensile stress. It softens a vibrating beam by some 20 %
/// at any spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrintedArtificialStress(f64);

macro_rules! artificial {
    ($($stress:ident: $name:literal, $balance:literal;)*) => {$(
        impl Default for $stress {
            fn default() -> Self {
                $stress(0.3)
            }
        }
        impl $stress {
            /// Create an artificial stress with this eps.
            ///
            /// # Errors
            /// A negative or non-finite eps.
            pub fn new(eps: f64) -> Result<Self, StabilisationError> {
                Ok($stress(not_negative("eps of the artificial stress", eps)?))
            }
        }
        impl Stabilisation<Updated> for $stress {
            const NAME: &'static str = $name;
            const STRESS: bool = true;
            const BALANCE: bool = $balance;
            fn artificial(&self) -> (f64, i32) {
                (self.0, 4)
            }
        }
    )*};
}
artificial! {
    ArtificialStress: "balanced artificial stress", true;
    PrintedArtificialStress: "artificial stress as printed", false;
}

/// Pair viscosity between approaching particles \[Monaghan1992\]: Pi = (-alpha c mu + beta mu^2) / rho, mu = h v.r / (r^2 + 0.01 h^2). It
/// damps velocities that alternate from particle to particle and cause no velocity gradient. The dissipated energy is booked
/// ([`Exchange::viscosity`](impactite_scene::Exchange::viscosity)) and does not heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairViscosity([f64; 2]);
impl Default for PairViscosity {
    fn default() -> Self {
        PairViscosity([0.5, 0.5])
    }
}
impl PairViscosity {
    /// Pair viscosity of liquids: alpha 0.05 and no beta.
    pub const LIQUID: PairViscosity = PairViscosity([0.05, 0.0]);
    /// Create a pair viscosity with these alpha and beta.
    ///
    /// # Errors
    /// A negative or non-finite coefficient.
    pub fn new(alpha: f64, beta: f64) -> Result<Self, StabilisationError> {
        let alpha = not_negative("alpha of the viscosity of pairs", alpha)?;
        Ok(PairViscosity([alpha, not_negative("beta of the viscosity of pairs", beta)?]))
    }
}

impl Stabilisation<Updated> for PairViscosity {
    const NAME: &'static str = "viscosity of pairs";
    const VISCOSITY: bool = true;
    fn viscosity(&self) -> [f64; 2] {
        self.0
    }
}

/// Density diffusion \[Antuono2010\]: densities change by
///
/// d rho_i / dt = 2 delta sum_j V_j h_ij c_ij (-W'/r) (rho_j - rho_i - (grad rho_i + grad rho_j) . x_ij / 2)
///
/// besides by the divergence of velocity, with h and c the means of a pair and corrected gradients. It damps pressures that alternate from
/// particle to particle and cause no pressure gradient, and preserves a density that is linear in space, at surfaces too. Laws receive it
/// as a change of volume without shear; the energy of this change is booked
/// ([`Exchange::viscosity`](impactite_scene::Exchange::viscosity)). By default delta is 0.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DensityDiffusion(f64);
impl Default for DensityDiffusion {
    fn default() -> Self {
        DensityDiffusion(0.1)
    }
}
impl DensityDiffusion {
    /// Create a density diffusion with this delta.
    ///
    /// # Errors
    /// A negative or non-finite delta.
    pub fn new(delta: f64) -> Result<Self, StabilisationError> {
        Ok(DensityDiffusion(not_negative("delta of the diffusion of density", delta)?))
    }
}
impl Stabilisation<Updated> for DensityDiffusion {
    const NAME: &'static str = "diffusion of density";
    const DIFFUSION: bool = true;
    fn diffusion(&self) -> f64 {
        self.0
    }
}

/// Combine several stabilisations: each number is that of the one that has it; the others contribute zero.
macro_rules! together {
    ($($name:literal: $($part:ident $n:tt),+;)*) => {$(
        impl Stabilisation<Updated> for ($($part),+) {
            const NAME: &'static str = $name;
            const STRESS: bool = $(<$part as Stabilisation<Updated>>::STRESS)||+;
            const BALANCE: bool = $(<$part as Stabilisation<Updated>>::BALANCE)||+;
            const VISCOSITY: bool = $(<$part as Stabilisation<Updated>>::VISCOSITY)||+;
            const DIFFUSION: bool = $(<$part as Stabilisation<Updated>>::DIFFUSION)||+;
            fn artificial(&self) -> (f64, i32) {
                let parts = [$(Stabilisation::<Updated>::artificial(&self.$n)),+];
                (parts.iter().map(|part| part.0).sum(), parts[0].1)
            }
            fn viscosity(&self) -> [f64; 2] {
                let parts = [$(Stabilisation::<Updated>::viscosity(&self.$n)),+];
                [0, 1].map(|k| parts.iter().map(|part| part[k]).sum())
            }
            fn diffusion(&self) -> f64 {
                [$(Stabilisation::<Updated>::diffusion(&self.$n)),+].iter().sum()
            }
        }
    )*};
}
together! {
    "balanced artificial stress, viscosity of pairs": ArtificialStress 0, PairViscosity 1;
    "balanced artificial stress, diffusion of density": ArtificialStress 0, DensityDiffusion 1;
    "viscosity of pairs, diffusion of density": PairViscosity 0, DensityDiffusion 1;
    "balanced artificial stress, viscosity of pairs, diffusion of density":
        ArtificialStress 0, PairViscosity 1, DensityDiffusion 2;
}
