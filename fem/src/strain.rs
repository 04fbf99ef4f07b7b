//! Element update in a step: strains, stresses, internal forces, and removal.

use std::sync::Mutex;

use impactite_scene::{Cause, Clock, PointKind, StepError, Stopped};
use impactite_simd::Team;

use crate::body::ElementBody;
use crate::set::wide;
use crate::surface::surface_of;
use crate::sweep::{BATCH, Batch, Left, Moving, Of, Pass, Reason, Scratch, Trouble};

/// Message for an inverted element: cause and remedy.
const INVERTED: &str = "it is turned inside out (det J <= 0 at an integration point): the mesh cannot follow the deformation; let such \
                        elements leave (`MeshBody::eroding(Erosion::volume(..))`), make the body of particles (the material point \
                        method), or take a finer mesh or a smaller step";
/// Ratio of the first to the present stable time step above which a run stops.
const SHORTER: f64 = 1e4;
/// Message for such an element: cause and remedy.
const FLAT: &str = "it is so flat that the stable step is ten thousand times shorter than at the start: the mesh cannot follow the \
                    deformation; let such elements leave (`MeshBody::eroding(Erosion::step(..))`), make the body of particles (the \
                    material point method), or take a finer mesh";

impl<const D: usize> ElementBody<D> {
    /// Update strains, stresses and internal forces over a step of `dt` seconds that ends at the present node positions.
    pub(crate) fn strain(
        &mut self,
        dt: f64,
        clock: &Clock,
        team: &Team,
        memory: &[Mutex<Scratch>],
    ) -> Result<(), StepError> {
        self.flow.clear();
        if self.pace.ratio == 1 && !self.carried.is_empty() {
            let flow =
                self.carried.iter().zip(&self.nodes).map(|(carried, node)| carried.unwrap_or(node.velocity));
            self.flow.extend(flow);
        }
        if self.pace.ratio > 1 {
            let mean = |(node, from): (&crate::Node<D>, &[f64; D])| -> [f64; D] {
                std::array::from_fn(|d| (node.position[d] - from[d]) / dt)
            };
            let flow: Vec<_> = self.nodes.iter().zip(&self.from).map(mean).collect();
            self.flow = flow;
        }
        for s in 0..self.sets.len() {
            let averaged = self.sets[s].sweep.averaged();
            if averaged {
                self.sweep(s, Pass::Stretch, dt, team, memory);
                self.average(s, team);
            }
            self.sweep(s, Pass::Stress, dt, team, memory);
            self.sound(s, clock)?;
            if averaged {
                self.average(s, team);
                self.sweep(s, Pass::Force, dt, team, memory);
                self.sound(s, clock)?;
            }
        }
        self.take_rates();
        self.bury();
        self.leads_on(clock)
    }

    /// Compute the internal forces of the present states.
    pub(crate) fn forces_of_states(&mut self, team: &Team, memory: &[Mutex<Scratch>]) {
        self.flow.clear();
        for s in 0..self.sets.len() {
            if self.sets[s].sweep.averaged() {
                self.mean_stresses(s);
                self.average(s, team);
            }
            self.sweep(s, Pass::Force, 0.0, team, memory);
        }
        self.take_rates();
        self.first_rate = self.rate;
        self.bury();
    }

    /// Scatter Kirchhoff mean stresses of the present states, and reference volumes, to the slots.
    fn mean_stresses(&mut self, s: usize) {
        let set = &self.sets[s];
        let (mut state, n) = (vec![0.0; self.virgin.len()], set.sweep.nodes());
        self.slots[set.slots()].fill([0.0; 4]);
        for (batch, first) in set.batches.iter().zip(&set.starts) {
            for e in (0..batch.elements).filter(|&e| batch.alive(e, 1)) {
                batch.read(e, (0, 1), &mut state);
                let Some(said) = self.material.describe_point(&state) else { continue };
                let mean = said.stress[..3].iter().sum::<f64>() / 3.0 * said.volume_ratio;
                let volume = set.volume(batch, e);
                for c in 0..n {
                    let corner = batch.corners[(e / 8 * n + c) * 8 + e % 8];
                    let slot = &mut self.slots[set.first + *first as usize + corner as usize];
                    slot[0] += mean * volume;
                    slot[1] += volume;
                }
            }
        }
    }

    /// Run one pass over the elements of a set.
    fn sweep(&mut self, s: usize, pass: Pass, dt: f64, team: &Team, memory: &[Mutex<Scratch>]) {
        let ElementBody {
            sets,
            slots,
            nodes,
            averages,
            flow,
            material,
            probe,
            virgin,
            erosion,
            converting,
            ..
        } = self;
        let set = &mut sets[s];
        let range = set.slots();
        let (sweep, points) = (&*set.sweep, set.sweep.points());
        let (numbers, control, least) = (virgin.len(), set.control, erosion.least);
        let of = Of { material: &**material, numbers, probe, control, least, dt };
        let (numbers_of, converting) = (&set.numbers, converting.as_deref());
        team.each_part(&mut slots[range], &set.starts, &mut set.batches, |b, slots, batch| {
            let leaving = |batch: &Batch, scratch: &Scratch| -> Vec<(usize, Reason)> {
                let gone = erosion.gone(&**material, points, batch, scratch);
                let mut list: Vec<_> = gone.into_iter().map(|e| (e, Reason::Erosion)).collect();
                if let Some(converting) = converting {
                    let own = &numbers_of[b * BATCH..];
                    let mut new = converting.leaving(&**material, points, (batch, scratch), own);
                    new.retain(|(e, _)| list.iter().all(|(gone, _)| gone != e));
                    list.append(&mut new);
                }
                list
            };
            let scratch = &mut *team.own(memory);
            for (Moving(to), &n) in scratch.moving.iter_mut().zip(&batch.nodes) {
                let node = &nodes[n as usize];
                for d in 0..D {
                    (to[d], to[4 + d]) = (node.position[d], node.velocity[d]);
                }
            }
            if !flow.is_empty() {
                for (Moving(to), &n) in scratch.moving.iter_mut().zip(&batch.nodes) {
                    to[4..4 + D].copy_from_slice(&flow[n as usize]);
                }
            }
            if sweep.averaged() {
                for (Moving(to), &n) in scratch.moving.iter_mut().zip(&batch.nodes) {
                    to[3] = averages.get(n as usize).copied().unwrap_or(0.0);
                }
            }
            sweep.sweep(pass, &of, batch, scratch, slots, &leaving);
        });
    }

    /// Average element values at each node over a set, weighted by mass; zero without elements.
    fn average(&mut self, s: usize, team: &Team) {
        let (range, mut averages) = (self.sets[s].slots(), std::mem::take(&mut self.averages));
        averages.resize(self.nodes.len(), 0.0);
        let (incidence, slots) = (&self.incidence, &self.slots);
        team.each(&mut averages, |n, mean| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for &slot in incidence.slots_of(n) {
                if range.contains(&(slot as usize)) {
                    let slot = &slots[slot as usize];
                    sum += slot[0];
                    weight += slot[1];
                }
            }
            *mean = if weight > 0.0 { sum / weight } else { 0.0 };
        });
        self.averages = averages;
    }

    fn take_rates(&mut self) {
        let rates = self.sets.iter().flat_map(|s| s.batches.iter().map(|b| b.report.rate));
        self.rate = rates.fold(0.0, f64::max);
    }

    /// Check for failed elements; the error names the first one.
    fn sound(&self, s: usize, clock: &Clock) -> Result<(), StepError> {
        let set = &self.sets[s];
        for (b, batch) in set.batches.iter().enumerate() {
            let Some((e, trouble)) = batch.report.trouble else { continue };
            let cause = match trouble {
                Trouble::Inverted => Cause::Other(INVERTED),
                Trouble::Law(cause) => Cause::Law(cause),
            };
            return Err(clock.stopped(self.stopped(s, b, e, cause)));
        }
        Ok(())
    }

    /// Check that the stable time step has not collapsed; the error names the flattest element of the batch that limits it.
    fn leads_on(&self, clock: &Clock) -> Result<(), StepError> {
        if self.first_rate == 0.0 || self.rate <= SHORTER * self.first_rate {
            return Ok(());
        }
        for (s, set) in self.sets.iter().enumerate() {
            let Some(b) = set.batches.iter().position(|b| b.report.rate == self.rate) else { continue };
            let batch = &set.batches[b];
            let width = |e: usize| {
                let nodes: Vec<u32> = set.nodes_of(batch, e).collect();
                let apart = |a: u32, b: u32| -> f64 {
                    let [a, b] = [a, b].map(|n| self.nodes[n as usize].position);
                    (0..D).map(|d| (a[d] - b[d]).powi(2)).sum()
                };
                let pairs =
                    nodes.iter().enumerate().flat_map(|(i, &a)| nodes[i + 1..].iter().map(move |&b| (a, b)));
                pairs.map(|(a, b)| apart(a, b)).fold(f64::INFINITY, f64::min)
            };
            let alive = (0..batch.elements).filter(|&e| batch.alive(e, set.sweep.points()));
            if let Some(e) = alive.min_by(|&a, &b| width(a).total_cmp(&width(b))) {
                return Err(clock.stopped(self.stopped(s, b, e, Cause::Other(FLAT))));
            }
        }
        Ok(())
    }

    /// Error for an element of a batch of a set.
    fn stopped(&self, s: usize, b: usize, e: usize, cause: Cause) -> Stopped {
        let set = &self.sets[s];
        Stopped::Point {
            kind: PointKind::Element,
            body: self.name.clone(),
            number: set.numbers[b * BATCH + e] as usize,
            position: self.centre(set, &set.batches[b], e),
            law: self.material.name(),
            cause,
        }
    }

    /// Process removed elements. The energy of eroded elements is booked as conversion, and their mass stays on the nodes; converted
    /// elements take both with them.
    fn bury(&mut self) {
        if self.sets.iter().all(|s| s.batches.iter().all(|b| b.report.left.is_empty())) {
            return;
        }
        let mut numbers = Vec::new();
        for s in 0..self.sets.len() {
            for b in 0..self.sets[s].batches.len() {
                for left in std::mem::take(&mut self.sets[s].batches[b].report.left) {
                    numbers.push(self.sets[s].numbers[b * BATCH + left.element]);
                    match left.reason {
                        Reason::Erosion => self.erode(s, b, left),
                        Reason::Conversion(criterion) => self.convert(s, b, left, criterion),
                    }
                }
            }
        }
        if let Some(converting) = &mut self.converting {
            converting.see_marks();
        }
        self.uncover(&numbers);
        self.revision += 1;
    }

    fn erode(&mut self, s: usize, b: usize, left: Left) {
        self.debris.resize(self.nodes.len(), 0.0);
        let set = &self.sets[s];
        let nodes: Vec<u32> = set.nodes_of(&set.batches[b], left.element).collect();
        let corners: Vec<_> = nodes.iter().map(|&n| wide(&self.mesh.nodes[n as usize])).collect();
        for (&n, share) in nodes.iter().zip(set.sweep.measure(&corners).shares) {
            self.debris[n as usize] += share * self.probe.density;
            self.eroded.mass += share * self.probe.density;
            if let Some(converting) = &mut self.converting {
                converting.elements_at[n as usize] -= 1;
            }
        }
        self.eroded.elements += 1;
        self.eroded.energy += left.energy;
        self.eroded.hourglass += left.hourglass;
        self.exchange.conversion -= left.energy;
    }

    /// Find the surface of the remaining elements.
    pub(crate) fn find_surface(&mut self) {
        let mut there = vec![false; self.elements];
        for (_, _, number) in self.sets.iter().flat_map(|s| s.alive()) {
            there[number as usize] = true;
        }
        self.surface = surface_of(&self.mesh, &|number| there[number as usize]);
        let ElementBody { loads, surface, .. } = self;
        loads.iter_mut().for_each(|load| load.keep(surface));
    }
}
