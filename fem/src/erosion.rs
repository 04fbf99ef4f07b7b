//! Erosion: removal of elements.

use impactite_scene::SceneError;
use impactite_scene::error::parameter;
use mpm_materials::material::Material;

use crate::sweep::{Batch, OCTET, Scratch, lane};

/// Criterion for the removal of an element. Its mass stays on its nodes, which fly on without elements; its internal energy is booked as
/// negative [`Exchange::conversion`](impactite_scene::Exchange); the surface of the body is updated.
#[derive(Clone, Debug, PartialEq)]
pub enum Criterion {
    /// State variable of the law, by name ([`Body::state_names`](impactite_scene::Body::state_names)), at or above a threshold in half of
    /// the integration points: `plastic_strain`, `damage` and others.
    State {
        /// Name of the state variable.
        name: String,
        /// Threshold.
        at_least: f64,
    },
    /// Failure by the law in half of the integration points.
    Failed,
    /// Volume ratio of an integration point, at most this part of the reference volume. It is checked before the law is evaluated, so that
    /// elements about to turn inside out are removed instead of stopping the run. In (0, 1).
    Volume(f64),
    /// Stable time step of the element, at most this, s.
    Step(f64),
    /// Conjunction of these criteria; not [`Criterion::Volume`].
    All(Vec<Criterion>),
}

/// Erosion criteria of a body: an element is removed if any is satisfied.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Erosion {
    criteria: Vec<Criterion>,
}

impl Erosion {
    /// Empty set of criteria: no erosion.
    #[must_use]
    pub fn none() -> Self {
        Erosion::default()
    }
    /// Add a criterion.
    #[must_use]
    pub fn or(mut self, criterion: Criterion) -> Self {
        self.criteria.push(criterion);
        self
    }
    /// Erosion by accumulated plastic strain, the state variable of that name.
    #[must_use]
    pub fn plastic_strain(at_least: f64) -> Self {
        Erosion::none().or(Criterion::State { name: "plastic_strain".into(), at_least })
    }
    /// Erosion by failure of the law.
    #[must_use]
    pub fn failed() -> Self {
        Erosion::none().or(Criterion::Failed)
    }
    /// Erosion by volume ratio: elements compressed to this part of their volume, or turned inside out.
    #[must_use]
    pub fn volume(part: f64) -> Self {
        Erosion::none().or(Criterion::Volume(part))
    }
    /// Erosion by stable time step: elements at or below this, s.
    #[must_use]
    pub fn step(at_most: f64) -> Self {
        Erosion::none().or(Criterion::Step(at_most))
    }

    /// Resolve names of state variables to indices in a law, and check the parameters.
    pub(crate) fn resolve(&self, material: &dyn Material<f64>) -> Result<Resolved, SceneError> {
        let names = material.state_names();
        let tests = self.criteria.iter().filter(|c| !matches!(c, Criterion::Volume(_)));
        let tests: Result<Vec<Test>, SceneError> =
            tests.map(|c| test(c, &names, material.name(), "erosion")).collect();
        let mut least = 0.0f64;
        for criterion in &self.criteria {
            if let Criterion::Volume(part) = *criterion {
                parameter(part > 0.0 && part < 1.0, "erosion", "part of the volume", part, "in (0, 1)")?;
                least = least.max(part);
            }
        }
        Ok(Resolved { least, tests: tests? })
    }
}

/// Resolved criteria of a body with its law.
#[derive(Clone, Debug, Default)]
pub(crate) struct Resolved {
    /// Volume ratio at which an element is removed, or zero.
    pub least: f64,
    tests: Vec<Test>,
}

impl Resolved {
    /// True if elements may erode.
    pub fn is_on(&self) -> bool {
        !self.tests.is_empty() || self.least > 0.0
    }
}

#[derive(Clone, Debug)]
pub(crate) enum Test {
    /// State variable by index, and its threshold.
    State(usize, f64),
    Failed,
    Rate(f64),
    All(Vec<Test>),
}

/// Resolve a criterion: indices of state variables for their names. `Criterion::Volume` is refused.
pub(crate) fn test(
    criterion: &Criterion,
    names: &[String],
    law: &'static str,
    what: &'static str,
) -> Result<Test, SceneError> {
    match criterion {
        Criterion::State { name, at_least } => {
            parameter(at_least.is_finite(), what, "at_least", *at_least, "finite")?;
            let place = names.iter().position(|n| n == name);
            let place = place.ok_or_else(|| SceneError::NotWith {
                what: format!("{what} by `{name}`"),
                method: format!("the law {law}, whose state has {}", names.join(", ")),
                why: "take one of these numbers",
            })?;
            Ok(Test::State(place, *at_least))
        }
        Criterion::Failed => Ok(Test::Failed),
        Criterion::Step(step) => {
            parameter(*step > 0.0, what, "step", *step, "positive and finite")?;
            Ok(Test::Rate(1.0 / step))
        }
        Criterion::Volume(part) => {
            let allowed = "none: of erosion it is a criterion of its own, looked at before the law is asked; elements become \
                           particles by their Jacobians";
            Err(SceneError::Parameter { owner: what, field: "part of the volume", value: *part, allowed })
        }
        Criterion::All(list) => {
            Ok(Test::All(list.iter().map(|c| test(c, names, law, what)).collect::<Result<_, _>>()?))
        }
    }
}

impl Resolved {
    /// True if there is no criterion to check after a sweep.
    pub fn is_idle(&self) -> bool {
        self.tests.is_empty()
    }

    /// Elements of a batch to erode, by index.
    pub fn gone(
        &self,
        material: &dyn Material<f64>,
        points: usize,
        batch: &Batch,
        scratch: &Scratch,
    ) -> Vec<usize> {
        if self.is_idle() {
            return Vec::new();
        }
        let alive = (0..batch.elements).filter(|&e| batch.alive(e, points));
        let meets = |e: &usize| self.tests.iter().any(|t| met(t, *e, (material, points), batch, scratch));
        alive.filter(meets).collect()
    }
}

/// True if an element of a batch satisfies a criterion, after a sweep.
pub(crate) fn met(
    test: &Test,
    e: usize,
    of: (&dyn Material<f64>, usize),
    batch: &Batch,
    scratch: &Scratch,
) -> bool {
    let (material, points) = of;
    let half = |holds: &dyn Fn(usize) -> bool| 2 * (0..points).filter(|&p| holds(p)).count() >= points;
    match test {
        Test::State(place, least) => {
            half(&|p| batch.number(e, (p, points), (*place, material.numbers())) >= *least)
        }
        Test::Failed => {
            let mut state = vec![0.0; material.numbers()];
            let failed = (0..points).filter(|&p| {
                batch.read(e, (p, points), &mut state);
                material.describe_point(&state).is_some_and(|said| said.failed)
            });
            2 * failed.count() >= points
        }
        Test::Rate(rate) => lane(&scratch.rates[e / OCTET], e % OCTET) >= *rate,
        Test::All(list) => list.iter().all(|t| met(t, e, of, batch, scratch)),
    }
}
