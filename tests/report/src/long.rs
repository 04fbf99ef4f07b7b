//! Long time: how the energy of a swinging bar (T17 of the stability scenes) changes with the steps.

use stability::scenes::long::{LENGTH, STEP, swinging_bar};
use stability::stage::energy;
use verification::work::{Stopwatch, Work};
use verification::{Outcome, Scheme};

use crate::job::Key;

/// A bar that swings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Long {
    /// Scheme.
    pub scheme: Scheme,
    /// Steps.
    pub steps: u64,
}

impl Long {
    /// The name of its problem in files.
    pub const PROBLEM: &str = "T17 swing";

    /// Its name. The number of steps is told by the records of a run, not by its name.
    pub fn key(self) -> Key {
        Key {
            problem: Self::PROBLEM.into(),
            scheme: self.scheme.name(),
            per_axis: 2,
            cells: LENGTH as usize,
            courant: STEP,
        }
    }

    /// The one of a name, of the length that is asked of a quick sweep.
    pub fn of(key: &Key) -> Option<Long> {
        let scheme = Scheme::named(&key.scheme)?;
        let long = Long { scheme, steps: 100_000 };
        (long.key() == *key).then_some(long)
    }

    /// Steps after which it is looked at: 1, 2 and 5 in a decade, and the last.
    fn marks(self) -> Vec<u64> {
        let all = (2..9).flat_map(|decade| [1, 2, 5].map(|n| n * 10u64.pow(decade)));
        all.filter(|&n| n > 2 * Self::period() && n < self.steps).chain([self.steps]).collect()
    }

    /// Steps of a period.
    fn period() -> u64 {
        (2.0 * LENGTH / STEP).round() as u64
    }

    /// Run it: "energy" is the relative change of its mean over a period, from the first one to the last before
    /// each mark.
    pub fn run(self) -> Vec<Outcome> {
        let mut mpm = match swinging_bar(self.scheme) {
            Ok(mpm) => mpm,
            Err(why) => return vec![Outcome { failure: Some(why), ..Outcome::default() }],
        };
        let mut work = Work { nodes: self.scheme.kernel.nodes(2), ..Work::default() };
        for body in mpm.bodies() {
            body.for_each(&mut |_| work.particles += 1);
        }
        let period = Self::period();
        let mut first = f64::NAN;
        let mut outcomes = Vec::new();
        for mark in std::iter::once(period).chain(self.marks()) {
            let mut sum = 0.0;
            while work.steps < mark {
                // Looked at are the steps of the last period alone.
                let looked = work.steps >= mark - period;
                let stretch = if looked { 1 } else { mark - period - work.steps };
                let watch = Stopwatch::start();
                for _ in 0..stretch {
                    if let Err(error) = mpm.step() {
                        let failure = Some(error.to_string());
                        outcomes.push(Outcome { measures: Vec::new(), work, failure });
                        return outcomes;
                    }
                    work.steps += 1;
                }
                work.seconds += watch.seconds();
                if looked {
                    sum += energy(&mpm.totals());
                }
            }
            work.bytes = mpm.bytes() as u64;
            if first.is_nan() {
                first = sum;
            } else {
                outcomes.push(Outcome { measures: vec![("energy", sum / first - 1.0)], work, failure: None });
            }
        }
        outcomes
    }
}
