//! The contact algorithm of the grid: normals, detection, laws.

use mpm_core::parallel::Float;
use mpm_core::step::Contact as NodeAlgorithm;
use mpm_core::step::contact::{Found, Meeting, NodeContact, NodeImpulse, SharedNodes, Touch};
use mpm_core::step::survey::Survey;

use crate::couple::{Coupled, Coupling};
use crate::detect::ContactDetector;
use crate::law::Pairs;
use crate::normal::{Memory, Nodal, each};
use crate::solve::{Pair, solve, total};
use crate::vector::{difference, dot, length, sum, times};

/// Contact of any number of bodies through the nodes they share: a detector and the laws of the pairs.
///
/// ```
/// use mpm_contact::{Coulomb, GridContact, Pairs, SurfaceDistance};
/// use mpm_core::geometry::Lattice;
/// use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let method = Method::new(Linear, Flip, Musl, PlaneStrain);
/// let grid = BlockGrid::new(Lattice::new([0.0; 2], 0.01)?);
/// let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3)?));
/// let mpm = Mpm::<f64, 2, _, _, _>::with_contact(method, grid, contact);
/// # assert!(mpm.contacts().is_empty());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct GridContact<S, T> {
    detector: S,
    laws: Pairs<T>,
    strain: bool,
}

impl<S, T> GridContact<S, T> {
    /// A detector and laws.
    pub fn new(detector: S, laws: Pairs<T>) -> Self {
        GridContact { detector, laws, strain: false }
    }
    /// Also correct the velocities that the strain is taken from (before the stress update of USF, after the
    /// second mapping of MUSL), as the flow chart of \[Ma2010\] does. Impacts then gain energy, since the strain
    /// sees a motion that the particles do not make (docs/notes.md 7).
    #[must_use]
    pub fn with_strain_corrected(mut self) -> Self {
        self.strain = true;
        self
    }
    /// The laws.
    pub fn laws(&self) -> &Pairs<T> {
        &self.laws
    }
}

impl<S, T, const D: usize> NodeAlgorithm<T, D> for GridContact<S, T>
where
    T: Float,
    S: ContactDetector<T, D>,
{
    fn corrects_strain(&self) -> bool {
        self.strain
    }

    fn impulses(&self, at: &SharedNodes<'_, T, D>, found: &mut Found<T>) {
        let Found { impulses, contacts, touches, scratch, bits } = found;
        touches.clear();
        scratch.clear();
        let crowded = share(at, bits);
        if bits.iter().all(|&nodes| nodes == 0) {
            return;
        }
        let mut memory = Memory { numbers: scratch, shared: bits };
        crate::normal::NormalRule::prepare(self.detector.normals(), at, &mut memory);
        self.find(at, &memory, crowded, touches);
        touches.sort_unstable_by_key(|t| (t.node, t.fields));
        for touches in touches.chunk_by_mut(|a, b| a.node == b.node) {
            if !couples(at, touches) {
                self.exchange(at, touches);
                book(at, touches, |field, part| moved(at, touches, field, part), impulses, contacts);
            }
        }
    }

    fn couple(&self, at: &[SharedNodes<'_, T, D>], found: &mut [Found<T>]) {
        let mut couplings = Vec::new();
        for (block, (at, found)) in at.iter().zip(found.iter()).enumerate() {
            for touches in found.touches.chunk_by(|a, b| a.node == b.node).filter(|t| couples(at, t)) {
                couplings.extend(
                    touches.iter().map(|touch| Coupling::new(block, at, *touch, self.pair(at, touch))),
                );
            }
        }
        let solved = Coupled::solve(at, couplings);
        for (block, node, touches) in solved.nodes() {
            let Found { impulses, contacts, .. } = &mut found[block];
            let moved = |field, part| solved.moved(at, block, node, field, part);
            book(&at[block], &touches, moved, impulses, contacts);
        }
    }
}

/// Is a free rigid body among those at the node? Then all its nodes are solved together.
fn couples<T: Float, const D: usize>(at: &SharedNodes<'_, T, D>, touches: &[Touch<T>]) -> bool {
    let free = |field: usize| !at.is_prescribed(field) && at.rigid(field).is_some();
    at.has_rigid() && touches.iter().any(|t| t.fields.iter().any(|&f| free(f)))
}

/// Fill `bits` with each field's nodes that others have mass at, too. Returns the nodes of three and more.
fn share<T: Float, const D: usize>(at: &SharedNodes<'_, T, D>, bits: &mut Vec<u64>) -> u64 {
    bits.clear();
    let (mut one, mut two, mut three) = (0, 0, 0);
    for field in 0..at.fields() {
        let nodes = at.occupied(field);
        bits.push(nodes);
        three |= two & nodes;
        two |= one & nodes;
        one |= nodes;
    }
    bits.iter_mut().for_each(|nodes| *nodes &= two);
    three
}

impl<S, T: Float> GridContact<S, T> {
    fn find<const D: usize>(
        &self,
        at: &SharedNodes<'_, T, D>,
        memory: &Memory<'_, T>,
        crowded: u64,
        touches: &mut Vec<Touch<T>>,
    ) where
        S: ContactDetector<T, D>,
    {
        let zero = [T::of(0.0); 3];
        let mut normals: Nodal<[T; 3]> = [zero; 64];
        let mut gaps: Nodal<Option<T>> = [None; 64];
        for r in 0..at.fields() {
            for s in r + 1..at.fields() {
                let both = memory.shared[r] & memory.shared[s];
                if both == 0 || at.is_prescribed(r) && at.is_prescribed(s) {
                    continue;
                }
                let rule = self.detector.normals();
                let mut nodes =
                    crate::normal::NormalRule::normals(rule, at, [r, s], both, memory, &mut normals);
                if !self.laws.law(at.body(r), at.body(s)).pulls() {
                    let approach = |n: usize| {
                        let relative = difference(at.velocity(r, n), at.velocity(s, n));
                        dot(relative, normals[n]) > T::of(0.0)
                    };
                    nodes = each(nodes)
                        .filter(|&n| crowded & (1 << n) != 0 || approach(n))
                        .fold(0, |bits, n| bits | 1 << n);
                }
                if nodes == 0 {
                    continue;
                }
                nodes = self.detector.touching(at, [r, s], nodes, &normals, &mut gaps);
                let touch = |node: usize| Touch {
                    node,
                    fields: [r, s],
                    normal: normals[node],
                    gap: gaps[node],
                    impulse: zero,
                    next: zero,
                    ahead: zero,
                };
                touches.extend(each(nodes).map(touch));
            }
        }
    }

    /// The impulses of the pairs at one node.
    fn exchange<const D: usize>(&self, at: &SharedNodes<'_, T, D>, touches: &mut [Touch<T>]) {
        solve(touches, |touch| self.pair(at, touch), at.dt());
    }

    fn pair<const D: usize>(&self, at: &SharedNodes<'_, T, D>, touch: &Touch<T>) -> Pair<'_, T> {
        let [r, s] = touch.fields;
        let law = self.laws.law(at.body(r), at.body(s));
        let node = touch.node;
        Pair {
            law,
            masses: [at.mass(r, node), at.mass(s, node)],
            velocities: trial(at, touch, law.pulls()),
            area: if law.needs_area() { area(at, touch) } else { T::of(0.0) },
        }
    }
}

/// The velocities that the law sees: the trial ones, less what keeps contact from doing work.
///
/// An impulse J does the work J . (w + w') / 2 on the nodes, with w and w' the velocities of the second body relative to
/// the first at the start and at the end of the step. Where the bodies part already (w . n > 0, as after the map
/// of particles that did not follow the nodes), J would drive them on. There they may end the step with the opposite
/// of w . n at most, and J does none along the normal.
fn trial<T: Float, const D: usize>(at: &SharedNodes<'_, T, D>, touch: &Touch<T>, pulls: bool) -> [[T; 3]; 2] {
    let ([r, s], node) = (touch.fields, touch.node);
    let mut velocities = [at.velocity(r, node), at.velocity(s, node)];
    if !pulls && at.meeting() == Meeting::Trial {
        let parting = dot(difference(at.old_velocity(s, node), at.old_velocity(r, node)), touch.normal);
        velocities[0] = difference(velocities[0], times(touch.normal, parting.max(T::of(0.0))));
    }
    velocities
}

/// Area of contact that a node stands for, m^2: the smaller of |sum_p V_p grad N_ip| of both.
fn area<T: Float, const D: usize>(at: &SharedNodes<'_, T, D>, touch: &Touch<T>) -> T {
    let of = |field: usize| {
        let mut out: Nodal<[T; 3]> = [[T::of(0.0); 3]; 64];
        at.survey(field, Survey::VolumeGradient, 1 << touch.node, &[], &mut out);
        length(out[touch.node])
    };
    of(touch.fields[0]).min(of(touch.fields[1]))
}

/// Velocity of a field at a node once it has this part of its impulses.
fn moved<T: Float, const D: usize>(
    at: &SharedNodes<'_, T, D>,
    touches: &[Touch<T>],
    field: usize,
    part: f64,
) -> [T; 3] {
    let node = touches[0].node;
    let share = T::of(part) / at.mass(field, node);
    sum(at.velocity(field, node), times(total(touches, field), share))
}

/// Note the impulses of one node by field, and what they did by pair. `moved` knows the velocity of a field once it
/// has a part of its impulses.
fn book<T: Float, const D: usize>(
    at: &SharedNodes<'_, T, D>,
    touches: &[Touch<T>],
    moved: impl Fn(usize, f64) -> [T; 3],
    impulses: &mut Vec<NodeImpulse<T>>,
    contacts: &mut Vec<NodeContact>,
) {
    let zero = T::of(0.0);
    let node = touches[0].node;
    for field in 0..at.fields() {
        let impulse = total(touches, field);
        if impulse.iter().any(|&x| x != zero) {
            impulses.push(NodeImpulse { field, node, impulse });
        }
    }
    if at.meeting() != Meeting::Trial || at.is_image(node) {
        return;
    }
    // With the mean of the velocities before and after, impulse times velocity is the change of kinetic energy.
    for touch in touches.iter().filter(|t| t.impulse.iter().any(|&x| x != zero)) {
        let [r, s] = touch.fields;
        let mean = difference(moved(r, 0.5), moved(s, 0.5));
        let slip = difference(moved(r, 1.0), moved(s, 1.0));
        let along = dot(touch.impulse, touch.normal);
        // What slips at the end of the step; stopping a slip takes energy as stopping an approach does.
        let friction = dot(touch.impulse, slip) - along * dot(slip, touch.normal);
        contacts.push(NodeContact {
            bodies: [at.body(r), at.body(s)],
            node,
            normal: touch.normal.map(T::to_double),
            gap: touch.gap.map(T::to_double),
            impulse: touch.impulse.map(T::to_double),
            friction: friction.to_double(),
            taken: (dot(touch.impulse, mean) - friction).to_double(),
        });
    }
}
