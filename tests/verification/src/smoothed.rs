//! Smoothed particles as a formulation of cases: one particle at the position of a material point of a cell with one.

use mpm_contact::particles::ParticleBody;
use mpm_core::{Body, FullSpace, PlaneStrain, StepError};
use mpm_materials::IntoMaterial;
use sph::{Composition, Layout, Method, Sph};

use crate::case::{Case, Outcome};
use crate::empty::{Gas, GasState};
use crate::formulation::Formulation;
use crate::scene::{Drive, Ended, Moment, Run, Scene, Stepped};

/// Method of smoothed particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothed {
    /// `sph::Method::total_lagrangian`.
    TotalLagrangian,
    /// `sph::Method::updated`.
    Updated,
}

impl Smoothed {
    /// Both methods.
    pub const ALL: [Smoothed; 2] = [Smoothed::TotalLagrangian, Smoothed::Updated];

    /// Courant number by default: fraction of the stable time step.
    pub const COURANT: f64 = 0.7;

    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Smoothed::TotalLagrangian => "SPH total Lagrangian",
            Smoothed::Updated => "SPH updated",
        }
    }

    /// Find a method by name.
    pub fn named(name: &str) -> Option<Smoothed> {
        Smoothed::ALL.into_iter().find(|s| s.name() == name)
    }

    /// Number of neighbours of a particle in two dimensions, within 2.2 and 2.6 spacings.
    pub const fn neighbours(self) -> u64 {
        match self {
            Smoothed::TotalLagrangian => 12,
            Smoothed::Updated => 20,
        }
    }
}

/// Number of neighbours in three dimensions, within 2.2 spacings.
const IN_SPACE: u64 = 32;

impl Formulation for Smoothed {
    fn name(self) -> String {
        Smoothed::name(self).into()
    }

    /// Two particles across, so that they and their images are mutual neighbours; images of images beyond the other plane
    /// are not created.
    fn run(case: &Case<Self>) -> Outcome {
        case.by_problem()
    }

    fn across(self) -> usize {
        2
    }

    fn plane<C: IntoMaterial<f64> + Clone>(
        self,
        scene: &Scene<C, 2>,
        look: &mut dyn FnMut(&Moment<'_, 2>),
    ) -> Outcome {
        let run = Run { scene, look };
        let ended = match self {
            Smoothed::TotalLagrangian => run.by_particles(Method::total_lagrangian(PlaneStrain)),
            Smoothed::Updated => run.by_particles(Method::updated(PlaneStrain)),
        };
        Outcome::of(self.neighbours(), Some(ended))
    }

    /// Runs the total Lagrangian method only.
    fn solid<C: IntoMaterial<f64> + Clone>(
        self,
        scene: &Scene<C, 3>,
        look: &mut dyn FnMut(&Moment<'_, 3>),
    ) -> Outcome {
        let run = Run { scene, look };
        let total = self == Smoothed::TotalLagrangian;
        Outcome::of(IN_SPACE, total.then(|| run.by_particles(Method::total_lagrangian(FullSpace))))
    }

    fn gas(
        self,
        scene: &Scene<Gas, 2>,
        state: fn([f64; 2]) -> GasState,
        look: &mut dyn FnMut(&Moment<'_, 2>),
    ) -> Outcome {
        let run = Run { scene, look };
        let ended = match self {
            Smoothed::TotalLagrangian => run.of_gas(Method::total_lagrangian(PlaneStrain), state),
            Smoothed::Updated => run.of_gas(Method::updated(PlaneStrain), state),
        };
        Outcome::of(self.neighbours(), Some(ended))
    }
}

impl<C: IntoMaterial<f64> + Clone, const D: usize> Run<'_, C, D> {
    /// Run the scene by smoothed particles.
    fn by_particles<M: Composition<D>>(self, method: M) -> Ended {
        let made = of_scene(method, self.scene, &Layout::of_seeds(&self.scene.seeds));
        self.driven(made)
    }
}

impl Run<'_, Gas, 2> {
    /// Run gas by smoothed particles. Volumes of a layout are those at the reference density.
    fn of_gas<M: Composition<2>>(self, method: M, state: fn([f64; 2]) -> GasState) -> Ended {
        let mut layout = Layout::of_seeds(&self.scene.seeds);
        for (volume, &x) in layout.volumes.iter_mut().zip(&layout.positions) {
            *volume /= state(x).volume_ratio;
        }
        let made = of_scene(method, self.scene, &layout).and_then(|mut sph| {
            sph.set_states::<Gas>(|x, _| state(x)).map_err(text)?;
            Ok(sph)
        });
        self.driven(made)
    }
}

impl<C, const D: usize> Run<'_, C, D> {
    /// Run the solver of the scene. Its velocities are half a step before the start, so that the first force acts for a whole step.
    fn driven<M: Composition<D>>(self, made: Result<Sph<D, M>, String>) -> Ended {
        let scene = self.scene;
        match made {
            Ok(sph) => {
                let march = March { lag: 0.5 * scene.dt, ..March::new(Box::new(sph)) };
                self.by_steps(&mut Driven {
                    march,
                    drive: scene.field.clone(),
                    rest: &scene.seeds.positions,
                    dt: scene.dt,
                })
            }
            Err(why) => self.refused(why),
        }
    }
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Create the particles of a scene in a layout.
fn of_scene<C: IntoMaterial<f64> + Clone, const D: usize, M: Composition<D>>(
    method: M,
    scene: &Scene<C, D>,
    layout: &Layout<D>,
) -> Result<Sph<D, M>, String> {
    let mut sph = Sph::new(method, scene.law.clone(), layout, |x| (scene.velocity)(x)).map_err(text)?;
    for boundary in &scene.boundaries {
        sph.bound(boundary.clone()).map_err(text)?;
    }
    Ok(sph)
}

/// Particle body with given step sizes, and an external acceleration per particle in addition to neighbour forces.
pub(crate) struct March<const D: usize> {
    /// Particle body.
    pub body: Box<dyn ParticleBody<D>>,
    /// Time, s.
    pub time: f64,
    /// Number of steps.
    pub steps: u64,
    /// Offset of the leapfrog velocities: time of the positions minus that of the velocities, s.
    lag: f64,
    masses: Vec<f64>,
    start: Vec<[f64; D]>,
}

impl<const D: usize> March<D> {
    /// Create a march from rest or motion at t = 0.
    pub fn new(body: Box<dyn ParticleBody<D>>) -> Self {
        let masses = (0..body.len()).map(|n| body.particle(n).mass).collect();
        March { body, time: 0.0, steps: 0, lag: 0.0, masses, start: Vec::new() }
    }

    /// Duration of an external acceleration in a step, s: leapfrog velocities are at mid-step.
    pub fn kick(&self, dt: f64) -> f64 {
        self.lag + 0.5 * dt
    }

    /// Return accelerations by neighbour forces, m/s^2, by number, at the beginning of a step of `dt` seconds.
    pub fn accelerations(mut self, dt: f64) -> Result<Vec<[f64; D]>, StepError> {
        let kick = self.kick(dt);
        let March { body, start, .. } = &mut self;
        body.accelerate(dt, start)?;
        let of = |(n, before): (usize, &[f64; D])| {
            let now = body.particle(n).velocity;
            std::array::from_fn(|d| (now[d] - before[d]) / kick)
        };
        Ok(start.iter().enumerate().map(of).collect())
    }

    /// Advance by one step with external accelerations (m/s^2) by number.
    ///
    /// Never inlined, so that its instructions can be counted.
    #[inline(never)]
    pub fn smoothed_step(
        &mut self,
        dt: f64,
        acceleration: Option<&dyn Fn(usize) -> [f64; D]>,
    ) -> Result<(), StepError> {
        let kick = self.kick(dt);
        let March { body, masses, start, .. } = self;
        body.accelerate(dt, start)?;
        if let Some(acceleration) = acceleration {
            for (n, mass) in masses.iter().enumerate() {
                let (more, mut impulse) = (acceleration(n), [0.0; 3]);
                (0..D).for_each(|d| impulse[d] = kick * mass * more[d]);
                body.push(n, &impulse);
            }
        }
        body.advance(dt, start)?;
        body.finish(dt)?;
        (self.lag, self.time, self.steps) = (0.5 * dt, self.time + dt, self.steps + 1);
        Ok(())
    }
}

/// Particles of a scene with its body force.
struct Driven<'a, const D: usize> {
    march: March<D>,
    drive: Option<Drive<D>>,
    rest: &'a [[f64; D]],
    dt: f64,
}

impl<const D: usize> Stepped<D> for Driven<'_, D> {
    fn step(&mut self) -> Result<(), StepError> {
        let Driven { march, drive, rest, dt } = self;
        let time = march.time;
        match drive {
            Some(drive) => march.smoothed_step(*dt, Some(&|n| drive(&rest[n], time))),
            None => march.smoothed_step(*dt, None),
        }
    }
    fn time(&self) -> f64 {
        self.march.time
    }
    /// Time of the velocities; with a body force, the middle of the last step.
    fn velocity_time(&self, dt: f64) -> f64 {
        if self.drive.is_some() { self.march.time - 0.5 * dt } else { self.march.time }
    }
    fn body(&self) -> &dyn Body {
        &*self.march.body
    }
    fn bytes(&self) -> usize {
        self.march.body.bytes()
    }
}
