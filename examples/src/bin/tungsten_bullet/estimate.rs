//! Theory of the interface speed.

use crate::scene::{SPEED, Space, TARGET as PLATE};

/// Densities of bullet and target, kg/m^3.
const DENSITY: [f64; 2] = [19220.0, 2703.0];
/// Strengths of bullet and target, Pa, for round bullets: range of the former, and the latter.
const BULLET: [f64; 2] = [1.2e9, 2.2e9];
const TARGET: f64 = 1.8e9;
/// Shear modulus and flow stress of the target by the law of the paper, at a strain of one, cold, at a rate of 1.4e5 /s (speed over width
/// of the bullet), Pa.
const SHEAR: f64 = 26.7e9;
const FLOW: f64 = (324e6 + 114e6) * 1.19;

/// Interface speed of round bullets, m/s: `tate` for the strengths above.
const ROUND: [f64; 2] = [760.0, 880.0];

/// Return the range of the interface speed, m/s, for the smallest and largest strength of the bullet. In plane strain the resistance of the
/// target is smaller, in the ratio of the cavity pressures of cylinder and sphere.
pub fn interface(space: Space) -> [f64; 2] {
    match space {
        Space::Axisymmetric => ROUND,
        Space::PlaneStrain => BULLET.map(|bullet| tate(bullet, TARGET * cylinder() / sphere())),
    }
}

/// Return the range of the time at which a depth of 50 mm is reached, s.
pub fn through(space: Space) -> [f64; 2] {
    match space {
        Space::Axisymmetric => [57.0e-6, 66.0e-6],
        Space::PlaneStrain => {
            let [slow, fast] = interface(space);
            [PLATE[0] / fast, PLATE[0] / slow]
        }
    }
}

/// Return Tate's steady interface speed, m/s: rho_p (V - U)^2 / 2 + Y_p = rho_t U^2 / 2 + R_t; the impact speed if the bullet does not
/// yield.
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

/// Return the cavity pressure of a sphere in the incompressible elastic-plastic target (Bishop, Hill, Mott 1945), Pa: 2 Y / 3 (1 + ln(2 G /
/// Y)).
fn sphere() -> f64 {
    2.0 / 3.0 * FLOW * (1.0 + (2.0 * SHEAR / FLOW).ln())
}

/// Return the cavity pressure of a cylinder, Pa: k (1 + ln(G / k)), k = Y / sqrt 3.
fn cylinder() -> f64 {
    let k = FLOW / 3f64.sqrt();
    k * (1.0 + (SHEAR / k).ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tate_by_hand() {
        // Zero strength: V / (1 + sqrt(rho_t / rho_p)), 829 m/s; with (1.2, 1.8) and (2.2, 1.8) GPa 761 and 880 m/s.
        for ([bullet, target], speed) in [([0.0; 2], 829.0), ([1.2e9, 1.8e9], 761.0), ([2.2e9, 1.8e9], 880.0)]
        {
            assert!((tate(bullet, target) - speed).abs() < 1.0, "{}", tate(bullet, target));
        }
        assert_eq!(tate(1e10, 0.0), SPEED);
    }

    #[test]
    fn round_and_plane() {
        for (bullet, asked) in BULLET.into_iter().zip(interface(Space::Axisymmetric)) {
            assert!((tate(bullet, TARGET) - asked).abs() < 1.5, "{}", tate(bullet, TARGET));
        }
        let plane = interface(Space::PlaneStrain);
        assert!((plane[0] - 791.7).abs() < 0.1 && (plane[1] - 920.3).abs() < 0.1, "{plane:?}");
        assert!((cylinder() / sphere() - 0.844).abs() < 1e-3, "{}", cylinder() / sphere());
    }
}
