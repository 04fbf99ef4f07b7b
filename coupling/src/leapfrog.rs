//! Steps of bodies within a step of the liquid.

/// Part of the largest stable step that is taken where the last one cannot be kept.
const PART: f64 = 0.8;
/// Part of the largest stable step above which a step is kept.
const KEPT: f64 = 0.5;
/// Part of a run that is rounding.
const ROUNDING: f64 = 1e-9;

/// Steps of a leapfrog in runs under constant forces.
///
/// Velocities are in the middle of steps: v' = v + dt f(x), x' = x + dt v'. A body that goes from x to x + dt v' in the last step of a run is at
/// x' - dt v' / 2 in its middle. With these places Y, the work of a force F that acts in all steps of a run is F . (Y' - Y) for equal steps, of any
/// length that is stable: (x_n + x_(n-1)) / 2 - (x_0 + x_(-1)) / 2 = sum of (x_(k+1) - x_(k-1)) / 2 over the steps. With the places x_n it is not, the
/// less the longer the steps are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leapfrog {
    /// Time from the place at the start of the next step to the end of the run, s: less than half a step, or negative, at the end.
    until: f64,
    /// Longest step of the run, s: it has two at least, so that half a run has one.
    longest: f64,
}

impl Leapfrog {
    /// Begin a run of `duration`, s, from the middle of the last step.
    pub fn new(duration: f64, last: Option<f64>) -> Self {
        let until = duration - 0.5 * last.unwrap_or(0.0);
        // A run much shorter than the last step begins at its end.
        let until = if until > 0.1 * duration { until } else { 0.5 * duration };
        Leapfrog { until, longest: until / 1.5 }
    }

    /// Size of the next step, s, and the share of the impulses that are left for it, by the step that the body allows and its last one; none at the end
    /// of the run.
    pub fn next(&self, allowed: f64, last: Option<f64>) -> Option<(f64, f64)> {
        if self.until <= 0.0 {
            return None;
        }
        // The longest step of a run may be missed by rounding, the stable one may not: a body would make less of it.
        let longest = allowed.min(self.longest);
        let kept = last.map(|last| (self.until / last + 0.5).round().max(1.0));
        let size = |steps: f64| self.until / (steps - 0.5);
        let steps = kept
            .filter(|n| size(*n) <= allowed.min(self.longest * (1.0 + ROUNDING)) && size(*n) > KEPT * longest)
            .unwrap_or_else(|| (self.until / (PART * longest) + 0.5).ceil());
        let step = size(steps);
        Some((step, (step / (self.until + 0.5 * step)).min(1.0)))
    }

    /// Note a step, s.
    pub fn made(&mut self, step: f64) {
        self.until -= step;
        if self.until < ROUNDING * step {
            self.until = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oscillator that runs under forces, with steps of `part` of its limit. Work and change of energy of each run.
    fn balance(part: f64) -> Vec<(f64, f64)> {
        let (omega, mut x, mut v, mut last) = (1.0, 0.3, 0.2, None);
        let allowed = 2.0 * part / omega;
        let place = |x: f64, v: f64, last: Option<f64>| x - 0.5 * last.unwrap_or(0.0) * v;
        let mut list = Vec::new();
        for n in 0..50 {
            let (force, duration) = (f64::from(n * 7 % 11) - 5.0, 3.2);
            let start = place(x, v, last);
            let energy = |x: f64, v: f64, dt: f64| 0.5 * v * v + 0.5 * x * (x - dt * v);
            let before = energy(x, v, last.unwrap_or(0.0));
            let mut steps = Leapfrog::new(duration, last);
            let mut given = 0.0;
            while let Some((dt, share)) = steps.next(allowed, last) {
                assert!(dt <= allowed * (1.0 + 1e-9), "{dt}");
                let impulse = share * (force * duration - given);
                given += impulse;
                v += impulse - dt * omega * omega * x;
                x += dt * v;
                last = Some(dt);
                steps.made(dt);
            }
            assert!((given - force * duration).abs() < 1e-12);
            let work = force * (place(x, v, last) - start);
            list.push((work, energy(x, v, last.unwrap_or(0.0)) - before));
        }
        list
    }

    #[test]
    fn work_of_forces_on_the_places_is_the_energy() {
        for part in [0.1, 0.4, 0.8, 0.95] {
            // The first run begins at a place instead of the middle of a step, and the steps become equal after it.
            for (work, energy) in &balance(part)[25..] {
                assert!((work - energy).abs() < 1e-9, "{part}: {work} {energy}");
            }
        }
    }
}
