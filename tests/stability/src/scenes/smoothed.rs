//! Smoothed particles where they are known to fail.

use impactite_geometry::{Cuboid, Filling, Lattice, Ring, Shape, fill};
use impactite_scene::{
    Axisymmetric, Body, Boundary, PlaneStrain, Side, Solver, StepError, TimeControl, Watch,
};
use mpm_contact::particles::Bodies;
use mpm_contact::{Frictionless, Pairs, SurfaceDistance};
use mpm_materials::{Elastic, LinearElastic, LogarithmicBulk, Moduli, NoFailure, Solid};
use sph::{
    Composition, CubicSpline, GradientCorrection, Layout, Method, NoCorrection, Sph, TotalLagrangian,
    Unstabilised, Updated, WendlandC2,
};

use crate::stage::text;
use crate::verdict::{Limit, Measured, Scene, Size, Stop};

type Rubber = Solid<Elastic<f64>, LogarithmicBulk<f64>, NoFailure>;

/// K 121.7, G 26.1 MPa, 1010 kg/m^3.
fn rubber() -> Result<Rubber, String> {
    let bulk = LogarithmicBulk::new(1010.0, 121.7e6).map_err(text)?;
    Ok(Solid::new(Elastic::new(26.1e6).map_err(text)?, bulk))
}

/// Modulus 1, density 1.
fn unit(poisson: f64) -> Result<LinearElastic<f64>, String> {
    LinearElastic::new(1.0, Moduli::young_poisson(1.0, poisson).map_err(text)?).map_err(text)
}

fn layout(shape: &impl Shape<2>, h: f64, axisymmetric: bool) -> Result<Layout<2>, String> {
    let filling = if axisymmetric { Filling::new().axisymmetric() } else { Filling::new() };
    let lattice = Lattice::new([0.0; 2], h).map_err(text)?;
    Ok(Layout::of_seeds(&fill(shape, &lattice, 1, &filling).map_err(text)?))
}

fn block(size: [f64; 2]) -> Result<Layout<2>, String> {
    layout(&Cuboid::new([0.0; 2], size).map_err(text)?, 1.0, false)
}

fn stop(error: &StepError) -> Option<Stop> {
    Some(Stop { step: error.step, what: error.to_string() })
}

/// Without stabilisation: total Lagrangian, and updated.
fn bare_total() -> impl Composition<2> {
    Method::new(PlaneStrain, WendlandC2::NARROW, TotalLagrangian::default(), GradientCorrection, Unstabilised)
}
fn bare_updated() -> impl Composition<2> {
    Method::new(PlaneStrain, WendlandC2::default(), Updated, GradientCorrection, Unstabilised)
}
fn plain() -> impl Composition<2> {
    Method::new(PlaneStrain, CubicSpline::default(), Updated, NoCorrection, Unstabilised)
}

/// S1.
pub fn checkerboard() -> Scene {
    fn trial<M: Composition<2>>(method: M) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let amplitude = 1e-4;
            let sign = |[x, y]: [f64; 2]| if (x.floor() + y.floor()) as i64 % 2 == 0 { 1.0 } else { -1.0 };
            let mut body = Sph::new(method, unit(0.3)?, &block([20.0; 2])?, |x| [amplitude * sign(x), 0.0])
                .map_err(text)?;
            body.set_watch(Watch::off());
            let start = body.positions().to_vec();
            let end = 100.0;
            if let Err(error) = body.run_until(end) {
                return Ok(Measured::new(f64::NAN, body.steps()).stopped(stop(&error)));
            }
            // In the middle, where no surface sees the alternation.
            let middle = |x: &[f64; 2]| x.iter().all(|x| (8.0..12.0).contains(x));
            let moved = |(x, y): (&[f64; 2], &[f64; 2])| (x[0] - y[0]).abs() / (amplitude * end);
            let inside = body.positions().iter().zip(&start).filter(|(_, y)| middle(y));
            Ok(Measured::new(inside.map(moved).fold(0.0, f64::max), body.steps()))
        }
    }
    Scene {
        id: "S1",
        name: "alternating velocities of smoothed particles",
        fails: "Velocities that alternate from particle to particle at zero stress: no velocity gradient sees them, and what has nothing else against \
                them lets particles fly through each other.",
        metric: "largest displacement in the middle over that of free flight",
        limit: Limit::AtMost(0.1),
        rows: Vec::new(),
    }
    .holds("total Lagrangian, zero-energy penalty", "gates 3.6", trial(Method::total_lagrangian(PlaneStrain)))
    .fails("total Lagrangian, no stabilisation", "gates 3.6", trial(bare_total()))
    .fails("updated, no stabilisation", "gates 3.6", trial(bare_updated()))
}

/// S2.
pub fn rotation() -> Scene {
    fn trial<M: Composition<2>>(method: M) -> impl Fn(Size) -> Result<Measured, String> {
        move |size| {
            let turns = if size == Size::Fast { 1.0 } else { 20.0 };
            let rate = 0.02;
            let spin = |[x, y]: [f64; 2]| [-rate * (y - 4.0), rate * (x - 4.0)];
            let mut body = Sph::new(method, unit(0.3)?, &block([8.0; 2])?, spin).map_err(text)?;
            body.set_watch(Watch::off());
            let before = Body::totals(&body);
            if let Err(error) = body.run_until(turns * 2.0 * std::f64::consts::PI / rate) {
                return Ok(Measured::new(f64::NAN, body.steps()).stopped(stop(&error)));
            }
            let after = Body::totals(&body);
            let spin = |t: &impactite_scene::Totals| {
                // About the middle, which stays.
                t.angular_momentum[2] - 4.0 * t.momentum[1] + 4.0 * t.momentum[0]
            };
            Ok(Measured::new((spin(&after) / spin(&before) - 1.0).abs(), body.steps()))
        }
    }
    Scene {
        id: "S2",
        name: "a spinning block of smoothed particles",
        fails: "A block that spins without load, its corners at a tenth of the wave speed: gradients that are not exact of linear fields strain it as \
                it turns, and forces along no line between particles brake it.",
        metric: "change of the angular momentum",
        limit: Limit::AtMost(1e-6),
        rows: Vec::new(),
    }
    .holds("total Lagrangian, zero-energy penalty", "gates 3.6", trial(Method::total_lagrangian(PlaneStrain)))
    .holds("updated, corrected, no stabilisation", "gates 3.6", trial(bare_updated()))
    .fails("updated, gradients as they are", "gates 3.6", trial(plain()))
    .fails("updated, artificial stress", "own", trial(Method::updated(PlaneStrain)))
}

/// S3.
pub fn axis() -> Scene {
    fn trial<M: Composition<2>>(method: M) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let square = Cuboid::new([0.0; 2], [12.0; 2]).map_err(text)?;
            let closing = |[r, z]: [f64; 2]| [-1e-3 * r, -1e-3 * z];
            let mut body =
                Sph::new(method, unit(0.3)?, &layout(&square, 1.0, true)?, closing).map_err(text)?;
            body.set_time_control(TimeControl::Fixed(1e-3)).map_err(text)?;
            body.step_at_most(f64::INFINITY).map_err(text)?;
            let stress = body.points()[0].stress[0];
            let mut worst = 0.0f64;
            for (i, x) in body.positions().iter().enumerate() {
                // Free surfaces accelerate.
                if x[0] < 6.0 && (5.0..7.0).contains(&x[1]) {
                    worst = worst.max((body.acceleration(i)[0] * x[0] / stress).abs());
                }
            }
            Ok(Measured::new(worst, 1))
        }
    }
    Scene {
        id: "S3",
        name: "a uniform stress of smoothed particles at an axis",
        fails: "A body of revolution under a uniform stress s: kernels that do not see the other side of the axis accelerate the rows beside it. Images \
                beyond it mend that, and do no work that goes with corrected gradients.",
        metric: "largest acceleration along the radius over s / (rho r)",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    }
    .holds("as printed, images beyond the axis", "gates 3.1", trial(Method::printed(Axisymmetric)))
    .fails(
        "total Lagrangian, corrected gradients without images",
        "book, \"Smoothed particles\"",
        trial(Method::total_lagrangian(Axisymmetric)),
    )
}

/// S4.
pub fn rebound() -> Scene {
    fn trial<M: Composition<2>>(method: M, mirror: bool) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let mut bar =
                Sph::new(method, unit(0.0)?, &block([4.0, 40.0])?, |_| [0.0, -0.002]).map_err(text)?;
            bar.set_watch(Watch::off());
            if mirror {
                bar.mirror_wall(1, 0.0, Side::Above).map_err(text)?;
            } else {
                bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })
                    .map_err(text)?;
            }
            let before = bar.totals().kinetic;
            if let Err(error) = bar.run_until(110.0) {
                return Ok(Measured::new(f64::NAN, bar.steps()).stopped(stop(&error)));
            }
            let after = bar.totals();
            let gained = (after.kinetic + after.internal + bar.exchange().impacts) / before - 1.0;
            Ok(Measured::new(gained.abs(), bar.steps()))
        }
    }
    Scene {
        id: "S4",
        name: "a bar of smoothed particles leaves a wall",
        fails: "An elastic bar on a rigid wall and off it again: images at a wall push, but do not do the work that the gradients beside it see, and may \
                hold what should leave.",
        metric: "energy that no book has, over that at impact",
        limit: Limit::AtMost(2e-3),
        rows: Vec::new(),
    }
    .holds("total Lagrangian, wall", "gates 3.6", trial(Method::total_lagrangian(PlaneStrain), false))
    .holds("updated, no stabilisation, wall", "gates 3.6", trial(bare_updated(), false))
    .fails("gradients as they are, wall of mirror images", "gates 3.6", trial(plain(), true))
}

/// S5.
pub fn rings() -> Scene {
    fn trial<M: Composition<2>>(method: M) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
            scene.set_watch(Watch::off());
            for (name, x, speed) in [("left", -41e-3, 30.0), ("right", 41e-3, -30.0)] {
                let ring = Ring::new([x, 0.0], 30e-3, 40e-3).map_err(text)?;
                let layout = layout(&ring, 2e-3, false)?;
                scene.add(name, Sph::new(method, rubber()?, &layout, |_| [speed, 0.0]).map_err(text)?);
            }
            if let Err(error) = scene.run_until(6e-3) {
                return Ok(Measured::new(f64::NAN, scene.steps()).stopped(stop(&error)));
            }
            // The farthest that a particle is from its nearest one: a ring that broke has gaps.
            let mut gap = 0.0f64;
            for body in scene.bodies() {
                let points = body.points();
                for p in &points {
                    let square = |q: &impactite_scene::PointView| {
                        (0..2).map(|d| (p.position[d] - q.position[d]).powi(2)).sum::<f64>()
                    };
                    let others = points.iter().filter(|q| q.number != p.number);
                    gap = gap.max(others.map(square).fold(f64::INFINITY, f64::min).sqrt());
                }
            }
            let speed = scene.totals_of(1).map_or(0.0, |t| t.momentum[0] / t.mass);
            let said = format!(
                "leave at {speed:.1} m/s; largest distance to the nearest one {:.2} spacings",
                gap / 2e-3
            );
            Ok(Measured::new(gap / 2e-3, scene.steps()).since(Some(said)))
        }
    }
    Scene {
        id: "S5",
        name: "rings of rubber of smoothed particles",
        fails: "Two rings of rubber at 30 m/s each are drawn out as they bounce: particles in tension clump, and the rings break by themselves.",
        metric: "largest distance of a particle to its nearest one after they parted, in spacings",
        limit: Limit::AtMost(1.3),
        rows: Vec::new(),
    }
    .holds("total Lagrangian, zero-energy penalty", "gates 3.4", trial(Method::total_lagrangian(PlaneStrain)))
    .fails("updated, no stabilisation", "gates 3.4", trial(bare_updated()))
}
