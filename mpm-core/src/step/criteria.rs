//! Criteria of smaller cells, evaluated while a scene runs ([`Mpm::refine_where`](crate::Mpm::refine_where)).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::bodies::body::GridBody;
use super::nodes::at_wall::Plane;
use crate::grid::Levels;
use impactite_geometry::Shape;
use impactite_scene::boundary::Boundary;
use impactite_simd::{Float, Team};

/// Points along an edge of a block at which a region is sampled.
const SAMPLES: usize = 9;

/// Block of particles, for criteria.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OccupiedBlock<const D: usize> {
    /// Stored coordinates, which contain the level.
    pub(super) at: [i32; D],
    /// Index of its body in the scene.
    pub body: usize,
    /// Number of halvings of its cells.
    pub halvings: usize,
    /// Lower corner of its cells with particles, m.
    pub low: [f64; D],
    /// Upper corner of its cells with particles, m.
    pub high: [f64; D],
    /// Edge of the block, four cells, m.
    pub edge: f64,
}

/// Scene between two steps, for criteria.
pub struct RegridView<'a, T: Float, const D: usize> {
    pub(super) bodies: &'a [Box<dyn GridBody<T, D>>],
    pub(super) boundaries: &'a [Boundary<D>],
    pub(super) blocks: Vec<OccupiedBlock<D>>,
    /// Centres of mass of the bodies at the first decision, m.
    pub(super) starts: &'a [[f64; D]],
    pub(super) team: &'a Team,
    /// Time, s.
    pub time: f64,
}

impl<T: Float, const D: usize> RegridView<'_, T, D> {
    /// Blocks of four cells an axis with particles, in the order of bodies.
    pub fn blocks(&self) -> &[OccupiedBlock<D>] {
        &self.blocks
    }
    /// Boundary conditions.
    pub fn boundaries(&self) -> &[Boundary<D>] {
        self.boundaries
    }
    /// Return the index of a body by its name.
    pub fn body_named(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.name() == name)
    }
    /// Return the displacement of the centre of mass of a body since the first decision, at the start of the run, m.
    pub fn displacement(&self, body: usize) -> [f64; D] {
        let (now, start) = (centre_of(&*self.bodies[body]), self.starts.get(body));
        std::array::from_fn(|d| start.map_or(0.0, |start| now[d] - start[d]))
    }
    /// Return true if the law of a body has a state variable of this name.
    pub fn has_state(&self, state: &str) -> bool {
        self.bodies.iter().any(|body| body.state_names().iter().any(|name| name == state))
    }
    /// Return, for every block, true if it has a particle whose state variable `state` is `least` or more. Laws without
    /// the variable have none.
    pub fn above(&self, state: &str, least: f64) -> Vec<bool> {
        let mut found = BTreeSet::new();
        for (number, body) in self.bodies.iter().enumerate() {
            body.each_block_above(state, least, self.team, &mut |at| {
                found.insert((number, *at));
            });
        }
        self.blocks.iter().map(|block| found.contains(&(block.body, block.at))).collect()
    }
}

/// Criterion for smaller cells.
pub trait Criterion<T: Float, const D: usize>: Send + Sync {
    /// Set the entry of every block of [`RegridView::blocks`] whose cells are to be halved.
    fn mark(&self, view: &RegridView<'_, T, D>, marked: &mut [bool]);
    /// Check the parameters before the first decision.
    ///
    /// # Errors
    /// Parameters that do not fit the scene, in words.
    fn check(&self, view: &RegridView<'_, T, D>) -> Result<(), &'static str> {
        let _ = view;
        Ok(())
    }
    /// Description of the criterion, for checkpoints: with all parameters.
    fn describe(&self) -> String;
}

/// Smaller cells where another body or a wall is near.
///
/// A block is marked if a block of another body, or a wall, is within this many of its own edges: cells become smaller
/// towards the contact by themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearContact {
    /// Distance in edges of a block, four cells; 1 by default.
    pub edges: f64,
}

impl Default for NearContact {
    fn default() -> Self {
        NearContact { edges: 1.0 }
    }
}

impl<T: Float, const D: usize> Criterion<T, D> for NearContact {
    fn mark(&self, view: &RegridView<'_, T, D>, marked: &mut [bool]) {
        let blocks = view.blocks();
        let Some(widest) = blocks.iter().map(|block| block.edge).reduce(f64::max) else { return };
        let cell = widest * self.edges.max(1.0);
        let cells = |low: &[f64; D], high: &[f64; D]| {
            let ends: [[i64; 2]; D] =
                std::array::from_fn(|d| [low[d], high[d]].map(|x| (x / cell).floor() as i64));
            let counts = ends.map(|[a, b]| (b - a) as usize + 1);
            (0..counts.iter().product::<usize>()).map(move |n| {
                let mut rest = n;
                std::array::from_fn::<i64, D, _>(|d| {
                    let at = ends[d][0] + (rest % counts[d]) as i64;
                    rest /= counts[d];
                    at
                })
            })
        };
        let mut there: BTreeMap<[i64; D], Vec<usize>> = BTreeMap::new();
        for (n, block) in blocks.iter().enumerate() {
            cells(&block.low, &block.high).for_each(|at| there.entry(at).or_default().push(n));
        }
        let walls: Vec<Plane<D>> =
            view.boundaries().iter().filter_map(|boundary| Plane::of(boundary, view.time)).collect();
        for (block, marked) in blocks.iter().zip(marked) {
            let reach = self.edges * block.edge;
            let (low, high) = (block.low.map(|x| x - reach), block.high.map(|x| x + reach));
            let meets = |other: &usize| {
                let other = &blocks[*other];
                other.body != block.body && (0..D).all(|d| other.low[d] <= high[d] && low[d] <= other.high[d])
            };
            let wall = |wall: &Plane<D>| wall.distance(&block.low).min(wall.distance(&block.high)) <= reach;
            *marked |= walls.iter().any(wall)
                || cells(&low, &high).any(|at| there.get(&at).is_some_and(|list| list.iter().any(meets)));
        }
    }
    fn describe(&self) -> String {
        format!("near contact: {} edges", self.edges)
    }
}

/// Return the centre of mass of a body, m.
pub(super) fn centre_of<T: Float, const D: usize>(body: &dyn GridBody<T, D>) -> [f64; D] {
    let (mut mass, mut sum) = (0.0, [0.0; D]);
    body.for_each(&mut |p| {
        mass += p.mass;
        (0..D).for_each(|d| sum[d] += p.mass * p.position[d]);
    });
    sum.map(|sum| if mass > 0.0 { sum / mass } else { 0.0 })
}

/// Return true if a region contains one of the samples within a cuboid: one that ends at its face does not touch it.
pub(super) fn touches<const D: usize>(region: &dyn Shape<D>, low: &[f64; D], high: &[f64; D]) -> bool {
    let bounds = region.bounds();
    if (0..D).any(|d| bounds.min[d] > high[d] || bounds.max[d] < low[d]) {
        return false;
    }
    (0..SAMPLES.pow(D as u32)).any(|n| {
        let mut rest = n;
        let x = std::array::from_fn(|d| {
            let share = ((rest % SAMPLES) as f64 + 0.5) / SAMPLES as f64;
            rest /= SAMPLES;
            low[d] + share * (high[d] - low[d])
        });
        region.contains(x)
    })
}

/// Smaller cells in a region that moves with a body.
#[derive(Clone)]
pub struct WithBody<const D: usize> {
    /// Region at the start of the run.
    pub region: Arc<dyn Shape<D>>,
    /// Name of the body whose centre of mass the region follows.
    pub body: String,
}

impl<const D: usize> WithBody<D> {
    /// Halve cells in a region, given at its place at the start of the run, that follows the centre of mass of a body.
    pub fn new(region: impl Shape<D> + 'static, body: impl Into<String>) -> Self {
        WithBody { region: Arc::new(region), body: body.into() }
    }
}

impl<T: Float, const D: usize> Criterion<T, D> for WithBody<D> {
    fn mark(&self, view: &RegridView<'_, T, D>, marked: &mut [bool]) {
        let Some(body) = view.body_named(&self.body) else { return };
        let by = view.displacement(body);
        for (block, marked) in view.blocks().iter().zip(marked) {
            let [low, high] = [&block.low, &block.high].map(|x| std::array::from_fn(|d| x[d] - by[d]));
            *marked = *marked || touches(&*self.region, &low, &high);
        }
    }
    fn check(&self, view: &RegridView<'_, T, D>) -> Result<(), &'static str> {
        if view.body_named(&self.body).is_none() {
            return Err("the scene has no body of this name");
        }
        let (bounds, edges) = (self.region.bounds(), view.blocks().iter().map(|block| block.edge));
        let widest = edges.fold(0.0, f64::max) / SAMPLES as f64;
        let thin = (0..D).any(|d| bounds.max[d] - bounds.min[d] < widest);
        if thin { Err("the region is smaller than a ninth of four cells") } else { Ok(()) }
    }
    fn describe(&self) -> String {
        let (bounds, measure, centroid) =
            (self.region.bounds(), self.region.measure(), self.region.centroid());
        format!(
            "region of {:?} to {:?}, {measure:?}, {centroid:?} with {}",
            bounds.min, bounds.max, self.body
        )
    }
}

/// Smaller cells where a state variable of the law, as the plastic strain or the damage, has reached a value.
#[derive(Clone, Debug, PartialEq)]
pub struct StateAbove {
    /// Name of the state variable ([`Material::state_names`](mpm_materials::material::Material::state_names)).
    pub state: String,
    /// Least value.
    pub least: f64,
}

impl<T: Float, const D: usize> Criterion<T, D> for StateAbove {
    fn mark(&self, view: &RegridView<'_, T, D>, marked: &mut [bool]) {
        for (marked, above) in marked.iter_mut().zip(view.above(&self.state, self.least)) {
            *marked |= above;
        }
    }
    fn check(&self, view: &RegridView<'_, T, D>) -> Result<(), &'static str> {
        let known = view.has_state(&self.state);
        if known {
            Ok(())
        } else {
            Err("no law of the scene has this state variable (`Material::state_names`)")
        }
    }
    fn describe(&self) -> String {
        format!("{} from {}", self.state, self.least)
    }
}

/// Adaptive refinement of a scene.
pub(super) struct Adaptive<T: Float, const D: usize> {
    /// Criteria, each with its number of halvings; none with regions alone, around which empty blocks are refined once.
    pub(super) criteria: Vec<(Box<dyn Criterion<T, D>>, usize)>,
    /// Refined blocks of regions, for checkpoints.
    pub(super) regions: String,
    /// Centres of mass of the bodies at the first decision, m.
    pub(super) starts: Vec<[f64; D]>,
    /// True before the first decision, and if the last one halved cells with particles: the next step decides again.
    pub(super) again: bool,
    /// Levels from the next pass on.
    pub(super) pending: Option<Arc<Levels<D>>>,
}

impl<T: Float, const D: usize> Default for Adaptive<T, D> {
    /// No criteria yet, before the first decision.
    fn default() -> Self {
        let (criteria, regions, starts) = (Vec::new(), String::new(), Vec::new());
        Adaptive { criteria, regions, starts, again: true, pending: None }
    }
}
