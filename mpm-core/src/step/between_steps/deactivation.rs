//! Deactivation of bodies at rest until others come: no nodes, no passes, and the same bits.
//!
//! A body without stress, velocity and load maps the same mass and zeros in every step as long as it shares no nodes.
//! It is therefore deactivated: it claims no node blocks, its passes are skipped, and their rates are stored for the
//! time step. It is reactivated when other bodies claim a block that it would claim, which is before both reach the
//! first node. The map of its last pass is then made by that pass.

use crate::step::bodies::body::{BodyTrouble, GridBody, Steps, Which};

use super::deactivated::Deactivated;
use crate::dim::neighbours;
use crate::grid::OutsideGrid;
use crate::particles::{Columns, Sent};
use crate::step::bodies::particle_body::{NONE, ParticleBody};
use crate::step::mpm::Mpm;
use crate::step::nodes::block_place::BlockPlace;
use crate::step::nodes::layout::{Claim, Layout, Nodes};
use crate::step::passes::slot::Slot;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::boundary::Boundary;
use impactite_scene::error::SceneError;
use impactite_simd::{AlignedRecords, Float, Team};

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Check that no particle moves, is stressed or changes in a step among nodes at rest, and deactivate the body.
    pub(in crate::step) fn deactivate_particles(
        &mut self,
        longest: T,
        team: &Team,
    ) -> Result<(), SceneError> {
        let body = self.name.clone();
        if self.loads.act() {
            return Err(SceneError::Disturbed { body, what: "a load of its own".into() });
        }
        for slot in &self.slots {
            for (bin, at) in slot.block.places() {
                let p = self.particle(&slot.block, bin, at);
                let numbers = p.velocity.iter().map(|v| ("velocity", v));
                let mut numbers = numbers.chain(p.stress.iter().map(|s| ("stress", s)));
                if let Some((field, &value)) = numbers.find(|(_, x)| **x != 0.0) {
                    let (field, allowed) = (field.into(), "zero".into());
                    return Err(SceneError::NotAtEquilibrium {
                        body,
                        particle: p.number,
                        field,
                        value,
                        allowed,
                    });
                }
            }
        }
        // The response of a law to rest is tested by the passes of the run: a clock in its state is detected.
        let (slots, splits) = (self.slots.clone(), self.splits);
        let tried = self.try_rest(longest, team);
        self.sent.fill(Sent::default());
        let refused = match tried {
            Ok(resting) => {
                let changed = self.changed(&slots);
                self.resting = changed.is_none().then_some(resting);
                changed
            }
            Err(BodyTrouble { particle, cause, .. }) => {
                let what = format!("the end of particle {particle} in a step among nodes at rest ({cause})");
                Some(SceneError::Disturbed { body, what })
            }
        };
        if let Some(error) = refused {
            (self.slots, self.splits) = (slots, splits);
            return Err(error);
        }
        self.spare = Vec::new();
        self.slots.retain(|slot| !slot.block.is_empty());
        self.link_slots();
        self.slots.iter_mut().for_each(|slot| slot.tile = AlignedRecords::default());
        self.note_blocks();
        Ok(())
    }

    /// Make the passes of a step of `dt`, s, among nodes at rest.
    fn try_rest(&mut self, dt: T, team: &Team) -> Result<Deactivated<T, D>, BodyTrouble> {
        let mut resting = Deactivated { blocks: Vec::new(), rates: [T::default(); 3], dt };
        for (which, rate) in [Which::Map, Which::First, Which::Second].into_iter().zip(&mut resting.rates) {
            *rate = self.pass_at_rest(which, dt, team)?;
        }
        Ok(resting)
    }

    /// Make a pass without nodes, which reads zeros.
    fn pass_at_rest(&mut self, which: Which, dt: T, team: &Team) -> Result<T, BodyTrouble> {
        let layout = Layout::default();
        let steps = Steps { this: dt, next: dt, adapt: true, force_time: 0.0, force: [0.0; 3] };
        self.pass(which, Nodes { all: &[], layout: &layout }, steps, team)
    }

    /// Return the error for the first particle that changed.
    fn changed(&self, before: &[Slot<T, D>]) -> Option<SceneError> {
        for (old, new) in before.iter().zip(&self.slots) {
            for (bin, at) in old.block.places() {
                let particle = old.block.number(at);
                let not_as_it_was = |field: String, is: f64, was: f64| {
                    let body = self.name.clone();
                    let allowed = format!("what it is before a step among nodes at rest ({was})");
                    Some(SceneError::NotAtEquilibrium { body, particle, field, value: is, allowed })
                };
                let [was, is] = [&old.block, &new.block].map(|b| b.bin_len(bin));
                if was != is {
                    return not_as_it_was("number of particles in the bin".into(), is as f64, was as f64);
                }
                for column in 0..self.columns.rows() {
                    let [was, is] = [&old.block, &new.block].map(|b| b.get(at, column));
                    if was != is {
                        return not_as_it_was(self.named(column), is.to_double(), was.to_double());
                    }
                }
            }
        }
        None
    }

    /// Name of the content of a column.
    fn named(&self, column: usize) -> String {
        let state = Columns::state(D);
        let name = column.checked_sub(state).and_then(|n| self.columns.state_names().get(n));
        match name {
            Some(name) => name.clone(),
            None if column < Columns::velocity(D) => "position in its bin".into(),
            None if column < state => "velocity".into(),
            None => "domain".into(),
        }
    }

    fn note_blocks(&mut self) {
        let mut list: Vec<Claim<D>> = Vec::new();
        self.claim_blocks(0, &mut list);
        let mut blocks: Vec<[i32; D]> = list.iter().map(|claim| claim.coordinates).collect();
        blocks.sort_unstable();
        blocks.dedup();
        blocks.shrink_to_fit();
        if let Some(resting) = &mut self.resting {
            resting.blocks = blocks;
        }
    }

    /// Reactivate the body: compute the tiles that the last pass of a step would have left.
    pub(in crate::step) fn reactivate_particles(&mut self, team: &Team) {
        let Some(resting) = self.resting.take() else { return };
        let nodes = self.tile_records();
        self.slots.iter_mut().for_each(|slot| slot.tile = AlignedRecords::zeros(nodes));
        self.nodes_around.clear();
        self.nodes_around.resize(self.slots.len() * neighbours(D), NONE);
        let last = self.facts().last_pass();
        // It succeeded in the trial, with the same values.
        let _ = self.pass_at_rest(last, resting.dt, team);
    }

    /// Write or read the state of a deactivated body; the particles follow.
    pub(in crate::step) fn exchange_rest(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.option(&mut self.resting, |file, Deactivated { blocks: _, rates, dt }| {
            file.numbers(rates.iter_mut().chain([dt]))
        })
    }

    /// Restore the deactivated body after the particles were read.
    pub(in crate::step) fn rest_as_read(&mut self) {
        if self.resting.is_some() {
            self.slots.iter_mut().for_each(|slot| slot.tile = AlignedRecords::default());
            self.note_blocks();
        }
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Deactivate bodies until another one comes to them: a target in front of a projectile. A deactivated body has
    /// no nodes and its particles are not visited; totals, observers and checkpoints include them unchanged.
    ///
    /// **No bit changes** (except for the signs of zeros): a body without velocity, stress and load maps only its
    /// mass while it shares no nodes. It is reactivated as soon as the node blocks of an active body, of four cells
    /// an axis, include one that it would claim, and so before the first node is shared. Its wave speed continues to
    /// limit the time step. A body force, a moving wall or prescribed velocities in its region, set later, reactivate
    /// it in the next step. It is not deactivated again automatically.
    ///
    /// Deactivate bodies that touch in one call; they are reactivated together. Where contact separates bodies
    /// ([`ContactAlgorithm::separates`](crate::ContactAlgorithm::separates)) touching bodies stay active: contact may
    /// act between bodies at rest.
    ///
    /// ```
    /// # use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, geometry::*};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let lattice = Lattice::new([0.0; 2], 0.25)?;
    /// # let plate = fill(&Cuboid::new([0.0; 2], [1.0, 4.0])?, &lattice, 2, &Filling::new())?;
    /// # let ball = fill(&Ball::new([-6.0, 2.0], 0.5)?, &lattice, 2, &Filling::new())?;
    /// # let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3)?)?;
    /// # let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    /// mpm.add("ball", law, &ball, |_| [1.0, 0.0])?;
    /// mpm.add("plate", law, &plate, |_| [0.0; 2])?;
    /// mpm.deactivate(&["plate"])?;
    /// mpm.run_until(2.0)?;
    /// assert!(mpm.bodies()[1].is_deactivated() && mpm.moving_particles() == ball.positions.len());
    /// mpm.run_until(6.0)?;
    /// assert!(!mpm.bodies()[1].is_deactivated());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A method in the reference configuration, where bodies never interact and are never reactivated; an unknown
    /// name; a rigid body; a load of its own; a body force, a moving wall, or prescribed velocities in its region; a
    /// particle that moves, is stressed, or changes in one step among nodes at rest, for instance by a law with a
    /// clock (an explosive that will be ignited). The trial step is as long as the wave speed of the body allows. If
    /// one body is refused, all stay active.
    pub fn deactivate(&mut self, bodies: &[&str]) -> Result<(), SceneError> {
        self.work.deactivate(self, bodies)
    }

    pub(in crate::step) fn deactivate_here(&mut self, bodies: &[&str]) -> Result<(), SceneError> {
        self.check_frame("bodies at rest", "bodies mapped in the reference configuration never meet others")?;
        self.check_levels("a deactivated body")?;
        let outside = |outside| SceneError::Outside(bodies.join(", "), outside);
        let mut told = Vec::new();
        for name in bodies {
            let refused = self.lay_down(name, &mut told).err();
            if let Some(error) = refused {
                told.iter().for_each(|&number: &usize| self.scene.bodies[number].reactivate(&self.team));
                self.arrange().map_err(outside)?;
                return Err(error);
            }
        }
        if self.scene.contact.separates() {
            told.iter().for_each(|&number| self.wake_beside(number));
        }
        self.arrange().map_err(outside)?;
        self.grid.storage.give_back();
        Ok(())
    }

    /// Deactivate an active body, and append its number to `told`.
    fn lay_down(&mut self, name: &str, told: &mut Vec<usize>) -> Result<(), SceneError> {
        let Some(number) = self.scene.bodies.iter().position(|b| b.name() == name) else {
            let bodies: Vec<&str> = self.scene.bodies.iter().map(|b| b.name()).collect();
            return Err(SceneError::NoBody { body: name.into(), bodies: bodies.join(", ") });
        };
        if self.scene.bodies[number].is_deactivated() {
            return Ok(());
        }
        // Longest step that its wave speed allows: a clock that rounding stops at this step also stops at shorter ones.
        let rate = self.scene.bodies[number].rate(self.grid.lattice().spacing()).to_double();
        let longest = if rate > 0.0 { self.stepper.control.next(rate, None).max(1.0 / rate) } else { 1.0 };
        let body = &mut self.scene.bodies[number];
        let what = if body.rigid().is_some() { "its being rigid" } else { "its reference configuration" };
        let cannot = SceneError::Disturbed { body: name.into(), what: what.into() };
        body.deactivation_mut().ok_or(cannot)?.deactivate(T::of(longest), &self.team)?;
        told.push(number);
        let disturbed = self.disturbance(number);
        disturbed.map_or(Ok(()), |what| Err(SceneError::Disturbed { body: name.into(), what }))
    }

    /// Number of particles that a step computes: those of active bodies ([`Mpm::deactivate`]).
    pub fn moving_particles(&self) -> usize {
        self.scene.bodies.iter().filter(|b| !b.is_deactivated()).map(|b| b.len()).sum()
    }

    /// Number of node blocks, including those that deactivated bodies would have: the look-ahead must not depend on deactivation.
    pub(in crate::step) fn blocks(&self) -> usize {
        let rest = self.scene.bodies.iter().filter_map(|b| b.deactivated_blocks()).flatten();
        self.grid.fields.len() + rest.filter(|at| self.grid.storage.find(at).is_none()).count()
    }

    /// Reactivate a body and other deactivated bodies that share node blocks with it.
    fn wake_beside(&mut self, number: usize) {
        let Some(blocks) = self.scene.bodies[number].deactivated_blocks().map(<[_]>::to_vec) else { return };
        let mut beside = false;
        for (_, body) in self.scene.bodies.iter_mut().enumerate().filter(|(other, _)| *other != number) {
            let meets = |at: &[[i32; D]]| blocks.iter().any(|block| at.binary_search(block).is_ok());
            if body.deactivated_blocks().is_some_and(meets) {
                body.reactivate(&self.team);
                beside = true;
            }
        }
        if beside {
            self.scene.bodies[number].reactivate(&self.team);
        }
    }

    /// Describe the condition that may move a deactivated body, if any; other bodies are not considered.
    fn disturbance(&self, number: usize) -> Option<String> {
        let blocks = self.scene.bodies[number].deactivated_blocks()?;
        if self.scene.conditions.gravity.is_some() {
            return Some("a body force".into());
        }
        let lattice = self.grid.lattice();
        let reach = 2.0 * lattice.spacing();
        let acts = |boundary: &&Boundary<D>| match boundary {
            Boundary::Symmetry { .. }
            | Boundary::Fixed { .. }
            | Boundary::Absorbing { .. }
            | Boundary::Periodic { .. } => false,
            Boundary::Wall { velocity, .. } => *velocity != 0.0,
            Boundary::FrictionWall { velocity, .. } => *velocity != [0.0; D],
            Boundary::Prescribed { .. } | Boundary::Own(_) => blocks.iter().any(|block| {
                let place = BlockPlace::new(&self.grid.fields.lattices(), block);
                boundary.reaches(&place.low, &place.high, self.clock.time, reach)
            }),
        };
        self.scene
            .conditions
            .boundaries
            .iter()
            .find(acts)
            .map(|boundary| format!("the boundary {boundary:?}"))
    }

    /// Reactivate bodies that a condition may have moved since the last step.
    pub(in crate::step) fn reactivate_disturbed(&mut self) -> Result<(), OutsideGrid> {
        let mut woken = false;
        for number in 0..self.scene.bodies.len() {
            if self.disturbance(number).is_some() {
                self.scene.bodies[number].reactivate(&self.team);
                woken = true;
            }
        }
        if woken { self.arrange() } else { Ok(()) }
    }
}
