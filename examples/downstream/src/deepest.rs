//! Hook that follows the deepest penetration: the lowest point of a body along an axis, after every step.

use std::sync::{Arc, Mutex};

use impactite::mpm::{Hook, HookError, StepView};

/// Deepest place so far and its time, shared with the program.
#[derive(Clone, Debug)]
pub struct Deepest {
    /// Index of the body, and axis.
    pub of: (usize, usize),
    /// Smallest coordinate, m, and its time, s.
    pub found: Arc<Mutex<[f64; 2]>>,
}

impl Deepest {
    /// Follow a body along an axis.
    pub fn new(body: usize, axis: usize) -> Self {
        Deepest { of: (body, axis), found: Arc::new(Mutex::new([f64::INFINITY, 0.0])) }
    }
}

impl<const D: usize> Hook<f64, D> for Deepest {
    fn name(&self) -> &str {
        "deepest penetration"
    }
    fn needs_nodes(&self) -> bool {
        false
    }
    fn after_step(&mut self, step: &StepView<'_, D>) -> Result<(), HookError> {
        let mut found = self.found.lock().map_err(|_| "the result is lost")?;
        step.bodies[self.of.0].for_each(&mut |point| {
            let place = point.position[self.of.1];
            if place < found[0] {
                *found = [place, step.time];
            }
        });
        Ok(())
    }
}
