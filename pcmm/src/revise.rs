//! Deletion, search, creation: the second half of the flow chart of \[Feng2014\].

use mpm_core::Embedding;
use mpm_materials::Constitutive;
use mpm_materials::point::unflatten;

use crate::elements::Elements;
use crate::inheritance::{Inheritance, Newborn, Parent};
use crate::method::Composition;
use crate::simplex::{overlap, volume};
use crate::solver::Pcmm;
use crate::tessellation::{Revision, Tessellation, View, corners};

impl<const D: usize, C, M> Pcmm<D, C, M>
where
    C: Constitutive<f64>,
    M: Composition<D>,
{
    /// Search, delete, create, inherit, and book what was added and removed.
    pub(crate) fn revise(&mut self) {
        self.neighbours.update(&self.particles, &self.team);
        let view = View {
            particles: &self.particles,
            neighbours: &self.neighbours,
            nodes: &self.elements.nodes,
            incidence: &self.elements.incidence,
            team: &self.team,
        };
        let revision = self.method.tessellation().revise(&view);
        if !revision.is_empty() {
            self.remember(&revision);
            self.apply(&revision);
            self.make_room();
            self.forces_of_states();
        }
    }

    fn nodes_of(&self, e: usize) -> &[u32] {
        &self.elements.nodes[e * (D + 1)..(e + 1) * (D + 1)]
    }

    fn element_volume(&self, nodes: &[u32]) -> f64 {
        volume(&corners(&self.particles, nodes), M::Embedding::HOOP)
    }

    /// Internal energy per reference volume of a state.
    pub(crate) fn energy_of(&self, state: &[f64]) -> f64 {
        unflatten::<f64, C::State<f64>>(state).map_or(0.0, |s| self.law.energy(&s))
    }

    /// Average the states of elements to the particles of the dead and the newborn, weighted by mass.
    fn remember(&mut self, revision: &Revision) {
        let dead = revision.dead.iter().flat_map(|&e| self.nodes_of(e as usize));
        let mut touched: Vec<u32> = dead.chain(&revision.born).copied().collect();
        touched.sort_unstable();
        touched.dedup();
        for n in touched {
            self.remember_at(n as usize);
        }
    }

    /// The mean of the states of the elements at particle `n`; without elements it keeps the last one.
    pub(crate) fn remember_at(&mut self, n: usize) {
        let numbers = self.virgin.len();
        let (mut sum, mut state) = (vec![0.0; numbers], vec![0.0; numbers]);
        let mut weight = 0.0;
        for &at in self.elements.incidence.of(n) {
            let e = at as usize / (D + 1);
            self.elements.read(e, &mut state);
            weight += self.elements.reference[e];
            for k in 0..numbers {
                sum[k] += self.elements.reference[e] * state[k];
            }
        }
        if weight > 0.0 {
            for k in 0..numbers {
                self.memory[n * numbers + k] = sum[k] / weight;
            }
        }
    }

    /// Make the new set of elements: survivors in their order, then the newborn.
    fn apply(&mut self, revision: &Revision) {
        let numbers = self.virgin.len();
        let mut states: Vec<f64> = Vec::new();
        let mut nodes: Vec<u32> = Vec::new();
        let mut reference: Vec<f64> = Vec::new();
        let mut state = vec![0.0; numbers];
        let mut dead = revision.dead.iter().copied().peekable();
        let mut is_dead = vec![false; self.elements.len()];
        for e in 0..self.elements.len() {
            self.elements.read(e, &mut state);
            if dead.next_if_eq(&(e as u32)).is_some() {
                is_dead[e] = true;
                self.audit.removed.elements += 1;
                self.audit.removed.volume += self.element_volume(self.nodes_of(e));
                self.audit.removed.mass += self.law.density() * self.elements.reference[e];
                self.audit.removed.energy += self.elements.reference[e] * self.energy_of(&state);
                continue;
            }
            nodes.extend_from_slice(self.nodes_of(e));
            reference.push(self.elements.reference[e]);
            states.extend_from_slice(&state);
        }
        for newborn in revision.born.chunks_exact(D + 1) {
            let volume = self.element_volume(newborn);
            let own = self.inherit(newborn, volume, &is_dead, &mut state);
            self.audit.created.elements += 1;
            self.audit.created.volume += volume;
            self.audit.created.mass += self.law.density() * own;
            self.audit.created.energy += own * self.energy_of(&state);
            nodes.extend_from_slice(newborn);
            reference.push(own);
            states.extend_from_slice(&state);
        }
        for k in 0..self.audit.flaws.len() {
            self.audit.flaws[k] += revision.flaws[k] as u64;
        }
        self.audit.revisions += 1;
        self.elements = Elements::assemble(nodes, reference, &states, &self.virgin, self.particles.len());
    }

    /// The state of a newborn, and its reference volume.
    fn inherit(&self, newborn: &[u32], volume: f64, is_dead: &[bool], state: &mut [f64]) -> f64 {
        let numbers = self.virgin.len();
        let hoop = M::Embedding::HOOP;
        let x = corners(&self.particles, newborn);
        let at = |&n: &u32| self.elements.incidence.of(n as usize).iter().map(|&c| c as usize / (D + 1));
        let mut near: Vec<usize> = newborn.iter().flat_map(at).filter(|&e| is_dead[e]).collect();
        near.sort_unstable();
        near.dedup();
        let mut shares = Vec::with_capacity(near.len());
        let mut old = vec![0.0; near.len() * numbers];
        for (k, &e) in near.iter().enumerate() {
            let y = corners(&self.particles, self.nodes_of(e));
            shares.push((overlap(&x, &y, hoop), crate::simplex::volume(&y, hoop)));
            self.elements.read(e, &mut old[k * numbers..(k + 1) * numbers]);
        }
        let parents: Vec<Parent<'_>> = near
            .iter()
            .zip(&shares)
            .enumerate()
            .filter(|(_, (_, (shared, whole)))| *shared > 0.0 && *whole > 0.0)
            .map(|(k, (&e, &(shared, whole)))| Parent {
                shared,
                volume: whole,
                reference: self.elements.reference[e],
                state: &old[k * numbers..(k + 1) * numbers],
            })
            .collect();
        let of_particle = |&n: &u32| &self.memory[n as usize * numbers..(n as usize + 1) * numbers];
        let particles: Vec<&[f64]> = newborn.iter().map(of_particle).collect();
        let taken =
            M::Inheritance::inherit(&Newborn { volume, parents: &parents, particles: &particles }, state);
        let ratio = unflatten::<f64, C::State<f64>>(state).map_or(1.0, |s| self.law.volume_ratio(&s));
        taken.reference + (1.0 - taken.part) * volume / ratio
    }
}
