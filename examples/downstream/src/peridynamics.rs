//! User-defined method: bond-based peridynamics (Silling and Askari 2005) in plane strain, on the shared infrastructure.
//!
//! Points are bonded to all others within the horizon delta. A bond of reference length xi and stretch s attracts its
//! points with the force c s V_i V_j, c = 48 E / (5 pi delta^3) (per metre of depth; Poisson's ratio is 1/4), and breaks at
//! a critical stretch. Neighbour search, threads, run loop, observers, ParaView series, pictures, checkpoints and restart
//! are those of all methods.

use impactite::geometry::Seeds;
use impactite::geometry::search::{NeighbourSearch, Points, Reach, SortedCells};
use impactite::parallel::Team;
use impactite::scene::error::parameter;
use impactite::scene::{Archive, Body, Cause, CheckpointError, Clock, Exchange, PointKind, PointView};
use impactite::scene::{Solver, StepError, Stopped, Totals};

/// Brittle solid: density, kg/m^3, Young's modulus, Pa, and critical stretch of bonds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Brittle {
    pub density: f64,
    pub young: f64,
    pub critical: f64,
}

/// Bond of a point: stiffness c V_i V_j, N, reference length, m, and stretch.
#[derive(Clone, Copy, Debug)]
struct Bond {
    other: u32,
    stiffness: f64,
    length: f64,
    stretch: f64,
    broken: bool,
}

/// Material point, with half of the energy stored in its bonds and half of that dissipated by broken bonds, J.
#[derive(Clone, Debug)]
struct Point {
    mass: f64,
    position: [f64; 2],
    velocity: [f64; 2],
    force: [f64; 2],
    bonds: Vec<Bond>,
    stored: f64,
    dissipated: f64,
}

impl Point {
    /// Compute bond force and stored energy; break bonds above the critical stretch.
    fn pull(&mut self, positions: &[[f64; 2]], critical: f64) {
        (self.force, self.stored) = ([0.0; 2], 0.0);
        for bond in self.bonds.iter_mut().filter(|b| !b.broken) {
            let other = positions[bond.other as usize];
            let way = [other[0] - self.position[0], other[1] - self.position[1]];
            let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
            let before = std::mem::replace(&mut bond.stretch, length / bond.length - 1.0);
            let half = 0.25 * bond.stiffness * bond.length;
            if bond.stretch > critical {
                // This point's half of the work of the last bond force up to the present stretch.
                bond.broken = true;
                self.dissipated += half * before * bond.stretch;
                continue;
            }
            self.stored += half * bond.stretch * bond.stretch;
            let pull = bond.stiffness * bond.stretch / length;
            self.force = [self.force[0] + pull * way[0], self.force[1] + pull * way[1]];
        }
    }
}

/// Plate of bonded points.
#[derive(Clone)]
pub struct Plate {
    solid: Brittle,
    points: Vec<Point>,
    positions: Vec<[f64; 2]>,
    limit: f64,
    clock: Clock,
    team: Team,
    stopped_by: Option<StepError>,
}

impl Plate {
    /// Bond the points of a shape within the horizon (m); `velocity` is the initial velocity (m/s) at a position (m).
    ///
    /// # Errors
    /// Constant of the solid that is not positive; invalid search radius; point without bonds.
    pub fn new(
        solid: Brittle,
        seeds: &Seeds<2>,
        horizon: f64,
        velocity: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Result<Self, Box<dyn std::error::Error>> {
        for (field, x) in [("density", solid.density), ("modulus", solid.young), ("stretch", solid.critical)]
        {
            parameter(x > 0.0, "brittle solid", field, x, "positive and finite")?;
        }
        let positions = seeds.positions.clone();
        let search = SortedCells::new(&Points::of_positions(&positions)?, Reach::uniform(horizon))?;
        let lists = search.neighbours(&Team::one())?;
        let modulus = 48.0 * solid.young / (5.0 * std::f64::consts::PI * horizon.powi(3));
        let (mut points, mut stiffest) = (Vec::new(), 0.0f64);
        for (number, (&position, &volume)) in positions.iter().zip(&seeds.volumes).enumerate() {
            let bond = |&other: &u32| {
                let [x, y] = positions[other as usize];
                let stiffness = modulus * volume * seeds.volumes[other as usize];
                let length = (x - position[0]).hypot(y - position[1]);
                Bond { other, stiffness, length, stretch: 0.0, broken: false }
            };
            let bonds: Vec<Bond> = lists.of(number).iter().map(bond).collect();
            parameter(!bonds.is_empty(), "horizon", "bonds of a point", 0.0, "at least 1")?;
            let (mass, velocity) = (solid.density * volume, velocity(position));
            stiffest = stiffest.max(bonds.iter().map(|b| b.stiffness / b.length).sum::<f64>() / mass);
            let (force, stored, dissipated) = ([0.0; 2], 0.0, 0.0);
            points.push(Point { mass, position, velocity, force, bonds, stored, dissipated });
        }
        // Time step limit: half of dt = sqrt(2 m_i / sum of stiffness), section 5 of the paper.
        let (limit, clock, team) = (0.5 * (2.0 / stiffest).sqrt(), Clock::default(), Team::one());
        Ok(Plate { solid, points, positions, limit, clock, team, stopped_by: None })
    }

    /// Break the bonds between positions (m) for which `cuts` is true: a notch.
    pub fn cut(&mut self, cuts: impl Fn([f64; 2], [f64; 2]) -> bool) {
        for point in &mut self.points {
            for bond in &mut point.bonds {
                bond.broken |= cuts(point.position, self.positions[bond.other as usize]);
            }
        }
    }

    /// Advance by velocity Verlet: half a step of velocities, a step of positions, half a step of velocities.
    fn step(&mut self, dt: f64) -> Result<(), StepError> {
        let kick = |p: &mut Point| (0..2).for_each(|d| p.velocity[d] += 0.5 * dt / p.mass * p.force[d]);
        self.team.each(&mut self.points, |_, p| {
            kick(p);
            (0..2).for_each(|d| p.position[d] += dt * p.velocity[d]);
        });
        self.positions.iter_mut().zip(&self.points).for_each(|(x, p)| *x = p.position);
        let (positions, critical) = (&self.positions, self.solid.critical);
        self.team.each(&mut self.points, |_, p| {
            p.pull(positions, critical);
            kick(p);
        });
        let sum = |p: &Point| p.velocity[0] + p.velocity[1] + p.stored + p.dissipated;
        if let Some(number) = self.points.iter().position(|p| !sum(p).is_finite()) {
            let ([x, y], kind, cause) = (self.positions[number], PointKind::Particle, Cause::Velocity);
            let (body, law, position) = (self.name().into(), self.law(), [x, y, 0.0]);
            return Err(self.clock.stopped(Stopped::Point { kind, body, number, position, law, cause }));
        }
        self.clock.advance(dt);
        Ok(())
    }
}

impl Body for Plate {
    fn name(&self) -> &str {
        "plate"
    }
    fn law(&self) -> &'static str {
        "brittle bonds"
    }
    fn len(&self) -> usize {
        self.points.len()
    }
    fn state_names(&self) -> Vec<String> {
        vec!["damage".into()]
    }
    fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        for p in &self.points {
            sum.add_point(p.mass, &p.position, &p.velocity);
            sum.internal += p.stored + p.dissipated;
        }
        sum
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        for (number, p) in self.points.iter().enumerate() {
            let broken = p.bonds.iter().filter(|b| b.broken).count() as f64 / p.bonds.len() as f64;
            let [position, velocity] = [p.position, p.velocity].map(|[x, y]| [x, y, 0.0]);
            let (mass, volume, state) = (p.mass, p.mass / self.solid.density, vec![broken]);
            visit(&PointView { number, position, velocity, mass, volume, state, ..PointView::default() });
        }
    }
    fn bytes(&self) -> usize {
        self.points.iter().map(|p| size_of::<Point>() + size_of_val(&p.bonds[..])).sum()
    }
}

impl Solver for Plate {
    fn method(&self) -> String {
        "bond-based peridynamics, plane strain".into()
    }
    fn dimensions(&self) -> usize {
        2
    }
    fn clock(&self) -> &Clock {
        &self.clock
    }
    fn clock_mut(&mut self) -> &mut Clock {
        &mut self.clock
    }
    fn stable_step(&mut self) -> Result<f64, StepError> {
        Ok(self.limit)
    }
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError> {
        if let Some(error) = &self.stopped_by {
            return Err(error.clone());
        }
        let dt = self.clock.step_within(self.limit, left)?;
        let made = self.step(dt);
        self.stopped_by = made.as_ref().err().cloned();
        made.map(|()| dt)
    }
    fn set_team(&mut self, team: Team) {
        self.team = team;
    }
    fn bodies(&self) -> Vec<&dyn Body> {
        vec![self]
    }
    fn exchange(&self) -> Exchange {
        Exchange::default()
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let bonds: usize = self.points.iter().map(|p| p.bonds.len()).sum();
        file.same("solid, points and bonds", &format!("{:?}, {}, {bonds}", self.solid, self.points.len()))?;
        self.clock.archive(file)?;
        for (p, place) in self.points.iter_mut().zip(&mut self.positions) {
            file.reals(p.position.iter_mut().chain(&mut p.velocity).chain(&mut p.force))?;
            file.reals([&mut p.stored, &mut p.dissipated])?;
            for bond in &mut p.bonds {
                file.flag(&mut bond.broken)?;
                file.real(&mut bond.stretch)?;
            }
            *place = p.position;
        }
        Ok(())
    }
    fn stopped_by(&self) -> Option<&StepError> {
        self.stopped_by.as_ref()
    }
}
