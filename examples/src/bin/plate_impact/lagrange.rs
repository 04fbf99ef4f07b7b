//! The same spall by another method: Lagrangian finite differences in one dimension, staggered in space and time, with
//! von Neumann and Richtmyer's viscosity. The metal is a fluid that breaks at once where its tension exceeds the spall
//! strength. It shares no line with the material point method.

use crate::metals::Metal;
use crate::spall::{FLYER, STRENGTH};

/// What the free surface and the crack of the other method do.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// How much velocity the free surface loses before the spall tells it of the crack, m/s.
    pub pull_back: f64,
    /// Thickness of what is intact between the free surface and the nearest broken cell, at rest, m.
    pub scab: f64,
}

/// How the other method looks at the plates.
#[derive(Clone, Copy, Debug)]
pub struct Mesh {
    /// Cells along the flyer.
    pub cells: usize,
    /// Length of the viscosity, m.
    pub length: f64,
    /// Its linear and quadratic coefficient: q = rho l |du/dx| (b1 c0 + b0 l |du/dx|) where the metal is compressed.
    pub viscosity: [f64; 2],
}

/// Courant number of the step.
const COURANT: f64 = 0.3;
/// The pull-back is looked for in this time, and the run ends, in transits of the flyer by sound.
const PULL_BACK: [f64; 2] = [3.4, 5.0];
const END: f64 = 6.5;

/// Let a flyer at this speed hit the target of twice its thickness.
pub fn spall(metal: &Metal, speed: f64, mesh: &Mesh) -> Reference {
    let (density, sound) = (metal.density, metal.sound_speed);
    let Mesh { cells, length, viscosity: [linear, quadratic] } = *mesh;
    let h = FLYER / cells as f64;
    let all = 3 * cells;
    let transit = FLYER / sound;
    let dt = COURANT * h / sound / (1.0 + 2.0 * linear * length / h);
    let mut velocity: Vec<f64> = vec![0.0; all + 1];
    velocity[..cells].fill(speed);
    velocity[cells] = 0.5 * speed;
    let mut stretch = vec![1.0; all];
    // Minus the stress of each cell, between two that are empty.
    let mut push = vec![0.0; all + 2];
    let mut broken = vec![false; all];
    let (mut time, mut lowest) = (0.0, speed);
    while time < END * transit {
        for (i, u) in velocity.iter_mut().enumerate() {
            let mass = density * h * if i == 0 || i == all { 0.5 } else { 1.0 };
            *u += dt * (push[i] - push[i + 1]) / mass;
        }
        for i in 0..all {
            let rate = (velocity[i + 1] - velocity[i]) / h;
            stretch[i] += dt * rate;
            let closing = length * (-rate).max(0.0);
            let viscous = density / stretch[i] * closing * (linear * sound + quadratic * closing);
            let mut pressure = metal.pressure(1.0 - stretch[i]);
            broken[i] |= pressure < -STRENGTH;
            if broken[i] {
                pressure = pressure.max(0.0);
            }
            push[i + 1] = pressure + viscous;
        }
        time += dt;
        if (PULL_BACK[0]..PULL_BACK[1]).contains(&(time / transit)) {
            lowest = lowest.min(velocity[all]);
        }
    }
    let intact = broken.iter().rev().take_while(|b| !**b).count();
    Reference { pull_back: speed - lowest, scab: intact as f64 * h }
}
