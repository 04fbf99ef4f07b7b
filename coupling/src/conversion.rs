//! Conversion of elements to particles: criteria, division and energy balance.

use std::sync::{Arc, Mutex, PoisonError};

use fem::{Criterion, ElementBody, Fem};
use impactite_geometry::Shape;
use impactite_scene::SceneError;
use impactite_scene::error::parameter;
use mpm_core::Surroundings;

use crate::element::{Form, box_around, gathered};

/// Default distance to other matter, in cells, at which elements become particles: both reach nodes that are two cells away, and approach
/// each other in the step before conversion.
const NEAR: f64 = 3.0;
/// Part of the first stable time step at which elements become particles in [`Conversion::adaptive`].
const STEP: f64 = 0.5;
/// Parts for [`Conversion::when_distorted`] in [`Conversion::adaptive`].
const DISTORTED: [f64; 2] = [0.4, 0.25];

/// Division of an element into particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Particles {
    /// One particle per half cell of length along each of its axes: two for an element as large as a cell.
    #[default]
    HalfCells,
    /// This number along each axis of a quadrilateral or brick; triangles and tetrahedra are halved until their edges have this number of
    /// parts.
    Each(u32),
    /// One particle at each integration point.
    Points,
}

/// Rules for the conversion of elements to particles ([`Elements::converting`](crate::Elements::converting)): criteria and division.
///
/// Elements whose surface is near other matter are always converted ([`Conversion::near`]), so that contact is that of the scene's grid.
#[derive(Clone)]
pub struct Conversion<const D: usize> {
    region: Option<Arc<dyn Shape<D>>>,
    criteria: Vec<(String, Criterion)>,
    distorted: Option<[f64; 2]>,
    step: Option<f64>,
    near: f64,
    particles: Particles,
}

impl<const D: usize> Conversion<D> {
    fn new() -> Self {
        let (region, criteria, distorted, step) = (None, Vec::new(), None, None);
        Conversion { region, criteria, distorted, step, near: NEAR, particles: Particles::default() }
    }

    /// Convert elements that are deformed too far for a mesh (AFEMP, \[Lian2012\]): a corner Jacobian falls to 0.4 of its initial value,
    /// the edge ratio (shortest over longest) to a quarter, or the stable time step to half of the first one of the body.
    #[must_use]
    pub fn adaptive() -> Self {
        Conversion { step: Some(STEP), distorted: Some(DISTORTED), ..Conversion::new() }
    }

    /// Convert elements with all nodes within a region (MPFEM, \[Zhang2006\]), from the start or as soon as they enter it.
    #[must_use]
    pub fn within(region: impl Shape<D> + 'static) -> Self {
        Conversion { region: Some(Arc::new(region)), ..Conversion::new() }
    }

    /// Also convert elements with all nodes within a region.
    #[must_use]
    pub fn or_within(mut self, region: impl Shape<D> + 'static) -> Self {
        self.region = Some(Arc::new(region));
        self
    }

    /// Also convert by a criterion of the law's state: plastic strain, damage, failure ([`Criterion`]); with a name for the conversion
    /// book.
    #[must_use]
    pub fn or(mut self, name: impl Into<String>, criterion: Criterion) -> Self {
        self.criteria.push((name.into(), criterion));
        self
    }

    /// Also convert elements with a corner Jacobian at most this part of that at rest, or with an edge ratio (shortest over longest) at
    /// most that part.
    #[must_use]
    pub fn when_distorted(mut self, jacobian: f64, edges: f64) -> Self {
        self.distorted = Some([jacobian, edges]);
        self
    }

    /// Also convert elements whose stable time step is at most this part of that of the body at the start.
    #[must_use]
    pub fn when_step_falls_to(mut self, part: f64) -> Self {
        self.step = Some(part);
        self
    }

    /// Set the distance to other matter for conversion, in cells, by default 3.
    #[must_use]
    pub fn near(mut self, cells: f64) -> Self {
        self.near = cells;
        self
    }

    /// Set the division into particles.
    #[must_use]
    pub fn into_particles(mut self, particles: Particles) -> Self {
        self.particles = particles;
        self
    }

    pub(crate) fn particles(&self) -> Particles {
        self.particles
    }

    /// Description for checkpoints.
    pub(crate) fn constants(&self) -> String {
        let Conversion { region, criteria, distorted, step, near, particles } = self;
        let region = region.as_ref().map(|region| impactite_scene::constants::region(&**region));
        format!(
            "into {particles:?}, near {near:?} cells, {region:?}, {criteria:?}, distorted {distorted:?}, step {step:?}"
        )
    }

    /// Check the parameters, and enable conversion in a body.
    pub(crate) fn of(self, fem: &mut Fem<D>) -> Result<Rules<D>, SceneError> {
        let owner = "Conversion";
        let part =
            |field, value: f64| parameter(value > 0.0 && value < 1.0, owner, field, value, "in (0, 1)");
        if let Some([jacobian, edges]) = self.distorted {
            part("part of the Jacobian", jacobian)?;
            part("part of the edges", edges)?;
        }
        let least = "at least 2, so that contact on the grid is that of particles";
        parameter(self.near >= 2.0, owner, "near: cells", self.near, least)?;
        if let Particles::Each(count) = self.particles {
            parameter(
                (1..=8).contains(&count),
                owner,
                "particles along an axis",
                f64::from(count),
                "1 to 8",
            )?;
        }
        let mut criteria = self.criteria.clone();
        if let Some(step) = self.step {
            part("part of the step", step)?;
            criteria.push(("stable step".into(), Criterion::Step(step * fem.body(0).stable_step())));
        }
        let tests: Vec<Criterion> = criteria.iter().map(|(_, criterion)| criterion.clone()).collect();
        fem.convert_by(0, &tests)?;
        let mut names: Vec<String> = criteria.into_iter().map(|(name, _)| name).collect();
        names.extend(MARKS.map(String::from));
        let shares = vec![Share::default(); names.len()];
        let book = ConversionBook { by: names.into_iter().zip(shares).collect(), ..Default::default() };
        let log = ConversionLog(Arc::new(Mutex::new(book)));
        Ok(Rules { what: self, first_mark: tests.len(), looks: 0, rest: Vec::new(), log })
    }
}

/// Criteria that the coupling checks itself, numbered after those of the body.
const MARKS: [&str; 4] = ["region", "Jacobian", "edges", "near others"];
const REGION: usize = 0;
const JACOBIAN: usize = 1;
const EDGES: usize = 2;
const NEAR_OTHERS: usize = 3;
/// Steps between two checks of the element shapes: a fast impact changes them by a fifth in that time.
const LOOK_EVERY: u64 = 4;

/// Conversions by one criterion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Number of elements.
    pub elements: u64,
    /// Energy gained by conversion, J: kinetic energy of particles minus that of the nodes' mass, minus the hourglass energy, which is
    /// lost.
    pub energy: f64,
}

/// Totals of the conversions since the start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConversionBook {
    /// Number of elements.
    pub elements: u64,
    /// Number of particles.
    pub particles: u64,
    /// Mass of the particles, kg.
    pub mass: f64,
    /// Energy gained by conversion, J.
    pub energy: f64,
    /// Part of `energy` by loss of hourglass energy, J, negative.
    pub hourglass: f64,
    /// Shares of the criteria.
    pub by: Vec<(String, Share)>,
    /// Smallest corner Jacobian of a converted element, over that at rest; none before the first conversion.
    pub least_jacobian: Option<f64>,
}

/// Handle that reads the [`ConversionBook`] of elements while they are in a scene.
#[derive(Clone, Debug, Default)]
pub struct ConversionLog(Arc<Mutex<ConversionBook>>);

impl ConversionLog {
    /// Present state of the book.
    pub fn book(&self) -> ConversionBook {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
    pub(crate) fn change(&self, change: impl FnOnce(&mut ConversionBook)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// Conversion rules of a body ([`Conversion`]).
pub(crate) struct Rules<const D: usize> {
    pub what: Conversion<D>,
    first_mark: usize,
    looks: u64,
    /// Shapes of the elements at rest; empty before first use.
    rest: Vec<Form>,
    pub log: ConversionLog,
}

impl<const D: usize> Rules<D> {
    pub fn particles(&self) -> Particles {
        self.what.particles
    }

    pub fn looks_mut(&mut self) -> &mut u64 {
        &mut self.looks
    }

    /// Mark the elements to convert.
    pub fn mark(&mut self, body: &mut ElementBody<D>, around: &Surroundings<D>) {
        let mut marks = Vec::new();
        self.mark_near(body, around, &mut marks);
        if self.looks.is_multiple_of(LOOK_EVERY) {
            self.mark_shapes(body, &mut marks);
        }
        self.looks += 1;
        for (element, mark) in marks {
            body.mark(element, self.first_mark + mark);
        }
    }

    fn mark_near(&self, body: &ElementBody<D>, around: &Surroundings<D>, marks: &mut Vec<(usize, usize)>) {
        if around.others.is_empty() {
            return;
        }
        let margin = self.what.near * around.spacing();
        for facet in body.surface() {
            let (low, high) = box_around(body, facet.nodes());
            if around.others.touches(&low.map(|x| x - margin), &high.map(|x| x + margin)) {
                marks.push((body.element_of(facet), NEAR_OTHERS));
            }
        }
    }

    fn mark_shapes(&mut self, body: &ElementBody<D>, marks: &mut Vec<(usize, usize)>) {
        let region = self.what.region.clone();
        let region = region.as_deref();
        if region.is_none() && self.what.distorted.is_none() {
            return;
        }
        let inside: Vec<bool> = region.map_or(Vec::new(), |region| {
            let within = |n: usize| body.elements_at(n) > 0 && region.contains(body.nodes()[n].position);
            (0..body.nodes().len()).map(within).collect()
        });
        if self.rest.is_empty() && self.what.distorted.is_some() {
            let rest = |n: u32| body.mesh().nodes[n as usize];
            let all = body.mesh().blocks.iter().flat_map(|b| b.elements().map(|nodes| (b.kind, nodes)));
            self.rest.extend(all.map(|(kind, nodes)| Form::of(kind, &gathered(nodes, rest))));
        }
        let mut element = 0;
        for block in &body.mesh().blocks {
            for nodes in block.elements() {
                let number = element;
                element += 1;
                if !body.is_there(number) {
                    continue;
                }
                if region.is_some() && nodes.iter().all(|&n| inside[n as usize]) {
                    marks.push((number, REGION));
                    continue;
                }
                let Some([jacobian, edges]) = self.what.distorted else { continue };
                let now = Form::of(block.kind, &gathered(nodes, |n| body.nodes()[n as usize].position));
                let rest = &self.rest[number];
                if now.aspect <= edges * rest.aspect {
                    marks.push((number, EDGES));
                } else if now.least_jacobian(rest) <= jacobian {
                    marks.push((number, JACOBIAN));
                }
            }
        }
    }
}
