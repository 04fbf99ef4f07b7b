//! Body of another discretisation: a lattice of masses and springs in contact with particles on the grid.

use std::collections::BTreeMap;

use crate::common::{H, WAVE, cuboid, lattice, plane, rubber};
use mpm_contact::{Coulomb, Frictionless, Pairs, Penalty, Regression, SurfaceDistance};
use mpm_core::parallel::Team;
use mpm_core::scene::{Archive, Body, CheckpointError, constants::Constant};
use mpm_core::{
    Apic, BlockGrid, ClientPoint, Exchange, GridClient, GridContact, Method, Mpm, OneField, PlaneStrain,
    PointView, QuadraticBSpline, SceneError, Solver, Stopped, Totals, Usl,
};

/// Masses at distance `spacing`, connected to their eight neighbours.
#[derive(Clone, Debug)]
struct Springs {
    mass: f64,
    stiffness: f64,
    spacing: f64,
    positions: Vec<[f64; 2]>,
    velocities: Vec<[f64; 2]>,
    /// End masses and rest lengths of the springs, m.
    springs: Vec<(usize, usize, f64)>,
    /// Velocities of the present step, m/s.
    trial: Vec<[f64; 2]>,
}

impl Springs {
    fn block(low: [f64; 2], counts: [usize; 2], spacing: f64, velocity: [f64; 2]) -> Self {
        let mut numbers = BTreeMap::new();
        let (mut positions, mut springs) = (Vec::new(), Vec::new());
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                numbers.insert((i, j), positions.len());
                positions.push([low[0] + spacing * i as f64, low[1] + spacing * j as f64]);
            }
        }
        for (&(i, j), &from) in &numbers {
            for other in [(i + 1, j), (i, j + 1), (i + 1, j + 1), (i + 1, j.wrapping_sub(1))] {
                if let Some(&to) = numbers.get(&other) {
                    let diagonal = other.0 != i && other.1 != j;
                    springs.push((from, to, spacing * if diagonal { 2.0f64.sqrt() } else { 1.0 }));
                }
            }
        }
        let (velocities, trial) = (vec![velocity; positions.len()], vec![[0.0; 2]; positions.len()]);
        let mass = 1000.0 * spacing * spacing;
        Springs { mass, stiffness: 5e5, spacing, positions, velocities, springs, trial }
    }

    fn pull(&self, n: usize) -> (f64, [f64; 2]) {
        let (i, j, length) = self.springs[n];
        let way = [0, 1].map(|d| self.positions[j][d] - self.positions[i][d]);
        let now = way[0].hypot(way[1]);
        let force = self.stiffness * (now - length);
        (0.5 * force * (now - length), way.map(|x| force * x / now))
    }
}

impl Body for Springs {
    fn name(&self) -> &str {
        "springs"
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
        let mut sum = Totals::default();
        for (x, v) in self.positions.iter().zip(&self.velocities) {
            sum.add_point(self.mass, x, v);
        }
        sum.internal = (0..self.springs.len()).map(|n| self.pull(n).0).sum();
        sum
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        for (number, ([x, y], [u, v])) in self.positions.iter().zip(&self.velocities).enumerate() {
            visit(&PointView {
                number,
                position: [*x, *y, 0.0],
                velocity: [*u, *v, 0.0],
                mass: self.mass,
                volume: self.spacing * self.spacing,
                ..PointView::default()
            });
        }
    }
    fn bytes(&self) -> usize {
        size_of_val(&self.positions[..]) + size_of_val(&self.velocities[..]) + size_of_val(&self.springs[..])
    }
}

impl GridClient<f64, 2> for Springs {
    fn constants(&self, _: [f64; 2]) -> Vec<Constant> {
        vec![("springs".into(), format!("{:?} kg, {:?} N/m", self.mass, self.stiffness))]
    }
    fn embedding(&self) -> &'static str {
        "plane strain"
    }
    fn half_size(&self) -> [f64; 2] {
        [0.5 * self.spacing; 2]
    }
    fn mass_points(&self) -> Vec<(f64, [f64; 2])> {
        self.velocities.iter().map(|v| (self.mass, *v)).collect()
    }
    fn place(&mut self, points: &mut [ClientPoint]) {
        for (point, [x, y]) in points.iter_mut().zip(&self.positions) {
            let half = 0.5 * self.spacing;
            point.position = [*x, *y, 0.0];
            point.half_edges = [[half, 0.0, 0.0], [0.0, half, 0.0], [0.0; 3]];
        }
    }
    fn rate(&self) -> f64 {
        (8.0 * self.stiffness / self.mass).sqrt()
    }
    fn open(&mut self, dt: f64, velocities: &mut [[f64; 3]], _: &Team) -> Result<(), Stopped> {
        self.trial.copy_from_slice(&self.velocities);
        for n in 0..self.springs.len() {
            let ((i, j, _), (_, force)) = (self.springs[n], self.pull(n));
            for d in 0..2 {
                self.trial[i][d] += dt * force[d] / self.mass;
                self.trial[j][d] -= dt * force[d] / self.mass;
            }
        }
        for (out, [u, v]) in velocities.iter_mut().zip(&self.trial) {
            *out = [*u, *v, 0.0];
        }
        Ok(())
    }
    fn advance(&mut self, dt: f64, changes: Option<&mut Vec<[f64; 3]>>, _: &Team) -> Result<(), Stopped> {
        for (trial, change) in self.trial.iter_mut().zip(changes.into_iter().flatten()) {
            (0..2).for_each(|d| trial[d] += change[d]);
        }
        self.velocities.copy_from_slice(&self.trial);
        for (x, v) in self.positions.iter_mut().zip(&self.velocities) {
            (0..2).for_each(|d| x[d] += dt * v[d]);
        }
        Ok(())
    }
    fn given(&self) -> Exchange {
        Exchange::default()
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals(self.positions.iter_mut().flatten().chain(self.velocities.iter_mut().flatten()))
    }
}

fn springs_at(speed: f64) -> Springs {
    Springs::block([0.35, 0.62], [9, 7], 0.5 * H, [0.2 * speed, -speed])
}

fn law() -> Penalty<f64> {
    Penalty::new(0.9 * WAVE / H, 0.8, 0.3).expect("law")
}

fn surfaces() -> SurfaceDistance<Regression> {
    SurfaceDistance::new(Regression, 0.0).expect("detector").locally()
}

/// Create the scene: the lattice falls on a block of rubber.
fn scene() -> Mpm<2> {
    let contact = GridContact::new(surfaces(), Pairs::new(law()));
    let mut mpm = Mpm::with_contact(plane(), BlockGrid::new(lattice()), contact);
    mpm.add("block", rubber(), &cuboid([0.2, 0.3], [0.9, 0.6]), |_| [0.0; 2]).expect("body");
    mpm.add_client(springs_at(0.05 * WAVE)).expect("client");
    mpm
}

#[test]
fn what_the_lattice_gives_the_particles_get() {
    let mut mpm = scene();
    let (start, own) = (mpm.totals(), mpm.bodies()[1].totals());
    let mut met = 0;
    for _ in 0..400 {
        mpm.step().expect("step");
        met += mpm.contact_points().len();
        let now = mpm.totals();
        for d in 0..2 {
            let error = (now.momentum[d] - start.momentum[d]).abs();
            assert!(error < 1e-13 * start.momentum_scale, "momentum {error:e}");
        }
    }
    let (end, after) = (mpm.totals(), mpm.bodies()[1].totals());
    assert!(met > 50, "{met} nodes touched");
    assert!(after.momentum[1] > 0.3 * own.momentum[1].abs(), "it comes back: {after:?}");
    let share = (end.kinetic + end.internal) / (start.kinetic + start.internal);
    // Energy loss of bodies of particles in contact by these springs, which are damped (`reference.rs`).
    assert!(share > 0.84 && share < 1.02, "energy {share}");
}

/// A single lattice moves as without a grid, bit for bit.
#[test]
fn alone_it_is_as_without_the_grid() {
    let mut mpm = Mpm::with_contact(
        plane(),
        BlockGrid::new(lattice()),
        GridContact::new(surfaces(), Pairs::new(law())),
    );
    mpm.add_client(springs_at(1.0)).expect("client");
    let mut alone = springs_at(1.0);
    let mut out = vec![[0.0; 3]; alone.len()];
    for _ in 0..100 {
        let dt = mpm.step().expect("step");
        alone.open(dt, &mut out, &Team::one()).expect("open");
        alone.advance(dt, None, &Team::one()).expect("advance");
    }
    let there: Vec<[f64; 3]> = mpm.bodies()[0].points().iter().map(|p| p.position).collect();
    let here: Vec<[f64; 3]> = alone.positions.iter().map(|[x, y]| [*x, *y, 0.0]).collect();
    assert_eq!(there, here);
}

#[test]
fn it_is_resumed_and_threads_change_nothing() {
    let file = std::env::temp_dir().join(format!("impactite-client-{}", std::process::id()));
    let (mut whole, mut first) = (scene(), scene());
    whole.set_team(Team::new(3).expect("threads"));
    let end = |mpm: &mut Mpm<2>, steps: usize| {
        for _ in 0..steps {
            mpm.step().expect("step");
        }
    };
    end(&mut whole, 150);
    end(&mut first, 70);
    first.save(&file).expect("saved");
    let mut again = scene().resumed(&file).expect("resumed");
    std::fs::remove_file(&file).expect("removed");
    end(&mut again, 80);
    assert_eq!(again.totals(), whole.totals());
    assert_eq!(again.bodies()[1].points(), whole.bodies()[1].points());
    assert_eq!(Solver::contacts(&again), Solver::contacts(&whole));
}

#[test]
fn what_cannot_be_is_refused() {
    let coulomb = || Pairs::new(Coulomb::new(0.3).expect("law"));
    let mut together = Mpm::with_contact(
        Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain),
        BlockGrid::new(lattice()),
        GridContact::new(Regression, coulomb()),
    );
    assert!(matches!(together.add_client(springs_at(1.0)), Err(SceneError::NotWith { .. })));
    let mut one = Mpm::with_contact(plane(), BlockGrid::new(lattice()), OneField);
    assert!(matches!(one.add_client(springs_at(1.0)), Err(SceneError::NoContact(_))));
    let free = || GridContact::new(Regression, Pairs::new(Frictionless));
    let mut mpm = Mpm::with_contact(plane(), BlockGrid::new(lattice()), free());
    let wide = Springs::block([0.3; 2], [3, 3], 1.5 * H, [0.0; 2]);
    assert!(matches!(mpm.add_client(wide), Err(SceneError::HalfSize { .. })));
    mpm.add_client(springs_at(1.0)).expect("client");
    assert!(matches!(mpm.add_client(springs_at(1.0)), Err(SceneError::Name { .. })));
    let refused = mpm.set_kinetic_damping(true).expect_err("kinetic damping").to_string();
    assert!(refused.contains("`springs`"), "{refused}");
    mpm.set_body_force(|_| [0.0, -9.81]);
    let stopped = mpm.step().expect_err("gravity").to_string();
    assert!(
        stopped.contains("a body force of the scene is not allowed beside the body `springs`"),
        "{stopped}"
    );
}
