//! Long-time contact of finite elements.

use fem::{Fem, Hourglass, MeshBody, Technology};
use impactite_geometry::structured::{Butterfly, ball_mesh};
use impactite_geometry::{Ball, ElementKind};
use impactite_scene::{Boundary, PlaneStrain, Side, Solver, TimeControl};
use mpm_contact::Coulomb;
use verification::problems::rubber;

use crate::stage::text;
use crate::verdict::{Limit, Measured, Scene, Size, Stop};

/// Finite element balls in a shaken box.
struct Shaken {
    fem: Fem<2>,
    edge: f64,
}

/// Contact and integration settings of a run.
#[derive(Clone, Copy)]
struct How {
    /// Friction coefficient of the balls; no contact between balls if none.
    friction: Option<f64>,
    /// True if walls have friction, too.
    rough: bool,
    technology: Technology,
    /// Fraction of the stable time step.
    factor: f64,
}

const SPRINGS: Technology = Technology::OnePoint(Hourglass::Stiffness(0.05));
const SMOOTH: How =
    How { friction: Some(0.0), rough: false, technology: Technology::MeanDilatation, factor: 0.5 };

/// Radius of the balls, m, and velocity amplitude of the box, m/s.
const RADIUS: f64 = 1.0;
const SHAKE: f64 = 0.05;

impl Shaken {
    /// Build sixteen discs in a shaken box, in the frame of the box with a body force.
    fn new(how: &How) -> Result<Self, String> {
        let mut fem = Fem::new(PlaneStrain);
        let edge = 10.0;
        for n in 0..16 {
            let [x, y] = [n % 4, n / 4].map(|k| 1.25 + 2.4 * f64::from(k));
            let ball = Ball::new([x + 0.1 * f64::from(n / 4 % 2), y], RADIUS).map_err(text)?;
            let mesh = ball_mesh(&ball, Butterfly { core: 2, rings: 1 }).map_err(text)?;
            let body = MeshBody::new(format!("ball {n}"), mesh, rubber(1.0, 1.0, 0.3)?);
            fem.add(body.with(ElementKind::Quad4, how.technology)).map_err(text)?;
        }
        for axis in 0..2 {
            for (at, side) in [(0.0, Side::Above), (edge, Side::Below)] {
                let wall = match how.rough {
                    true => Boundary::FrictionWall { axis, at, side, velocity: [0.0; 2], friction: 0.3 },
                    false => Boundary::Wall { axis, at, side, velocity: 0.0 },
                };
                fem.bound(wall).map_err(text)?;
            }
        }
        let turn = 2.0 * std::f64::consts::PI / 60.0;
        fem.set_body_force(std::sync::Arc::new(move |t| {
            [SHAKE * turn * (turn * t).cos(), -0.3 * SHAKE * turn * (0.7 * turn * t).sin() - 1e-3]
        }));
        if let Some(mu) = how.friction {
            fem.touch(Coulomb::new(mu).map_err(text)?).map_err(text)?;
        }
        fem.set_time_control(TimeControl::Courant { factor: how.factor, growth: 1.1 }).map_err(text)?;
        Ok(Shaken { fem, edge })
    }

    /// Centres of the balls, m.
    fn centres(&self) -> Vec<[f64; 2]> {
        let centre = |body: &fem::ElementBody<2>| {
            let n = body.nodes().len() as f64;
            [0, 1].map(|d| body.nodes().iter().map(|node| node.position[d]).sum::<f64>() / n)
        };
        self.fem.element_bodies().iter().map(centre).collect()
    }

    /// Return true if a ball is outside the box, or two balls overlap by half.
    fn is_lost(&self) -> bool {
        let centres = self.centres();
        let out = |x: &[f64; 2]| x.iter().any(|x| !(0.3 * RADIUS..=self.edge - 0.3 * RADIUS).contains(x));
        let within = |n: usize| {
            let near =
                |y: &[f64; 2]| (0..2).map(|d| (centres[n][d] - y[d]).powi(2)).sum::<f64>() < RADIUS * RADIUS;
            centres[n + 1..].iter().any(near)
        };
        centres.iter().any(out) || (0..centres.len()).any(within)
    }
}

const FOLDS: &str = "a disc of twelve elements folds in hourglass modes, whose springs hold several times the rest of its energy, and gains from step 7e4 on; the \
                     watch stops it in step 74496. So does a disc alone between the walls, in steps of 0.9: it is not contact";

/// E2: shaken box of balls.
pub fn balls() -> Scene {
    fn trial(how: How) -> impl Fn(Size) -> Result<Measured, String> {
        move |size| {
            let count: u64 = if size == Size::Fast { 4_000 } else { 100_000 };
            let mut scene = Shaken::new(&how)?;
            let (mut gained, mut most, mut left) = (0.0f64, 0.0f64, 0.0f64);
            for step in 1..=count {
                if let Err(e) = scene.fem.step_at_most(f64::INFINITY) {
                    let stop = Stop { step: e.step, what: e.to_string() };
                    return Ok(Measured::new(f64::NAN, step).stopped(Some(stop)));
                }
                if step % 50 == 0 {
                    // Scale: largest energy supplied so far, including work returned later.
                    let account = scene.fem.account();
                    most = most.max(account.work.abs()).max(account.energy_scale);
                    let scale = most.max(account.friction + account.impacts);
                    gained = gained.max(account.unexplained / scale);
                    left = account.unexplained / scale;
                    if scene.is_lost() {
                        let said = format!("a ball is out of the box, or in another, in step {step}");
                        return Ok(Measured::new(f64::INFINITY, step).since(Some(said)));
                    }
                }
            }
            let account = scene.fem.account();
            let said = format!(
                "work {:.3e} J, of that friction {:.3e}, impacts {:.3e}; {left:.1e} of it unexplained at the end",
                account.work, account.friction, account.impacts
            );
            Ok(Measured::new(gained, count).since(Some(said)))
        }
    }
    Scene {
        id: "E2",
        name: "a shaken box of balls",
        fails: "Sixteen discs of elements in a box that is shaken, 1e5 steps (tests: 4000). Contact that pushes on velocities and not on means, or \
                mends depths, makes energy; what finds one contact late lets a ball out.",
        metric: "largest energy gained beyond what was given, over all that was given; infinite if a ball is out or in another",
        limit: Limit::AtMost(3e-4),
        rows: Vec::new(),
    }
    .fails("control: bodies that do not touch", "control", trial(How { friction: None, ..SMOOTH }))
    .holds("frictionless", "own", trial(SMOOTH))
    .holds("friction 0.3", "own", trial(How { friction: Some(0.3), ..SMOOTH }))
    .holds("friction 0.3, rough walls", "own", trial(How { friction: Some(0.3), rough: true, ..SMOOTH }))
    .holds("one point, springs of 0.05", "own", trial(How { technology: SPRINGS, ..SMOOTH }))
    .but(|row| row.noted_when_long(FOLDS))
    .fails("steps of 0.9", "waves near the limit, in any impact: 6e-4 on a wall", trial(How { factor: 0.9, ..SMOOTH }))
}
