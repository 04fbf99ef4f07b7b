//! Simple body of particles for contact tests.

use impactite_scene::{
    Archive, Body, Cause, CheckpointError, Clock, Exchange, PointKind, PointView, SceneError, StepError,
    Stopped, Totals,
};
use impactite_simd::Team;

use crate::particles::{ContactParticle, Facing, ParticleBody};
use crate::vector::{difference, dot, length, sum, times, unit, wide};

/// Cutoff distance of springs between balls, in radii.
const BOND: f64 = 3.0;
/// Rounding tolerance of the sum of unit vectors to neighbours, over their number, for a surrounded ball.
const SURROUNDED: f64 = 1e-9;

/// Balls of equal radius and mass: free, or bonded by linear springs.
///
/// ```
/// use mpm_contact::conformance::Balls;
/// use mpm_contact::particles::Bodies;
/// use mpm_contact::{Frictionless, Pairs, SurfaceDistance};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // Two balls of 1 mm; the one flies into the other, and they go on together.
/// let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
/// scene.add("target", Balls::new(vec![[0.0, 0.0]], 1.0e-3, 2.0));
/// scene.add("bullet", Balls::new(vec![[-3.0e-3, 0.0]], 1.0e-3, 1.0).moving([30.0, 0.0]));
/// scene.run_until(1.0e-4)?;
/// assert!(scene.particles(0).all(|ball| (ball.velocity[0] - 10.0).abs() < 1e-12));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Balls<const D: usize> {
    name: String,
    positions: Vec<[f64; D]>,
    velocities: Vec<[f64; D]>,
    radius: f64,
    mass: f64,
    gravity: [f64; D],
    stiffness: f64,
    springs: Vec<Spring>,
    /// Bonded neighbours of each ball, ascending.
    neighbours: Vec<Vec<u32>>,
    forces: Vec<[f64; 3]>,
    rim_only: bool,
    axisymmetric: bool,
    clock: Clock,
    exchange: Exchange,
}

#[derive(Clone, Debug)]
struct Spring {
    ends: [usize; 2],
    length: f64,
}

impl<const D: usize> Balls<D> {
    /// Create free balls at rest, with a radius in m and a mass in kg.
    #[must_use]
    pub fn new(positions: Vec<[f64; D]>, radius: f64, mass: f64) -> Self {
        let count = positions.len();
        Balls {
            name: "balls".into(),
            positions,
            velocities: vec![[0.0; D]; count],
            radius,
            mass,
            gravity: [0.0; D],
            stiffness: 0.0,
            springs: Vec::new(),
            neighbours: vec![Vec::new(); count],
            forces: vec![[0.0; 3]; count],
            rim_only: false,
            axisymmetric: false,
            clock: Clock::default(),
            exchange: Exchange::default(),
        }
    }

    /// Set the velocity, m/s.
    #[must_use]
    pub fn moving(mut self, velocity: [f64; D]) -> Self {
        self.velocities.fill(velocity);
        self
    }

    /// Bond all balls less than three radii apart by springs of this stiffness, N/m, at rest.
    #[must_use]
    pub fn bonded(mut self, stiffness: f64) -> Self {
        self.stiffness = stiffness;
        for a in 0..self.positions.len() {
            for b in a + 1..self.positions.len() {
                let length = length(self.apart(a, b));
                if length < BOND * self.radius {
                    self.springs.push(Spring { ends: [a, b], length });
                    self.neighbours[a].push(b as u32);
                    self.neighbours[b].push(a as u32);
                }
            }
        }
        self
    }

    /// Set the body force, as an acceleration, m/s^2.
    #[must_use]
    pub fn under(self, gravity: [f64; D]) -> Self {
        Balls { gravity, ..self }
    }

    /// Restrict contact to the surface: [`ParticleBody::may_touch`] is false for surrounded balls.
    #[must_use]
    pub fn touched_at_the_rim(self) -> Self {
        Balls { rim_only: true, ..self }
    }

    /// Declare the coordinates radius and axis; nothing else changes.
    #[must_use]
    pub fn around_an_axis(self) -> Self {
        Balls { axisymmetric: true, ..self }
    }

    /// Vector from ball `a` to ball `b`, m.
    fn apart(&self, a: usize, b: usize) -> [f64; 3] {
        difference(wide(&self.positions[b]), wide(&self.positions[a]))
    }

    /// Volume of the cell of a ball, m^3.
    fn volume(&self) -> f64 {
        (2.0 * self.radius).powi(D as i32)
    }

    fn pull(&mut self) {
        self.forces.fill([0.0; 3]);
        for Spring { ends: [a, b], length: rest } in &self.springs {
            let apart = self.apart(*a, *b);
            let stretch = length(apart) - rest;
            let force = times(unit(apart).unwrap_or_default(), self.stiffness * stretch);
            self.forces[*a] = sum(self.forces[*a], force);
            self.forces[*b] = difference(self.forces[*b], force);
        }
    }
}

impl<const D: usize> Body for Balls<D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        "springs"
    }
    fn len(&self) -> usize {
        self.positions.len()
    }
    fn state_names(&self) -> Vec<String> {
        Vec::new()
    }
    fn totals(&self) -> Totals {
        let mut totals = Totals::default();
        for (x, v) in self.positions.iter().zip(&self.velocities) {
            totals.add_point(self.mass, x, v);
        }
        for spring in &self.springs {
            let stretch = length(self.apart(spring.ends[0], spring.ends[1])) - spring.length;
            totals.internal += 0.5 * self.stiffness * stretch * stretch;
        }
        totals
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        for (number, (x, v)) in self.positions.iter().zip(&self.velocities).enumerate() {
            visit(&PointView {
                number,
                position: wide(x),
                velocity: wide(v),
                mass: self.mass,
                volume: self.volume(),
                width: Some(2.0 * self.radius),
                in_range: true,
                ..PointView::default()
            });
        }
    }
    fn bytes(&self) -> usize {
        self.positions.len() * (2 * size_of::<[f64; D]>() + size_of::<[f64; 3]>())
    }
}

impl<const D: usize> ParticleBody<D> for Balls<D> {
    fn particle(&self, n: usize) -> ContactParticle<D> {
        let Balls { positions, velocities, mass, radius, .. } = self;
        ContactParticle { position: positions[n], velocity: velocities[n], mass: *mass, radius: *radius }
    }
    fn may_touch(&self, n: usize) -> bool {
        !self.rim_only || !self.facing(n).is_within()
    }

    /// Surface normal away from the neighbours.
    fn facing(&self, n: usize) -> Facing {
        let neighbours = &self.neighbours[n];
        if neighbours.is_empty() {
            return Facing::LONE;
        }
        let to = |m: &u32| unit(self.apart(n, *m as usize)).unwrap_or_default();
        let inward = neighbours.iter().map(to).fold([0.0; 3], sum);
        if length(inward) <= SURROUNDED * neighbours.len() as f64 {
            return Facing::WITHIN;
        }
        let face = (2.0 * self.radius).powi(D as i32 - 1);
        let area = times(inward, -face / length(inward));
        Facing { area, mass: times(area, self.mass / self.volume()), lone: false }
    }
    fn beyond(&self, _: usize) -> f64 {
        self.radius
    }
    fn around(&self, n: usize, visit: &mut dyn FnMut(usize)) {
        visit(n);
        self.neighbours[n].iter().for_each(|&m| visit(m as usize));
    }
    /// Traction by the springs: they pull inwards at a surface in tension.
    fn traction(&self, n: usize, normal: &[f64; 3]) -> f64 {
        -dot(self.forces[n], *normal) / (2.0 * self.radius).powi(D as i32 - 1)
    }

    /// Courant rate: half a bound of the highest frequency (Gershgorin), or speed over diameter.
    fn rate(&self) -> f64 {
        let most = self.neighbours.iter().map(Vec::len).max().unwrap_or_default() as f64;
        (0.5 * most * self.stiffness / self.mass).sqrt().max(self.fastest() / (2.0 * self.radius))
    }
    fn check(&self, _: f64) -> Result<(), SceneError> {
        Ok(())
    }
    fn accelerate(&mut self, dt: f64, start: &mut Vec<[f64; D]>) -> Result<(), StepError> {
        start.clone_from(&self.velocities);
        for (v, f) in self.velocities.iter_mut().zip(&self.forces) {
            for d in 0..D {
                v[d] += dt * (f[d] / self.mass + self.gravity[d]);
            }
        }
        Ok(())
    }
    fn push(&mut self, n: usize, impulse: &[f64; 3]) {
        for d in 0..D {
            self.velocities[n][d] += impulse[d] / self.mass;
        }
    }
    fn advance(&mut self, dt: f64, start: &[[f64; D]]) -> Result<(), StepError> {
        for (number, v) in self.velocities.iter().enumerate() {
            if v.iter().any(|v| !v.is_finite()) {
                let (kind, body, law) = (PointKind::Particle, self.name.clone(), "springs");
                let (position, cause) = (wide(&self.positions[number]), Cause::Velocity);
                let what = Stopped::Point { kind, body, number, position, law, cause };
                return Err(self.clock.stopped(what));
            }
            for d in 0..D {
                let load = dt * self.mass * self.gravity[d];
                self.exchange.load[d] += load;
                self.exchange.work += load * 0.5 * (start[number][d] + v[d]);
                self.positions[number][d] += dt * v[d];
            }
        }
        Ok(())
    }
    fn finish(&mut self, dt: f64) -> Result<(), StepError> {
        self.pull();
        self.clock.advance(dt);
        Ok(())
    }

    fn describe(&self) -> String {
        format!("balls on {} springs", self.springs.len())
    }
    fn axisymmetric(&self) -> bool {
        self.axisymmetric
    }
    fn exchange(&self) -> Exchange {
        self.exchange
    }
    fn speed(&self) -> f64 {
        self.rate() * 2.0 * self.radius
    }
    fn rename(&mut self, name: String) {
        self.name = name;
    }
    fn set_team(&mut self, _: Team) {}
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let of = |what: &str| format!("{what} of body `{}`", self.name);
        file.same(&of("number of balls"), &self.positions.len().to_string())?;
        file.same(&of("springs"), &format!("{:?} of {} N/m", self.springs, self.stiffness))?;
        file.same(&of("gravity"), &format!("{:?} m/s^2", self.gravity))?;
        self.clock.archive(file)?;
        file.reals(self.positions.iter_mut().flatten())?;
        file.reals(self.velocities.iter_mut().flatten())?;
        self.exchange.archive(file)?;
        self.pull();
        Ok(())
    }
}
