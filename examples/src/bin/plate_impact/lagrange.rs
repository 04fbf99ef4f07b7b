//! Reference solution of the spall problem: one-dimensional Lagrangian finite differences, staggered in space and time, with the viscosity
//! of von Neumann and Richtmyer. The metal is a fluid with cohesive cracks: they open when the tension exceeds the spall strength, and
//! their traction decreases with the opening to zero. The code is independent of the material point method.

use crate::metals::Metal;
use crate::spall::{FLYER, STRENGTH};

/// Free surface and crack of the reference solution.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// Pull-back: loss of velocity of the free surface before the arrival of the crack's signal, m/s.
    pub pull_back: f64,
    /// Thickness of the intact layer between the free surface and the nearest broken cell, at rest, m.
    pub scab: f64,
}

/// Discretisation of the reference solution.
#[derive(Clone, Copy, Debug)]
pub struct Mesh {
    /// Cells along the flyer.
    pub cells: usize,
    /// Length scale of the viscosity, m.
    pub length: f64,
    /// Linear and quadratic viscosity coefficient: q = rho l |du/dx| (b1 c0 + b0 l |du/dx|) in compression.
    pub viscosity: [f64; 2],
    /// Opening at which the traction of a crack is zero, m.
    pub opening: f64,
}

/// Cohesive crack of a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Crack {
    /// Current opening, m.
    open: f64,
    /// Largest opening so far, m.
    widest: f64,
}

impl Crack {
    /// Update the opening in a cell of rest length h for a total stretch; return the pressure.
    fn follow(&mut self, metal: &Metal, stretch: f64, h: f64, full: f64) -> f64 {
        let stiffness = metal.density * metal.sound_speed * metal.sound_speed;
        if self.widest >= full {
            return metal.pressure(1.0 - stretch).max(0.0);
        }
        if self.widest == 0.0 {
            let pressure = metal.pressure(1.0 - stretch);
            if pressure >= -STRENGTH {
                return pressure;
            }
            if stiffness * full < STRENGTH * h {
                self.widest = full;
                return 0.0;
            }
        }
        // Traction balance: the tension of the metal, which decreases with the opening, equals the crack's traction, on the softening line
        // from the strength or on the unloading line to the origin.
        let widest = self.widest;
        let mut w = self.open;
        for _ in 0..NEWTON_STEPS {
            let (line, slope) = if w < widest {
                let slope = STRENGTH * (1.0 / widest - 1.0 / full);
                (slope * w, slope)
            } else {
                (STRENGTH * (1.0 - w / full), -STRENGTH / full)
            };
            let tension = -metal.pressure(1.0 - (stretch - w / h));
            w = (w + (tension - line) / (stiffness / h + slope)).clamp(0.0, full);
        }
        self.open = w;
        self.widest = widest.max(w);
        if self.open > full * (1.0 - 1e-9) {
            *self = Crack { open: 0.0, widest: full };
            return metal.pressure(1.0 - stretch).max(0.0);
        }
        metal.pressure(1.0 - (stretch - self.open / h))
    }
}

/// Courant number of the time step.
const COURANT: f64 = 0.3;
/// Number of Newton iterations for an opening.
const NEWTON_STEPS: usize = 6;
/// Time window of the pull-back, and end of the run, in transits of the flyer by sound.
const PULL_BACK: [f64; 2] = [3.4, 5.0];
const END: f64 = 6.5;

/// Impact of a flyer at this speed on a target of twice its thickness.
pub fn spall(metal: &Metal, speed: f64, mesh: &Mesh) -> Reference {
    let (density, sound) = (metal.density, metal.sound_speed);
    let Mesh { cells, length, viscosity: [linear, quadratic], opening } = *mesh;
    let h = FLYER / cells as f64;
    let all = 3 * cells;
    let transit = FLYER / sound;
    let dt = COURANT * h / sound / (1.0 + 2.0 * linear * length / h);
    let mut velocity: Vec<f64> = vec![0.0; all + 1];
    velocity[..cells].fill(speed);
    velocity[cells] = 0.5 * speed;
    let mut stretch = vec![1.0; all];
    // Negative stress of each cell, with an empty cell at both ends.
    let mut push = vec![0.0; all + 2];
    let mut cracks = vec![Crack::default(); all];
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
            push[i + 1] = cracks[i].follow(metal, stretch[i], h, opening) + viscous;
        }
        time += dt;
        if (PULL_BACK[0]..PULL_BACK[1]).contains(&(time / transit)) {
            lowest = lowest.min(velocity[all]);
        }
    }
    let intact = cracks.iter().rev().take_while(|c| c.widest < opening).count();
    Reference { pull_back: speed - lowest, scab: intact as f64 * h }
}
