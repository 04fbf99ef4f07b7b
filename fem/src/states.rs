//! Initial states.

use impactite_scene::SceneError;
use impactite_scene::error::parameter;
use mpm_materials::point::{flatten, unflatten};
use mpm_materials::{Constitutive, State};

use crate::solver::Fem;

impl<const D: usize> Fem<D> {
    /// Set initial states, such as initial stresses: call `change` with the centre of the element (m) and the state of every integration
    /// point of a body. `C` must be the law of the body.
    ///
    /// # Errors
    /// No such body; another law; a number that is not finite.
    pub fn set_states<C: Constitutive<f64>>(
        &mut self,
        body: usize,
        mut change: impl FnMut([f64; D], C::State<f64>) -> C::State<f64>,
    ) -> Result<(), SceneError> {
        let there = body < self.bodies.len();
        parameter(there, "initial states", "body", body as f64, "the number of a body of the scene")?;
        let body = &mut self.bodies[body];
        let mut names = Vec::new();
        C::State::<f64>::names("state", &mut names);
        if names != body.material.state_names() {
            return Err(SceneError::OtherState { law: body.material.name(), there: names.join(", ") });
        }
        let mut numbers = vec![0.0; body.virgin.len()];
        let mut sets = std::mem::take(&mut body.sets);
        let mut broken = None;
        for set in &mut sets {
            let points = set.sweep.points();
            let alive: Vec<(usize, usize, u32)> = (0..set.batches.len())
                .flat_map(|b| (0..set.batches[b].elements).map(move |e| (b, e)))
                .zip(&set.numbers)
                .map(|((b, e), &number)| (b, e, number))
                .filter(|(b, e, _)| set.batches[*b].alive(*e, points))
                .collect();
            for (b, e, number) in alive {
                let wide = body.centre(set, &set.batches[b], e);
                let centre = std::array::from_fn(|d| wide[d]);
                for point in 0..points {
                    let batch = &mut set.batches[b];
                    batch.read(e, (point, points), &mut numbers);
                    if let Ok(state) = unflatten::<f64, C::State<f64>>(&numbers) {
                        numbers.copy_from_slice(&flatten(&change(centre, state)));
                    }
                    broken = broken.or(numbers.iter().find(|x| !x.is_finite()).map(|&value| (number, value)));
                    batch.write(e, (point, points), &numbers);
                }
            }
        }
        body.sets = sets;
        if let Some((element, value)) = broken {
            return Err(SceneError::Element {
                body: body.name.clone(),
                element: element as usize,
                field: "number of the state",
                value,
                allowed: "finite",
            });
        }
        body.forces_of_states(&self.team, &self.memory);
        Ok(())
    }
}
