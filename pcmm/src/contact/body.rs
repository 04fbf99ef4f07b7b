//! A body of a scene, whatever its law and method.

use impactite_scene::{
    Archive, Body, Boundary, CheckpointError, Embedding, Exchange, SceneError, Side, Solver, StepError,
};
use impactite_simd::Team;
use mpm_materials::Sym3;

use crate::audit::{Audit, Coverage};
use crate::method::Composition;
use crate::particles::Particle;
use crate::simplex::{measure, slopes};
use crate::solver::Pcmm;
use crate::tessellation::corners;
use impactite_scene::boundary::check_at;

/// The surface of a body at a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facing {
    /// sum_e V_e grad N_e, m^2: it points out of the body; an area.
    pub area: [f64; 3],
    /// sum_e m_e grad N_e, kg/m: likewise.
    pub mass: [f64; 3],
    /// Is it in no element?
    pub lone: bool,
}

/// The part of |sum of V grad N| over the sum of |V grad N| that is rounding: the particle is surrounded.
const SURROUNDED: f64 = 1e-9;
/// A particle this near to a plane of symmetry, in radii, lies on it.
const ON_PLANE: f64 = 1e-6;

impl Facing {
    /// Is the particle within the body, elements all around it?
    pub fn is_within(&self) -> bool {
        !self.lone && self.area == [0.0; 3]
    }
}

/// What a scene of several bodies asks of one. A step is [`Part::accelerate`], impulses between bodies,
/// [`Part::advance`], [`Part::finish`].
pub(crate) trait Part<const D: usize>: Body + Send + Sync {
    fn particles(&self) -> &[Particle<D>];
    fn push(&mut self, n: usize, impulse: &[f64; 3]);
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>);
    fn advance(&mut self, dt: f64, start: &[[f64; D]]) -> Result<(), StepError>;
    fn finish(&mut self, dt: f64) -> Result<(), StepError>;
    fn set_team(&mut self, team: Team);
    fn rate(&self) -> f64;
    fn facing(&self, n: usize) -> Facing;
    /// Mean over the elements at a particle of n . sigma . n, Pa.
    fn traction(&self, n: usize, normal: &[f64; 3]) -> f64;
    fn around(&self, n: usize, visit: &mut dyn FnMut(usize));
    /// How far the surface lies beyond the centre of a particle, m.
    fn beyond(&self, n: usize) -> f64;
    fn axisymmetric(&self) -> bool;
    fn audit(&self) -> Audit;
    fn coverage(&self) -> Coverage;
    fn exchange(&self) -> Exchange;
    fn check(&self, dt: f64) -> Result<(), SceneError>;
    fn speed(&self) -> f64;
    fn elements(&self) -> usize;
    fn element_nodes(&self) -> &[u32];
    fn describe(&self) -> String;
    fn rename(&mut self, name: String);
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;
}

impl<const D: usize, M: Composition<D>> Part<D> for Pcmm<D, M> {
    fn particles(&self) -> &[Particle<D>] {
        &self.particles
    }
    fn push(&mut self, n: usize, impulse: &[f64; 3]) {
        let p = &mut self.particles[n];
        for d in 0..D {
            p.velocity[d] += impulse[d] / p.mass;
        }
    }
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>) {
        start.clear();
        start.extend(self.particles.iter().map(|p| p.velocity));
        Pcmm::accelerate(self, dt);
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
        // The other half of the body cancels what points across a plane of symmetry.
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
    fn audit(&self) -> Audit {
        self.audit
    }
    fn coverage(&self) -> Coverage {
        Pcmm::coverage(self)
    }
    fn exchange(&self) -> Exchange {
        Solver::exchange(self)
    }
    fn check(&self, dt: f64) -> Result<(), SceneError> {
        let time = self.clock.time;
        check_at(self.body_force.as_ref(), &self.boundaries, time, &[time + dt])
    }
    fn speed(&self) -> f64 {
        Pcmm::speed(self)
    }
    fn elements(&self) -> usize {
        self.elements.len()
    }
    fn element_nodes(&self) -> &[u32] {
        &self.elements.nodes
    }
    fn describe(&self) -> String {
        self.method.describe()
    }
    fn rename(&mut self, name: String) {
        self.name = name;
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.archive_body(file)
    }
}
