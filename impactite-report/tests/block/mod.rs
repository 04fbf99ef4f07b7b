//! Test scene: a block of points in the plane, connected by springs, that falls on a wall.

use impactite_scene::observe::Observer;
use impactite_scene::{
    Archive, Body, CheckpointError, Clock, Exchange, Finding, PointView, Run, RunSummary, Solver, StepError,
    StepLimit, Totals, Warning,
};
use impactite_simd::Team;

/// Number of points along x and y; `SPACING`: their distance, m.
const SIZE: [usize; 2] = [16, 10];
const SPACING: f64 = 0.01;
/// Mass of a point, kg per metre of depth; `STIFFNESS` of a spring, N/m per metre of depth.
const MASS: f64 = 0.1;
const STIFFNESS: f64 = 1.0e7;
/// Initial downward speed, m/s.
const SPEED: f64 = 8.0;
/// Time step, s: a small fraction of the period of a point between eight springs.
const STEP: f64 = 5.0e-6;
/// Step at which the run warns.
const WARNS: u64 = 300;

/// Block of points; a report shows its name and law.
pub struct Block {
    clock: Clock,
    points: Points,
    exchange: Exchange,
    warnings: Vec<Warning>,
}

struct Points {
    name: String,
    positions: Vec<[f64; 2]>,
    velocities: Vec<[f64; 2]>,
    /// Springs: indices of two points, and rest length, m.
    springs: Vec<([usize; 2], f64)>,
}

impl Block {
    /// Create the block in its initial state, with this name.
    pub fn new(name: &str) -> Self {
        let [nx, ny] = SIZE;
        let place = |n: usize| [(n % nx) as f64 * SPACING, (n / nx) as f64 * SPACING + 0.3 * SPACING];
        let positions: Vec<[f64; 2]> = (0..nx * ny).map(place).collect();
        let mut springs = Vec::new();
        for a in 0..positions.len() {
            for b in a + 1..positions.len() {
                let length = distance(positions[a], positions[b]);
                if length < 1.5 * SPACING {
                    springs.push(([a, b], length));
                }
            }
        }
        let velocities = vec![[0.0, -SPEED]; positions.len()];
        let points = Points { name: name.into(), positions, velocities, springs };
        Block { clock: Clock::default(), points, exchange: Exchange::default(), warnings: Vec::new() }
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl Body for Points {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        "springs <b>& dashpots</b>"
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
            sum.add_point(MASS, x, v);
        }
        for &([a, b], length) in &self.springs {
            let stretch = distance(self.positions[a], self.positions[b]) - length;
            sum.internal += 0.5 * STIFFNESS * stretch * stretch;
        }
        sum
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        for (number, (x, v)) in self.positions.iter().zip(&self.velocities).enumerate() {
            visit(&PointView {
                number,
                position: [x[0], x[1], 0.0],
                velocity: [v[0], v[1], 0.0],
                mass: MASS,
                volume: SPACING * SPACING,
                in_range: true,
                ..PointView::default()
            });
        }
    }
    fn bytes(&self) -> usize {
        64 * self.positions.len()
    }
}

impl Solver for Block {
    fn method(&self) -> String {
        "points and springs".into()
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
        Ok(STEP)
    }
    fn limited_by(&self) -> Option<StepLimit> {
        Some(StepLimit::Body(0))
    }
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError> {
        let dt = self.clock.step_within(STEP, left)?;
        let Points { positions, velocities, springs, .. } = &mut self.points;
        for &([a, b], length) in springs.iter() {
            let now = distance(positions[a], positions[b]);
            for d in 0..2 {
                let force = STIFFNESS * (now - length) * (positions[b][d] - positions[a][d]) / now;
                velocities[a][d] += force * dt / MASS;
                velocities[b][d] -= force * dt / MASS;
            }
        }
        for (x, v) in positions.iter_mut().zip(velocities.iter_mut()) {
            // The wall reflects points.
            if x[1] <= 0.0 && v[1] < 0.0 {
                self.exchange.impulse[1] -= 2.0 * MASS * v[1];
                v[1] = -v[1];
            }
            for d in 0..2 {
                x[d] += v[d] * dt;
            }
        }
        self.clock.advance(dt);
        if self.clock.steps == WARNS {
            let body = self.points.name.clone();
            let finding = Finding::Torn { body, parts: 2, before: 1, share: 0.125 };
            self.warnings.push(Warning { step: self.clock.steps, time: self.clock.time, finding });
        }
        Ok(dt)
    }
    fn set_team(&mut self, _: Team) {}
    fn bodies(&self) -> Vec<&dyn Body> {
        vec![&self.points]
    }
    fn exchange(&self) -> Exchange {
        self.exchange
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.clock.archive(file)?;
        self.exchange.archive(file)?;
        let Points { positions, velocities, .. } = &mut self.points;
        file.reals(positions.iter_mut().flatten())?;
        file.reals(velocities.iter_mut().flatten())
    }
    fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}

/// Temporary folder of a test, removed on drop.
pub struct Folder(pub std::path::PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("impactite-report-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Folder(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Kept for inspection if requested by the environment.
        if std::env::var_os("IMPACTITE_KEEP").is_none() {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

/// Run a block until `end`, s, with `observers`.
pub fn run<'a>(block: &'a mut Block, end: f64, observers: Vec<&'a mut dyn Observer>) -> RunSummary {
    Run::new(block).observe_all(observers).until(end).expect("a run")
}
