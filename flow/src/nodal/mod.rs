//! Semi-staggered scheme \[Zhang2017b\], as printed: velocities at nodes, the pressure at the centres of cells.
//!
//! ```text
//! v* = v + dt (b + div s / rho)                    at the nodes, s the deviatoric stress of the particles
//! lap q = div v*,  q = p dt / rho                  at the cells: (2D+1) points, ghost values at the surface; div by the hat functions
//! v <- v* - mean of the face gradients of q        at the nodes
//! v <- v - alpha sum_k (Gamma_k . v) Gamma_k       over the cells: hourglass filter
//! v_p <- (1 - c) (v_p + dv(x_p)) + c v(x_p)        FLIP with the share c of PIC; positions by a Runge-Kutta step of third order
//! ```
//! The Laplacian is not the divergence of the gradient at the nodes, so that the velocity is not free of divergence, and a pressure that
//! alternates between cells has no gradient at the nodes.

mod balls;
mod gather;
pub(crate) mod nodes;
mod operators;
mod transfer;

use impactite_scene::{SceneError, StepError, Stopped};
use impactite_solve::Stop;

use crate::blocks::{Blocks, local};
use crate::gather::Sums;
use crate::options::{Fluid, SemiStaggered};
use crate::pressure::Cells;
use crate::solver::{Flow, add_to};
use crate::surface::{AIR, LIQUID, SOLID};
use crate::wall::{Wall, Walls};

use gather::NodalGather;
use nodes::Nodes;

/// Open share of a cell or a face by which a wall is off the lines of the grid.
const OFF: f64 = 1e-6;

fn add_up<const D: usize>(sum: &mut [f64; D], by: &[f64; D]) {
    (0..D).for_each(|d| sum[d] += by[d]);
}

impl<const D: usize> Flow<D> {
    /// Check that walls and bodies are such as the scheme of the scene is written for, as far as it is known before the first step: inclined
    /// and round walls are found where liquid meets them.
    ///
    /// # Errors
    /// With the semi-staggered scheme a correction of the density that was asked for after it, a body that the liquid moves, a wall that moves,
    /// and a wall that is not on lines of the grid.
    pub fn check_scheme(&self) -> Result<(), SceneError> {
        if self.options.semi_staggered.is_none() {
            return Ok(());
        }
        if self.options.correction > 0.0 {
            return Err(SceneError::NotWith {
                what: "a correction of the density".into(),
                method: self.method_of_scheme().into(),
                why: "the scheme has none; leave it out, or take the staggered scheme",
            });
        }
        let moving = self.walls.iter().any(|wall| wall.is_moving() || wall.spin().is_some());
        let what = if self.moves_bodies() {
            "a body that the liquid moves".into()
        } else if moving {
            "a wall that moves".into()
        } else if let Some((axis, at)) = self.walls.iter().find_map(|wall| self.off_lines(wall)) {
            format!("a wall at {} = {at} m", ["x", "y", "z"][axis])
        } else {
            return Ok(());
        };
        Err(self.only_lines(what))
    }

    fn only_lines(&self, what: String) -> SceneError {
        SceneError::NotWith {
            what,
            method: self.method_of_scheme().into(),
            why: "walls are lines of the grid that do not move; take cells whose edge divides the places of the walls, or the staggered scheme",
        }
    }

    /// Axis and place of an end of a wall that is not on a line of the grid.
    fn off_lines(&self, wall: &Wall<D>) -> Option<(usize, f64)> {
        let bounds = wall.bounds();
        (0..D).flat_map(|d| [(d, bounds.min[d]), (d, bounds.max[d])]).find(|(d, at)| {
            let cells = (at - self.frame.origin[*d]) / self.frame.h;
            cells.is_finite() && (cells - cells.round()).abs() > OFF * cells.abs().max(1.0)
        })
    }

    /// Stages of a step of `dt` seconds with velocities at nodes.
    pub(crate) fn stages_at_nodes(
        &mut self,
        with: SemiStaggered,
        dt: f64,
        walls: &mut Walls<'_, D>,
    ) -> Result<Vec<Sums<D>>, StepError> {
        let mut nodes = self.nodes.take().unwrap_or_default();
        let stepped = self.stages_of_nodes(with, dt, walls, &mut nodes);
        self.nodes = Some(nodes);
        stepped
    }

    fn stages_of_nodes(
        &mut self,
        with: SemiStaggered,
        dt: f64,
        walls: &mut Walls<'_, D>,
        nodes: &mut Nodes<D>,
    ) -> Result<Vec<Sums<D>>, StepError> {
        let fluid = self.fluid.ok_or_else(|| self.clock.stopped(Stopped::Scene(SceneError::NoBodies)))?;
        self.part(|t| &mut t.sort, |f| f.sort(walls))?;
        self.part(|t| &mut t.sort, |f| f.hold_nodes(walls, nodes))?;
        self.part(|t| &mut t.scatter, |f| f.scatter_to_nodes(nodes));
        self.part(|t| &mut t.surface, |f| f.find_surface_of_balls(nodes));
        self.part(|t| &mut t.pressure, Self::assemble)?;
        self.part(|t| &mut t.forces, |f| f.force_nodes(fluid, dt, nodes));
        self.part(|t| &mut t.pressure, |f| f.project_nodes(with, nodes))?;
        let scale = fluid.density * self.frame.h / dt;
        self.book_pressure_on_walls(dt * scale, walls);
        self.finish_pressure(scale);
        self.part(|t| &mut t.gather, |f| f.gather_from_nodes(with, dt, nodes))
    }

    /// Find the components of nodal velocities that walls hold: across faces between an open cell and a wall; all in walls, and where a wall
    /// is without slip.
    fn hold_nodes(&self, walls: &Walls<'_, D>, nodes: &mut Nodes<D>) -> Result<(), StepError> {
        let (grid, cells) = (&self.grid, Blocks::<D>::CELLS);
        let between = |x: &f64| *x > OFF && *x < 1.0 - OFF;
        if let Some(slot) = grid.open_cell.iter().position(between) {
            let at = local::<D>(slot % cells).map(|x| x as f64 + 0.5);
            let x = self.frame.place(&grid.blocks.keys[slot / cells], &at);
            let what = format!("a wall through the cell at {x:.6?} m");
            return Err(self.clock.stopped(Stopped::Scene(self.only_lines(what))));
        }
        nodes.held.clear();
        nodes.held.resize(grid.blocks.cells(), 0);
        let no_slip = walls.list.iter().any(Wall::is_no_slip);
        let open = |slot: Option<usize>| slot.is_none_or(|s| grid.open_cell[s] > 0.5);
        let cut = |b: &u32| grid.cuts.get(*b as usize).is_some_and(Option::is_some);
        for b in (0..grid.blocks.len()).filter(|b| grid.blocks.near(*b).iter().any(cut)) {
            for i in 0..cells {
                let at = local::<D>(i);
                // Cells around the node: bit d of `corner` is one for the upper side.
                let around: [bool; 8] = std::array::from_fn(|corner| {
                    let by = std::array::from_fn(|d| (corner >> d & 1) as i32 - 1);
                    corner >= 1 << D || open(grid.blocks.around_cell(b, &at, &by))
                });
                let around = &around[..1 << D];
                let mut held = 0;
                for d in 0..D {
                    let across = |corner: usize| around[corner] != around[corner ^ (1 << d)];
                    if (0..1 << D).any(across) || !around.contains(&true) {
                        held |= 1 << d;
                    }
                }
                if no_slip && held != 0 {
                    let x = self.frame.place(&grid.blocks.keys[b], &at.map(|x| x as f64));
                    let (gap, wall) = walls.gap(x);
                    if gap <= OFF * self.frame.h && walls.list[wall].is_no_slip() {
                        held = (1 << D) - 1;
                    }
                }
                nodes.held[b * cells + i] = held;
            }
        }
        Ok(())
    }

    fn scatter_to_nodes(&mut self, nodes: &mut Nodes<D>) {
        transfer::to_nodes(&self.team, &self.grid.blocks, &self.frame, &self.liquids, nodes);
    }

    fn find_surface_of_balls(&mut self, nodes: &mut Nodes<D>) {
        let grid = &mut self.grid;
        let surface = &mut grid.surface;
        balls::level(&self.team, &grid.blocks, &self.frame, &self.liquids, &mut surface.level);
        balls::sweep(&self.team, &grid.blocks, &grid.open_cell, &mut surface.level, &mut nodes.balls);
        let kind = |(level, open): (&f64, &f64)| match (*open > 0.5, *level < 0.0) {
            (false, _) => SOLID,
            (true, true) => LIQUID,
            (true, false) => AIR,
        };
        surface.kind.clear();
        surface.kind.extend(surface.level.iter().zip(&grid.open_cell).map(kind));
        // Faces of walls on lines of the grid are open or closed.
        grid.open.iter_mut().flatten().for_each(|open| *open = open.round());
    }

    /// Apply the body force, the viscous stress of the particles and the walls; find the pressure at the surface.
    fn force_nodes(&mut self, fluid: Fluid, dt: f64, nodes: &mut Nodes<D>) {
        let force = self.force(self.clock.time);
        let h = self.frame.h;
        let mut impulse = nodes.hold();
        if fluid.viscosity > 0.0 {
            let at = (&self.grid.blocks, &self.frame);
            let power = transfer::add_stress(&self.team, at, &self.liquids, (fluid, dt), nodes);
            self.book_heat(power * dt);
        }
        for (v, _) in nodes.velocity.iter_mut().zip(&nodes.volume).filter(|(_, volume)| **volume > 0.0) {
            (0..D).for_each(|d| v[d] += dt * force[d]);
        }
        add_up(&mut impulse, &nodes.hold());
        let mass = fluid.density * h.powi(D as i32);
        add_to(&mut self.exchange.impulse, &impulse.map(|sum| mass * sum));
        let grid = &mut self.grid;
        grid.jump.clear();
        if fluid.tension > 0.0 {
            let scale = fluid.tension / h * dt / (fluid.density * h);
            balls::curvature(&self.team, &grid.blocks, (&grid.surface.level, scale), &mut grid.jump);
        }
        operators::extrapolate(&self.team, &grid.blocks, nodes);
        nodes.hold();
    }

    /// Solve for the pressure, subtract its gradient at the nodes, and filter the hourglass modes.
    fn project_nodes(&mut self, with: SemiStaggered, nodes: &mut Nodes<D>) -> Result<(), StepError> {
        let mut system = std::mem::take(&mut self.grid.system);
        let mut q = std::mem::take(&mut self.grid.pressure);
        let mut right = std::mem::take(&mut self.grid.right);
        q.clear();
        q.resize(self.grid.blocks.cells(), 0.0);
        let jump = (!self.grid.jump.is_empty()).then_some(&self.grid.jump[..]);
        let at = Cells { surface: jump, ..self.cells() };
        operators::divergence(&self.team, &at, &nodes.velocity, &mut right);
        let speed = self.speed + 1e-3 * self.frame.h;
        let stop = Stop {
            relative: self.options.tolerance,
            absolute: 1e-14 * speed * (system.unknowns as f64).sqrt(),
            ..Stop::default()
        };
        let solved = system.solve(&self.team, &at, &right, &mut q, &stop, &|_, _| ());
        if solved.is_ok() {
            operators::subtract_gradient(&self.team, &at, &q, &mut nodes.velocity);
            nodes.hold();
            nodes.spare.clone_from(&nodes.velocity);
            operators::filter(&self.team, &at, with.hourglass, &nodes.spare, &mut nodes.velocity);
            nodes.hold();
        }
        let grid = &mut self.grid;
        (grid.right, grid.system, grid.pressure) = (right, system, q);
        match solved {
            Ok(iterations) => {
                self.grid.system.iterations = [iterations, 0];
                operators::find_change(nodes);
                operators::extrapolate(&self.team, &self.grid.blocks, nodes);
                nodes.hold();
                Ok(())
            }
            Err(error) => Err(self.unsolved("the pressure equation", &error)),
        }
    }

    fn gather_from_nodes(
        &mut self,
        with: SemiStaggered,
        dt: f64,
        nodes: &Nodes<D>,
    ) -> Result<Vec<Sums<D>>, StepError> {
        let mut liquids = std::mem::take(&mut self.liquids);
        let grid = &self.grid;
        let gather = NodalGather { grid, frame: &self.frame, nodes, pic: with.pic, dt };
        let sums: Vec<_> = liquids.iter_mut().map(|l| gather.run(&self.team, l)).collect();
        self.liquids = liquids;
        self.check_sums(&sums)?;
        Ok(sums)
    }

    /// Largest divergence of the nodal velocity at liquid cells times the width of a cell, m/s.
    pub(crate) fn divergence_at_nodes(&self, nodes: &Nodes<D>) -> f64 {
        let mut right = Vec::new();
        operators::divergence(&self.team, &self.cells(), &nodes.velocity, &mut right);
        right.iter().fold(0.0, |most, r| most.max(r.abs()))
    }
}
