//! History of a measure over the steps.

use impactite::scene::{Archive, CheckpointError};

use crate::model::measure::{OverTime, Statistic};

/// Value of a measure, and its time, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) time: f64,
    pub(super) value: f64,
}

/// History of a measure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Past {
    /// Last sample.
    last: Sample,
    /// Rate of change over the last step, per second.
    rate: f64,
    /// Integral over time, and its integration time, s.
    integral: f64,
    span: f64,
    largest: Sample,
    smallest: Sample,
}

impl Default for Past {
    fn default() -> Self {
        let none = Sample { time: f64::NAN, value: f64::NAN };
        Past { last: none, rate: 0.0, integral: 0.0, span: 0.0, largest: none, smallest: none }
    }
}

impl Past {
    /// Return the mean force of the last step, N: the rate of the recorded impulse.
    pub(super) fn force(&self) -> f64 {
        self.rate
    }

    /// Record a value whose rate is needed.
    pub(super) fn enter_rate(&mut self, now: Sample) {
        let step = now.time - self.last.time;
        if step > 0.0 {
            self.rate = (now.value - self.last.value) / step;
        }
        self.last = now;
    }

    /// Record a value of a measure over `from` to `to`, s: the mean of the last step if `mean`, else the value at its end.
    pub(super) fn enter(&mut self, now: Sample, [from, to]: [f64; 2], mean: bool) {
        let before = std::mem::replace(&mut self.last, now);
        if now.value.is_finite() && from <= now.time && now.time <= to {
            // Keep the first of equal values.
            if self.largest.value.is_nan() || now.value > self.largest.value {
                self.largest = now;
            }
            if self.smallest.value.is_nan() || now.value < self.smallest.value {
                self.smallest = now;
            }
        }
        let (start, end) = (before.time.max(from), now.time.min(to));
        let step = now.time - before.time;
        let known = now.value.is_finite() && (mean || before.value.is_finite());
        if !(known && step > 0.0 && end > start) {
            return;
        }
        let at = |time: f64| match mean {
            true => now.value,
            false => before.value + (now.value - before.value) * ((time - before.time) / step),
        };
        self.integral += 0.5 * (at(start) + at(end)) * (end - start);
        self.span += end - start;
    }

    /// Return the statistic; NaN without samples.
    pub(super) fn value(&self, of: &OverTime) -> f64 {
        match of.take {
            Statistic::Largest => self.largest.value,
            Statistic::Smallest => self.smallest.value,
            Statistic::TimeOfLargest => self.largest.time,
            Statistic::TimeOfSmallest => self.smallest.time,
            Statistic::Integral => self.integral,
            Statistic::Mean if self.span > 0.0 => self.integral / self.span,
            Statistic::Mean => f64::NAN,
        }
    }

    /// Store or load the history.
    pub(super) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let Past { last, rate, integral, span, largest, smallest } = self;
        let samples = [last, largest, smallest].into_iter().flat_map(|s| [&mut s.time, &mut s.value]);
        file.reals(samples.chain([rate, integral, span]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(samples: &[(f64, f64)], window: [f64; 2], mean: bool) -> Past {
        let mut past = Past::default();
        samples.iter().for_each(|&(time, value)| past.enter(Sample { time, value }, window, mean));
        past
    }

    #[test]
    fn a_straight_line_has_its_exact_integral_whatever_the_steps() {
        let line: Vec<(f64, f64)> = [0.0, 0.3, 0.35, 0.9, 2.0].map(|t| (t, 3.0 - t)).to_vec();
        let past = over(&line, [0.25, 1.5], false);
        assert!((past.integral - (3.0 * 1.25 - 0.5 * (1.5f64.powi(2) - 0.25f64.powi(2)))).abs() < 1e-14);
        assert!((past.span - 1.25).abs() < 1e-14);
        assert_eq!((past.largest.time, past.smallest.time), (0.3, 0.9), "values at the ends of steps within");
    }

    #[test]
    fn means_of_steps_are_summed_by_the_lengths_of_these() {
        let past = over(&[(0.0, f64::NAN), (1.0, 4.0), (3.0, 1.0)], [0.5, f64::INFINITY], true);
        assert_eq!((past.integral, past.span), (0.5 * 4.0 + 2.0, 2.5));
    }

    #[test]
    fn what_is_no_number_for_a_while_is_left_out() {
        let past = over(&[(0.0, 2.0), (1.0, f64::NAN), (2.0, 2.0), (3.0, 4.0)], [0.0, 9.0], false);
        assert_eq!((past.integral, past.span, past.largest.value, past.smallest.time), (3.0, 1.0, 4.0, 0.0));
    }

    #[test]
    fn an_impulse_has_the_force_of_the_last_step() {
        let mut past = Past::default();
        for (time, value) in [(0.0, 1.0), (0.5, 3.0), (0.5, 3.0)] {
            past.enter_rate(Sample { time, value });
        }
        assert_eq!(past.force(), 4.0);
    }
}
