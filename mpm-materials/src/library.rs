//! Named materials with their sources.
//!
//! Each function returns a complete law for a body. Modelling choices (failure, bulk viscosity, objective rate) are
//! left out unless the law requires them, and added by `with_...`. The source of every number is in the doc comment
//! here or of the component it names, and in book, "Material constants", with the marks explained there: \[S\] printed
//! in the source, \[V\] seen in a public source, \[C\] computed, \[I\] inferred, **\[M\] from memory of the
//! literature**. Known misprints are noted.
//!
//! ```
//! use mpm_materials::{JohnsonCookDamage, library};
//! # fn main() -> Result<(), mpm_materials::ParameterError> {
//! let plate = library::aluminium_6061_t6()
//!     .with_failure(JohnsonCookDamage::<f64>::aluminium_6061())
//!     .with_bulk_viscosity(0.06, 1.5)?;
//! # let _ = plate;
//! # Ok(())
//! # }
//! ```

use crate::elastic::{LinearElastic, Moduli};
use crate::eos::{IdealGas, LogarithmicBulk, MieGruneisen, Tait};
use crate::explosive::Explosive;
use crate::failure::{DamageLimit, JohnsonCookDamage};
use crate::fluid::Fluid;
use crate::ground::Ground;
use crate::lane::Real;
use crate::solid::Solid;
use crate::strength::{
    AdiabaticJohnsonCook, Borvik, Cone, DruckerPrager, HolmquistJohnsonCook, J2, JohnsonCook,
    LinearHardening, SteinbergGuinan,
};

/// Metal with rate dependence, heating and shock compression.
pub type Metal<T> = Solid<AdiabaticJohnsonCook<T>, MieGruneisen<T>>;
/// Metal with strain hardening only, and shock compression.
pub type PlainMetal<T> = Solid<JohnsonCook<T>, MieGruneisen<T>>;

/// 6061-T6 aluminium: [`JohnsonCook::aluminium_6061`], [`MieGruneisen::aluminium_6061`] \[V\]. Failure:
/// [`JohnsonCookDamage::aluminium_6061`]. T651 differs in stress relief
/// alone.
pub fn aluminium_6061_t6<T: Real>() -> Metal<T> {
    Solid::new(JohnsonCook::aluminium_6061(), MieGruneisen::aluminium_6061())
}

/// 2024-T3 aluminium: [`JohnsonCook::aluminium_2024_t3`], [`MieGruneisen::aluminium_2024`] \[V\]. Failure:
/// [`JohnsonCookDamage::aluminium_2024_t3`]. Strength and failure are those of T3 sheet, moduli and Hugoniot those of T4.
pub fn aluminium_2024_t3<T: Real>() -> Metal<T> {
    Solid::new(JohnsonCook::aluminium_2024_t3(), MieGruneisen::aluminium_2024())
}

/// Aluminium as printed in \[Feng2014\] \[S\]: A 324, B 114 MPa, n 0.42, **C 0.016**, m 1.34, T_room 298 K, T_melt 877
/// K, c 875 J/(kg K); rho0 2703 kg/m^3, c0 5350 m/s, s 1.34, gamma0 1.97, G 26.7 GPa. Use it to reproduce that paper.
///
/// **Known faults of the set**: C is eight times that of 6061-T6; the melting temperature is that of 7039; density,
/// Hugoniot and shear modulus are of three alloys. The printed equation of state has a wrong sign, corrected here; its
/// `a` = 1.5 is a melting constant, left out. The rate factor of the paper is
/// [`SmoothLogarithmic`](crate::SmoothLogarithmic); this set uses the standard one.
pub fn aluminium_feng_2014<T: Real>() -> Metal<T> {
    let strength = JohnsonCook::adiabatic([26.7e9, 324e6, 114e6, 0.42], 0.016, [298.0, 877.0, 1.34, 875.0]);
    Solid::new(strength, MieGruneisen::known([2703.0, 5350.0, 1.34, 1.97]))
}

/// Copper as in the table of \[Feng2014\] \[S\]: A 89.63 MPa, n 0.31, C 0.025; rho0 8940 kg/m^3, c0 3940 m/s, s 1.49,
/// gamma0 2.02. Use it to reproduce that paper.
///
/// **Known faults of the set**: B is printed as 45 MPa and is 291.64 MPa \[M\] here; G is printed as 60.74 GPa (E 159
/// GPa), and is Steinberg's 47.7 GPa here; heat capacity and melting temperature (383 J/(kg K), 1356 K; m 1.09) are not
/// printed and are those of OFHC copper \[V\]. The printed `a` = 1.5 is a melting constant, left out.
pub fn copper_feng_2014<T: Real>() -> Metal<T> {
    let strength =
        JohnsonCook::adiabatic([47.7e9, 89.63e6, 291.64e6, 0.31], 0.025, [294.0, 1356.0, 1.09, 383.0]);
    Solid::new(strength, MieGruneisen::known([8940.0, 3940.0, 1.49, 2.02]))
}

/// OFHC copper, the handbook set: [`JohnsonCook::copper`], [`MieGruneisen::copper`] \[V\]. In Taylor tests it is some
/// per cent too soft in the foot (book, "The finite-element reference"); see [`copper_taylor`]. Failure:
/// [`JohnsonCookDamage::copper_ofhc`].
pub fn copper_ofhc<T: Real>() -> Metal<T> {
    Solid::new(JohnsonCook::copper(), MieGruneisen::copper())
}

/// OFHC copper fitted to Taylor tests: [`JohnsonCook::copper_taylor`], [`MieGruneisen::copper`] \[V\].
pub fn copper_taylor<T: Real>() -> PlainMetal<T> {
    Solid::new(JohnsonCook::copper_taylor(), MieGruneisen::copper())
}

/// OFHC copper, half hard, for rates above 1e5 /s: [`SteinbergGuinan::copper`], its hardening **\[M\]**, and
/// [`MieGruneisen::copper`] \[V\].
pub fn copper_steinberg<T: Real>() -> Solid<SteinbergGuinan<T>, MieGruneisen<T>> {
    Solid::new(SteinbergGuinan::copper(), MieGruneisen::copper())
}

/// Copper-like casing of MPM3D-F90 `TNT3D.mpm` \[V\]: rho0 8900 kg/m^3, E 117 GPa, nu 0.31, A 90, B 392 MPa, n 0.5, C
/// 0, c0 3300 m/s, s 1.49, gamma0 1.96. **B and c0 differ from copper's** 292 MPa and 3940 m/s: use it to reproduce
/// that deck.
pub fn copper_casing<T: Real>() -> PlainMetal<T> {
    let strength = JohnsonCook::known([117e9 / 2.62, 90e6, 392e6, 0.5]);
    Solid::new(strength, MieGruneisen::known([8900.0, 3300.0, 1.49, 1.96]))
}

/// 4340 steel: [`JohnsonCook::steel_4340`], [`MieGruneisen::steel_4340`] \[V\]. Failure:
/// [`JohnsonCookDamage::steel_4340`].
pub fn steel_4340<T: Real>() -> Metal<T> {
    Solid::new(JohnsonCook::steel_4340(), MieGruneisen::steel_4340())
}

/// 4340 steel for rates above 1e5 /s: [`SteinbergGuinan::steel_4340`], **with two misprints of its source corrected**
/// \[V\], \[I\], and [`MieGruneisen::steel_4340`] \[V\].
pub fn steel_4340_steinberg<T: Real>() -> Solid<SteinbergGuinan<T>, MieGruneisen<T>> {
    Solid::new(SteinbergGuinan::steel_4340(), MieGruneisen::steel_4340())
}

/// Elastic steel without yield, for penetrators: rho0 7850 kg/m^3, E 206 GPa, nu 0.3 (usual values, \[M\]).
pub fn steel_elastic<T: Real>() -> LinearElastic<T> {
    LinearElastic::known(7850.0, moduli(206e9, 0.3))
}

/// Weldox 460 E with ductile damage, failing at its critical damage: [`Borvik::weldox_460_e`], the set of 2001, **most
/// of it \[M\]**; rho0 7850 kg/m^3, E 200 GPa, nu 0.33. Its nominal stress in smooth tension peaks at 577 MPa, at a
/// strain of 22 % \[C\]; 570 MPa at 10 % were computed for the steel \[V\]. Without damage the same constants would
/// reach 611 MPa: they belong to the coupled law.
pub fn weldox_460_e<T: Real>() -> Solid<Borvik<T>, LogarithmicBulk<T>, DamageLimit<T>> {
    let strength = Borvik::weldox_460_e();
    let limit = DamageLimit::known(strength.critical_damage());
    Solid::new(strength, LogarithmicBulk::known(7850.0, 200e9 / (3.0 * 0.34))).with_failure(limit)
}

/// Weldox 460 E by the later set, whose damage does not soften: [`JohnsonCook::weldox_460_e`] and
/// [`JohnsonCookDamage::weldox_460_e`], constants of the quasi-static curve \[V\], **those of rate and heat \[M\]**;
/// rho0 7750 kg/m^3, E 211 GPa, nu 0.33 \[V\]. Its nominal stress in smooth tension peaks at 572 MPa, at a strain of 10
/// % \[C\]; 570 MPa at 10 % were computed for the steel \[V\].
pub fn weldox_460_e_uncoupled<T: Real>()
-> Solid<AdiabaticJohnsonCook<T>, LogarithmicBulk<T>, JohnsonCookDamage<T>> {
    let bulk = LogarithmicBulk::known(7750.0, 211e9 / (3.0 * 0.34));
    Solid::new(JohnsonCook::weldox_460_e(), bulk).with_failure(JohnsonCookDamage::weldox_460_e())
}

/// Hardened Arne tool steel, bilinear: rho0 7850 kg/m^3, E 204 GPa, nu 0.33, yield 1900 MPa, tangent 15 GPa
/// (**\[M\]**; book, "Material constants").
pub fn arne_tool_steel<T: Real>() -> Solid<J2<T>, LogarithmicBulk<T>> {
    let hardening = LinearHardening::known(1900e6, 204e9 * 15e9 / (204e9 - 15e9));
    Solid::new(J2::known(204e9 / 2.66, hardening), LogarithmicBulk::known(7850.0, 204e9 / (3.0 * 0.34)))
}

/// Tungsten alloy: [`JohnsonCook::tungsten_alloy`] \[V\], melting temperature and heat capacity **\[M\]**, and
/// [`MieGruneisen::tungsten_alloy`] \[V\].
pub fn tungsten_alloy<T: Real>() -> Metal<T> {
    Solid::new(JohnsonCook::tungsten_alloy(), MieGruneisen::tungsten_alloy())
}

/// Lead: [`JohnsonCook::lead`], [`MieGruneisen::lead`] \[V\]. The deck sets failure at a plastic strain of 3
/// ([`PlasticStrainLimit`](crate::PlasticStrainLimit)).
pub fn lead<T: Real>() -> PlainMetal<T> {
    Solid::new(JohnsonCook::lead(), MieGruneisen::lead())
}

/// Concrete of 48 MPa: [`HolmquistJohnsonCook::concrete_48`] \[V\]. No set for 140 MPa was found.
pub fn concrete_48<T: Real>() -> Ground<HolmquistJohnsonCook<T>> {
    Ground::new(HolmquistJohnsonCook::concrete_48())
}

/// Soil of a slope: [`DruckerPrager::slope_soil`] \[V\].
pub fn slope_soil<T: Real>() -> Ground<DruckerPrager<T>> {
    Ground::new(DruckerPrager::slope_soil())
}

/// Aluminium bars as two-dimensional granular material: [`DruckerPrager::aluminium_bars`] \[V\].
pub fn aluminium_bars<T: Real>() -> Ground<DruckerPrager<T>> {
    Ground::new(DruckerPrager::aluminium_bars())
}

/// Dry sand, typical values **\[M\]**, no particular sand: rho0 1600 kg/m^3, E 10 MPa, nu 0.3, phi 33 degrees, no
/// cohesion, no dilatancy, outer cone.
pub fn dry_sand<T: Real>() -> Ground<DruckerPrager<T>> {
    Ground::new(DruckerPrager::known(1600.0, [10e6, 0.3], Cone::Outer, 33.0, 0.0))
}

/// TNT: [`Explosive::tnt`] \[V\]. Detonation must be initiated: see [`Explosive`].
pub fn tnt<T: Real>() -> Explosive<T> {
    Explosive::tnt()
}

/// Air at 15 degrees Celsius: [`IdealGas::air`], the standard atmosphere.
pub fn air<T: Real>() -> Fluid<IdealGas<T>> {
    Fluid::new(IdealGas::air())
}

/// Water with its real stiffness: Tait, rho0 1000 kg/m^3, c0 1480 m/s (handbook values \[M\]). For free-surface flow
/// use [`Tait`] with c0 ten times the largest speed.
pub fn water<T: Real>() -> Fluid<Tait<T>> {
    Fluid::new(Tait::known(1000.0, 1480.0))
}

/// Water under shock: rho0 1000 kg/m^3, c0 1490 m/s, s 1.79, gamma0 1.65 (**\[M\]**).
pub fn water_shocked<T: Real>() -> Fluid<MieGruneisen<T>> {
    Fluid::new(MieGruneisen::known([1000.0, 1490.0, 1.79, 1.65]))
}

fn moduli<T: Real>(young: f64, poisson: f64) -> Moduli<T> {
    let (bulk, shear) = (young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
    Moduli { bulk: T::of(bulk), shear: T::of(shear) }
}
