//! Step of the scene: a list of stages.

use std::time::Instant;

use impactite_scene::{Cause, PointKind, StepError, Stopped};
use impactite_solve::Stop;

use crate::blocks::{Blocks, TILE_CELLS, in_tile, local, stride};
use crate::coupled::Column;
use crate::cuts::{Cuts, cut};
use crate::extrapolate::{CLOSED, Field, Reach, constrain, extrapolate, limit_at_corners, mark};
use crate::gather::{Gather, Sums};
use crate::pressure::{Cells, Place, PressureError, continue_into_walls, outflow, subtract_gradient, theta};
use crate::solver::{Flow, StepTimes, add_to};
use crate::surface::{self, AIR, LIQUID};
use crate::transfer::{face_centre, to_faces};
use crate::view::wide;
use crate::viscosity::Stress;
use crate::wall::{Wall, Walls};

/// Tolerance of the density correction, relative.
const CORRECTION_TOLERANCE: f64 = 1e-2;
/// Relative change of the volume of a cell in a step by the velocity that particles bring, up to which it comes from smooth motion.
const SMOOTH: f64 = 0.02;
/// Share of the first step in which walls have the velocity of their start.
const START: f64 = 1e-3;
/// Share of the divergence that is reflected. With all of it errors of the transfer alternate from step to step without decay: the forces of a
/// steady jet on a wall, 16 cells thick, were a hundred times its momentum flux to both sides. With 0.9 they are between a third and twice of it.
const REFLECTED: f64 = 0.9;
/// Largest density error that a step corrects, before the relaxation.
const LARGEST_ERROR: f64 = 0.5;
/// Excess of density that is no error beside air, where deficits are none either: the fraction there is the level of the surface.
const ALLOWED: f64 = 0.1;
/// Density error that is no error in cells whose kernels walls cut through cells: the few particles of the open part are no lattice.
const ALLOWED_AT_CUTS: f64 = 0.05;
/// Number of faces that are worked on at once.
const MANY: usize = 1 << 14;
/// Density errors below which no correction is made.
const NO_ERROR: f64 = 1e-9;

impl<const D: usize> Flow<D> {
    /// Make a step of `dt` seconds. Velocities are those of the middle between positions (leap-frog): forces act over the mean of the last
    /// step and this one.
    pub(crate) fn step(&mut self, dt: f64) -> Result<(), StepError> {
        let (time, nodal) = (self.clock.time, self.options.semi_staggered);
        // The semi-staggered scheme has the whole impulse of the first step, too.
        let kick = if nodal.is_some() { dt } else { self.lag + 0.5 * dt };
        let list = std::mem::take(&mut self.walls);
        let skins = self.solids.as_mut().map_or(Vec::new(), |solids| std::mem::take(&mut solids.skins));
        let mut walls = Walls::at(&list, (&self.rigid, &skins), time, dt);
        if let Some(solids) = &self.solids {
            walls.velocities.clone_from(&solids.velocities);
        }
        let stepped = match nodal {
            None => self.stages(dt, kick, &mut walls),
            Some(with) => self.stages_at_nodes(with, dt, &mut walls),
        };
        self.walls = list;
        if let (Some(solids), Err(_)) = (&mut self.solids, &stepped) {
            solids.skins = skins;
        }
        let sums = stepped?;
        self.book(&sums, dt, kick);
        self.lag = 0.5 * dt;
        self.clock.advance(dt);
        let force = self.force(self.clock.time);
        for liquid in &mut self.liquids {
            (liquid.lag, liquid.force) = (self.lag, force);
        }
        for body in &mut self.rigid {
            (body.lag, body.force) = (self.lag, force);
        }
        Ok(())
    }

    /// Run a stage, and measure its wall time if times are measured.
    pub(crate) fn part<R>(
        &mut self,
        of: impl Fn(&mut StepTimes) -> &mut f64,
        work: impl FnOnce(&mut Self) -> R,
    ) -> R {
        if self.times.is_none() {
            return work(self);
        }
        let start = Instant::now();
        let result = work(self);
        if let Some(times) = &mut self.times {
            *of(times) += start.elapsed().as_secs_f64();
        }
        result
    }

    fn stages(&mut self, dt: f64, kick: f64, walls: &mut Walls<'_, D>) -> Result<Vec<Sums<D>>, StepError> {
        self.part(|t| &mut t.sort, |f| f.sort(walls))?;
        self.part(|t| &mut t.scatter, Self::scatter);
        self.part(|t| &mut t.surface, Self::find_surface);
        self.part(|t| &mut t.pressure, Self::assemble)?;
        self.part(|t| &mut t.forces, |f| f.apply_forces(dt, kick, walls))?;
        self.part(|t| &mut t.pressure, |f| f.project_with_bodies(dt, kick, walls))?;
        let corrected = self.part(|t| &mut t.density, |f| f.correct_density(dt))?;
        let scale = self.fluid.map_or(0.0, |fluid| fluid.density) * self.frame.h / kick;
        self.part(|t| &mut t.forces, |f| f.book_walls(kick * scale, walls));
        self.part(|t| &mut t.extrapolation, |f| f.extend_velocities(walls));
        self.hold_pockets(walls);
        self.move_bodies(dt, kick);
        self.settle_solids(walls)?;
        self.finish_pressure(scale);
        self.part(|t| &mut t.gather, |f| f.gather(dt, walls, corrected))
    }

    /// Apply body force, viscosity and surface tension to the velocity that particles brought.
    fn apply_forces(&mut self, dt: f64, kick: f64, walls: &Walls<'_, D>) -> Result<(), StepError> {
        self.surround_bodies(walls);
        self.find_advected_divergence(dt, walls);
        // Viscosity in the middle of the impulse: of second order.
        self.apply_body_force(0.5 * kick);
        self.find_jump(kick);
        self.apply_viscosity(kick, walls)?;
        self.apply_body_force(0.5 * kick);
        let grid = &mut self.grid;
        for (before, velocity) in grid.before.iter_mut().zip(&grid.velocity) {
            before.resize(velocity.len(), 0.0);
            let mut pieces: Vec<&[f64]> = velocity.chunks(MANY).collect();
            self.team.each_piece(before, MANY, &mut pieces, |_, before, velocity| {
                before.copy_from_slice(velocity);
            });
        }
        Ok(())
    }

    /// Start to measure the wall times of the stages of steps.
    pub fn measure_times(&mut self) {
        self.times = Some(StepTimes::default());
    }
    /// Wall times of the stages since [`Flow::measure_times`]; none if they are not measured.
    pub fn times(&self) -> Option<StepTimes> {
        self.times
    }

    /// Sort the particles into blocks, and cut the cells by the walls.
    pub(crate) fn sort(&mut self, walls: &Walls<'_, D>) -> Result<(), StepError> {
        let mut occupied = Vec::new();
        for (body, liquid) in self.liquids.iter_mut().enumerate() {
            let found = liquid.occupied(&self.team, &self.frame, &mut occupied);
            if let Err(n) = found {
                return Err(self.failed(body, n, Cause::TooFast));
            }
        }
        let blocks = Blocks::around(occupied, self.frame.period);
        self.liquids.iter_mut().for_each(|l| l.sort(&self.team, &blocks));
        let grid = &mut self.grid;
        let cuts = cut(&blocks, (&grid.blocks, &grid.cuts), &self.options.lattice, walls);
        (grid.blocks, grid.cuts) = (blocks, cuts);
        let open = (&mut grid.open, &mut grid.open_cell, &mut grid.uneven);
        surface::open_fractions(&grid.blocks, &grid.cuts, open);
        Ok(())
    }

    fn scatter(&mut self) {
        let grid = &mut self.grid;
        let fields = (&mut grid.volume, &mut grid.velocity);
        let scratch = &mut grid.scratch.transfer;
        to_faces(&self.team, &grid.blocks, &self.frame, &self.liquids, scratch, fields);
    }

    fn find_surface(&mut self) {
        let moves_bodies = self.moves_bodies();
        let grid = &mut self.grid;
        let walls = (&grid.cuts, &grid.open, &grid.open_cell[..], &grid.uneven[..]);
        surface::find(&self.team, &grid.blocks, walls, &grid.volume, &grid.profile, &mut grid.surface);
        if moves_bodies {
            grid.pockets = surface::open_pockets(&grid.blocks, &grid.cuts, &grid.open, &mut grid.surface);
        }
        self.mark_faces();
    }

    /// Mark the faces by the kinds of the cells beside them.
    pub(crate) fn mark_faces(&mut self) {
        let grid = &mut self.grid;
        for d in 0..D {
            let at = (&grid.surface.kind[..], &grid.open[d][..], &grid.volume[d][..]);
            mark(&self.team, &grid.blocks, at, d, &mut grid.marks[d]);
        }
    }

    /// Find what the reflection adds to the right-hand side of the pressure equation: the divergence of the velocity that particles brought,
    /// once more, where it is small enough to come from smooth motion and not from an impact. Liquid that fills a closed region has no impact.
    /// Walls have their velocities of the last step in it, as the liquid has: with those of this step, liquid would be ahead of a wall that
    /// gets faster, by half a step.
    fn find_advected_divergence(&mut self, dt: f64, walls: &Walls<'_, D>) {
        let mut once_more = std::mem::take(&mut self.grid.advected);
        if walls.moving() {
            let (time, bodies) = (self.clock.time, (&self.rigid[..], walls.skins));
            let mut last = match self.clock.last {
                Some(last) => Walls::at(walls.list, bodies, time - last, last),
                // Velocities at the start.
                None => Walls::at(walls.list, bodies, time, START * dt),
            };
            // Velocities of the last step, at the places of this one.
            last.poses.clone_from(&walls.poses);
            last.velocities.clone_from(&walls.velocities);
            self.find_wall_velocities(&last);
            self.grid.wall_before.clone_from(&self.grid.wall);
        }
        if self.options.reflection {
            outflow(&self.team, &self.cells(), &self.grid.velocity, self.wall_velocities(), &mut once_more);
            self.subtract_bodies(&mut once_more);
            let scale = if self.grid.system.is_singular() { 0.0 } else { dt / self.frame.h };
            for r in &mut once_more {
                *r *= REFLECTED * (2.0 - r.abs() * scale / SMOOTH).clamp(0.0, 1.0);
            }
            // The motion of light surfaces within a cell is not smooth in time.
            if let Some(solids) = &self.solids {
                solids.wetted.clear(&mut once_more);
            }
        } else {
            once_more.clear();
        }
        self.find_wall_velocities(walls);
        self.grid.advected = once_more;
    }

    fn wall_velocities(&self) -> Option<&[Vec<f64>; D]> {
        (!self.grid.wall[0].is_empty()).then_some(&self.grid.wall)
    }

    fn apply_body_force(&mut self, kick: f64) {
        let force = self.force(self.clock.time);
        let mut pieces = vec![(); self.grid.blocks.cells().div_ceil(MANY)];
        for d in 0..D {
            let by = kick * force[d];
            if by != 0.0 {
                self.team.each_piece(&mut self.grid.velocity[d], MANY, &mut pieces, |_, velocity, ()| {
                    velocity.iter_mut().for_each(|u| *u += by);
                });
            }
        }
        self.apply_field(kick);
    }

    /// Find the pressure at the surface by surface tension, sigma kappa, in the unit of q.
    fn find_jump(&mut self, kick: f64) {
        let grid = &mut self.grid;
        grid.jump.clear();
        let Some(fluid) = self.fluid.filter(|fluid| fluid.tension > 0.0) else { return };
        let walls = grid.cuts.iter().any(Option::is_some);
        let at = (&grid.surface.fraction[..], walls.then_some((&grid.open, &grid.open_cell[..])));
        grid.tension.find(&self.team, &grid.blocks, at, &grid.profile);
        let h = self.frame.h;
        let scale = fluid.tension / h * kick / (fluid.density * h);
        grid.jump.extend(grid.tension.curvature.iter().map(|kappa| kappa * scale));
    }

    /// Apply the viscous stress, and book its heat and the impulse of walls.
    fn apply_viscosity(&mut self, kick: f64, walls: &Walls<'_, D>) -> Result<(), StepError> {
        let Some(fluid) = self.fluid.filter(|fluid| fluid.viscosity > 0.0) else { return Ok(()) };
        let h = self.frame.h;
        let stick = self.sticking_faces(walls);
        let mut jump = std::mem::take(&mut self.grid.jump);
        let grid = &self.grid;
        let stress = Stress {
            blocks: &grid.blocks,
            kind: &grid.surface.kind,
            level: &grid.surface.level,
            marks: &grid.marks,
            open: &grid.open,
            stick: &stick,
            wall: &grid.wall,
            number: fluid.viscosity * kick / (fluid.density * h * h),
        };
        let mut u: Vec<f64> = grid.velocity.iter().flatten().copied().collect();
        let stepped = stress.step(&self.team, &mut u);
        let mut work = 0.0;
        if stress.bears() {
            let mut pressure = vec![0.0; grid.blocks.cells()];
            stress.add_surface_pressure(&self.team, &u, &mut pressure);
            work = stress.work_at_surface(&u, &pressure);
            if jump.is_empty() {
                jump = pressure;
            } else {
                jump.iter_mut().zip(&pressure).for_each(|(jump, p)| *jump += p);
            }
        }
        self.grid.jump = jump;
        let (impulse, lost) = stepped.map_err(|error| {
            self.clock.stopped(Stopped::Solve { what: "the viscous step", why: error.to_string() })
        })?;
        let (count, mass) = (self.grid.blocks.cells(), fluid.density * h.powi(D as i32));
        for d in 0..D {
            self.grid.velocity[d].copy_from_slice(&u[d * count..(d + 1) * count]);
        }
        let (impulse, heat) = (impulse.map(|sum| mass * sum), mass * (lost + work));
        add_to(&mut self.exchange.impulse, &impulse);
        self.book_heat(heat);
        Ok(())
    }

    /// Book heat of viscosity, J, to the liquids by their volumes.
    pub(crate) fn book_heat(&mut self, heat: f64) {
        let volume = |l: &crate::particles::Liquid<D>| l.particles.iter().map(|p| p.volume).sum::<f64>();
        let total: f64 = self.liquids.iter().map(volume).sum();
        self.liquids.iter_mut().for_each(|l| l.heat += heat * volume(l) / total);
    }

    /// Closed faces of walls without slip, as 1; empty if there are none.
    fn sticking_faces(&self, walls: &Walls<'_, D>) -> [Vec<f64>; D] {
        let (grid, cells) = (&self.grid, Blocks::<D>::CELLS);
        std::array::from_fn(|d| {
            if !walls.list.iter().any(Wall::is_no_slip) {
                return Vec::new();
            }
            let mut list = vec![0.0; grid.blocks.cells()];
            for (b, cut) in grid.cuts.iter().enumerate() {
                let Some(cut) = cut else { continue };
                for i in (0..cells).filter(|i| grid.open[d][b * cells + i] <= 0.0) {
                    let wall = cut.sample(&face_centre::<D>(i, d)).2;
                    list[b * cells + i] = if walls.list[wall].is_no_slip() { 1.0 } else { 0.0 };
                }
            }
            list
        })
    }

    /// Find the velocities of walls at faces, if any wall moves.
    fn find_wall_velocities(&mut self, walls: &Walls<'_, D>) {
        let (grid, cells) = (&mut self.grid, Blocks::<D>::CELLS);
        for list in &mut grid.wall {
            list.clear();
        }
        if !walls.moving() {
            return;
        }
        for (d, list) in grid.wall.iter_mut().enumerate() {
            list.resize(grid.blocks.cells(), 0.0);
            for (b, cut) in grid.cuts.iter().enumerate() {
                let Some(cut) = cut else { continue };
                for i in 0..cells {
                    let at = face_centre::<D>(i, d);
                    let x = self.frame.place(&grid.blocks.keys[b], &at);
                    let wall = cut.wall_at(walls, &at, cut.sample(&at).2, &x);
                    // Free bodies are added by the rows of their cells.
                    if !walls.list[wall].follows() {
                        let face = (&at, d, 1.0 - grid.open[d][b * cells + i]);
                        let mean = cut.closed_velocity(walls, face, (&x, self.frame.h));
                        list[b * cells + i] = mean.unwrap_or_else(|| walls.velocity(wall, &x, d));
                    }
                }
            }
        }
    }

    pub(crate) fn cells(&self) -> Cells<'_, D> {
        let grid = &self.grid;
        let (kind, level) = (&grid.surface.kind[..], &grid.surface.level[..]);
        Cells { blocks: &grid.blocks, kind, level, open: &grid.open, surface: None }
    }

    pub(crate) fn unsolved(&self, what: &'static str, why: &PressureError) -> StepError {
        self.clock.stopped(Stopped::Solve { what, why: why.to_string() })
    }

    pub(crate) fn assemble(&mut self) -> Result<(), StepError> {
        let mut system = std::mem::take(&mut self.grid.system);
        let periodic = self.frame.period.iter().any(|p| *p > 0);
        let assembled = system.assemble(&self.team, &self.cells(), periodic);
        self.grid.system = system;
        assembled.map_err(|error| self.unsolved("the pressure equation", &error))
    }

    /// Turn q into the pressure, Pa. Air has that of the surface; cells within walls continue that of the liquid beside them.
    pub(crate) fn finish_pressure(&mut self, scale: f64) {
        let (grid, ambient) = (&mut self.grid, self.options.ambient);
        for (n, p) in grid.pressure.iter_mut().enumerate() {
            let q =
                if grid.surface.kind[n] == LIQUID { *p } else { grid.jump.get(n).copied().unwrap_or(0.0) };
            *p = ambient + q * scale;
        }
        continue_into_walls(&grid.blocks, &grid.surface.kind, &mut grid.pressure);
    }

    /// Solve for the pressure, and make the velocity free of divergence.
    pub(crate) fn project(&mut self) -> Result<(), StepError> {
        let mut right = std::mem::take(&mut self.grid.right);
        let mut system = std::mem::take(&mut self.grid.system);
        let mut q = std::mem::take(&mut self.grid.pressure);
        let mut velocity = std::mem::replace(&mut self.grid.velocity, crate::blocks::faces());
        q.clear();
        q.resize(self.grid.blocks.cells(), 0.0);
        let jump = (!self.grid.jump.is_empty()).then_some(&self.grid.jump[..]);
        let at = Cells { surface: jump, ..self.cells() };
        outflow(&self.team, &at, &velocity, self.wall_velocities(), &mut right);
        self.subtract_bodies(&mut right);
        right.iter_mut().zip(&self.grid.advected).for_each(|(r, more)| *r += more);
        // The rounding of velocities at the faces of all cells.
        let speed = self.speed + 1e-3 * self.frame.h;
        let absolute = 1e-14 * speed * (system.unknowns as f64).sqrt();
        let stop = Stop { relative: self.options.tolerance, absolute, ..Stop::default() };
        let unit = self.unit();
        let columns = |place: &Place<'_>, into: &mut Vec<Column>| {
            self.couplings.iter().for_each(|coupling| coupling.columns(unit, place, into));
        };
        let solved = system.solve(&self.team, &at, &right, &mut q, &stop, &columns);
        if solved.is_ok() {
            subtract_gradient(&self.team, &at, &q, &mut velocity);
        }
        let grid = &mut self.grid;
        (grid.right, grid.system, grid.pressure, grid.velocity) = (right, system, q, velocity);
        match solved {
            Ok(iterations) => {
                self.grid.system.iterations[0] = iterations;
                Ok(())
            }
            Err(error) => Err(self.unsolved("the pressure equation", &error)),
        }
    }

    /// Find the displacement that restores the density, and return whether there is any: div dx = (rho - rho0) / rho0, dx = -grad q.
    fn correct_density(&mut self, dt: f64) -> Result<bool, StepError> {
        if self.options.correction == 0.0 || self.grid.system.unknowns == 0 {
            return Ok(false);
        }
        let mut right = std::mem::take(&mut self.grid.right);
        let largest = self.density_errors(self.correction(dt), &mut right);
        if largest < NO_ERROR {
            self.grid.right = right;
            self.grid.system.iterations[1] = 0;
            return Ok(false);
        }
        let mut system = std::mem::take(&mut self.grid.system);
        let mut q = std::mem::take(&mut self.grid.potential);
        let mut shift = std::mem::replace(&mut self.grid.shift, crate::blocks::faces());
        q.clear();
        q.resize(self.grid.blocks.cells(), 0.0);
        let at = self.cells();
        // A closed region keeps its volume: the mean of its errors is no error.
        let stop =
            Stop { relative: CORRECTION_TOLERANCE, absolute: NO_ERROR, incompatible: 1.0, ..Stop::default() };
        let solved = system.solve(&self.team, &at, &right, &mut q, &stop, &|_, _| ());
        for list in &mut shift {
            list.clear();
            list.resize(at.blocks.cells(), 0.0);
        }
        if solved.is_ok() {
            subtract_gradient(&self.team, &at, &q, &mut shift);
        }
        let grid = &mut self.grid;
        (grid.right, grid.system, grid.potential, grid.shift) = (right, system, q, shift);
        match solved {
            Ok(iterations) => {
                self.grid.system.iterations[1] = iterations;
                Ok(true)
            }
            Err(error) => Err(self.unsolved("the density correction", &error)),
        }
    }

    /// Relaxed density error of each liquid cell, against the fraction at its distance from the surface. Return the largest magnitude.
    fn density_errors(&self, relaxation: f64, right: &mut Vec<f64>) -> f64 {
        let (grid, cells) = (&self.grid, Blocks::<D>::CELLS);
        let surface = &grid.surface;
        right.resize(grid.blocks.cells(), 0.0);
        let mut largest = vec![0.0f64; grid.blocks.len()];
        self.team.each_piece(right, cells, &mut largest, |b, right, largest| {
            right.fill(0.0);
            if !surface.kind[b * cells..(b + 1) * cells].contains(&LIQUID) {
                return;
            }
            let (mut kind, mut level) = ([0; TILE_CELLS], [0.0; TILE_CELLS]);
            grid.blocks.load(b, &surface.kind, AIR, &mut kind);
            grid.blocks.load(b, &surface.level, 1.0, &mut level);
            for (i, right) in right.iter_mut().enumerate() {
                let slot = b * cells + i;
                if surface.kind[slot] != LIQUID {
                    continue;
                }
                let mut error = if surface::beside_air::<D>(&kind, in_tile(&local::<D>(i))) {
                    (surface.fraction[slot] - 1.0 - ALLOWED).max(0.0)
                } else {
                    surface.fraction[slot] - grid.profile.fraction(depth::<D>(&kind, &level, i))
                };
                if grid.uneven.get(slot).is_some_and(|by| *by != [0.0; 4]) {
                    error -= error.clamp(-ALLOWED_AT_CUTS, ALLOWED_AT_CUTS);
                }
                error = error.clamp(-LARGEST_ERROR, LARGEST_ERROR);
                *right = relaxation * error * grid.open_cell[slot];
                *largest = largest.max(error.abs());
            }
        });
        largest.into_iter().fold(0.0, f64::max)
    }

    /// Extrapolate the velocities beyond the liquid, and apply the walls.
    fn extend_velocities(&mut self, walls: &Walls<'_, D>) {
        let (grid, team) = (&mut self.grid, &self.team);
        let corrected = grid.shift[0].len() == grid.blocks.cells();
        for reach in [Reach::Closed, Reach::Beyond] {
            for d in 0..D {
                grid.scratch.marks[d].clone_from(&grid.marks[d]);
                let mut fields = [
                    Field { values: &mut grid.velocity[d], before: Some(&grid.before[d]) },
                    Field { values: &mut grid.shift[d], before: None },
                ];
                let fields = &mut fields[..if corrected { 2 } else { 1 }];
                let faces = (&grid.volume[d][..], &mut grid.scratch.marks[d][..]);
                extrapolate(team, &grid.blocks, reach, fields, faces, &mut grid.scratch.extrapolate[d]);
            }
            if reach == Reach::Closed {
                let velocity = &grid.velocity;
                start_at_closed_faces(&grid.cuts, &grid.marks, &grid.volume, velocity, &mut grid.before);
            }
            let at = (&grid.cuts, &grid.open, &grid.scratch.marks);
            let held = &mut grid.scratch.held;
            constrain(team, &grid.blocks, at, reach, (walls, true, &self.frame), &mut grid.velocity, held);
            if corrected {
                constrain(team, &grid.blocks, at, reach, (walls, false, &self.frame), &mut grid.shift, held);
            }
        }
        let walls = (&grid.cuts, &grid.open, &grid.open_cell[..]);
        limit_at_corners(&grid.blocks, walls, &mut grid.velocity);
    }

    fn gather(&mut self, dt: f64, walls: &Walls<'_, D>, corrected: bool) -> Result<Vec<Sums<D>>, StepError> {
        let places = self.before_motion()?;
        let mut liquids = std::mem::take(&mut self.liquids);
        let place = (&self.rigid[..], self.skins());
        let ends = walls.moving().then(|| Walls::at(walls.list, place, self.clock.time + dt, 0.0));
        let grid = &self.grid;
        let gather = Gather {
            blocks: &grid.blocks,
            frame: &self.frame,
            cuts: &grid.cuts,
            velocity: &grid.velocity,
            shift: corrected.then_some(&grid.shift),
            pressure: &grid.pressure,
            walls: ends.as_ref(),
            midpoint: !self.options.reflection,
            dt,
        };
        let sums: Vec<_> = liquids.iter_mut().map(|l| gather.run(&self.team, l)).collect();
        self.liquids = liquids;
        self.check_sums(&sums)?;
        self.book_field(&places, dt)?;
        Ok(sums)
    }

    /// Check that all particles have moved, and by no more than the grid around them.
    pub(crate) fn check_sums(&self, sums: &[Sums<D>]) -> Result<(), StepError> {
        for (body, sum) in sums.iter().enumerate() {
            if let Some(n) = sum.failed {
                let finite = self.liquids[body].particles[n].v.iter().all(|v| v.is_finite());
                return Err(self.failed(body, n, if finite { Cause::TooFast } else { Cause::Velocity }));
            }
        }
        Ok(())
    }

    pub(crate) fn failed(&self, body: usize, n: usize, cause: Cause) -> StepError {
        let liquid = &self.liquids[body];
        let p = &liquid.particles[n];
        self.clock.stopped(Stopped::Point {
            kind: PointKind::Particle,
            body: liquid.name.clone(),
            number: p.number as usize,
            position: wide(&p.x),
            law: "incompressible liquid",
            cause,
        })
    }

    /// Volume within the surface at the start of the last step, m^3 (m^2 in the plane): that of the level set, by the liquid share of each
    /// cell. Particles keep their volumes; this is the volume that they occupy.
    pub fn liquid_volume(&self) -> f64 {
        let grid = &self.grid;
        let cell = self.frame.h.powi(D as i32);
        let share = |(level, open): (&f64, &f64)| (0.5 - level).clamp(0.0, 1.0) * open;
        grid.surface.level.iter().zip(&grid.open_cell).map(share).sum::<f64>() * cell
    }

    /// Iterations of the last step: of the pressure equation and of the density correction.
    pub fn iterations(&self) -> [usize; 2] {
        self.grid.system.iterations
    }

    /// Largest net outflow of a liquid cell in the last step over the area of a face, m/s: of the velocity at the time of the positions at
    /// its start, which is the mean of those in the middles of the steps before and after. In the semi-staggered scheme that of the nodal
    /// velocity at its end.
    pub fn largest_divergence(&self) -> f64 {
        if let Some(nodes) = &self.nodes {
            return self.divergence_at_nodes(nodes);
        }
        let mut right = Vec::new();
        outflow(&self.team, &self.cells(), &self.grid.velocity, self.wall_velocities(), &mut right);
        for (body, around) in self.rigid.iter().zip(&self.around) {
            around.subtract_outflow(&body.solved, &mut right);
        }
        self.swept.iter().for_each(|(cell, by)| right[*cell as usize] -= by);
        right.iter_mut().zip(&self.grid.advected).for_each(|(r, more)| *r += more);
        right.iter().fold(0.0, |most, r| most.max(r.abs()))
    }
}

/// Take the velocities of closed faces of liquid cells without liquid as those before the projection: they have changed by nothing.
fn start_at_closed_faces<const D: usize>(
    cuts: &Cuts<D>,
    marks: &[Vec<u8>; D],
    volume: &[Vec<f64>; D],
    velocity: &[Vec<f64>; D],
    before: &mut [Vec<f64>; D],
) {
    let cells = Blocks::<D>::CELLS;
    for (b, _) in cuts.iter().enumerate().filter(|(_, cut)| cut.is_some()) {
        for slot in b * cells..(b + 1) * cells {
            for d in (0..D).filter(|d| marks[*d][slot] == CLOSED && volume[*d][slot] <= 0.0) {
                before[d][slot] = velocity[d][slot];
            }
        }
    }
}

/// Distance from cell `i` to the surface along an axis, in cells, if it is less than two; else two.
fn depth<const D: usize>(kind: &[u8; TILE_CELLS], level: &[f64; TILE_CELLS], i: usize) -> f64 {
    let at = in_tile(&local::<D>(i));
    let mut least = 2.0f64;
    for d in 0..D {
        for [near, far] in [[at - stride(d), at - 2 * stride(d)], [at + stride(d), at + 2 * stride(d)]] {
            if kind[near] == LIQUID && kind[far] == AIR {
                least = least.min(1.0 + theta(level[near], level[far]));
            }
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FlowOptions, Fluid, Wall};
    use impactite_geometry::{Cuboid, Lattice};

    #[test]
    fn liquid_on_a_lattice_has_no_density_error() {
        let mut flow = Flow::new(FlowOptions::<2>::new(Lattice::new([0.0; 2], 1.0).unwrap()));
        flow.add_wall(Wall::container(Cuboid::new([0.0; 2], [9.0, 20.0]).unwrap())).unwrap();
        let block = Cuboid::new([0.0; 2], [9.0, 8.0]).unwrap();
        flow.add_shape("water", Fluid::new(1.0).unwrap(), &block, 2, |_| [0.0; 2]).unwrap();
        let walls = flow.walls.clone();
        let walls = Walls::at(&walls, (&[], &[]), 0.0, 1.0);
        flow.sort(&walls).unwrap();
        flow.scatter();
        flow.find_surface();
        let mut right = Vec::new();
        let largest = flow.density_errors(0.25, &mut right);
        for (slot, r) in right.iter().enumerate() {
            if r.abs() > 1e-12 {
                let cell = flow.grid.blocks.cell(slot / 16, slot % 16);
                panic!("{cell:?} {r} {}", flow.grid.surface.fraction[slot]);
            }
        }
        assert!(largest < 1e-14, "{largest}");
    }
}
