//! Velocity update of the nodes in the stages of the grid: momentum update, re-mapped velocity.

use mpm_materials::Lane;

use crate::grid::Node;
use impactite_scene::{Exchange, LocalDamping};
use impactite_simd::{Arch, Float, Kernel, Quad};

/// State of a node for reacting conditions: mass, kg, velocity at the start of the step, m/s, if known, and time step, s.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Trial {
    pub(in crate::step) mass: f64,
    pub(in crate::step) start: Option<[f64; 3]>,
    pub(in crate::step) dt: f64,
    /// True if only constraining reactions are requested, before forces act.
    pub(in crate::step) only_held: bool,
}

/// Boundary conditions at a node.
pub(in crate::step) trait Around {
    /// Apply prescribed velocities at a time. Returns true if any applies.
    fn constrain(&self, v: &mut [f64; 3], time: f64) -> bool;
    /// Apply prescribed velocities as [`Around::constrain`], and book them to the accounts of conditions; `mass`, kg, is that of the
    /// node, times the share that particles receive.
    fn constrain_booked(&self, v: &mut [f64; 3], time: f64, mass: f64, ledger: &mut Exchange) -> bool;
    /// Apply reacting conditions to a velocity, and record them in the ledger. Returns true if any reacts.
    fn react(&mut self, trial: &Trial, v: &mut [f64; 3], takes: f64, ledger: &mut Exchange) -> bool;
    /// Directions in which reacting conditions constrain the node in this step.
    fn held(&self) -> [bool; 3];
    /// Directions in which the forces of the node include its weight already.
    fn weighed(&self) -> [bool; 3];
    /// Place of the node in the grid.
    fn place(&self) -> usize;
}

/// No boundary conditions.
pub(in crate::step) struct Nothing;

impl Around for Nothing {
    fn constrain(&self, _: &mut [f64; 3], _: f64) -> bool {
        false
    }
    fn constrain_booked(&self, _: &mut [f64; 3], _: f64, _: f64, _: &mut Exchange) -> bool {
        false
    }
    fn react(&mut self, _: &Trial, _: &mut [f64; 3], _: f64, _: &mut Exchange) -> bool {
        false
    }
    fn held(&self) -> [bool; 3] {
        [false; 3]
    }
    fn weighed(&self) -> [bool; 3] {
        [false; 3]
    }
    fn place(&self) -> usize {
        0
    }
}

/// Nodal update of a grid stage.
pub(in crate::step) trait NodeUpdate<T>: Sync {
    /// True if the update finds the constrained nodes.
    const HOLDS: bool = false;

    /// Acceleration of all material that the update adds, m/s^2.
    fn weight(&self) -> Option<[f64; 3]> {
        None
    }

    /// Update the node, subject to the boundary conditions around it.
    fn update(&self, node: &mut Node<T>, around: &mut impl Around, ledger: &mut Exchange);

    /// Update nodes without boundary conditions; bitwise equal to `update`.
    fn update_free(&self, nodes: &mut [Node<T>], ledger: &mut Exchange) {
        one_by_one(self, nodes, ledger);
    }

    /// [`NodeUpdate::update_free`] of nodes from place `first` of the grid on.
    fn update_free_from(&self, first: usize, nodes: &mut [Node<T>], ledger: &mut Exchange) {
        let _ = first;
        self.update_free(nodes, ledger);
    }
}

fn one_by_one<T>(update: &(impl NodeUpdate<T> + ?Sized), nodes: &mut [Node<T>], ledger: &mut Exchange) {
    nodes.iter_mut().for_each(|node| update.update(node, &mut Nothing, ledger));
}

/// No update: only the sums.
pub(in crate::step) struct Leave;

impl<T> NodeUpdate<T> for Leave {
    #[inline(always)]
    fn update(&self, _: &mut Node<T>, _: &mut impl Around, _: &mut Exchange) {}
}

/// Velocities: momentum over mass, without boundary conditions.
pub(in crate::step) struct MeanVelocities<T, const D: usize> {
    pub(in crate::step) cutoff: T,
}

impl<T: Float, const D: usize> NodeUpdate<T> for MeanVelocities<T, D> {
    #[inline(always)]
    fn update(&self, node: &mut Node<T>, _: &mut impl Around, _: &mut Exchange) {
        let mass = node.first[0];
        let per_mass = if mass > self.cutoff { T::of(1.0) / mass } else { T::default() };
        (0..D).for_each(|d| node.first[d + 1] *= per_mass);
    }
}

pub(in crate::step) struct Velocities<T, const D: usize> {
    pub(in crate::step) cutoff: T,
    pub(in crate::step) time: f64,
    pub(in crate::step) takes: T,
    pub(in crate::step) dt: T,
}

impl<T: Float, const D: usize> NodeUpdate<T> for Velocities<T, D> {
    const HOLDS: bool = true;

    #[inline(always)]
    fn update(&self, node: &mut Node<T>, around: &mut impl Around, ledger: &mut Exchange) {
        let mass = node.first[0];
        if mass <= self.cutoff {
            drop_momentum::<T, D>(node, ledger, T::default());
            return;
        }
        let per_mass = T::of(1.0) / mass;
        let mut v = [0.0; 3];
        for d in 0..D {
            node.first[d + 1] *= per_mass;
            v[d] = node.first[d + 1].to_double();
        }
        let trial = Trial { mass: mass.to_double(), start: None, dt: self.dt.to_double(), only_held: true };
        if around.react(&trial, &mut v, self.takes.to_double(), ledger) {
            (0..D).for_each(|d| node.first[d + 1] = T::of(v[d]));
        }
        let free = v;
        if around.constrain_booked(&mut v, self.time, (self.takes * mass).to_double(), ledger) {
            for d in 0..D {
                let impulse = (self.takes * mass).to_double() * (v[d] - free[d]);
                ledger.impulse[d] += impulse;
                ledger.work += impulse * v[d];
                node.first[d + 1] = T::of(v[d]);
            }
        }
    }
}

pub(in crate::step) struct Integrate<T, const D: usize> {
    pub(in crate::step) cutoff: T,
    pub(in crate::step) dt: T,
    pub(in crate::step) end: f64,
    pub(in crate::step) gravity: Option<[f64; D]>,
    pub(in crate::step) from_velocity: bool,
    /// True if nodal forces are known separately from momentum.
    pub(in crate::step) forces: bool,
}

impl<T: Float, const D: usize> NodeUpdate<T> for Integrate<T, D> {
    const HOLDS: bool = true;

    fn weight(&self) -> Option<[f64; 3]> {
        self.gravity.map(|g| {
            let mut weight = [0.0; 3];
            weight[..D].copy_from_slice(&g);
            weight
        })
    }

    #[inline(always)]
    fn update(&self, node: &mut Node<T>, around: &mut impl Around, ledger: &mut Exchange) {
        let (mass, dt) = (node.first[0], self.dt);
        if mass <= self.cutoff {
            drop_momentum::<T, D>(node, ledger, dt);
            return;
        }
        let per_mass = T::of(1.0) / mass;
        let per_first = if self.from_velocity { T::of(1.0) } else { per_mass };
        let (mut old, mut new) = ([T::default(); 3], [T::default(); 3]);
        let mut given = [0.0; 3];
        let weighed = around.weighed();
        for d in 0..D {
            old[d] = node.first[d + 1] * per_first;
            let mut a = node.second[d + 1] * per_mass;
            if let Some(g) = self.gravity {
                if !weighed[d] {
                    a += T::of(g[d]);
                }
                given[d] = g[d];
            }
            new[d] = old[d] + a * dt;
            node.first[d + 1] = new[d];
            node.second[d + 1] = a;
        }
        let mut v = new.map(T::to_double);
        let start = self.forces.then(|| old.map(T::to_double));
        let trial = Trial { mass: mass.to_double(), start, dt: dt.to_double(), only_held: false };
        if around.react(&trial, &mut v, 1.0, ledger) {
            let per_dt = T::of(1.0) / dt;
            for d in 0..D {
                (new[d], node.first[d + 1]) = (T::of(v[d]), T::of(v[d]));
                node.second[d + 1] = (new[d] - old[d]) * per_dt;
            }
        }
        if around.constrain_booked(&mut v, self.end, mass.to_double(), ledger) {
            let per_dt = T::of(1.0) / dt;
            for d in 0..D {
                let impulse = mass.to_double() * (v[d] - new[d].to_double());
                ledger.impulse[d] += impulse;
                ledger.work += impulse * v[d];
                node.first[d + 1] = T::of(v[d]);
                node.second[d + 1] = (node.first[d + 1] - old[d]) * per_dt;
            }
        }
        if self.gravity.is_some() {
            // Body force work is its impulse times the mean velocity. If nodes store only the sum of momentum and impulse,
            // that sum replaces the start velocity: summed over the nodes, impulses of stresses cancel.
            for d in 0..D {
                let impulse = (mass * dt).to_double() * given[d];
                ledger.load[d] += impulse;
                ledger.work += impulse * 0.5 * (old[d].to_double() + v[d]);
            }
        }
    }

    fn update_free(&self, nodes: &mut [Node<T>], ledger: &mut Exchange) {
        let Integrate { cutoff, dt, gravity, from_velocity, .. } = *self;
        if gravity.is_none() && !from_velocity {
            T::dispatch(IntegrateFree::<T, D> { cutoff, dt, nodes, ledger });
        } else {
            one_by_one(self, nodes, ledger);
        }
    }
}

/// [`Integrate`] under nodal forces alone.
struct IntegrateFree<'a, T, const D: usize> {
    cutoff: T,
    dt: T,
    nodes: &'a mut [Node<T>],
    ledger: &'a mut Exchange,
}

impl<T: Float, const D: usize> Kernel<T> for IntegrateFree<'_, T, D> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let dt = A::Quad::splat(self.dt);
        for node in self.nodes {
            let mass = node.first[0];
            if mass <= self.cutoff {
                drop_momentum::<T, D>(node, self.ledger, self.dt);
                continue;
            }
            let per_mass = A::Quad::splat(T::of(1.0) / mass);
            let a = A::Quad::load(&node.second) * per_mass;
            let v = A::Quad::load(&node.first) * per_mass + a * dt;
            v.store(&mut node.first);
            a.store(&mut node.second);
            node.first[0] = mass;
        }
    }
}

/// Local damping of the nodes, after all forces and constraints: acts on the velocity changes of the step. Constrained
/// directions are not damped.
pub(in crate::step) struct Damp<T, const D: usize> {
    pub(in crate::step) cutoff: T,
    pub(in crate::step) dt: T,
    pub(in crate::step) end: f64,
    pub(in crate::step) gravity: [f64; D],
    pub(in crate::step) damping: LocalDamping,
}

impl<T: Float, const D: usize> NodeUpdate<T> for Damp<T, D> {
    #[inline(always)]
    fn update(&self, node: &mut Node<T>, around: &mut impl Around, ledger: &mut Exchange) {
        if node.first[0] <= self.cutoff {
            return;
        }
        let (mass, dt, held) = (node.first[0].to_double(), self.dt.to_double(), around.held());
        let (mut start, mut end, mut slowed) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for d in 0..D {
            end[d] = node.first[d + 1].to_double();
            start[d] = (node.first[d + 1] - node.second[d + 1] * self.dt).to_double();
            slowed[d] = if held[d] { end[d] } else { self.damping.slowed(start[d], end[d]) };
        }
        around.constrain(&mut slowed, self.end);
        for d in (0..D).filter(|&d| slowed[d] != end[d]) {
            node.first[d + 1] = T::of(slowed[d]);
            node.second[d + 1] += T::of((slowed[d] - end[d]) / dt);
            let impulse = mass * (slowed[d] - end[d]);
            ledger.load[d] += impulse;
            ledger.damping -= 0.5 * impulse * (start[d] + slowed[d]);
            // Body force work was recorded with the undamped velocities: add the difference.
            ledger.work += 0.5 * mass * dt * self.gravity[d] * (slowed[d] - end[d]);
        }
    }
}

pub(in crate::step) struct Remap<T, const D: usize> {
    pub(in crate::step) cutoff: T,
    pub(in crate::step) end: f64,
}

impl<T: Float, const D: usize> NodeUpdate<T> for Remap<T, D> {
    #[inline(always)]
    fn update(&self, node: &mut Node<T>, around: &mut impl Around, _ledger: &mut Exchange) {
        let mass = node.first[0];
        let per_mass = if mass > self.cutoff { T::of(1.0) / mass } else { T::default() };
        let mut v = [0.0; 3];
        for d in 0..D {
            node.second[d + 1] *= per_mass;
            v[d] = node.second[d + 1].to_double();
        }
        // Constrained directions keep the velocity of the constraint.
        let held = around.held();
        for d in (0..D).filter(|d| held[*d]) {
            node.second[d + 1] = node.first[d + 1];
            v[d] = node.second[d + 1].to_double();
        }
        if mass > self.cutoff && around.constrain(&mut v, self.end) {
            for d in 0..D {
                node.second[d + 1] = T::of(v[d]);
            }
        }
    }

    fn update_free(&self, nodes: &mut [Node<T>], _ledger: &mut Exchange) {
        T::dispatch(RemapFree { cutoff: self.cutoff, nodes });
    }
}

/// [`Remap`] without boundary conditions.
struct RemapFree<'a, T> {
    cutoff: T,
    nodes: &'a mut [Node<T>],
}

impl<T: Float> Kernel<T> for RemapFree<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        for node in self.nodes {
            let mass = node.first[0];
            let per_mass = if mass > self.cutoff { T::of(1.0) / mass } else { T::default() };
            (A::Quad::load(&node.second) * A::Quad::splat(per_mass)).store(&mut node.second);
        }
    }
}

/// Drop the momentum of a node that is too light to divide by, and record it.
fn drop_momentum<T: Float, const D: usize>(node: &mut Node<T>, ledger: &mut Exchange, dt: T) {
    for d in 0..D {
        ledger.dropped[d] += (node.first[d + 1] + dt * node.second[d + 1]).to_double();
        node.first[d + 1] = T::default();
        node.second[d + 1] = T::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::nodes::stages::mass_cutoff;

    /// Return nodes of all masses, from zero to some that are too light for a velocity.
    fn nodes<T: Float>() -> Vec<Node<T>> {
        let mixed = |n: u32, k: u32| n.wrapping_mul(k).wrapping_mul(2_654_435_761) >> 8;
        let record = |n: u32, k: u32| T::of(f64::from(mixed(n, k)) * 1e-5 - 60.0);
        let masses = [1.0, 3e-7, 1e-20, 1e-40, 0.0];
        let node = |n: u32| {
            let mass = T::of(masses[n as usize % masses.len()]);
            let (p, f) = (|d| record(n + 1, d), |d| record(n + 7, d));
            Node { first: [mass, p(1), p(2), p(3)], second: [T::default(), f(4), f(5), f(6)] }
        };
        (0..40).map(node).collect()
    }

    fn agree<T: Float, const D: usize>(update: &impl NodeUpdate<T>) {
        let mut plain = nodes::<T>();
        if D == 2 {
            plain.iter_mut().for_each(|n| (n.first[3], n.second[3]) = (T::default(), T::default()));
        }
        let mut fast = plain.clone();
        let [mut of_plain, mut of_fast] = [Exchange::default(); 2];
        plain.iter_mut().for_each(|n| update.update(n, &mut Nothing, &mut of_plain));
        update.update_free(&mut fast, &mut of_fast);
        for (n, (plain, fast)) in plain.iter().zip(&fast).enumerate() {
            assert_eq!((plain.first, plain.second), (fast.first, fast.second), "node {n}");
        }
        assert_eq!(of_plain.dropped, of_fast.dropped);
    }

    fn all<T: Float, const D: usize>() {
        let (cutoff, dt) = (mass_cutoff::<T>(), T::of(1e-3));
        for gravity in [None, Some([9.81; D])] {
            for from_velocity in [false, true] {
                let (end, forces) = (0.0, true);
                agree::<T, D>(&Integrate { cutoff, dt, end, gravity, from_velocity, forces });
            }
        }
        agree::<T, D>(&Remap::<T, D> { cutoff, end: 0.0 });
    }

    #[test]
    fn free_nodes_are_changed_like_constrained_ones() {
        all::<f64, 2>();
        all::<f64, 3>();
        all::<f32, 2>();
        all::<f32, 3>();
    }
}
