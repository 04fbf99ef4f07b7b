//! Force on a rigid wedge that enters water at constant speed, without gravity, per unit of depth.
//!
//! The water within a half breadth c moves as around a plate of that half breadth: added mass (pi / 2) rho c^2, half of that of a plate in
//! unbounded water, so that F = d/dt \[(pi / 2) rho c^2 V\] = pi rho V c dc/dt.
//!
//! | | half breadth | F / (rho V^3 t) |
//! |---|---|---|
//! | \[vonKarman1929\]: the undisturbed water level | c = V t / tan(beta) | pi / tan^2(beta) |
//! | \[Wagner1932\]: the surface beside the plate rises as fast as the plate's flow makes it, v = V x / sqrt(x^2 - c^2) - V in the frame of the wedge, and meets the wedge at x = c | c = (pi / 2) V t / tan(beta) | pi^3 / (4 tan^2(beta)) |
//!
//! In the second theory a point x tan(beta) above the keel is wetted when the integral of V x / sqrt(x^2 - c^2) dt equals that height; with
//! dc = k dt this is V x / k asin(1) = x tan(beta), k = pi V / (2 tan(beta)). The first theory neglects the rise of the surface, and its
//! force is too small; the second treats the wedge as flat and neglects its jets: it is exact as beta tends to 0, and too large otherwise.

use std::f64::consts::PI;

use crate::setup::Setup;

/// Return F / (rho V^3 t) without the rise of the surface (von Karman).
pub fn von_karman(setup: &Setup) -> f64 {
    PI / setup.deadrise.tan().powi(2)
}

/// Return F / (rho V^3 t) with the rise of the surface, for a flat wedge (Wagner).
pub fn wagner(setup: &Setup) -> f64 {
    PI.powi(3) / (4.0 * setup.deadrise.tan().powi(2))
}

/// Similarity solution for 30 degrees: F / (rho V^3 t), and the largest pressure over the stagnation pressure \[ZhaoFaltinsen1993\] \[M\].
pub const SIMILARITY: [f64; 2] = [14.139, 6.927];
