//! Three-region crush curve of porous brittle solids.

use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Constants of a [`CrushCurve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrushConstants<T> {
    /// Pressure at which pores begin to collapse, P_crush, Pa.
    pub crush_pressure: T,
    /// Compression mu at P_crush.
    pub crush_compression: T,
    /// Pressure of full pore collapse, P_lock, Pa.
    pub lock_pressure: T,
    /// Compression mu_lock of the pore-free material at zero pressure.
    pub lock_compression: T,
    /// Coefficients K1, K2, K3 of the pore-free material, Pa.
    pub solid: [T; 3],
}

/// Crush curve p(mu) of Holmquist, Johnson and Cook with the largest compression mu_max as history
/// (\[HolmquistJohnsonCook1993\], book, "Concrete"). On loading, mu = mu_max:
///
/// - I: p = K_e mu up to P_crush, K_e = P_crush/mu_crush;
/// - II: a straight line from (mu_crush, P_crush) to (mu_plock, P_lock);
/// - III: p = K1 m + K2 m^2 + K3 m^3, m = (mu - mu_lock)/(1 + mu_lock).
///
/// Region II ends at **mu_plock, where the curve of region III reaches P_lock**, not at mu_lock, where that curve is
/// zero: p is thus continuous. Below mu_max it unloads and reloads along a straight line, into tension too, of slope
/// (1 - F) K_e + F K1 with F = (mu_max - mu_crush)/(mu_plock - mu_crush) in II and K1/(1 + mu_lock) in III. The slope
/// drops from K1 to K1/(1 + mu_lock) at mu_plock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrushCurve<T> {
    constants: CrushConstants<T>,
    /// Compression mu_plock at the end of region II.
    locked: T,
}

impl<T: Real> CrushCurve<T> {
    /// Create from constants.
    ///
    /// # Errors
    /// P_crush, mu_crush, mu_lock or K1 not positive; P_lock not above P_crush; K2 or K3 not finite; no or too small
    /// a mu_plock (P_lock beyond the first maximum of region III, or mu_plock not above mu_crush); a solid softer
    /// than K_e.
    pub fn new(constants: CrushConstants<T>) -> Result<Self, ParameterError> {
        let check = Check("crush curve");
        let k = &constants;
        check.positive("P_crush", k.crush_pressure)?;
        check.positive("mu_crush", k.crush_compression)?;
        check.that(k.lock_pressure > k.crush_pressure, "P_lock", k.lock_pressure, "above P_crush")?;
        check.positive("mu_lock", k.lock_compression)?;
        check.positive("K1", k.solid[0])?;
        check.that(true, "K2", k.solid[1], "finite")?;
        check.that(true, "K3", k.solid[2], "finite")?;
        let elastic = k.crush_pressure / k.crush_compression;
        check.that(k.solid[0] >= elastic, "K1", k.solid[0], "at least P_crush/mu_crush")?;
        let locked = plock(k);
        let reached = locked.is_some_and(|mu| mu > k.crush_compression.to_double());
        let allowed = "reached by K1 m + K2 m^2 + K3 m^3 on its first rise, beyond mu_crush";
        check.that(reached, "P_lock", k.lock_pressure, allowed)?;
        Ok(Self::known(constants))
    }

    /// Create from checked constants.
    pub(crate) fn known(constants: CrushConstants<T>) -> Self {
        let locked = plock(&constants).map_or(constants.lock_compression, T::of);
        CrushCurve { constants, locked }
    }

    /// Elastic modulus K_e, Pa.
    #[inline(always)]
    pub fn elastic_modulus(&self) -> T {
        self.constants.crush_pressure / self.constants.crush_compression
    }
    /// Compression mu_crush, also mu_max of the virgin material.
    pub fn crush_compression(&self) -> T {
        self.constants.crush_compression
    }
    /// Compression mu_plock.
    pub fn locked_compression(&self) -> T {
        self.locked
    }

    #[inline(always)]
    fn solid<L: Lane<Real = T>>(&self, mu: L) -> L {
        (mu - L::splat(self.constants.lock_compression))
            * L::splat(T::of(1.0) / (T::of(1.0) + self.constants.lock_compression))
    }

    /// Pressure of virgin loading at mu >= mu_crush, Pa.
    #[inline(always)]
    pub fn loading<L: Lane<Real = T>>(&self, mu: L) -> L {
        let k = &self.constants;
        let slope = (k.lock_pressure - k.crush_pressure) / (self.locked - k.crush_compression);
        let line = L::splat(slope).mul_add(mu - L::splat(k.crush_compression), L::splat(k.crush_pressure));
        let m = self.solid(mu);
        let [k1, k2, k3] = k.solid;
        let solid = m * L::splat(k3).mul_add(m, L::splat(k2)).mul_add(m, L::splat(k1));
        L::select(mu.lt(L::splat(self.locked)), line, solid)
    }

    /// Slope dp/dmu of virgin loading at mu >= mu_crush, Pa.
    #[inline(always)]
    pub fn loading_slope<L: Lane<Real = T>>(&self, mu: L) -> L {
        let k = &self.constants;
        let line = (k.lock_pressure - k.crush_pressure) / (self.locked - k.crush_compression);
        let m = self.solid(mu);
        let [k1, k2, k3] = k.solid;
        let per_m = L::splat(k3 * T::of(3.0)).mul_add(m, L::splat(k2 * T::of(2.0))).mul_add(m, L::splat(k1));
        let solid = per_m * L::splat(T::of(1.0) / (T::of(1.0) + k.lock_compression));
        L::select(mu.lt(L::splat(self.locked)), L::splat(line), solid)
    }

    /// Slope dp/dmu of unloading from `largest` = mu_max >= mu_crush, Pa.
    #[inline(always)]
    pub fn unloading_slope<L: Lane<Real = T>>(&self, largest: L) -> L {
        let k = &self.constants;
        let elastic = self.elastic_modulus();
        let per_crushing = T::of(1.0) / (self.locked - k.crush_compression);
        let crushed = (largest - L::splat(k.crush_compression)) * L::splat(per_crushing);
        let porous = L::splat(k.solid[0] - elastic).mul_add(crushed, L::splat(elastic));
        let solid = L::splat(k.solid[0] / (T::of(1.0) + k.lock_compression));
        L::select(largest.lt(L::splat(self.locked)), porous, solid)
    }

    /// Pressure at `mu` on the unloading line from `largest` = mu_max >= mu, Pa; on the loading curve if they are
    /// equal. No tension cut-off.
    #[inline(always)]
    pub fn pressure<L: Lane<Real = T>>(&self, mu: L, largest: L) -> L {
        self.loading(largest) - self.unloading_slope(largest) * (largest - mu)
    }

    /// Crushing strain mu_p: residual compression after unloading from mu_max to zero pressure, at most mu_lock.
    #[inline(always)]
    pub fn crushing<L: Lane<Real = T>>(&self, largest: L) -> L {
        let porous = largest - self.loading(largest) / self.unloading_slope(largest);
        let full = L::splat(self.constants.lock_compression);
        L::select(largest.lt(L::splat(self.locked)), porous.min(full), full)
    }
}

/// Smallest mu at which region III reaches P_lock, if it does before its first maximum.
fn plock<T: Real>(constants: &CrushConstants<T>) -> Option<f64> {
    let (lock, mu_lock) = (constants.lock_pressure.to_double(), constants.lock_compression.to_double());
    let [k1, k2, k3] = constants.solid.map(T::to_double);
    let solid = |m: f64| m * (k1 + m * (k2 + m * k3));
    let slope = |m: f64| k1 + m * (2.0 * k2 + m * 3.0 * k3);
    // Steps far smaller than the scale of the curve.
    let part = 1e-3 * lock / k1;
    let mut above = part;
    for _ in 0..100_000 {
        if solid(above) >= lock {
            let (mut low, mut high) = (above - part, above);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if solid(middle) < lock { low = middle } else { high = middle }
            }
            return Some(mu_lock + (1.0 + mu_lock) * high);
        }
        if slope(above) <= 0.0 {
            return None;
        }
        above += part;
    }
    None
}
