//! What is done against motions that sums over neighbours do not see, and against particles that clump in tension.

use std::fmt::Debug;

use crate::form::{TotalLagrangian, Updated};

/// A stabilisation that goes with a form `F`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not go with the form `{F}`",
    note = "`ZeroEnergyPenalty` is by the deformation gradient of the reference configuration: it is for `TotalLagrangian`",
    note = "`ArtificialStress`, `PairViscosity` and `DensityDiffusion` are for `Updated`: under kernels of the reference configuration there is no tensile instability"
)]
pub trait Stabilisation<F>: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Is there a zero-energy penalty?
    const PENALTY: bool = false;
    /// Is there an artificial stress?
    const STRESS: bool = false;
    /// Is what the artificial stress does to linear velocity fields taken off again?
    const BALANCE: bool = false;
    /// Is there a viscosity of pairs?
    const VISCOSITY: bool = false;
    /// Is there a diffusion of density?
    const DIFFUSION: bool = false;
    /// Stiffness of the penalty over the modulus of longitudinal waves.
    fn penalty(&self) -> f64 {
        0.0
    }
    /// Part of a tensile stress that pushes particles apart, and the power of the kernel over its value at the spacing.
    fn artificial(&self) -> (f64, i32) {
        (0.0, 4)
    }
    /// Linear and quadratic coefficient of the viscosity of pairs.
    fn viscosity(&self) -> [f64; 2] {
        [0.0; 2]
    }
    /// Coefficient of the diffusion of density.
    fn diffusion(&self) -> f64 {
        0.0
    }
}

/// A number of a stabilisation that cannot be.
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

/// None.
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

/// Springs against what the deformation gradient of a particle leaves of the places of its neighbours: the energy is
///
/// U = 1/2 sum_i sum_j alpha rho0 c^2 V_i V_j (-W'/R) |x_ij - F_i X_ij|^2,
///
/// with c the speed of longitudinal waves at rest. F_i is the very tensor for which the sum over j is least, so that the force of a pair,
/// which \[Ganzenmueller2015\] chose along its line, is here the whole derivative of an energy: that is in the books, momentum and angular
/// momentum are kept to rounding, and what deforms linearly feels nothing. By default alpha is
/// 0.02: the springs do not yield, and in metal that flows far stiffer ones hold back what should spread (book, "Taylor bars of 4340 steel").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZeroEnergyPenalty(f64);
impl Default for ZeroEnergyPenalty {
    fn default() -> Self {
        ZeroEnergyPenalty(0.02)
    }
}
impl ZeroEnergyPenalty {
    /// With this alpha.
    ///
    /// # Errors
    /// Negative or not finite.
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

/// A pressure that keeps particles in tension from clumping \[Gray2001\]: the tensile principal stresses s of a pair act once more as
/// R = -eps s times (W(r) / W(d))^4, d the spacing, with a quotient of at most one: where one principal stress is tensile and particles are
/// pressed together along another one, more of it would feed the motion. By default eps is 0.3. It follows the stress with a delay of twenty
/// times that a wave takes through the smoothing length: a force that depended on the stress at once would be a stiffness that is not
/// symmetric, under which particles flutter, and makes energy wherever there is tension. It is no part of the law: what it does is booked
/// ([`Exchange::impacts`](impactite_scene::Exchange::impacts)).
///
/// It is balanced: with T = sum_j V_j (-W'/r) (W(r) / W(d))^4 d (x) d and M the same sum without the quotient, a pair gets
/// R_i ((W(r) / W(d))^4 - T_i M_i^-1), which pushes apart those that are near and draws those that are far. In a linear velocity field that
/// does no work, and it keeps the angular momentum. [`PrintedArtificialStress`] is not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArtificialStress(f64);

/// [`ArtificialStress`] without its balance, as printed: a part of every tensile stress. A beam that swings is softened by it by some 20 %,
/// whatever the spacing.
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
            /// With this eps.
            ///
            /// # Errors
            /// Negative or not finite.
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

/// A viscosity between particles that approach each other \[Monaghan1992\]: Pi = (-alpha c mu + beta mu^2) / rho, mu = h v.r / (r^2 + 0.01
/// h^2). It takes energy from velocities that alternate from particle to particle, which no velocity gradient sees; what it takes is booked
/// ([`Exchange::impacts`](impactite_scene::Exchange::impacts)) and does not heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairViscosity([f64; 2]);
impl Default for PairViscosity {
    fn default() -> Self {
        PairViscosity([0.5, 0.5])
    }
}
impl PairViscosity {
    /// With these alpha and beta.
    ///
    /// # Errors
    /// Negative or not finite.
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

/// A diffusion of density \[Antuono2010\]: densities change by
///
/// d rho_i / dt = 2 delta sum_j V_j h_ij c_ij (-W'/r) (rho_j - rho_i - (grad rho_i + grad rho_j) . x_ij / 2)
///
/// besides by the divergence of velocity, h and c the means of a pair, the gradients those of the correction. It takes away pressures that
/// alternate from particle to particle, which no pressure gradient sees, and leaves a density that is linear in space as it is, at surfaces
/// too. Laws see it as a change of volume without shear; the energy that this gives them is booked
/// ([`Exchange::impacts`](impactite_scene::Exchange::impacts)). By default delta is 0.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DensityDiffusion(f64);
impl Default for DensityDiffusion {
    fn default() -> Self {
        DensityDiffusion(0.1)
    }
}
impl DensityDiffusion {
    /// With this delta.
    ///
    /// # Errors
    /// Negative or not finite.
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

/// Several at once: each number is that of the one that has it, and zero of the others.
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
