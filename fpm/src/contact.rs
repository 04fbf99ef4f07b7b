//! A body as contact with others sees it. Cells have the numbers of their [`Cells`](crate::Cells) here.

use impactite_scene::{Archive, CheckpointError, Exchange, SceneError, Solver, StepError};
use impactite_simd::Team;
use mpm_contact::particles::{Advice, ContactParticle, Facing, ParticleBody};

use crate::cells::OuterFace;
use crate::method::Composition;
use crate::rest::PLACES;
use crate::solver::{ADVICE, Fpm, TOUCHED};
use crate::sums::BATCH;
use crate::vector::{along, apply, cofactor, scaled, with_identity};

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    fn place_of(&self, n: usize) -> usize {
        self.places[n] as usize
    }

    /// The faces of a cell on the surface.
    fn outer_of(&self, i: usize) -> impl Iterator<Item = &OuterFace<D>> {
        let first = self.surface.partition_point(|f| (f.cell as usize) < i);
        self.surface[first..].iter().take_while(move |f| f.cell as usize == i)
    }

    /// Areas of the faces of a cell that have nothing behind them, each times its outward normal, in the reference configuration, m^2.
    fn bare(&self, i: usize) -> [f64; D] {
        let sum = self.outer_of(i).fold([0.0; D], |sum, f| along(&sum, f.area, &f.normal));
        let open = self.sides.of(i).filter(|&s| !self.joins(i, s));
        open.fold(sum, |sum, s| along(&sum, 1.0, &self.sides.surface[s].area))
    }
}

impl<const D: usize, M: Composition<D>> ParticleBody<D> for Fpm<D, M> {
    fn particle(&self, n: usize) -> ContactParticle<D> {
        let i = self.place_of(n);
        ContactParticle {
            position: self.position(i),
            velocity: self.velocity[i],
            mass: self.mass[i],
            radius: 0.5 * self.sizes[i],
        }
    }

    fn may_touch(&self, n: usize) -> bool {
        let i = self.place_of(n);
        self.sides.of(i).any(|s| !self.joins(i, s)) || self.bare(i) != [0.0; D]
    }

    fn facing(&self, n: usize) -> Facing {
        let i = self.place_of(n);
        if !self.sides.of(i).any(|s| self.joins(i, s)) {
            return Facing::LONE;
        }
        // Nanson's formula.
        let area = apply(&cofactor(&with_identity(&self.traces[i].h)), &self.bare(i));
        let density = self.mass[i] / (self.volume[i] * self.batches[i / BATCH].said[i % BATCH][6]);
        let wide = |a: &[f64; D]| mpm_contact::vector::wide(a);
        Facing { area: wide(&area), mass: wide(&scaled(&area, density)), lone: false }
    }

    fn beyond(&self, n: usize) -> f64 {
        let i = self.place_of(n);
        let own = self
            .outer_of(i)
            .map(|f| (0..D).map(|d| (f.centroid[d] - self.reference[i][d]) * f.normal[d]).sum::<f64>());
        own.fold(0.0, f64::max)
    }

    fn around(&self, n: usize, visit: &mut dyn FnMut(usize)) {
        let i = self.place_of(n);
        let mut near: Vec<u32> =
            self.sides.of(i).filter(|&s| self.joins(i, s)).map(|s| self.sides.neighbour[s]).collect();
        near.push(i as u32);
        near.sort_unstable();
        near.dedup();
        near.into_iter().for_each(|j| visit(self.numbers[j as usize] as usize));
    }

    fn traction(&self, n: usize, normal: &[f64; 3]) -> f64 {
        let i = self.place_of(n);
        let said = &self.batches[i / BATCH].said[i % BATCH];
        let mut sum = 0.0;
        for a in 0..3 {
            for b in 0..3 {
                sum += normal[a] * said[PLACES[a][b]] * normal[b];
            }
        }
        sum
    }

    fn rate(&self) -> f64 {
        self.rate
    }
    fn check(&self, dt: f64) -> Result<(), SceneError> {
        self.check_loads(dt)
    }
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>) -> Result<(), StepError> {
        start.resize(self.velocity.len(), [0.0; D]);
        for (v, &n) in self.velocity.iter().zip(&self.numbers) {
            start[n as usize] = *v;
        }
        Fpm::accelerate(self, dt);
        Ok(())
    }
    fn push(&mut self, n: usize, impulse: &[f64; 3]) {
        let i = self.place_of(n);
        for d in 0..D {
            self.velocity[i][d] += impulse[d] / self.mass[i];
            if impulse[d] != 0.0 {
                self.batches[i / BATCH].held[i % BATCH] |= TOUCHED << d;
            }
        }
    }
    fn advance(&mut self, dt: f64, _: &[[f64; D]]) -> Result<(), StepError> {
        Fpm::advance(self, dt)
    }
    fn finish(&mut self, dt: f64) -> Result<(), StepError> {
        Fpm::finish(self, dt)
    }
    fn describe(&self) -> String {
        Solver::method(self)
    }
    fn exchange(&self) -> Exchange {
        Solver::exchange(self)
    }
    fn speed(&self) -> f64 {
        self.rest.speed
    }
    fn advice(&self) -> Advice {
        ADVICE
    }
    fn rename(&mut self, name: String) {
        self.name = name;
    }
    fn set_team(&mut self, team: Team) {
        Fpm::set_team(self, team);
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.archive_body(file)
    }
}
