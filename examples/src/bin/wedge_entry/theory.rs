//! Forces on a rigid wedge that enters water at constant speed, without gravity, a unit of depth.
//!
//! The water in reach of a half breadth c moves as about a plate of that half breadth: added mass (pi / 2) rho c^2, half of that of a plate
//! in endless water, so that F = d/dt \[(pi / 2) rho c^2 V\] = pi rho V c dc/dt.
//!
//! | | half breadth | F / (rho V^3 t) |
//! |---|---|---|
//! | \[vonKarman1929\]: the undisturbed water level | c = V t / tan(beta) | pi / tan^2(beta) |
//! | \[Wagner1932\]: the surface beside the plate rises as fast as the plate's flow makes it, v = V x / sqrt(x^2 - c^2) - V in the frame of the wedge, and meets the wedge at x = c | c = (pi / 2) V t / tan(beta) | pi^3 / (4 tan^2(beta)) |
//!
//! For the second, points at x tan(beta) above the keel are met when integral of V x / sqrt(x^2 - c^2) dt is as much; with dc = k dt that is
//! V x / k asin(1) = x tan(beta), k = pi V / (2 tan(beta)). The first leaves out the rise of the surface, and is too small; the second
//! takes a wedge for flat and its jets for nothing, is exact as beta goes to 0, and too large for others.

use std::f64::consts::PI;

use crate::setup::Setup;

/// F / (rho V^3 t) without the rise of the surface.
pub fn von_karman(setup: &Setup) -> f64 {
    PI / setup.deadrise.tan().powi(2)
}

/// F / (rho V^3 t) with it, for a flat wedge.
pub fn wagner(setup: &Setup) -> f64 {
    PI.powi(3) / (4.0 * setup.deadrise.tan().powi(2))
}

/// F / (rho V^3 t) and the largest pressure over that of stagnation of the similarity solution for 30 degrees \[ZhaoFaltinsen1993\] \[M\].
pub const SIMILARITY: [f64; 2] = [14.139, 6.927];
