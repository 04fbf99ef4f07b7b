//! What theory says about the speed of the interface.

use crate::scene::SPEED;

/// Densities of bullet and target, kg/m^3.
const DENSITY: [f64; 2] = [19220.0, 2703.0];
/// Strain rate at the interface, 1/s: the speed over the width of the bullet.
const RATE: f64 = 1.4e5;

/// Tate's steady speed of the interface, m/s: rho_p (V - U)^2 / 2 + Y_p = rho_t U^2 / 2 + R_t. The impact speed where the
/// bullet does not yield.
pub fn tate(bullet: f64, target: f64) -> f64 {
    let excess = |u: f64| 0.5 * DENSITY[0] * (SPEED - u).powi(2) + bullet - 0.5 * DENSITY[1] * u * u - target;
    if excess(SPEED) > 0.0 {
        return SPEED;
    }
    let (mut low, mut high) = (0.0, SPEED);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Resistance of the target in plane strain, Pa: pressure that opens a cylinder in an incompressible elastic-plastic
/// solid, k (1 + ln(G / k)), with k = Y / sqrt 3 and the flow stress of the printed law at a strain of one, cold.
pub fn resistance() -> f64 {
    let k = (324e6 + 114e6) * (1.0 + 0.016 * RATE.ln()) / 3f64.sqrt();
    k * (1.0 + (26.7e9 / k).ln())
}

/// Strength of the bullet by its printed law, Pa, cold, at a strain of one.
pub fn strength() -> f64 {
    (1.2e9 + 1.03e9) * (1.0 + 0.034 * RATE.ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tate_by_hand() {
        // Without strength: V / (1 + sqrt(rho_t / rho_p)), 829 m/s; with (1.2, 1.8) and (2.2, 1.8) GPa 761 and 880 m/s.
        for ([bullet, target], speed) in [([0.0; 2], 829.0), ([1.2e9, 1.8e9], 761.0), ([2.2e9, 1.8e9], 880.0)]
        {
            assert!((tate(bullet, target) - speed).abs() < 1.0, "{}", tate(bullet, target));
        }
        assert_eq!(tate(1e10, 0.0), SPEED);
    }
}
