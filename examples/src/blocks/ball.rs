//! An elastic ball pressed by Hertz's pressure: how much its centre of mass approaches.
//!
//! Hertz measures the approach between points far from the contact in half spaces. The centre of mass of a ball is
//! not far: it approaches less, by about 0.45 a / R of the whole. Here the ball is loaded by p = p0 sqrt(1 - (sin
//! theta / s)^2), s = a / R, around its pole, and a uniform body force holds it. The pressure is a series of Legendre
//! polynomials, and every term has a solution in closed form (Lur'e, Three-dimensional problems of the theory of
//! elasticity): for order n
//!
//! ```text
//! 2 G u_r = [A (n+1)(n-2+4 nu) r^(n+1) + B n r^(n-1)] P_n
//! sigma_r = [A (n+1)(n^2-n-2-2 nu) r^n + B n (n-1) r^(n-2)] P_n
//! tau     = [A (n^2+2n-1+2 nu) r^n + B (n-1) r^(n-2)] dP_n/dtheta
//! ```
//!
//! The body force b along the axis is met by sigma_zz = -b z alone, whose tractions are of order 1 and 3.

use std::f64::consts::{FRAC_PI_2, PI};

/// Orders of the series, and points of the integrals over the pressed cap.
const ORDERS: usize = 1000;
const POINTS: usize = 1000;

/// Approach of the centre of mass to the plane over Hertz's, for a contact of radius `part` radii.
pub fn approach_over_hertz(part: f64, poisson: f64) -> f64 {
    // Units: radius 1, Young's modulus 1, largest pressure 1.
    let shear = 0.5 / (1.0 + poisson);
    let (mut normal, force) = cap(part);
    let mut across = vec![0.0; normal.len()];
    // The tractions that the solution for the body force leaves to the series.
    let b = force / (4.0 / 3.0 * PI);
    for (order, along, beside) in [(1, 3.0 / 5.0, 1.0 / 5.0), (3, 2.0 / 5.0, 2.0 / 15.0)] {
        normal[order] += b * along;
        across[order] += b * beside;
    }
    let mut pole = -0.5 * b;
    let mut centre = -0.5 * b * (1.0 / 5.0 + poisson * 2.0 / 5.0);
    for n in 0..normal.len() {
        let k = n as f64;
        let bulge = (k + 1.0) * (k - 2.0 + 4.0 * poisson);
        if n < 2 {
            // Order 0 has no B; that of order 1 moves the whole ball.
            let a = normal[n] / ((k + 1.0) * (k * k - k - 2.0 - 2.0 * poisson));
            pole += a * bulge / (2.0 * shear);
            if n == 1 {
                let mean = 2.0 * (4.0 * poisson - 1.0) / 3.0 + (6.0 - 4.0 * poisson) * 2.0 / 3.0;
                centre += a * mean * (3.0 / 5.0) / (2.0 * shear);
            }
            continue;
        }
        let row = [(k + 1.0) * (k * k - k - 2.0 - 2.0 * poisson), k * (k - 1.0)];
        let other = [k * k + 2.0 * k - 1.0 + 2.0 * poisson, k - 1.0];
        let determinant = row[0] * other[1] - row[1] * other[0];
        let a = (normal[n] * other[1] - row[1] * across[n]) / determinant;
        let b = (row[0] * across[n] - other[0] * normal[n]) / determinant;
        pole += (a * bulge + b * k) / (2.0 * shear);
    }
    let hertz = 0.5 * PI * part * (1.0 - poisson * poisson);
    (centre - pole) / hertz
}

/// Coefficients of -p in Legendre polynomials, and the force along the axis.
fn cap(part: f64) -> (Vec<f64>, f64) {
    let mut orders = vec![0.0; ORDERS + 1];
    let mut force = 0.0;
    for i in 0..POINTS {
        // sin theta = part sin phi.
        let phi = FRAC_PI_2 * (i as f64 + 0.5) / POINTS as f64;
        let sin = part * phi.sin();
        let cos = (1.0 - sin * sin).sqrt();
        let pressed = FRAC_PI_2 / POINTS as f64 * phi.cos() * sin * part * phi.cos() / cos;
        force += 2.0 * PI * pressed * cos;
        let (mut before, mut now) = (0.0, 1.0);
        for (n, order) in orders.iter_mut().enumerate() {
            let k = n as f64;
            *order -= (k + 0.5) * pressed * now;
            (before, now) = (now, ((2.0 * k + 1.0) * cos * now - k * before) / (k + 1.0));
        }
    }
    (orders, force)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_contact_is_that_of_half_spaces() {
        let part = |s| 1.0 - approach_over_hertz(s, 0.3);
        // First order in the contact's size.
        assert!((part(0.1) / part(0.05) - 2.0).abs() < 0.2, "{} {}", part(0.1), part(0.05));
        assert!(part(0.05) > 0.0 && part(0.05) < 0.03);
    }

    #[test]
    fn pressure_and_body_force_balance() {
        // Order 1 of both tractions must ask for the same A.
        let (normal, force) = cap(0.1);
        let b = force / (4.0 / 3.0 * PI);
        let sum = (normal[1] + 0.6 * b) / -4.0 - 0.2 * b / 2.0;
        assert!(sum.abs() < 1e-6 * b, "{sum} of {b}");
    }
}
