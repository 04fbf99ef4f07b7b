//! Revision of the elements by deletion, search and creation: the second half of the flow chart of \[Feng2014\].

use impactite_scene::{Embedding, SceneError, StepError, Stopped};

use crate::elements::Elements;
use crate::inheritance::{Inheritance, Newborn, Parent};
use crate::method::Composition;
use crate::simplex::{overlap, volume};
use crate::solver::Pcmm;
use crate::tessellation::{Revision, Tessellation, View, corners};

impl<const D: usize, M: Composition<D>> Pcmm<D, M> {
    /// Search, delete, create, inherit, and book additions and removals. Steps do this by themselves every [`Pcmm::set_revision_interval`]
    /// steps.
    ///
    /// # Errors
    /// Particles that the neighbour search cannot use.
    pub fn revise(&mut self) -> Result<(), StepError> {
        self.neighbours.update(&self.particles, &self.team);
        if let Some(refused) = self.neighbours.refused() {
            let refused = SceneError::Search(refused.clone());
            return Err(self.clock.stopped(Stopped::Scene(refused)));
        }
        let view = View {
            particles: &self.particles,
            neighbours: &self.neighbours,
            nodes: &self.elements.nodes,
            incidence: &self.elements.incidence,
            team: &self.team,
            open: &self.elements.open,
        };
        let revision = self.method.tessellation().revise(&view);
        if !revision.is_empty() {
            self.remember(&revision);
            self.apply(&revision);
            self.make_room();
            self.forces_of_states();
        }
        Ok(())
    }

    fn nodes_of(&self, e: usize) -> &[u32] {
        &self.elements.nodes[e * (D + 1)..(e + 1) * (D + 1)]
    }

    fn element_volume(&self, nodes: &[u32]) -> f64 {
        volume(&corners(&self.particles, nodes), M::Embedding::HOOP)
    }

    /// Return the internal energy per reference volume of a state, J/m^3.
    pub(crate) fn energy_of(&self, state: &[f64]) -> f64 {
        self.material.describe_point(state).map_or(0.0, |said| said.energy)
    }

    /// Average the states of elements to the particles of deleted and new elements, weighted by mass.
    fn remember(&mut self, revision: &Revision) {
        let dead = revision.dead.iter().flat_map(|&e| self.nodes_of(e as usize));
        let mut touched: Vec<u32> = dead.chain(&revision.born).copied().collect();
        touched.sort_unstable();
        touched.dedup();
        for n in touched {
            self.remember_at(n as usize);
        }
    }

    /// Store the mean state of the elements at particle `n`.
    fn remember_at(&mut self, n: usize) {
        let mut mean = vec![0.0; self.virgin.len()];
        self.mean_state(n, &mut mean, &mut Vec::new());
        self.memory[n * mean.len()..(n + 1) * mean.len()].copy_from_slice(&mean);
    }

    /// Compute the mean state of the elements at particle `n`, or load its last mean if it has none; `scratch` is memory.
    pub(crate) fn mean_state(&self, n: usize, mean: &mut [f64], scratch: &mut Vec<f64>) {
        let numbers = self.virgin.len();
        scratch.resize(numbers, 0.0);
        mean.fill(0.0);
        let mut weight = 0.0;
        for &at in self.elements.incidence.of(n) {
            let e = at as usize / (D + 1);
            self.elements.read(e, scratch);
            weight += self.elements.reference[e];
            for k in 0..numbers {
                mean[k] += self.elements.reference[e] * scratch[k];
            }
        }
        if weight > 0.0 {
            mean.iter_mut().for_each(|x| *x /= weight);
        } else {
            mean.copy_from_slice(&self.memory[n * numbers..(n + 1) * numbers]);
        }
    }

    /// Assemble the new set of elements: survivors in their order, then the new ones.
    fn apply(&mut self, revision: &Revision) {
        let numbers = self.virgin.len();
        let mut states: Vec<f64> = Vec::new();
        let mut nodes: Vec<u32> = Vec::new();
        let mut reference: Vec<f64> = Vec::new();
        let mut state = vec![0.0; numbers];
        let mut dead = revision.dead.iter().copied().peekable();
        let mut is_dead = vec![false; self.elements.len()];
        let mut left: Vec<Estate> = Vec::with_capacity(revision.dead.len());
        for e in 0..self.elements.len() {
            self.elements.read(e, &mut state);
            if dead.next_if_eq(&(e as u32)).is_some() {
                is_dead[e] = true;
                self.audit.removed.elements += 1;
                self.audit.removed.volume += self.element_volume(self.nodes_of(e));
                self.audit.removed.mass += self.material.density() * self.elements.reference[e];
                let estate =
                    Estate { reference: self.elements.reference[e], density: self.energy_of(&state) };
                self.audit.removed.energy += estate.reference * estate.density;
                left.push(estate);
                continue;
            }
            nodes.extend_from_slice(self.nodes_of(e));
            reference.push(self.elements.reference[e]);
            states.extend_from_slice(&state);
        }
        let mut wants: Vec<[f64; 2]> = Vec::with_capacity(revision.born.len() / (D + 1));
        for newborn in revision.born.chunks_exact(D + 1) {
            let volume = self.element_volume(newborn);
            let Heir { reference: own, parents } = self.inherit(newborn, volume, &is_dead, &mut state);
            let energy = own * self.energy_of(&state);
            let mut want = [own, energy];
            for (e, taken) in parents {
                if let Ok(k) = revision.dead.binary_search(&(e as u32)) {
                    left[k].reference -= taken;
                    want[0] -= taken;
                    want[1] -= taken * left[k].density;
                }
            }
            wants.push(want);
            self.audit.created.elements += 1;
            self.audit.created.volume += volume;
            self.audit.created.mass += self.material.density() * own;
            self.audit.created.energy += energy;
            nodes.extend_from_slice(newborn);
            reference.push(own);
            states.extend_from_slice(&state);
        }
        self.settle(revision, &left, &wants);
        for k in 0..self.audit.flaws.len() {
            self.audit.flaws[k] += revision.flaws[k] as u64;
        }
        self.audit.revisions += 1;
        self.elements = Elements::assemble(nodes, reference, &states, &self.virgin, self.particles.len());
    }

    /// Transfer the part of deleted elements that is not inherited to the stores of their particles. The excess of new elements over their
    /// inheritance is taken from the stores of their particles, as far as these suffice.
    fn settle(&mut self, revision: &Revision, left: &[Estate], wants: &[[f64; 2]]) {
        self.stores.resize(self.particles.len(), [0.0; 2]);
        let part = 1.0 / (D + 1) as f64;
        let before = self.stored();
        for (&e, estate) in revision.dead.iter().zip(left) {
            for &n in &self.elements.nodes[e as usize * (D + 1)..(e as usize + 1) * (D + 1)] {
                self.stores[n as usize][0] += part * estate.reference;
                self.stores[n as usize][1] += part * estate.reference * estate.density;
            }
        }
        for (newborn, want) in revision.born.chunks_exact(D + 1).zip(wants) {
            for k in 0..2 {
                let held: f64 = newborn.iter().map(|&n| self.stores[n as usize][k]).sum();
                for &n in newborn {
                    let store = &mut self.stores[n as usize][k];
                    if want[k] < 0.0 {
                        *store -= part * want[k];
                    } else if held > 0.0 {
                        *store *= (1.0 - want[k] / held).max(0.0);
                    }
                }
            }
        }
        let after = self.stored();
        self.audit.stored_mass += self.material.density() * (after[0] - before[0]);
        self.audit.stored_energy += after[1] - before[1];
    }

    /// Return the reference volume and internal energy stored at particles, outside elements.
    pub(crate) fn stored(&self) -> [f64; 2] {
        self.stores.iter().fold([0.0; 2], |sum, s| [sum[0] + s[0], sum[1] + s[1]])
    }

    /// Set the state of a new element; return its reference volume, and the part from each parent.
    fn inherit(&self, newborn: &[u32], volume: f64, is_dead: &[bool], state: &mut [f64]) -> Heir {
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
        let ratio = self.material.describe_point(state).map_or(1.0, |said| said.volume_ratio);
        // Parents contribute in proportion to their part in the new element.
        let lay = |k: usize| shares[k].0 / shares[k].1 * self.elements.reference[near[k]];
        let gave = |k: &usize| shares[*k].0 > 0.0 && shares[*k].1 > 0.0;
        let all: f64 = (0..near.len()).filter(gave).map(lay).sum();
        let share = if all > 0.0 { taken.reference / all } else { 0.0 };
        let parents = (0..near.len()).filter(gave).map(|k| (near[k], share * lay(k))).collect();
        Heir { reference: taken.reference + (1.0 - taken.part) * volume / ratio, parents }
    }
}

/// Part of a deleted element that is not inherited yet.
struct Estate {
    /// Reference volume.
    reference: f64,
    /// Internal energy per reference volume, J/m^3.
    density: f64,
}

/// Reference volume of a new element, and its parents.
struct Heir {
    reference: f64,
    /// Deleted elements, and the reference volume inherited from each.
    parents: Vec<(usize, f64)>,
}
