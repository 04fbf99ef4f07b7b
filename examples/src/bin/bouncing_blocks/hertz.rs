//! Slow collisions of two equal balls or cylinders: area, force and approach against Hertz.

use std::f64::consts::PI;
use std::path::Path;

use examples::blocks::ball::approach_over_hertz;
use examples::blocks::circles::Part;
use examples::blocks::hertz::{
    CURVATURE, DENSITY, POISSON, RADIUS, Row, STIFFNESS, YOUNG, collide, lasts, mean, top,
};
use examples::blocks::scene::Asked;
use examples::{CaseError, Check, Restart, worst};
use mpm_core::{Axisymmetric, Flip, Method, Musl, PlaneStrain, QuadraticBSpline};

use crate::{Outcome, figures};

/// Cells on the radius, and closing speeds over sqrt(E / rho), for a contact that is 6 cells wide.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub cells: u32,
    pub ball: f64,
    pub cylinder: f64,
}

/// Run balls and cylinders.
pub fn all(
    size: Size,
    asked: Asked,
    threads: usize,
    folder: &Path,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let h = RADIUS / f64::from(size.cells);
    let turned = Method::new(QuadraticBSpline, Flip, Musl, Axisymmetric);
    let plane = Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain);
    let task = |label: &str| Ok::<_, CaseError>(asked.in_simulation(restart.scene(label)?));
    let (balls, a) = collide(turned, Part::Ball, h, size.ball, task("balls")?, threads)?;
    let (cylinders, b) = collide(plane, Part::Half, h, size.cylinder, task("cylinders")?, threads)?;
    let (ball_top, cylinder_top) = (top(&balls), top(&cylinders));
    let radius = mean(ball_top, |r| r.width);
    let part = approach_over_hertz(radius / RADIUS, POISSON);
    figures::hertz(&balls, &cylinders, part, folder)?;
    let exact = "Hertz, V11";
    let near = 0.03;
    // Balls are no half spaces: the approach of their centres of mass is smaller.
    let whole = 1.0 - part;
    let over = |rows: &[Row], of: &dyn Fn(&Row) -> f64| mean(rows, of);
    let speed = size.ball * (YOUNG / DENSITY).sqrt();
    let mass = 0.5 * DENSITY * 4.0 / 3.0 * PI * RADIUS.powi(3);
    let deepest = (15.0 * mass * speed * speed / (16.0 * CURVATURE.sqrt() * STIFFNESS)).powf(0.4);
    let approach = balls.iter().map(|r| r.approach).fold(0.0, f64::max);
    let mut checks = vec![
        Check::at_least("balls: radius of contact", radius / h, "cells", 6.0, "V11"),
        Check::gate(
            "balls: radius over that of the force",
            over(ball_top, &|r| r.width / r.ball_radius()),
            "-",
            1.0,
            near,
            exact,
        ),
        Check::gate(
            "balls: force over that of the approach",
            over(ball_top, &|r| r.force / r.hertz_force(part)),
            "-",
            1.0,
            near,
            "Hertz, V11, approach of a ball's centre of mass [C]",
        ),
        Check::gate(
            "balls: the same, approach as in half spaces",
            over(ball_top, &|r| r.force / r.hertz_force(1.0)),
            "-",
            part.powf(-1.5),
            near,
            "a ball's centre of mass [C]",
        ),
        Check::gate("balls: largest approach", approach, "m", deepest, whole, "half spaces, V11"),
        Check::gate(
            "balls: duration",
            lasts(&balls),
            "s",
            2.943 * deepest / speed,
            whole,
            "half spaces, V11",
        ),
        Check::at_least(
            "cylinders: half width of contact",
            mean(cylinder_top, |r| r.width) / h,
            "cells",
            6.0,
            "V11",
        ),
        Check::gate(
            "cylinders: half width over that of the force",
            over(cylinder_top, &|r| r.width / r.cylinder_width()),
            "-",
            1.0,
            near,
            exact,
        ),
    ];
    let along = worst(balls.iter().chain(&cylinders).map(|r| r.momentum));
    checks.push(Check::gate("balls, cylinders: momentum along the axis", along, "-", 0.0, 1e-12, "V8"));
    Ok(Outcome { checks, totals: a.plus(&b) })
}
