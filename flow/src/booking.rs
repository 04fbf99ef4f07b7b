//! Balances of a step.

use crate::blocks::Blocks;
use crate::gather::Sums;
use crate::grid::Grid;
use crate::solver::{Flow, add_to};
use crate::surface::LIQUID;
use crate::transfer::face_centre;
use crate::wall::Walls;

impl<const D: usize> Flow<D> {
    /// Book the impulse and the work of the walls: that on the mass at closed faces, which gets the velocity of the wall, and that of the
    /// pressure. Impulses act from the middle of the last step to that of this one: their work is by the mean velocity of the wall in both.
    /// q times `scale` is an impulse per area, N s/m^2; over a cell, it is the momentum of a velocity q.
    pub(crate) fn book_walls(&mut self, scale: f64, walls: &Walls<'_, D>) {
        let (grid, cells) = (&self.grid, Blocks::<D>::CELLS);
        let area = self.frame.h.powi(D as i32 - 1);
        let beside = |slot: Option<usize>| slot.is_some_and(|s| grid.surface.kind[s] == LIQUID);
        for (b, cut) in grid.cuts.iter().enumerate() {
            let Some(cut) = cut else { continue };
            for (i, d) in (0..cells).flat_map(|i| (0..D).map(move |d| (i, d))) {
                let slot = b * cells + i;
                if grid.open[d][slot] <= 0.0
                    && grid.volume[d][slot] > 0.0
                    && (beside(Some(slot)) || beside(grid.blocks.beside(b, i, d, false)))
                {
                    let (mut wall, mut mean) = (0.0, 0.0);
                    if walls.moving() {
                        let at = face_centre::<D>(i, d);
                        let x = self.frame.place(&grid.blocks.keys[b], &at);
                        let n = cut.wall_at(walls, &at, cut.sample(&at).2, &x);
                        if walls.list[n].follows() {
                            continue;
                        }
                        wall = walls.velocity(n, &x, d);
                        mean = wall + mean_of(grid, d, slot) - grid.wall[d][slot];
                    }
                    let impulse = grid.volume[d][slot] * (wall - grid.velocity[d][slot]) * scale * area;
                    self.exchange.impulse[d] += impulse;
                    self.exchange.work += impulse * mean;
                }
            }
        }
        self.book_pressure_on_walls(scale, walls);
    }

    /// Book the impulse and the work of the pressure on walls; q times `scale` is an impulse per area, N s/m^2.
    pub(crate) fn book_pressure_on_walls(&mut self, scale: f64, walls: &Walls<'_, D>) {
        let (grid, cells) = (&self.grid, Blocks::<D>::CELLS);
        let area = self.frame.h.powi(D as i32 - 1);
        for (b, _) in grid.cuts.iter().enumerate().filter(|(_, cut)| cut.is_some()) {
            for i in (0..cells).filter(|i| grid.surface.kind[b * cells + i] == LIQUID) {
                let impulse = (grid.pressure[b * cells + i] * scale) * area;
                for d in 0..D {
                    let low = b * cells + i;
                    let Some(up) = grid.blocks.beside(b, i, d, true) else { continue };
                    let open = &grid.open[d];
                    if self.moves_bodies() {
                        // Closed parts of walls that are no free bodies.
                        for (slot, sign) in [(low, -1.0), (up, 1.0)] {
                            let Some(cut) = &grid.cuts[slot / cells] else { continue };
                            let n = cut.sample(&face_centre::<D>(slot % cells, d)).2;
                            if open[slot] < 1.0 && !walls.list[n].follows() {
                                let closed = impulse * sign * (1.0 - open[slot]);
                                let wall = if grid.wall[d].is_empty() { 0.0 } else { mean_of(grid, d, slot) };
                                self.exchange.impulse[d] -= closed;
                                self.exchange.work -= closed * wall;
                            }
                        }
                        continue;
                    }
                    self.exchange.impulse[d] += impulse * (open[up] - open[low]);
                    if !grid.wall[d].is_empty() {
                        let (a, b) = (mean_of(grid, d, low), mean_of(grid, d, up));
                        self.exchange.work += impulse * ((1.0 - open[low]) * a - (1.0 - open[up]) * b);
                    }
                }
            }
        }
    }

    /// Book the body force over a step of `dt` seconds, and the momentum that the transfer lost. The work is that of the mean of the forces at
    /// both ends, as the kinetic energy is that of the ends: with the force at the start alone it is off by dt / 2 of force times acceleration,
    /// which adds up where the force swings.
    pub(crate) fn book(&mut self, sums: &[Sums<D>], dt: f64, kick: f64) {
        let force = self.force(self.clock.time);
        let mean = self.mean_force(dt);
        self.speed = sums.iter().fold(0.0, |speed, s| speed.max(s.speed));
        let walls = self.exchange.impulse;
        let mut change = [0.0; 3];
        for (liquid, sum) in self.liquids.iter_mut().zip(sums) {
            let volume: f64 = liquid.particles.iter().map(|p| p.volume).sum();
            let mass = liquid.density * volume;
            liquid.acceleration = liquid.density * sum.change / (kick * kick);
            let mut load = [0.0; D];
            for d in 0..D {
                let gained = liquid.density * (sum.after[d] - sum.before[d]);
                liquid.momentum_rate[d] = gained / kick;
                change[d] += gained;
                load[d] = mass * force[d] * kick;
                self.exchange.work += liquid.density * sum.moved[d] * mean[d];
            }
            add_to(&mut self.exchange.load, &load);
            (0..D).for_each(|d| change[d] -= load[d]);
        }
        let field = self.book_load_of_field();
        let bodies = self.change_of_bodies(kick);
        let passed = self.solids.as_ref().map_or([0.0; D], |solids| solids.passed);
        for d in 0..D {
            change[d] += bodies[d] + passed[d] - field[d];
            self.speed = self.rigid.iter().fold(self.speed, |speed, body| speed.max(body.speed()));
            self.speed = self.solids.iter().fold(self.speed, |speed, solids| speed.max(solids.speed()));
            self.exchange.dropped[d] += change[d] - (walls[d] - self.booked_walls[d]);
        }
        self.booked_walls = walls;
    }
}

/// Mean velocity of a wall at a face in the last step and in this one, m/s.
fn mean_of<const D: usize>(grid: &Grid<D>, d: usize, slot: usize) -> f64 {
    0.5 * (grid.wall[d][slot] + grid.wall_before[d][slot])
}
