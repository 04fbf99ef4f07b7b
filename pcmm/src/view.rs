//! Observer interface of a body.

use impactite_scene::{Body, Bounds, Embedding, Parts, PointView, Totals};
use mpm_materials::material::Described;

use crate::audit::Coverage;
use crate::method::Composition;
use crate::particles::Particle;
use crate::simplex::{area, volume};
use crate::solver::Pcmm;
use crate::tessellation::corners;

impl<const D: usize, M: Composition<D>> Pcmm<D, M> {
    /// Return sums over particles and elements. Kinetic energy is that of the velocities at the end of the last step; internal energy is
    /// that of the elements and of the stores of particles ([`Audit`](crate::Audit)).
    pub fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        for p in &self.particles {
            let position: [f64; D] = std::array::from_fn(|d| p.position[d] - self.lead.way()[d]);
            sum.add_point(p.mass, &position, &p.velocity);
        }
        let mut state = vec![0.0; self.virgin.len()];
        for e in 0..self.elements.len() {
            self.elements.read(e, &mut state);
            sum.internal += self.elements.reference[e] * self.energy_of(&state);
            sum.viscous_heat += self.elements.reference[e] * self.material.viscous_heat_of(&state);
        }
        sum.internal += self.stored()[1];
        sum
    }
    /// Allocated memory, bytes, by own count.
    pub fn bytes(&self) -> usize {
        self.elements.bytes()
            + self.particles.len() * size_of::<Particle<D>>()
            + self.forces.capacity() * size_of::<[f64; D]>()
            + self.memory.capacity() * size_of::<f64>()
    }

    /// Coverage of the particles by elements.
    pub fn coverage(&self) -> Coverage {
        let mut sum = Coverage { stored: self.stored()[1], ..Coverage::default() };
        for (e, nodes) in self.elements.nodes.chunks_exact(D + 1).enumerate() {
            sum.mass += self.material.density() * self.elements.reference[e];
            sum.volume += volume(&corners(&self.particles, nodes), M::Embedding::HOOP);
        }
        sum
    }

    /// State variables of element `e`, named by [`Body::state_names`]; `None` if there is none.
    pub fn element_state(&self, e: usize) -> Option<Vec<f64>> {
        if e >= self.elements.len() {
            return None;
        }
        let mut numbers = vec![0.0; self.virgin.len()];
        self.elements.read(e, &mut numbers);
        Some(numbers)
    }

    /// Response of the law for element `e`: stress, volume ratio, wave speed, energy; `None` if there is none.
    pub fn describe_element(&self, e: usize) -> Option<Described<f64>> {
        self.material.describe_point(&self.element_state(e)?)
    }

    /// State variables at a particle: mean over its elements, weighted by mass, or its last mean. Named by [`Body::state_names`]; `None` if
    /// there is no such particle.
    pub fn particle_state(&self, n: usize) -> Option<Vec<f64>> {
        let mut state = vec![0.0; self.virgin.len()];
        (n < self.particles.len()).then(|| {
            self.mean_state(n, &mut state, &mut Vec::new());
            state
        })
    }
}

impl<const D: usize, M: Composition<D>> Body for Pcmm<D, M> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        self.material.name()
    }
    fn is_plane_stress(&self) -> bool {
        self.material.is_plane_stress()
    }
    fn len(&self) -> usize {
        self.particles.len()
    }
    fn softens_from(&self, rate: f64) -> Option<f64> {
        mpm_materials::softening::softens_from(&*self.material, rate)
    }
    fn state_names(&self) -> Vec<String> {
        self.material.state_names()
    }
    fn totals(&self) -> Totals {
        Pcmm::totals(self)
    }
    /// Area of the facets of exactly one element: the surface runs through the centres of the outermost particles.
    fn surface_area(&self) -> Option<f64> {
        let mut facets: Vec<[u32; D]> = Vec::new();
        for nodes in self.elements.nodes.chunks_exact(D + 1) {
            for left_out in 0..=D {
                let mut facet = std::array::from_fn(|k| nodes[k + usize::from(k >= left_out)]);
                facet.sort_unstable();
                facets.push(facet);
            }
        }
        facets.sort_unstable();
        let single = facets.chunk_by(|a, b| a == b).filter(|same| same.len() == 1);
        let place = |n: &u32| self.particles[*n as usize].position;
        Some(single.map(|facet| area(&facet[0].each_ref().map(place), M::Embedding::HOOP)).sum())
    }
    /// Visit the particles in their order, with the mean of the states of their elements.
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn bounds(&self, dimensions: usize, axisymmetric: bool) -> Option<[[f64; 3]; 2]> {
        // The outermost particles are on the surface: elements connect their centres.
        let mut held = Bounds::default();
        self.for_each_with(Parts::NONE, &mut |p| {
            held.hold(&PointView { width: Some(0.0), ..p.clone() }, dimensions, axisymmetric);
        });
        held.corners()
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let (mut point, mut scratch) = (PointView::default(), Vec::new());
        let density = self.material.density();
        point.state.resize(self.virgin.len(), 0.0);
        for (n, p) in self.particles.iter().enumerate() {
            point.number = n;
            (0..D).for_each(|d| point.position[d] = p.position[d] - self.lead.way()[d]);
            point.velocity[..D].copy_from_slice(&p.velocity);
            point.mass = p.mass;
            point.width = Some(2.0 * p.radius);
            if !parts.size && !parts.law {
                visit(&point);
                continue;
            }
            self.mean_state(n, &mut point.state, &mut scratch);
            let said = self.material.describe_point(&point.state);
            point.volume = p.mass / density * said.as_ref().map_or(1.0, |said| said.volume_ratio);
            point.stress = said.as_ref().map_or([f64::NAN; 6], |said| said.stress);
            point.in_range = said.as_ref().is_none_or(|said| said.in_range);
            point.failed = said.as_ref().is_some_and(|said| said.failed);
            visit(&point);
        }
    }
    fn bytes(&self) -> usize {
        Pcmm::bytes(self)
    }
}
