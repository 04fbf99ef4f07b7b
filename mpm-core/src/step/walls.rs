//! Walls that only push, as nodes meet them.
//!
//! A node on or behind a wall presses on it from the step in which its trial velocity goes into the wall to that in which its
//! acceleration points away from it. While it presses it is a node on a plane of symmetry: the wall balances what force and momentum
//! it has across, and it moves as the wall does. Particles are not pushed: they come to rest by the stress of the matter
//! that is compressed. So the wall does no work but that of its own motion. (A wall that stops trial velocities step by step does
//! work J . (v- + v+) / 2 on nodes that part at the start of a step and close at its end, and FLIP keeps it: a bounce off it gave up to
//! twice the energy.)
//!
//! On a rough wall a node that presses sticks from the step in which friction can stop its slip to that in which the force along the wall
//! is more than friction bears: while it sticks it is a node on a fixed plane, as above. Else friction is an impulse against the slip.

use impactite_scene::boundary::{Boundary, Side};

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
    /// Its velocity, m/s, of which friction sees what is along the wall.
    pub(super) drag: [f64; 3],
    /// Its coefficient of friction, zero if it is smooth.
    pub(super) friction: f64,
    /// Is the node that is looked at on or behind it?
    here: bool,
    /// Does that node press on it?
    pub(super) pressed: bool,
    /// Does it stick to it?
    pub(super) sticks: bool,
    /// The impulse that pushes the node off, N s.
    pub(super) push: f64,
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
    /// Note the impulse of a step, N s.
    pub(super) fn pushes(&mut self, impulse: f64) {
        self.push = impulse * self.sign;
    }
    /// May friction act?
    pub(super) fn rubs(&self) -> bool {
        self.pressed && self.friction > 0.0
    }
    /// The most that it is in a step, N s.
    pub(super) fn limit(&self) -> f64 {
        self.friction * self.push.max(0.0)
    }
    /// The directions along it.
    pub(super) fn along<const D: usize>(&self) -> impl Iterator<Item = usize> + use<D> {
        let axis = self.axis;
        (0..D).filter(move |d| *d != axis)
    }
    /// The node does not press any more.
    pub(super) fn let_go(&mut self) {
        (self.pressed, self.sticks) = (false, false);
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
            let (axis, at, side, velocity, drag, friction) = match *boundary {
                Boundary::Wall { axis, at, side, velocity } => (axis, at, side, velocity, [0.0; 3], 0.0),
                Boundary::FrictionWall { axis, at, side, velocity, friction } => {
                    let mut drag = [0.0; 3];
                    drag[..D].copy_from_slice(&velocity);
                    (axis, at, side, velocity[axis], drag, friction)
                }
                _ => continue,
            };
            let sign = if side == Side::Above { 1.0 } else { -1.0 };
            let at = at + velocity * time;
            let wall = Wall { axis, sign, at, velocity, drag, friction, ..Wall::default() };
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
    /// Look at the node `n` of the block, at `x`, which pressed on and stuck to those of `before`.
    pub(super) fn look_at<const D: usize>(
        &mut self,
        n: usize,
        x: &[f64; D],
        [pressed, stuck]: &[NodeSets; 2],
        tolerance: f64,
    ) {
        for wall in &mut self.list[..self.count] {
            wall.here = (x[wall.axis] - wall.at) * wall.sign <= tolerance;
            wall.pressed = wall.here && pressed.has(wall.axis, n);
            wall.sticks = wall.pressed && stuck.has(wall.axis, n);
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

/// Nodes of a block, a bit each, by an axis: that of a wall they press on, or one along which they are held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeSets(pub(super) [u64; 3]);

impl NodeSets {
    pub(super) fn has(&self, axis: usize, node: usize) -> bool {
        self.0[axis] >> node & 1 != 0
    }
    pub(super) fn set(&mut self, axis: usize, node: usize, is: bool) {
        self.0[axis] = self.0[axis] & !(1 << node) | u64::from(is) << node;
    }
    /// Is a node noted for another axis than this?
    pub(super) fn has_beside(&self, axis: usize, node: usize) -> bool {
        (0..3).any(|a| a != axis && self.has(a, node))
    }
}
