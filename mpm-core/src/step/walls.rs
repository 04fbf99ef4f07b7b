//! Walls that only push, as nodes meet them.
//!
//! A node on or behind a wall presses on it from the step in which its trial velocity goes into the wall to that in which its
//! acceleration points away from it. While it presses it is a node on a plane of symmetry: the wall balances what force and momentum
//! it has across, and it moves as the wall does. Particles are not pushed: they come to rest by the stress of the matter
//! that is compressed. So the wall does no work but that of its own motion. (A wall that stops trial velocities step by step does
//! work J . (v- + v+) / 2 on nodes that part at the start of a step and close at its end, and FLIP keeps it: a bounce off it gave up to
//! twice the energy.)

use super::solver::Mpm;
use crate::boundary::{Boundary, Side};
use crate::parallel::Float;

use super::checkpoint::{Archive, CheckpointError};

/// A wall that nodes of a block may be behind.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wall {
    /// Normal axis.
    pub(super) axis: usize,
    /// +1 if the wall pushes up the axis, else -1.
    sign: f64,
    /// Where it is, m.
    at: f64,
    /// Its velocity along the axis, m/s.
    pub(super) velocity: f64,
    /// Is the node that is looked at on or behind it?
    here: bool,
    /// Does that node press on it?
    pub(super) pressed: bool,
}

impl Wall {
    /// Does a node go into the wall at this velocity, m/s?
    pub(super) fn closes(&self, velocity: f64) -> bool {
        (velocity - self.velocity) * self.sign < 0.0
    }
    /// Does a force that accelerates a node so, m/s^2, push it onto the wall?
    pub(super) fn is_pushed(&self, acceleration: f64) -> bool {
        acceleration * self.sign < 0.0
    }
}

/// The walls that the nodes of a block may be behind: two an axis at most.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Walls {
    list: [Wall; 6],
    count: usize,
}

impl Walls {
    /// These boundaries' at `time`, s. Of several on one side of an axis the one that is furthest ahead counts.
    pub(super) fn of<'a, const D: usize>(
        boundaries: impl Iterator<Item = &'a Boundary<D>>,
        time: f64,
    ) -> Self {
        let mut walls = Walls::default();
        for boundary in boundaries {
            let Boundary::Wall { axis, at, side, velocity } = *boundary else { continue };
            let sign = if side == Side::Above { 1.0 } else { -1.0 };
            let wall = Wall { axis, sign, at: at + velocity * time, velocity, here: false, pressed: false };
            let known = walls.list[..walls.count].iter_mut().find(|w| w.axis == axis && w.sign == sign);
            match known {
                Some(known) if (wall.at - known.at) * sign <= 0.0 => {}
                Some(known) => *known = wall,
                None => {
                    walls.list[walls.count] = wall;
                    walls.count += 1;
                }
            }
        }
        walls
    }
    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }
    /// Look at the node `n` of the block, at `x`, which pressed on those of `pressed`.
    pub(super) fn look_at<const D: usize>(
        &mut self,
        n: usize,
        x: &[f64; D],
        pressed: &Pressed,
        tolerance: f64,
    ) {
        for wall in &mut self.list[..self.count] {
            wall.here = (x[wall.axis] - wall.at) * wall.sign <= tolerance;
            wall.pressed = wall.here && pressed.has(wall.axis, n);
        }
    }
    /// Those that the node is on or behind.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Wall> {
        self.list[..self.count].iter().filter(|wall| wall.here)
    }
    /// Those that the node is on or behind.
    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Wall> {
        self.list[..self.count].iter_mut().filter(|wall| wall.here)
    }
}

/// The nodes of a block that press on walls, a bit each, by the axis of the wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pressed([u64; 3]);

impl Pressed {
    pub(super) fn has(&self, axis: usize, node: usize) -> bool {
        self.0[axis] >> node & 1 != 0
    }
    pub(super) fn set(&mut self, axis: usize, node: usize, presses: bool) {
        self.0[axis] = self.0[axis] & !(1 << node) | u64::from(presses) << node;
    }
}

/// Nodes of a block that press on walls, and whose they are.
#[derive(Clone, Debug)]
pub(super) struct PressedAt<const D: usize> {
    at: [i32; D],
    owner: u32,
    nodes: Pressed,
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Which nodes press on walls, by place: before blocks are arranged anew.
    pub(super) fn pressed(&self) -> Vec<PressedAt<D>> {
        if !self.conditions.boundaries.iter().any(|b| matches!(b, Boundary::Wall { .. })) {
            return Vec::new();
        }
        let blocks = self.fields.coordinates().iter().zip(&self.books).enumerate();
        let pressed = blocks.filter(|(_, (_, books))| books.pressed != Pressed::default());
        pressed
            .map(|(block, (at, books))| PressedAt {
                at: *at,
                owner: self.fields.owner(block),
                nodes: books.pressed,
            })
            .collect()
    }

    /// Note it again, where the blocks are still there.
    pub(super) fn press(&mut self, pressed: &[PressedAt<D>]) {
        self.books.clear();
        self.books.resize_with(self.fields.len(), Default::default);
        for PressedAt { at, owner, nodes } in pressed {
            if let Some(block) = self.fields.find(&*self.grid, at, *owner) {
                self.books[block].pressed = *nodes;
            }
        }
    }

    /// In a checkpoint, after the blocks.
    pub(super) fn exchange_pressed(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let mut pressed = self.pressed();
        let blank = PressedAt { at: [0; D], owner: 0, nodes: Pressed::default() };
        file.list(&mut pressed, &blank, |file, PressedAt { at, owner, nodes }| {
            at.iter_mut().try_for_each(|c| file.integer(c))?;
            let mut word = u64::from(*owner);
            file.word(&mut word)?;
            *owner = u32::try_from(word).map_err(|_| file.damaged(format!("{word:#x} is no body")))?;
            nodes.0.iter_mut().try_for_each(|set| file.word(set))
        })?;
        if file.reads() {
            self.press(&pressed);
        }
        Ok(())
    }
}
