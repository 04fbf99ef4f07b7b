//! Load histories, and their exact waves.

use std::f64::consts::PI;

use clap::ValueEnum;

/// How the tension at the end goes with time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Shape {
    /// At once, and held
    Step,
    /// At once, and taken off at once
    Pulse,
    /// Half a sine: its rate jumps where it begins and ends
    HalfSine,
    /// Rises in a straight line, and is held
    Ramp,
    /// A sine squared: smooth
    SineSquared,
}

impl Shape {
    /// Return the name in file names and rows.
    pub fn name(self) -> &'static str {
        match self {
            Shape::Step => "step",
            Shape::Pulse => "pulse",
            Shape::HalfSine => "half sine",
            Shape::Ramp => "ramp",
            Shape::SineSquared => "sine squared",
        }
    }

    /// True if the tension has no jumps.
    pub fn is_continuous(self) -> bool {
        !matches!(self, Shape::Step | Shape::Pulse)
    }

    /// Return the default duration over the transit time of a wave along the plate.
    pub fn usual(self) -> f64 {
        match self {
            Shape::Step => 0.0,
            // Duration of 14.1 ms for the plate of the paper.
            Shape::Pulse => 14.1e-3 * 8e4f64.sqrt() / 4.0,
            Shape::Ramp => 1.0,
            Shape::HalfSine | Shape::SineSquared => 1.5,
        }
    }
}

/// Tension at the end of the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    pub shape: Shape,
    /// Largest tension, Pa.
    pub tension: f64,
    /// Duration of rise or action, s; unused for a step.
    pub duration: f64,
}

impl Load {
    /// Return the tension, Pa, at a time, s.
    pub fn at(&self, t: f64) -> f64 {
        if t < 0.0 {
            return 0.0;
        }
        let part = t / self.duration;
        self.tension
            * match self.shape {
                Shape::Step => 1.0,
                Shape::Ramp => part.min(1.0),
                _ if part > 1.0 => 0.0,
                Shape::Pulse => 1.0,
                Shape::HalfSine => (PI * part).sin(),
                Shape::SineSquared => (PI * part).sin().powi(2),
            }
    }

    /// Return the integral of the tension over time, Pa s.
    pub fn sum(&self, t: f64) -> f64 {
        let (t, end) = (t.max(0.0), self.duration);
        let within = t.min(end);
        self.tension
            * match self.shape {
                Shape::Step => t,
                Shape::Ramp => 0.5 * within * within / end + (t - within),
                Shape::Pulse => within,
                Shape::HalfSine => end / PI * (1.0 - (PI * within / end).cos()),
                Shape::SineSquared => 0.5 * within - 0.25 * end / PI * (2.0 * PI * within / end).sin(),
            }
    }
}

/// Exact waves in a plate of this length, m, clamped at x = 0, with wave speed c, m/s, and Young's modulus, Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact {
    pub load: Load,
    pub length: f64,
    pub speed: f64,
    pub young: f64,
}

impl Exact {
    /// Return the stress along the plate, Pa.
    pub fn stress(&self, x: f64, t: f64) -> f64 {
        self.images(x, t, 1.0, |t| self.load.at(t))
    }

    /// Return the displacement, m, with E / c = rho c.
    pub fn displacement(&self, x: f64, t: f64) -> f64 {
        self.images(x, t, -1.0, |t| self.load.sum(t)) * self.speed / self.young
    }

    /// Sum the waves from the end and its images beyond both ends: sum (-1)^n { f(t - ((2n+1)L - x)/c) +- f(t - ((2n+1)L + x)/c) }.
    fn images(&self, x: f64, t: f64, sign: f64, of: impl Fn(f64) -> f64) -> f64 {
        let (length, c) = (self.length, self.speed);
        let far = (0..).map(|n| (2.0 * f64::from(n) + 1.0) * length);
        let turns = [1.0, -1.0].into_iter().cycle();
        far.take_while(|far| far - length <= c * t)
            .zip(turns)
            .map(|(far, turn)| turn * (of(t - (far - x) / c) + sign * of(t - (far + x) / c)))
            .sum()
    }
}
