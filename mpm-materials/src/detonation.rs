//! Programmed detonation: initiation of a charge and arrival times of the wave.

use crate::parameter::{Check, ParameterError};

/// Initiation geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    /// Segment between two points, initiated at once; a point is a segment of zero length.
    Segment { from: [f64; 3], to: [f64; 3] },
    /// Plane through a point with this unit normal.
    Plane { through: [f64; 3], normal: [f64; 3] },
}

/// Programmed detonation wave: it travels from points, lines and planes at constant speed along straight rays. The
/// lighting time of a position is that of the earliest ray, t_L = min \[t_0 + |x - x_0|/D\] (book, "Detonation and
/// JWL").
///
/// Limits: rays ignore obstacles and holes, behind which the real wave arrives later; add an initiation point at the
/// edge that the wave turns around, with the time of that edge.
///
/// ```
/// use mpm_materials::Detonation;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let wave = Detonation::new(6930.0)?.from_point([0.0; 3], 0.0)?;
/// let time = wave.arrival([0.0, 0.0693, 0.0]).ok_or("lit nowhere")?;
/// assert!((time - 1.0e-5).abs() < 1e-18);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Detonation {
    speed: f64,
    starts: Vec<(Start, f64)>,
}

const CHECK: Check = Check("detonation");

impl Detonation {
    /// Create a wave of speed D, m/s, without initiation points.
    ///
    /// # Errors
    /// D not positive.
    pub fn new(speed: f64) -> Result<Self, ParameterError> {
        Ok(Detonation { speed: CHECK.positive("detonation speed D", speed)?, starts: Vec::new() })
    }
    /// Add an initiation point, m, at `time`, s.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn from_point(self, at: [f64; 3], time: f64) -> Result<Self, ParameterError> {
        self.from_line(at, at, time)
    }
    /// Add an initiation line, the segment between `from` and `to`, m, at `time`, s.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn from_line(self, from: [f64; 3], to: [f64; 3], time: f64) -> Result<Self, ParameterError> {
        for x in from.into_iter().chain(to) {
            CHECK.that(true, "coordinate of a start", x, "finite")?;
        }
        self.with(Start::Segment { from, to }, time)
    }
    /// Add an initiation plane through a point, m, with a normal of any length, at `time`, s.
    ///
    /// # Errors
    /// A number that is not finite, or a normal without length.
    pub fn from_plane(self, through: [f64; 3], normal: [f64; 3], time: f64) -> Result<Self, ParameterError> {
        for x in through {
            CHECK.that(true, "coordinate of a start", x, "finite")?;
        }
        let length = CHECK.positive("length of the normal", dot(normal, normal).sqrt())?;
        self.with(Start::Plane { through, normal: normal.map(|x| x / length) }, time)
    }

    fn with(mut self, start: Start, time: f64) -> Result<Self, ParameterError> {
        self.starts.push((start, CHECK.that(true, "time of a start", time, "finite")?));
        Ok(self)
    }

    /// Detonation speed D, m/s.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Lighting time of a position, s; `None` for a wave without initiation points.
    pub fn arrival(&self, place: [f64; 3]) -> Option<f64> {
        let of = |(start, time): &(Start, f64)| time + start.distance(place) / self.speed;
        self.starts.iter().map(of).reduce(f64::min)
    }
}

impl Start {
    fn distance(&self, place: [f64; 3]) -> f64 {
        match *self {
            Start::Segment { from, to } => {
                let (along, reach) = (minus(to, from), minus(place, from));
                let square = dot(along, along);
                let share = if square > 0.0 { (dot(reach, along) / square).clamp(0.0, 1.0) } else { 0.0 };
                let gap = minus(reach, along.map(|x| x * share));
                dot(gap, gap).sqrt()
            }
            Start::Plane { through, normal } => dot(minus(place, through), normal).abs(),
        }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
