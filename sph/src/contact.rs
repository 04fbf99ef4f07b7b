//! Contact interface of a body. Particles have the numbers of the layout here.

use impactite_scene::{Archive, CheckpointError, Exchange, SceneError, Solver, StepError};
use impactite_simd::Team;
use mpm_contact::particles::{Advice, ContactParticle, Facing, ParticleBody, SurfacePoint};

use crate::kernel::Kernel as _;
use crate::matrix::inverse;
use crate::method::Composition;
use crate::solver::{PRESCRIBED, Sph, TOUCHED};
use crate::sums::BATCH;
use crate::tensors::PLACES;

/// Threshold of the colour function, the sum of V W over a particle and its neighbours: below it a particle is on the surface
/// \[Randles1996\]. The colour is 1 within a body, about 0.75 at a face.
const COLOUR: f64 = 0.9;

impl<const D: usize, M: Composition<D>> Sph<D, M> {
    fn place_of(&self, n: usize) -> usize {
        self.places[n] as usize
    }

    /// Return the colour of the particle at place `i`: the sum of V W over it and its neighbours.
    fn colour(&self, i: usize) -> f64 {
        let (records, kernel) = (&self.records, self.method.kernel());
        let norm = kernel.norm(D);
        let value = |q: f64, h: f64| norm * kernel.value(q) / h.powi(D as i32);
        let (own, h) = (&records.place[i], records.smoothing[i]);
        let mut sum = own[3] * value(0.0, h);
        for &j in self.batches[i / BATCH].near.of(i % BATCH).0 {
            let (other, mean) = (&records.place[j as usize], 0.5 * (h + records.smoothing[j as usize]));
            let square: f64 = (0..D).map(|d| (other[d] - own[d]).powi(2)).sum();
            sum += other[3] * value(square.sqrt() / mean, mean);
        }
        sum
    }
}

impl<const D: usize, M: Composition<D>> ParticleBody<D> for Sph<D, M> {
    fn particle(&self, n: usize) -> ContactParticle<D> {
        let i = self.place_of(n);
        ContactParticle {
            position: self.positions[i],
            velocity: self.velocity(i),
            mass: self.mass(i),
            radius: 0.5 * self.spacing[i],
        }
    }
    fn may_touch(&self, n: usize) -> bool {
        self.colour(self.place_of(n)) < COLOUR
    }

    fn facing(&self, n: usize) -> Facing {
        let i = self.place_of(n);
        let batch = &self.batches[i / BATCH];
        let (index, slope) = batch.near.of(i % BATCH);
        if index.is_empty() {
            return Facing::LONE;
        }
        if self.colour(i) >= COLOUR {
            return Facing::WITHIN;
        }
        let own = &self.records.place[i];
        let mut sum = [0.0; 3];
        for (&j, &s) in index.iter().zip(slope) {
            let other = &self.records.place[j as usize];
            for d in 0..D {
                sum[d] -= other[3] * s * (other[d] - own[d]);
            }
        }
        // Push forward from the reference to the present configuration, by Nanson's formula.
        if let Some(f) = batch.deformation.get(i % BATCH) {
            let inverse = inverse(f, D);
            let of_reference = sum;
            for d in 0..D {
                sum[d] = (0..D).map(|c| inverse[c][d] * of_reference[c]).sum();
            }
        }
        let volume = self.reference[i] * batch.stress[i % BATCH][6];
        let mass = self.mass(i);
        Facing { area: sum.map(|s| volume * s), mass: sum.map(|s| mass * s), lone: false }
    }

    fn by_places(&self) -> bool {
        true
    }

    fn beyond(&self, n: usize) -> f64 {
        0.5 * self.surface * self.spacing[self.place_of(n)]
    }

    fn around(&self, n: usize, visit: &mut dyn FnMut(usize)) {
        let i = self.place_of(n);
        visit(n);
        let particles = self.positions.len();
        for &j in self.batches[i / BATCH].near.of(i % BATCH).0.iter().filter(|&&j| (j as usize) < particles) {
            visit(self.numbers[j as usize] as usize);
        }
    }

    fn has_surface(&self) -> bool {
        true
    }
    fn find_surface(&mut self, particles: &[usize]) {
        let places: Vec<usize> = particles.iter().map(|&n| self.place_of(n)).collect();
        self.find_faces_of(places.into_iter());
    }
    fn surface(&self, n: usize, out: &mut Vec<SurfacePoint>) {
        self.surface_points(self.place_of(n), out);
    }
    fn carriers(&self, n: usize, point: &SurfacePoint, visit: &mut dyn FnMut(usize, [f64; 3])) {
        self.carriers_of(self.place_of(n), point, visit);
    }
    fn held(&self, n: usize) -> [bool; 3] {
        let bits = self.held[self.place_of(n)];
        std::array::from_fn(|d| bits & PRESCRIBED << d != 0)
    }

    fn traction(&self, n: usize, normal: &[f64; 3]) -> f64 {
        let i = self.place_of(n);
        let said = &self.batches[i / BATCH].stress[i % BATCH];
        let mut along = 0.0;
        for a in 0..3 {
            for b in 0..3 {
                along += normal[a] * said[PLACES[a][b]] * normal[b];
            }
        }
        along
    }

    fn rate(&self) -> f64 {
        self.rate
    }
    fn check(&self, dt: f64) -> Result<(), SceneError> {
        self.check_loads(dt)
    }
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>) -> Result<(), StepError> {
        start.resize(self.positions.len(), [0.0; D]);
        for (i, &n) in self.numbers.iter().enumerate() {
            start[n as usize] = self.velocity(i);
        }
        Sph::accelerate(self, dt);
        Ok(())
    }
    fn push(&mut self, n: usize, impulse: &[f64; 3]) {
        let i = self.place_of(n);
        let v = &mut self.records.velocity[i];
        let mass = v[3];
        for d in 0..D {
            v[d] += impulse[d] / mass;
            if impulse[d] != 0.0 {
                self.held[i] |= TOUCHED << d;
            }
        }
    }
    fn advance(&mut self, dt: f64, _: &[[f64; D]]) -> Result<(), StepError> {
        Sph::advance(self, dt)
    }
    fn finish(&mut self, dt: f64) -> Result<(), StepError> {
        Sph::finish(self, dt)
    }
    fn describe(&self) -> String {
        Solver::method(self)
    }
    fn axisymmetric(&self) -> bool {
        Self::HOOP
    }
    fn exchange(&self) -> Exchange {
        Solver::exchange(self)
    }
    fn speed(&self) -> f64 {
        self.speed_at_rest
    }
    fn advice(&self) -> Advice {
        Self::ADVICE
    }
    fn rename(&mut self, name: String) {
        self.name = name;
    }
    fn set_team(&mut self, team: Team) {
        Sph::set_team(self, team);
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.archive_body(file)
    }
}
