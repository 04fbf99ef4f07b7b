//! Erosion: elements that leave.

use impactite_scene::SceneError;
use impactite_scene::error::parameter;
use mpm_materials::material::Material;

use crate::sweep::{Batch, OCTET, Scratch, lane};

/// When an element leaves. Its mass stays on its nodes, which fly on when no element is left at them; its internal energy is booked as
/// one of conversion ([`Exchange::conversion`](impactite_scene::Exchange)), negative; the surface of the body is that of what is left.
#[derive(Clone, Debug, PartialEq)]
pub enum Criterion {
    /// A number of the state of the law, by its name ([`Body::state_names`](impactite_scene::Body::state_names)), is at least this in half
    /// of the integration points: `plastic_strain`, `damage` and others.
    State {
        /// The name.
        name: String,
        /// The number.
        at_least: f64,
    },
    /// The law says of half of the integration points that they failed.
    Failed,
    /// A point has at most this part of its reference volume. It is looked at before the law is asked, so that elements about to
    /// turn inside out leave instead of stopping the run. In (0, 1).
    Volume(f64),
    /// The stable step of the element is at most this, s.
    Step(f64),
    /// All of these; not [`Criterion::Volume`].
    All(Vec<Criterion>),
}

/// The criteria of a body: an element leaves by any of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Erosion {
    criteria: Vec<Criterion>,
}

impl Erosion {
    /// No element leaves.
    #[must_use]
    pub fn none() -> Self {
        Erosion::default()
    }
    /// Also by this criterion.
    #[must_use]
    pub fn or(mut self, criterion: Criterion) -> Self {
        self.criteria.push(criterion);
        self
    }
    /// By accumulated plastic strain, the law's number of that name.
    #[must_use]
    pub fn plastic_strain(at_least: f64) -> Self {
        Erosion::none().or(Criterion::State { name: "plastic_strain".into(), at_least })
    }
    /// Of points that failed.
    #[must_use]
    pub fn failed() -> Self {
        Erosion::none().or(Criterion::Failed)
    }
    /// Of elements squeezed to this part of their volume, or turned inside out.
    #[must_use]
    pub fn volume(part: f64) -> Self {
        Erosion::none().or(Criterion::Volume(part))
    }
    /// Of elements whose stable step is at most this, s.
    #[must_use]
    pub fn step(at_most: f64) -> Self {
        Erosion::none().or(Criterion::Step(at_most))
    }

    /// With places of numbers of a law for their names.
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

/// Criteria of a body with a law.
#[derive(Clone, Debug, Default)]
pub(crate) struct Resolved {
    /// Part of the volume at which points count as gone, or zero.
    pub least: f64,
    tests: Vec<Test>,
}

impl Resolved {
    /// May elements erode?
    pub fn is_on(&self) -> bool {
        !self.tests.is_empty() || self.least > 0.0
    }
}

#[derive(Clone, Debug)]
pub(crate) enum Test {
    /// A number of the state, by place.
    State(usize, f64),
    Failed,
    Rate(f64),
    All(Vec<Test>),
}

/// A criterion with places of numbers of a law for their names; for erosion without that of volume.
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
    /// Is there nothing to look at after a sweep?
    pub fn is_idle(&self) -> bool {
        self.tests.is_empty()
    }

    /// The elements of a batch that leave.
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

/// Does an element of a batch meet a criterion, after a sweep?
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
