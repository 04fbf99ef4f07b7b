//! Contact interface of a body.

use impactite_scene::boundaries::check_at;
use impactite_scene::{
    Archive, Boundary, CheckpointError, Embedding, Exchange, SceneError, Side, Solver, StepError,
};
use impactite_simd::Team;
use mpm_contact::particles::{Advice, ContactParticle, Facing, ParticleBody};
use mpm_materials::Sym3;

use crate::method::Composition;
use crate::particles::Particle;
use crate::simplex::{measure, slopes};
use crate::solver::{ADVICE, Pcmm};
use crate::tessellation::corners;

/// Rounding of |sum of V grad N| over the sum of |V grad N|: below it a particle is surrounded.
const SURROUNDED: f64 = 1e-9;
/// Distance from a plane of symmetry, in radii, below which a particle is on it.
const ON_PLANE: f64 = 1e-6;

/// Any particle may be in contact: a body that penetrated the surface is in contact with the inside.
impl<const D: usize, M: Composition<D>> ParticleBody<D> for Pcmm<D, M> {
    fn particle(&self, n: usize) -> ContactParticle<D> {
        let Particle { position, velocity, mass, radius } = self.particles[n];
        ContactParticle { position, velocity, mass, radius }
    }
    fn push(&mut self, n: usize, impulse: &[f64; 3]) {
        let p = &mut self.particles[n];
        for d in 0..D {
            p.velocity[d] += impulse[d] / p.mass;
        }
    }
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>) -> Result<(), StepError> {
        start.clear();
        start.extend(self.particles.iter().map(|p| p.velocity));
        Pcmm::accelerate(self, dt);
        Ok(())
    }
    fn advance(&mut self, dt: f64, start: &[[f64; D]]) -> Result<(), StepError> {
        Pcmm::advance(self, dt, start)
    }
    fn finish(&mut self, dt: f64) -> Result<(), StepError> {
        Pcmm::finish(self, dt)
    }
    fn set_team(&mut self, team: Team) {
        Pcmm::set_team(self, team);
    }
    fn rate(&self) -> f64 {
        self.rate
    }

    fn facing(&self, n: usize) -> Facing {
        let (mut area, mut mass, mut size) = ([0.0; 3], [0.0; 3], 0.0);
        let density = self.material.density();
        let at = self.elements.incidence.of(n);
        for &c in at {
            let (e, corner) = (c as usize / (D + 1), c as usize % (D + 1));
            let x = corners(&self.particles, &self.elements.nodes[e * (D + 1)..(e + 1) * (D + 1)]);
            let (volume, slope) = (measure(&x), slopes(&x).of[corner]);
            for d in 0..D {
                area[d] += volume * slope[d];
                mass[d] += density * self.elements.reference[e] * slope[d];
            }
            size += volume * slope.iter().map(|s| s * s).sum::<f64>().sqrt();
        }
        let p = &self.particles[n];
        // The mirror half of the body cancels components across a plane of symmetry.
        let mut on_plane = [false; 3];
        on_plane[0] = M::Embedding::HOOP && p.position[0] <= ON_PLANE * p.radius;
        for boundary in &self.boundaries {
            if let Boundary::Symmetry { axis, at, side } = *boundary {
                let sign = if side == Side::Above { 1.0 } else { -1.0 };
                on_plane[axis] |= (p.position[axis] - at) * sign <= ON_PLANE * p.radius;
            }
        }
        for d in (0..D).filter(|&d| on_plane[d]) {
            (area[d], mass[d]) = (0.0, 0.0);
        }
        let length = area.iter().map(|a| a * a).sum::<f64>().sqrt();
        if length <= SURROUNDED * size {
            (area, mass) = ([0.0; 3], [0.0; 3]);
        }
        if M::Embedding::HOOP {
            area = area.map(|a| a * p.position[0]);
        }
        Facing { area, mass, lone: at.is_empty() }
    }

    fn traction(&self, n: usize, normal: &[f64; 3]) -> f64 {
        let mut state = vec![0.0; self.virgin.len()];
        let (mut sum, mut weight) = (0.0, 0.0);
        for &c in self.elements.incidence.of(n) {
            let e = c as usize / (D + 1);
            self.elements.read(e, &mut state);
            if let Some(said) = self.material.describe_point(&state) {
                let stress = Sym3(said.stress);
                let mut along = 0.0;
                for i in 0..3 {
                    for j in 0..3 {
                        along += normal[i] * stress.at(i, j) * normal[j];
                    }
                }
                sum += self.elements.reference[e] * along;
                weight += self.elements.reference[e];
            }
        }
        if weight > 0.0 { sum / weight } else { 0.0 }
    }

    fn around(&self, n: usize, visit: &mut dyn FnMut(usize)) {
        let at = self.elements.incidence.of(n);
        let nodes = |c: &u32| {
            let e = *c as usize / (D + 1);
            &self.elements.nodes[e * (D + 1)..(e + 1) * (D + 1)]
        };
        let mut list: Vec<u32> = at.iter().flat_map(nodes).copied().collect();
        list.push(n as u32);
        list.sort_unstable();
        list.dedup();
        list.iter().for_each(|&m| visit(m as usize));
    }

    fn beyond(&self, n: usize) -> f64 {
        self.surface * self.particles[n].radius
    }
    fn axisymmetric(&self) -> bool {
        M::Embedding::HOOP
    }
    fn exchange(&self) -> Exchange {
        Solver::exchange(self)
    }
    fn check(&self, dt: f64) -> Result<(), SceneError> {
        let time = self.clock.time;
        check_at(self.body_force.as_ref(), &self.boundaries, time, &[time, time + dt])
    }
    fn speed(&self) -> f64 {
        Pcmm::speed(self)
    }
    fn describe(&self) -> String {
        Solver::method(self)
    }
    fn advice(&self) -> Advice {
        ADVICE
    }
    fn rename(&mut self, name: String) {
        self.name = name;
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.archive_body(file)
    }
}
