//! Contact benchmarks: bars end to end (V8), a pulse through a joint (V9), colliding discs (V10), Hertzian contact of balls
//! (V11), with every contact detection.

use std::time::Instant;

use examples::blocks::ball::approach_over_hertz;
use examples::blocks::circles::Part;
use examples::blocks::scene::Asked;
use examples::blocks::{discs, hertz, waves};
use examples::{CaseError, Detection, Law, Totals};
use mpm_core::{
    Axisymmetric, Flip, IntoKernels, Linear, Method, Musl, PlaneStrain, QuadraticBSpline, TimeControl,
};
use verification::smoothed::Smoothed;
use verification::work::{Stopwatch, Work};
use verification::{Kernel, Outcome, Scheme, Velocity};

use crate::job::Key;

/// All charted contact detections.
pub const DETECTIONS: [Detection; 8] = [
    Detection::Plane,
    Detection::Approach,
    Detection::Compression,
    Detection::Distance,
    Detection::Centres,
    Detection::Local,
    Detection::Regression,
    Detection::LocalRegression,
];

/// Closing speed of the balls over sqrt(E / rho): the contact width reaches a sixth of the radius.
const BALL_SPEED: f64 = 1e-2;

/// Linear bulk viscosity coefficient of colliding bars.
const VISCOSITY: f64 = 0.1;

/// Contact benchmark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// V9: pulse through a joint under pressure. Resolution: cells of the bar.
    Pulse,
    /// V10: two discs. Resolution: cells across the box of 1 m.
    Discs,
    /// V11: two balls. Resolution: cells of the radius.
    Balls,
    /// V8: two bars end to end, with bulk viscosity. Resolution: cells of one bar.
    Bars,
    /// V8: two bars end to end, without bulk viscosity.
    BareBars,
}

impl Meeting {
    /// All contact benchmarks.
    pub const ALL: [Meeting; 5] =
        [Meeting::Pulse, Meeting::Discs, Meeting::Balls, Meeting::Bars, Meeting::BareBars];
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Meeting::Pulse => "V9 pulse",
            Meeting::Discs => "V10 discs",
            Meeting::Balls => "V11 balls",
            Meeting::Bars => "V8 bars",
            Meeting::BareBars => "V8 bars bare",
        }
    }
}

/// Contact benchmark, method (linear shape functions or quadratic splines, FLIP and MUSL), contact detection and
/// grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Contact benchmark.
    pub meeting: Meeting,
    /// Quadratic splines instead of linear shape functions.
    pub quadratic: bool,
    /// Contact detection.
    pub detection: Detection,
    /// Number of cells along the problem's length.
    pub cells: usize,
}

impl Touch {
    fn kernel(self) -> Kernel {
        if self.quadratic { Kernel::Quadratic } else { Kernel::Linear }
    }

    /// Key of the run.
    pub fn key(self) -> Key {
        let scheme = Scheme::moving(self.kernel(), Velocity::FlipMusl).name();
        let control = Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels().facts().time_control();
        let courant = match control {
            TimeControl::Courant { factor, .. } => factor,
            _ => f64::NAN,
        };
        Key {
            problem: self.meeting.name().into(),
            scheme: format!("{scheme}, {}", self.detection.name()),
            per_axis: 2,
            cells: self.cells,
            courant,
        }
    }

    /// Find the run of a key.
    pub fn of(key: &Key) -> Option<Touch> {
        let meeting = Meeting::ALL.into_iter().find(|m| m.name() == key.problem)?;
        let made = DETECTIONS.into_iter().flat_map(|detection| {
            [false, true].map(|quadratic| Touch { meeting, quadratic, detection, cells: key.cells })
        });
        made.into_iter().find(|t| t.key() == *key)
    }

    /// Scale the run down to the smallest grid with contact.
    pub fn scaled(self) -> Touch {
        let cells = match self.meeting {
            Meeting::Bars | Meeting::BareBars => 25,
            Meeting::Pulse | Meeting::Discs => 10,
            Meeting::Balls => 5,
        };
        Touch { cells, ..self }
    }

    /// Run the benchmark.
    pub fn run(self) -> Outcome {
        let made = match (self.meeting, self.quadratic) {
            (Meeting::Balls, false) => self.balls(Method::new(Linear, Flip, Musl, Axisymmetric)),
            (Meeting::Balls, true) => self.balls(Method::new(QuadraticBSpline, Flip, Musl, Axisymmetric)),
            (_, false) => self.plane(|| Method::new(Linear, Flip, Musl, PlaneStrain)),
            (_, true) => self.plane(|| Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain)),
        };
        made.unwrap_or_else(|error| Outcome { failure: Some(error.to_string()), ..Outcome::default() })
    }

    /// Run the contact only, without a reference, and return its work.
    pub fn work(self) -> Work {
        if self.meeting != Meeting::Pulse {
            return self.run().work;
        }
        let made = if self.quadratic {
            self.pulse(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain), false)
        } else {
            self.pulse(Method::new(Linear, Flip, Musl, PlaneStrain), false)
        };
        made.map(|m| m.1).unwrap_or_default()
    }

    fn plane<M: IntoKernels<f64, 2>>(self, method: impl Fn() -> M) -> Result<Outcome, CaseError> {
        match self.meeting {
            Meeting::Discs => return self.discs(method()),
            Meeting::Bars => return self.bars(method(), VISCOSITY),
            Meeting::BareBars => return self.bars(method(), 0.0),
            Meeting::Pulse | Meeting::Balls => {}
        }
        let (bonded, _) = self.pulse(method(), true)?;
        let (split, work) = self.pulse(method(), false)?;
        let peak = |rows: &[waves::Row]| waves::most(rows, 2, 1.0);
        let reflected = waves::reflected(&bonded, &split, Self::push());
        let measures = vec![("transmitted", peak(&split) / peak(&bonded) - 1.0), ("reflected", reflected)];
        Ok(Outcome { measures, work, failure: None })
    }

    /// Contact options: this detection with Coulomb friction.
    fn asked(self) -> Asked {
        Asked { detection: Some(self.detection), law: Some(Law::Coulomb) }
    }

    /// Pulse amplitude, Pa: half of the preload of the joint.
    fn push() -> f64 {
        0.5 * waves::PRELOAD
    }

    fn pulse<M: IntoKernels<f64, 2>>(
        self,
        method: M,
        joined: bool,
    ) -> Result<(Vec<waves::Row>, Work), CaseError> {
        let asked = self.asked();
        self.timed(|| waves::pressed(method, self.cells as u32, joined, Self::push(), asked))
    }

    fn bars<M: IntoKernels<f64, 2>>(self, method: M, viscosity: f64) -> Result<Outcome, CaseError> {
        let asked = self.asked();
        let (made, work) = self.timed(|| {
            let made = waves::strike(method, self.cells as u32, [1.0; 2], viscosity, asked)?;
            let totals = made.totals;
            Ok((made, totals))
        })?;
        Ok(Outcome { measures: of_bars(&made), work, failure: None })
    }

    fn discs<M: IntoKernels<f64, 2>>(self, method: M) -> Result<Outcome, CaseError> {
        let h = 1.0 / self.cells as f64;
        let (made, work) = self.timed(|| {
            let made = discs::collide(method, h, self.asked(), None)?;
            let totals = made.totals;
            Ok((made, totals))
        })?;
        let (first, last) = (made.rows.first(), made.rows.last());
        let (first, last) = (first.copied().unwrap_or([f64::NAN; 4]), last.copied().unwrap_or([f64::NAN; 4]));
        // Contact onset error: that of the farther end of the onset step, since the exact time within it is
        // unknown.
        let end = made.rows.iter().map(|r| r[0]).find(|t| *t > made.onset).unwrap_or(f64::NAN);
        let off = |t: f64| (t / discs::touch() - 1.0).abs();
        let measures = vec![
            ("onset", if end.is_nan() { f64::NAN } else { off(made.onset).max(off(end)) }),
            ("energy", (last[1] + last[2]) / first[1] - 1.0),
            ("rebound", -last[3] / discs::SPEED),
        ];
        Ok(Outcome { measures, work, failure: None })
    }

    fn balls<M: IntoKernels<f64, 2>>(self, method: M) -> Result<Outcome, CaseError> {
        let h = hertz::RADIUS / self.cells as f64;
        let asked = self.asked();
        let (rows, work) = self.timed(|| hertz::collide(method, Part::Ball, h, BALL_SPEED, asked, 1))?;
        let top = hertz::top(&rows);
        let radius = hertz::mean(top, |r| r.width);
        let part = approach_over_hertz(radius / hertz::RADIUS, hertz::POISSON);
        let measures = vec![
            ("force", hertz::mean(top, |r| r.force / r.hertz_force(part)) - 1.0),
            ("width", hertz::mean(top, |r| r.width / r.ball_radius()) - 1.0),
        ];
        Ok(Outcome { measures, work, failure: None })
    }

    fn timed<R>(self, run: impl FnOnce() -> Result<(R, Totals), CaseError>) -> Result<(R, Work), CaseError> {
        timed(self.kernel().nodes(2), run)
    }
}

/// Return the result of a run and its work, with `nodes` nodes or neighbours per particle. Core-seconds are those of the whole run,
/// times the fraction of wall-clock time in steps, so that sampling does not count.
fn timed<R>(
    nodes: u64,
    run: impl FnOnce() -> Result<(R, Totals), CaseError>,
) -> Result<(R, Work), CaseError> {
    let (watch, clock) = (Stopwatch::start(), Instant::now());
    let (made, totals) = run()?;
    let share = (totals.wall_seconds / clock.elapsed().as_secs_f64()).min(1.0);
    let work = Work {
        particles: totals.particles as u64,
        steps: totals.steps,
        nodes,
        seconds: share * watch.seconds(),
        bytes: totals.bytes as u64,
    };
    Ok((made, work))
}

/// Measures of two colliding bars.
fn of_bars(made: &waves::Struck) -> Vec<(&'static str, f64)> {
    let stress = made.plateau[1] / made.stress - 1.0;
    vec![("velocity", made.error), ("overshoot", made.overshoot), ("stress", stress)]
}

/// V8 by smoothed particles, with or without bulk viscosity: contact of their surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strike {
    /// True if the bars have bulk viscosity.
    pub viscous: bool,
    /// Method of smoothed particles.
    pub smoothed: Smoothed,
    /// Number of particles along a bar.
    pub cells: usize,
}

impl Strike {
    /// List all runs on these grids, coarse first.
    pub fn all(viscous: bool, cells: &[usize]) -> Vec<Strike> {
        let of = |&cells| Smoothed::ALL.map(|smoothed| Strike { viscous, smoothed, cells });
        cells.iter().flat_map(of).collect()
    }

    fn meeting(self) -> Meeting {
        if self.viscous { Meeting::Bars } else { Meeting::BareBars }
    }

    /// Key of the run.
    pub fn key(self) -> Key {
        let scheme = self.smoothed.name().into();
        Key {
            problem: self.meeting().name().into(),
            scheme,
            per_axis: 1,
            cells: self.cells,
            courant: Smoothed::COURANT,
        }
    }

    /// Find the run of a key.
    pub fn of(key: &Key) -> Option<Strike> {
        let made = [true, false].into_iter().flat_map(|viscous| Strike::all(viscous, &[key.cells]));
        made.into_iter().find(|strike| strike.key() == *key)
    }

    /// Run the benchmark.
    pub fn run(self) -> Outcome {
        let viscosity = if self.viscous { VISCOSITY } else { 0.0 };
        let strike = |cells| match self.smoothed {
            Smoothed::TotalLagrangian => {
                waves::strike_of_particles(sph::Method::total_lagrangian(PlaneStrain), cells, viscosity)
            }
            Smoothed::Updated => {
                waves::strike_of_particles(sph::Method::updated(PlaneStrain), cells, viscosity)
            }
        };
        let made = timed(self.smoothed.neighbours(), || {
            let made = strike(self.cells as u32)?;
            let totals = made.totals;
            Ok((made, totals))
        });
        match made {
            Ok((made, work)) => Outcome { measures: of_bars(&made), work, failure: None },
            Err(error) => Outcome { failure: Some(error.to_string()), ..Outcome::default() },
        }
    }
}
