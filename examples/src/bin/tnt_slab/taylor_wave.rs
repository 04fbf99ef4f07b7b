//! Taylor wave: exact flow behind a plane detonation that starts at a rigid wall.
//!
//! The products expand along the isentrope through the Chapman-Jouguet state. Behind the front, x = D t, the flow is a centred simple wave,
//! x/t = u + c with u = u_CJ - int c drho/rho, until u = 0; from there to the wall the products are at rest.

use mpm_materials::{Jwl, JwlConstants};

/// Chapman-Jouguet state of this charge, computed independently: speed, m/s, pressure, Pa, volume ratio, particle speed, m/s.
pub const CHAPMAN_JOUGUET: [f64; 4] = [6928.0, 20.98e9, 0.7318, 1858.0];

/// State of the wave.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Similarity variable x / t, m/s.
    pub place: f64,
    /// Pressure, Pa.
    pub pressure: f64,
    /// Particle speed, m/s.
    pub speed: f64,
}

/// States of the wave, from the front to the products at rest.
pub struct TaylorWave(Vec<State>);

/// Number of steps of the integration along the isentrope.
const STEPS: usize = 4000;

impl TaylorWave {
    /// Integrate the wave of a charge with these products.
    pub fn of(products: &Jwl<f64>) -> Self {
        let &JwlConstants { density, a, b, r1, r2, omega, .. } = products.constants();
        let [_, pressure, volume, mut speed] = CHAPMAN_JOUGUET;
        // p_s(V) = A e^(-R1 V) + B e^(-R2 V) + C V^(-1 - omega), with C from the Chapman-Jouguet state.
        let of_solid = |v: f64| a * (-r1 * v).exp() + b * (-r2 * v).exp();
        let c = (pressure - of_solid(volume)) * volume.powf(1.0 + omega);
        let isentrope = |v: f64| of_solid(v) + c * v.powf(-1.0 - omega);
        let falls = |v: f64| {
            a * r1 * (-r1 * v).exp() + b * r2 * (-r2 * v).exp() + c * (1.0 + omega) * v.powf(-2.0 - omega)
        };
        let sound = |v: f64| v * (falls(v) / density).sqrt();
        let mut states = vec![State { place: speed + sound(volume), pressure, speed }];
        let step = volume / STEPS as f64;
        let mut v = volume;
        // -c drho/rho = c dV/V, by the midpoint rule.
        while speed > 0.0 {
            let middle = v + 0.5 * step;
            let fall = sound(middle) / middle * step;
            let last = (speed / fall).min(1.0);
            v += last * step;
            speed -= last * fall;
            states.push(State { place: speed + sound(v), pressure: isentrope(v), speed });
        }
        TaylorWave(states)
    }

    /// Return the pressure of the products at rest, Pa.
    pub fn rest_pressure(&self) -> f64 {
        self.0.last().map_or(0.0, |s| s.pressure)
    }

    /// Return the state at x / t: at rest behind the wave, unreacted in front of it.
    pub fn at(&self, place: f64) -> State {
        let states = &self.0;
        if place > states[0].place {
            return State { place, pressure: 0.0, speed: 0.0 };
        }
        let after = states.partition_point(|s| s.place > place);
        let [Some(ahead), Some(behind)] =
            [after.checked_sub(1).map(|i| states[i]), states.get(after).copied()]
        else {
            return State { place, pressure: self.rest_pressure(), speed: 0.0 };
        };
        let share = (ahead.place - place) / (ahead.place - behind.place);
        let between = |a: f64, b: f64| a + share * (b - a);
        State {
            place,
            pressure: between(ahead.pressure, behind.pressure),
            speed: between(ahead.speed, behind.speed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_runs_at_the_detonation_speed() {
        let wave = TaylorWave::of(&Jwl::tnt());
        let [detonation, pressure, ..] = CHAPMAN_JOUGUET;
        let rest = wave.0.last().unwrap().place;
        // u + c = D at the Chapman-Jouguet state.
        assert!((wave.0[0].place / detonation - 1.0).abs() < 1e-3, "{}", wave.0[0].place);
        assert_eq!(wave.at(0.999 * rest).speed, 0.0);
        assert_eq!(wave.at(1.01 * detonation).pressure, 0.0);
        // About half the distance, as for a gas of gamma = 3, whose rest zone begins at D/2 with 8/27 of the pressure.
        assert!((0.4..0.6).contains(&(rest / detonation)), "{rest}");
        assert!((0.25..0.4).contains(&(wave.rest_pressure() / pressure)), "{}", wave.rest_pressure());
        let middle = wave.at(0.8 * detonation);
        assert!(middle.speed > 0.0 && middle.speed < CHAPMAN_JOUGUET[3]);
    }
}
