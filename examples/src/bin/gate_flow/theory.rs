//! References of a gate under water and of a column of water: beams and experiment.

use std::f64::consts::PI;

use examples::Water;

use crate::setup::{GATE, GRAVITY, RUBBER, Setup, WATER};

/// Cantilever in plane strain, clamped at its upper end.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Bending stiffness E t^3 / (12 (1 - nu^2)), N m.
    bending: f64,
    /// Shear stiffness 5/6 G t, N/m.
    shear: f64,
    /// Mass per length, kg/m^2.
    mass: f64,
}

impl Beam {
    /// Create the beam of the gate.
    pub fn of(setup: &Setup) -> Self {
        let (young, poisson, [_, thickness]) = (setup.young(), setup.poisson, GATE);
        Beam {
            bending: young * thickness.powi(3) / (12.0 * (1.0 - poisson.powi(2))),
            shear: 5.0 / 6.0 * young / (2.0 * (1.0 + poisson)) * thickness,
            mass: setup.scale() * RUBBER * thickness,
        }
    }

    /// Deflection of the free end under water at rest, m (Timoshenko): the load grows from rho g (H - L) at the clamp by
    /// rho g L to the end.
    pub fn bend(&self) -> f64 {
        let ([length, _], weight) = (GATE, Water::DENSITY * GRAVITY);
        let (even, rising) = (weight * (WATER[1] - length), weight * length);
        let bending = (even / 8.0 + rising * 11.0 / 120.0) * length.powi(4) / self.bending;
        bending + (even / 2.0 + rising / 3.0) * length.powi(2) / self.shear
    }

    /// Period of the first mode in air, s: the root 1.8751 of cos(x) cosh(x) = -1 (Euler and Bernoulli).
    pub fn period(&self) -> f64 {
        2.0 * PI * (GATE[0] / 1.875_104_068_7).powi(2) * (self.mass / self.bending).sqrt()
    }
}

/// Hydrostatic force on gate and wall, N/m.
pub fn hydrostatic() -> f64 {
    0.5 * Water::DENSITY * GRAVITY * WATER[1].powi(2)
}

/// Speed of outflow under a gap, m/s, at a depth of the water, m (Torricelli).
pub fn outflow(depth: f64) -> f64 {
    (2.0 * GRAVITY * depth.max(0.0)).sqrt()
}

/// Contraction coefficient of the jet under an upright gate, pi / (pi + 2) (Kirchhoff); it is larger under an inclined one.
pub const CONTRACTION: f64 = PI / (PI + 2.0);
