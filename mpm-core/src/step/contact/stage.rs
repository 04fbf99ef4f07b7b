//! Contact stage.
//!
//! The step calls [`GridStages::apply_contact`] where \[Ma2010\] 1.4 adjusts momenta and forces (iv, vii, x). The stage has
//! two parts. First the scene's [`ContactAlgorithm`] computes the impulses at the nodes of every shared block separately;
//! nodes are only read. Then every field block adds its own impulses to its nodes. No task writes data that another reads,
//! and all sums have a fixed order, so that results do not depend on threads.

use super::algorithm::ContactAlgorithm;
use super::found::ContactPhase;
use super::shared_nodes::SharedNodes;
use super::state::ContactState;
use crate::step::PlaneTouch;
use crate::step::nodes::block_place::BlockPlace;
use crate::step::nodes::constraints::stops_rigid;
use crate::step::nodes::stages::GridStages;
use crate::step::rigid::motion::RigidState;
use crate::step::rigid::nodes;
use impactite_scene::boundary::Boundary;
use impactite_simd::Float;

impl<T: Float, const D: usize> GridStages<'_, T, D> {
    /// Apply contact at shared nodes: contact impulses on the velocities of `phase`, then boundaries again at nodes with an
    /// impulse. `planes` are the contacts of free rigid bodies with planes.
    pub(in crate::step) fn apply_contact(
        &mut self,
        contact: &dyn ContactAlgorithm<T, D>,
        phase: ContactPhase,
        contact_state: &mut ContactState<T>,
        planes: &mut [PlaneTouch<'_, D>],
    ) {
        if !contact.separates() {
            return;
        }
        let alone = self.fields.shared().is_empty();
        if alone && !planes.is_empty() {
            contact.couple(&[], &mut [], planes);
        }
        if !alone {
            self.planes.note_velocities(self.grid.nodes());
            self.find_impulses(contact, phase, contact_state, planes);
            self.add_impulses(phase, contact_state);
            self.copy_velocities(phase, 1.0);
        }
        if phase == ContactPhase::Trial {
            let [friction, taken] = contact_state.book(self.of.dt.to_double());
            self.scene_wide.friction += friction;
            self.scene_wide.node_contact += taken;
            if contact.remembers() > 0 {
                contact_state.remember(self.grid.lattice().spacing());
            }
            if !alone && contact.keeps(self.grid.lattice().spacing()) > 0.0 {
                self.follow(contact_state);
            }
        }
        if !alone {
            self.planes.extrapolate(self.grid.nodes_mut());
        }
    }

    /// Update the motion of bodies: no particle moves further than its fastest node. A node of less mass than a particle
    /// moves it by its weight at most.
    fn follow(&self, contact_state: &mut ContactState<T>) {
        let (nodes, fields, cutoff) = (self.grid.nodes(), self.fields, self.cutoff);
        let layout = fields.layout();
        let (per_particle, one) = (T::of(1.0) / self.lightest, T::of(1.0));
        self.team.each(contact_state.squares(fields.len()), |block, square| {
            *square = T::default();
            for node in layout.of(nodes, block).iter().filter(|n| n.first[0] > cutoff) {
                let [mass, x, y, z] = node.first;
                let weight = (mass * per_particle).min(one);
                *square = square.max(weight * weight * (x * x + y * y + z * z));
            }
        });
        contact_state.follow(|block| fields.owner(block), self.of.dt.to_double());
    }

    /// Copy velocity changes in front of symmetry planes to the nodes behind; particles receive the fraction `takes` of
    /// them.
    pub(in crate::step) fn copy_velocities(&mut self, phase: ContactPhase, takes: f64) {
        let (bodies, fields) = (self.bodies, self.fields);
        let counts = |node: u32| {
            let owner = fields.owner(fields.layout().block_of(node as usize)) as usize;
            !bodies.get(owner).is_some_and(|body| body.rigid().is_some_and(RigidState::is_prescribed))
        };
        let per_dt = (phase == ContactPhase::Trial).then(|| T::of(1.0) / self.of.dt);
        let impulse = self.planes.copy_velocities(self.grid.nodes_mut(), self.cutoff, &counts, per_dt);
        if phase == ContactPhase::Trial {
            let impulse = impulse.map(|part| takes * part);
            (0..3).for_each(|d| self.scene_wide.impulse[d] += impulse[d]);
            self.conditions.boundaries.book_symmetry(&impulse, self.scene_wide);
        }
    }

    fn find_impulses(
        &mut self,
        contact: &dyn ContactAlgorithm<T, D>,
        phase: ContactPhase,
        contact_state: &mut ContactState<T>,
        planes: &mut [PlaneTouch<'_, D>],
    ) {
        let lattice = *self.grid.lattice();
        let mirrors = self.planes.mirrors();
        let (fields, bodies, nodes) = (self.fields, self.bodies, self.grid.nodes());
        let (wide, cutoff, dt, rigid) = (self.of.wide, self.cutoff, self.of.dt, self.rigid);
        let time = self.of.time;
        let (found, way, memory, scratch) = contact_state.open(self.team.threads());
        let view = |s: usize| {
            let coordinates = fields.shared()[s].coordinates;
            SharedNodes {
                nodes,
                members: fields.members(s),
                bodies,
                fields,
                mirrors,
                wide,
                place: BlockPlace::new(&fields.lattices(), &coordinates),
                coordinates,
                phase,
                spacing: fields.lattices().of_block(&coordinates).0.spacing(),
                rigid,
                cutoff,
                dt,
                time,
                memory,
            }
        };
        let keeps = contact.keeps(lattice.spacing());
        self.team.each_with(found, scratch, |s, found, scratch| {
            let at = view(s);
            found.renew(way, keeps);
            contact.impulses(&at, found, scratch);
        });
        if self.rigid {
            let all: Vec<SharedNodes<'_, T, D>> = (0..fields.shared().len()).map(view).collect();
            contact.couple(&all, found, planes);
        }
    }

    fn add_impulses(&mut self, phase: ContactPhase, contact_state: &ContactState<T>) {
        let lattice = *self.grid.lattice();
        let (bodies, fields, dt) = (self.bodies, self.fields, self.of.dt);
        let (conditions, time) = (self.conditions, self.of.time);
        let end = if phase == ContactPhase::Momentum { time } else { time + dt.to_double() };
        let tolerance = 1e-6 * lattice.spacing();
        let copies = if self.of.wide { 1.5 * lattice.spacing() } else { 0.0 };
        let mirrors = self.planes.copied();
        let per_dt = T::of(1.0) / dt;
        let (layout, team) = (fields.layout(), self.team);
        let gravity = conditions.gravity.as_ref().map_or([0.0; D], |g| g(time));
        layout.each(team, self.grid.nodes_mut(), self.books, |block, mut nodes, books| {
            let Some((shared, field)) = fields.field_of(block) else { return };
            let found = &contact_state.found[shared];
            if found.touches.is_empty() {
                return;
            }
            let place = fields.place(block);
            if fields.members(shared)[field].prescribed {
                let body = bodies[fields.owner(block) as usize].rigid();
                let real = found.impulses(field);
                let real = real.filter(|i| phase == ContactPhase::Trial && !place.is_copy(i.0, mirrors));
                for ((node, impulse), body) in real.zip(body.into_iter().cycle()) {
                    let impulse = impulse.map(T::to_double);
                    nodes::book(body, &place.node(node), &impulse, &mut books.ledger);
                    // Body force work was recorded with the velocities before contact. Impulses between bodies change no
                    // mean velocity; those of a body with prescribed motion on others do.
                    for d in 0..D {
                        books.ledger.work -= 0.5 * dt.to_double() * gravity[d] * impulse[d];
                    }
                }
                return;
            }
            let body = &bodies[fields.owner(block) as usize];
            let (rigid, one_by_one) = (body.rigid().is_some(), body.meets_surfaces().is_some());
            let holds = |_, b: &Boundary<D>| !(rigid && stops_rigid(b) || one_by_one && b.is_wall());
            for (n, impulse) in found.impulses(field).filter(|i| !place.is_copy(i.0, mirrors)) {
                let Some(node) = nodes.get(n) else { continue };
                let mass = node.first[0];
                let mut change = [T::default(); 3];
                let (mut v, mut before) = ([0.0; 3], [T::default(); 3]);
                for d in 0..D {
                    change[d] = impulse[d] / mass;
                    before[d] = node.first[d + 1];
                    let now = if phase == ContactPhase::Remapped { node.second } else { node.first };
                    v[d] = (now[d + 1] + change[d]).to_double();
                }
                let free = v;
                let x = place.node(n);
                let share = if phase == ContactPhase::Trial { mass.to_double() } else { 0.0 };
                let at = (end, tolerance, copies);
                conditions.boundaries.constrain(holds, &x, &mut v, at, share, &mut books.ledger);
                for d in 0..D {
                    change[d] += T::of(v[d] - free[d]);
                    if phase == ContactPhase::Remapped {
                        node.second[d + 1] += change[d];
                        continue;
                    }
                    node.first[d + 1] += change[d];
                    if phase == ContactPhase::Momentum {
                        continue;
                    }
                    node.second[d + 1] += change[d] * per_dt;
                    if v[d] != free[d] {
                        let impulse = mass.to_double() * (v[d] - free[d]);
                        books.ledger.impulse[d] += impulse;
                        books.ledger.work += impulse * v[d];
                    }
                }
            }
        });
    }

    /// Undo the contact correction of the mapped momentum for the stress update (USF): trial velocities start from the
    /// uncorrected ones, so that the friction limit of the step applies to the whole impulse.
    pub(in crate::step) fn undo_contact_correction(&mut self, contact_state: &ContactState<T>) {
        let (fields, mirrors) = (self.fields, self.planes.copied());
        if fields.shared().is_empty() {
            return;
        }
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, self.grid.nodes_mut(), self.books, |block, mut nodes, _| {
            let Some((shared, field)) = fields.field_of(block) else { return };
            if fields.members(shared)[field].prescribed {
                return;
            }
            let place = fields.place(block);
            let front = |i: &(usize, [T; 3])| !place.is_copy(i.0, mirrors);
            for (n, impulse) in contact_state.found[shared].impulses(field).filter(front) {
                let Some(node) = nodes.get(n) else { continue };
                for d in 0..D {
                    node.first[d + 1] -= impulse[d] / node.first[0];
                }
            }
        });
        self.planes.copy_velocities(self.grid.nodes_mut(), self.cutoff, &|_| false, None);
    }
}
