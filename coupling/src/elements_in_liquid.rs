//! Bodies of finite elements in an incompressible liquid.

use fem::Fem;
use flow::{Deformable, NodeImpulse, SurfaceElement};
use impactite_geometry::Facet;
use impactite_scene::{Exchange, Solver, StepError};

use crate::leapfrog::Leapfrog;

/// Bodies of finite elements that an incompressible liquid moves, for [`flow::Flow::add_deformable`].
///
/// Body force, conditions and contact between the bodies are those of the [`Fem`], whose stable steps fill a step of the flow. A step of the
/// scene repeats these runs until the velocities of liquid and bodies agree, usually 4 to 20 times.
///
/// ```
/// use coupling::ElementsInLiquid;
/// use fem::{Fem, MeshBody};
/// use flow::{Flow, FlowOptions, Fluid, Wall};
/// use impactite_geometry::{Compose, Cuboid, Lattice, structured::box_mesh};
/// use impactite_scene::{PlaneStrain, Solver};
/// use mpm_materials::{Moduli, NeoHookean};
/// use std::sync::Arc;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A block of soft rubber, 0.1 m wide and half as dense as water, floats.
/// let rubber = NeoHookean::new(500.0, Moduli::young_poisson(1e5, 0.4)?)?;
/// let block = Cuboid::new([0.15, 0.15], [0.25, 0.25])?;
/// let mut elements = Fem::new(PlaneStrain);
/// elements.add(MeshBody::new("block", box_mesh(&block, [4, 4])?, rubber))?;
/// elements.set_body_force(Arc::new(|_| [0.0, -9.81]));
///
/// let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 2], 0.02)?));
/// flow.add_wall(Wall::container(Cuboid::new([0.0, 0.0], [0.4, 0.6])?))?;
/// flow.add_deformable(ElementsInLiquid::new(elements))?;
/// let water = Cuboid::new([0.0, 0.0], [0.4, 0.2])?.minus(block);
/// flow.add_shape("water", Fluid::new(1000.0)?, &water, 2, |_| [0.0; 2])?;
/// flow.set_body_force(|_| [0.0, -9.81]);
/// flow.run_until(0.1)?;
/// let height = flow.bodies()[1].totals().momentum[1];
/// assert!(height.abs() < 0.2);
/// # Ok(())
/// # }
/// ```
pub struct ElementsInLiquid<const D: usize> {
    fem: Fem<D>,
}

impl<const D: usize> ElementsInLiquid<D> {
    /// Create the bodies of a scene of finite elements.
    pub fn new(fem: Fem<D>) -> Self {
        ElementsInLiquid { fem }
    }
    /// Scene of finite elements.
    pub fn fem(&self) -> &Fem<D> {
        &self.fem
    }
}

/// Facets of `D` nodes of a facet of an element: a quadrilateral is two triangles.
fn parts<const D: usize>(facet: &Facet) -> impl Iterator<Item = [u32; D]> {
    let nodes = facet.nodes;
    let count = nodes.iter().filter(|n| **n != Facet::NONE).count();
    let pick: &[[usize; 3]] = if count == 4 { &[[0, 1, 2], [0, 2, 3]] } else { &[[0, 1, 2]] };
    pick.iter().map(move |place| std::array::from_fn(|k| nodes[place[k]]))
}

impl<const D: usize> Deformable<D> for ElementsInLiquid<D> {
    fn solver(&self) -> &dyn Solver {
        &self.fem
    }
    fn solver_mut(&mut self) -> &mut dyn Solver {
        &mut self.fem
    }
    fn surface(&self) -> Vec<SurfaceElement<D>> {
        let bodies = self.fem.element_bodies().iter().enumerate();
        let facets = bodies.flat_map(|(n, body)| body.surface().iter().map(move |facet| (n, facet)));
        let parts = facets.flat_map(|(n, facet)| parts(facet).map(move |nodes| (n, nodes)));
        parts.map(|(n, nodes)| SurfaceElement { body: n as u32, nodes }).collect()
    }
    fn surface_revision(&self) -> u64 {
        self.fem.element_bodies().iter().map(fem::ElementBody::surface_revision).sum()
    }
    fn node(&self, body: u32, node: u32) -> ([f64; D], [f64; D]) {
        let node = &self.fem.body(body as usize).nodes()[node as usize];
        // In the middle of the last step: see `Leapfrog`.
        let back = 0.5 * self.fem.clock().last.unwrap_or(0.0);
        (std::array::from_fn(|d| node.position[d] - back * node.velocity[d]), node.velocity)
    }
    fn run_for(&mut self, duration: f64, impulses: &[NodeImpulse<D>]) -> Result<(), StepError> {
        let mut steps = Leapfrog::new(duration, self.fem.clock().last);
        let mut left = 1.0;
        while let Some((dt, share)) = steps.next(self.fem.next_time_step(), self.fem.clock().last) {
            self.fem.begin(dt)?;
            for push in impulses {
                let part = push.impulse.map(|x| x * left * share);
                self.fem.body_mut(push.body as usize).add_impulse(push.node as usize, part);
            }
            self.fem.finish()?;
            left *= 1.0 - share;
            steps.made(dt);
        }
        Ok(())
    }
    fn given(&self) -> Exchange {
        self.fem.element_bodies().iter().fold(Exchange::default(), |sum, body| sum.plus(&body.pushed()))
    }
}
