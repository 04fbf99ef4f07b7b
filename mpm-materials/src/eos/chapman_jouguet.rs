//! Chapman-Jouguet state of an explosive.

use crate::eos::{Eos, Terms};
use crate::lane::Real;

/// Chapman-Jouguet state: state behind a plane, steady detonation wave of minimum speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChapmanJouguet {
    /// Detonation speed D, m/s.
    pub speed: f64,
    /// Pressure, Pa.
    pub pressure: f64,
    /// Volume over that of the unreacted explosive, V.
    pub volume_ratio: f64,
    /// Particle speed behind the wave, m/s.
    pub particle_speed: f64,
}

/// Compute the Chapman-Jouguet state of products with equation of state `eos`, whose initial energy is the heat of
/// detonation, from an unreacted explosive at rest without pressure; `None` if there is none.
///
/// On the Hugoniot p = (a + b e0)/(1 - b (1 - V)/2) the products move at their sound speed against the wave:
/// rho0 c^2/V^2 = p/(1 - V) (book, "Detonation and JWL"). Solved by bisection to rounding.
pub fn chapman_jouguet<T: Real, E: Eos<T>>(eos: &E) -> Option<ChapmanJouguet> {
    let density = eos.density().to_double();
    let energy = eos.initial_energy().to_double();
    // Pressure on the Hugoniot, if it exists.
    let hugoniot = |v: f64| {
        let Terms { cold, thermal } = eos.terms::<T::Single>(T::of(v).into());
        let (a, b) = (into_double::<T>(cold), into_double::<T>(thermal));
        let open = 1.0 - 0.5 * b * (1.0 - v);
        (open > 0.0).then(|| (a + b * energy) / open)
    };
    // Positive for subsonic products, as behind an overdriven wave.
    let excess = |v: f64| {
        hugoniot(v).map_or(1.0, |p| {
            let e = energy + 0.5 * p * (1.0 - v);
            let speed = eos.speed_squared::<T::Single>(T::of(v).into(), T::of(e).into());
            density * into_double::<T>(speed) / (v * v) - p / (1.0 - v)
        })
    };
    let (mut strong, mut weak) = (1e-3, 1.0 - 1e-6);
    if excess(strong) < 0.0 || excess(weak) >= 0.0 {
        return None;
    }
    for _ in 0..200 {
        let middle = 0.5 * (strong + weak);
        if excess(middle) >= 0.0 { strong = middle } else { weak = middle }
    }
    let volume_ratio = 0.5 * (strong + weak);
    let pressure = hugoniot(volume_ratio)?;
    let speed = (pressure / (density * (1.0 - volume_ratio))).sqrt();
    let found =
        ChapmanJouguet { speed, pressure, volume_ratio, particle_speed: speed * (1.0 - volume_ratio) };
    (speed > 0.0 && speed.is_finite()).then_some(found)
}

fn into_double<T: Real>(x: T::Single) -> f64 {
    let real: T = x.into();
    real.to_double()
}
