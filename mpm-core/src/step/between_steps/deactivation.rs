//! Bodies that rest until others come: no nodes, no passes, and the same bits.
//!
//! A body without stress, velocity and load maps the same mass and zeros in every step as long as its nodes are its own.
//! So it is left out: it claims no node blocks, its passes are not made, and the rates that they would find are
//! remembered for the time step. It wakes when other bodies claim a block that it would claim, which is before the first
//! node that both reach. The map that its last pass would have left is made then, by that pass.

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
    /// See that no particle moves, is stressed or changes in a step among nodes that stand still, and rest from now on.
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
        // What a law makes of rest is not asked of it but tried, by the passes of the run: a clock in its state shows.
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

    /// Make the passes of a step of `dt`, s, among nodes that stand still.
    fn try_rest(&mut self, dt: T, team: &Team) -> Result<Deactivated<T, D>, BodyTrouble> {
        let mut resting = Deactivated { blocks: Vec::new(), rates: [T::default(); 3], dt };
        for (which, rate) in [Which::Map, Which::First, Which::Second].into_iter().zip(&mut resting.rates) {
            *rate = self.pass_at_rest(which, dt, team)?;
        }
        Ok(resting)
    }

    /// A pass that finds no nodes, and so reads zeros.
    fn pass_at_rest(&mut self, which: Which, dt: T, team: &Team) -> Result<T, BodyTrouble> {
        let layout = Layout::default();
        let steps = Steps { this: dt, next: dt, adapt: true, force_time: 0.0, force: [0.0; 3] };
        self.pass(which, Nodes { all: &[], layout: &layout }, steps, team)
    }

    /// The first particle that is not as it was.
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

    /// What a column holds.
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

    /// Rest no longer: have the tiles that the last pass of a step would have left.
    pub(in crate::step) fn reactivate_particles(&mut self, team: &Team) {
        let Some(resting) = self.resting.take() else { return };
        let nodes = self.tile_records();
        self.slots.iter_mut().for_each(|slot| slot.tile = AlignedRecords::zeros(nodes));
        self.nodes_around.clear();
        self.nodes_around.resize(self.slots.len() * neighbours(D), NONE);
        let last = self.facts().last_pass();
        // It went well when it was tried, with the same numbers.
        let _ = self.pass_at_rest(last, resting.dt, team);
    }

    /// In a checkpoint; the particles follow.
    pub(in crate::step) fn exchange_rest(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.option(&mut self.resting, |file, Deactivated { blocks: _, rates, dt }| {
            file.numbers(rates.iter_mut().chain([dt]))
        })
    }

    /// After the particles were read.
    pub(in crate::step) fn rest_as_read(&mut self) {
        if self.resting.is_some() {
            self.slots.iter_mut().for_each(|slot| slot.tile = AlignedRecords::default());
            self.note_blocks();
        }
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Leave bodies out of the steps until another one comes to them: a target that a projectile flies to. While a body rests
    /// it has no nodes and its particles are not visited; totals, observers and checkpoints see them as they are.
    ///
    /// **No bit changes** (but for the signs of zeros): a body without velocity, stress and load maps nothing but its mass
    /// while its nodes are its own. It wakes as soon as the node blocks of another body that does not rest, of four cells an
    /// axis, are some that it would have, and so before the first node is shared. Its wave speed goes on to limit the time
    /// step. A body force, a moving wall or prescribed velocities where it lies, given later, wake it in the next step. It
    /// does not come to rest again by itself.
    ///
    /// Bodies that touch are told together, and wake together. Where bodies are kept apart ([`ContactAlgorithm::separates`](crate::ContactAlgorithm::separates)) they stay
    /// awake: contact may act between bodies that stand still.
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
    /// A method in the reference configuration, where bodies never meet others, and so would never wake; no body of a name; a rigid one; a load of its own; a body force, a moving wall, or prescribed velocities where it
    /// lies; a particle that moves, is stressed, or that one step among nodes at rest changes: by a law with a clock (an
    /// explosive that will be lit), for instance. The step tried is as long as the body's own waves allow. Where one is
    /// refused, all stay awake.
    pub fn deactivate(&mut self, bodies: &[&str]) -> Result<(), SceneError> {
        self.work.deactivate(self, bodies)
    }

    pub(in crate::step) fn deactivate_here(&mut self, bodies: &[&str]) -> Result<(), SceneError> {
        self.check_frame("bodies at rest", "bodies mapped in the reference configuration never meet others")?;
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

    /// Let a body rest that did not, and note its number.
    fn lay_down(&mut self, name: &str, told: &mut Vec<usize>) -> Result<(), SceneError> {
        let Some(number) = self.scene.bodies.iter().position(|b| b.name() == name) else {
            let bodies: Vec<&str> = self.scene.bodies.iter().map(|b| b.name()).collect();
            return Err(SceneError::NoBody { body: name.into(), bodies: bodies.join(", ") });
        };
        if self.scene.bodies[number].is_deactivated() {
            return Ok(());
        }
        // As long as its own waves allow: a clock that rounding stops at this step stands still at shorter ones.
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

    /// Particles that a step computes: those of bodies that do not rest ([`Mpm::deactivate`]).
    pub fn moving_particles(&self) -> usize {
        self.scene.bodies.iter().filter(|b| !b.is_deactivated()).map(|b| b.len()).sum()
    }

    /// Node blocks, with those that bodies at rest would have: whether to look ahead is decided as if none rested.
    pub(in crate::step) fn blocks(&self) -> usize {
        let rest = self.scene.bodies.iter().filter_map(|b| b.deactivated_blocks()).flatten();
        self.grid.fields.len() + rest.filter(|at| self.grid.storage.find(at).is_none()).count()
    }

    /// Wake a body and others that rest if they share node blocks.
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

    /// What may set a body in motion that rests, other bodies aside.
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
                let place = BlockPlace::new(lattice, block);
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

    /// Wake what was given a reason to move since the last step.
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
