//! Position of the ball, and force on it.

use examples::CaseError;
use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::{Archive, CheckpointError};

/// State of an impact at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Descent of the centre of mass since the first contact, m.
    pub approach: f64,
    /// Mean force on the ball since the previous row, N.
    pub force: f64,
    /// Upward speed of the ball, m/s.
    pub speed: f64,
}

/// Observer of a ball: time, height of its centre of mass, upward speed.
pub struct Track {
    ball: usize,
    pace: Pace,
    notes: Vec<[f64; 3]>,
}

impl Track {
    /// Create the observer of the body of this number, with an interval in seconds.
    pub fn new(ball: usize, every: f64) -> Result<Self, CaseError> {
        Ok(Track { ball, pace: Pace::interval(every)?, notes: Vec::new() })
    }

    /// Compute the history of a ball of this mass, kg.
    pub fn rows(&self, mass: f64) -> Vec<Row> {
        let start = self.notes.first().map_or(f64::NAN, |note| note[1]);
        let row = |pair: &[[f64; 3]]| {
            let [[before, _, slower], [time, height, speed]] = [pair[0], pair[1]];
            Row { time, approach: start - height, force: mass * (speed - slower) / (time - before), speed }
        };
        self.notes.windows(2).map(row).collect()
    }
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let Some(ball) = now.bodies().get(self.ball).copied() else { return Ok(()) };
        let (mut sum, totals) = (0.0, ball.totals());
        let mut mass = 0.0;
        ball.for_each(&mut |p| {
            sum += p.mass * p.position[1];
            mass += p.mass;
        });
        let note = [now.time(), sum / mass, totals.momentum[1] / totals.mass];
        // Consecutive segments of a run share one time.
        if self.notes.last().is_none_or(|last| last[0] < note[0]) {
            self.notes.push(note);
        }
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.notes, &[0.0; 3], |file, note| file.reals(note.each_mut()))
    }
}

/// Return the largest force, N, the largest approach, m, and the time for which the force exceeds a part of its maximum, s.
pub fn figures(rows: &[Row], part: f64) -> [f64; 3] {
    let force = rows.iter().map(|r| r.force).fold(0.0, f64::max);
    let approach = rows.iter().map(|r| r.approach).fold(0.0, f64::max);
    // Forces are means since the previous row, and belong to the middle of that interval.
    let mut ends = rows.windows(2).filter_map(|pair| {
        let [a, b] = [pair[0], pair[1]];
        let middle = |r: Row, length: f64| r.time - 0.5 * length;
        let every = b.time - a.time;
        let level = part * force;
        let crosses = (a.force - level) * (b.force - level) < 0.0;
        let share = (level - a.force) / (b.force - a.force);
        crosses.then(|| middle(a, every) + share * every)
    });
    let first = ends.next().unwrap_or(f64::NAN);
    [force, approach, ends.next_back().unwrap_or(f64::NAN) - first]
}
