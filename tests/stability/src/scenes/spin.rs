//! Rotating bodies.

use std::f64::consts::PI;

use mpm_core::geometry::{Ball, Filling, Seeds, fill};
use mpm_core::{
    Apic, BlockGrid, GridBody, Method, Mpm, Pic, PlaneStrain, QuadraticBSpline, TimeControl, Usl,
};
use mpm_materials::{
    Constitutive, IntoMaterial, J2, LinearElastic, LogarithmicBulk, Moduli, SmallRotation, Solid, Sym3,
};
use verification::Scheme;
use verification::problems::rubber;

use crate::stage::{
    ApicUsl, Cubic, FlipMusl, FlipUsl, Fmpm4Usl, Gimp, Linear, Means, Quadratic, cells, solver, steps, text,
    tl, ul,
};
use crate::verdict::{Limit, Measured, Row, Scene, Size, Stop};

const RADIUS: f64 = 8.0;
/// Angular velocity: rim speed of 0.3 bar wave speeds.
const OMEGA: f64 = 0.3 / RADIUS;
const DT: f64 = 0.3;

fn round() -> Result<Seeds<2>, String> {
    let disc = Ball::new([0.0; 2], RADIUS).map_err(text)?;
    fill(&disc, &cells()?, 2, &Filling::new()).map_err(text)
}

fn turning(x: [f64; 2]) -> [f64; 2] {
    [-OMEGA * x[1], OMEGA * x[0]]
}

fn count(turns: f64) -> u64 {
    (2.0 * PI * turns / (OMEGA * DT)).round() as u64
}

/// Measure the change of the particles' angular momentum between the means of the first and of the last half turn. Means are used since the
/// disc breathes, and with it the fraction (h/R)^2 in the affine matrices of APIC.
fn spin(mpm: &mut Mpm<2>, turns: f64) -> Result<Measured, String> {
    mpm.add("disc", rubber(1.0, 1.0, 0.3)?, &round()?, turning).map_err(text)?;
    let all = count(turns);
    let mut means = Means::new(all, (2.0 * turns) as u64);
    let stop = steps(mpm, all, |now, step| means.add(step, now.totals().angular_momentum[2]));
    let made = stop.as_ref().map_or(all, |s| s.step - 1);
    Ok(Measured::new(means.change().abs(), made).stopped(stop))
}

/// Cause of the angular momentum change in the reference configuration, mean over twenty turns.
const REFERENCE: &str =
    "in the reference configuration the affine matrix turns about places that do not turn: 1.3e-4 a turn";

/// T19: spinning disc.
pub fn disc() -> Scene {
    fn all(size: Size) -> f64 {
        if size == Size::Fast { 2.0 } else { 20.0 }
    }
    fn trial(scheme: Scheme) -> impl Fn(Size) -> Result<Measured, String> {
        move |size| spin(&mut solver(scheme, DT)?, all(size))
    }
    let pic = |size| {
        let method = Method::new(QuadraticBSpline, Pic, Usl, PlaneStrain).compiled();
        let mut mpm = Mpm::new(method, BlockGrid::new(cells()?));
        mpm.set_time_control(TimeControl::Fixed(DT)).map_err(text)?;
        spin(&mut mpm, all(size))
    };
    const WHY: &str = "particles move with the grid's velocity and keep their own: FLIP does not conserve angular momentum (book, Verification)";
    let affine = |row: Row| row.limit(Limit::AtMost(1e-3));
    Scene {
        id: "T19",
        name: "spinning disc",
        fails: "A disc of 8 cells turns 20 times (tests: 2), its rim at 0.3 c. Averaging over the grid takes its spin, \
                (p + 1) h^2 / 3 R^2 a step with PIC.",
        metric: "change of the particles' angular momentum (APIC: their part of it), last half turn against the first",
        limit: Limit::AtMost(1e-4),
        rows: Vec::new(),
    }
    .fails("quadratic PIC", "list T19, finding 4 [C]", pic)
    .fails("quadratic FMPM(4)", "book, Verification [C]", trial(ul(Quadratic, Fmpm4Usl)))
    .holds("quadratic APIC", "list T19, V6 [C]", trial(ul(Quadratic, ApicUsl)))
    .but(affine)
    .holds("cubic APIC", "list T19, V6 [C]", trial(ul(Cubic, ApicUsl)))
    .but(affine)
    .holds("TL quadratic APIC", "list T19, V6 [C]", trial(tl(Quadratic, ApicUsl)))
    .but(|row| row.limit(Limit::AtMost(1e-3)).noted_when_long(REFERENCE))
    .holds("quadratic FLIP-MUSL", "list T19", trial(ul(Quadratic, FlipMusl)))
    .but(|row| row.noted(WHY))
    .holds("quadratic FLIP-USL", "list T19", trial(ul(Quadratic, FlipUsl)))
    .but(|row| row.noted(WHY))
    .fails("uGIMP FLIP-MUSL", "list T19", trial(ul(Gimp, FlipMusl)))
    .holds("TL linear FLIP-MUSL", "list T19", trial(tl(Linear, FlipMusl)))
    .but(|row| row.noted(WHY))
}

/// State of a disc after some turns.
struct Turned {
    /// Growth: root mean square radius over the initial one, minus 1.
    growth: f64,
    /// Largest von Mises stress, Pa.
    equivalent: f64,
    steps: u64,
    stop: Option<Stop>,
}

fn turn(law: impl IntoMaterial<f64>, turns: f64) -> Result<Turned, String> {
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(cells()?));
    mpm.add("disc", law, &round()?, turning).map_err(text)?;
    mpm.set_time_control(TimeControl::Fixed(DT)).map_err(text)?;
    let radius = |bodies: &[Box<dyn GridBody<f64, 2>>]| {
        let (mut squares, mut n) = (0.0, 0.0);
        bodies[0].for_each(&mut |p| {
            squares += p.position[0].powi(2) + p.position[1].powi(2);
            n += 1.0;
        });
        f64::sqrt(squares / n)
    };
    let start = radius(mpm.bodies());
    let all = count(turns);
    let mut turned = Turned { growth: f64::NAN, equivalent: f64::NAN, steps: all, stop: None };
    for step in 0..all {
        if let Err(e) = mpm.step() {
            turned.stop = Some(Stop { step: e.step, what: e.to_string() });
            turned.steps = step;
            return Ok(turned);
        }
    }
    turned.growth = radius(mpm.bodies()) / start - 1.0;
    turned.equivalent = 0.0;
    mpm.bodies()[0].for_each(&mut |p| {
        turned.equivalent = turned.equivalent.max(Sym3(p.stress).deviator().equivalent());
    });
    Ok(turned)
}

fn turns(size: Size) -> f64 {
    if size == Size::Fast { 4.0 } else { 10.0 }
}

fn moduli() -> Result<Moduli<f64>, String> {
    Moduli::young_poisson(1.0, 0.3).map_err(text)
}

fn elastic() -> Result<LinearElastic<f64>, String> {
    LinearElastic::new(1.0, moduli()?).map_err(text)
}

fn metal() -> Result<Solid<J2<f64>, LogarithmicBulk<f64>>, String> {
    let strength = J2::linear(moduli()?.shear, 1.0, 0.0).map_err(text)?;
    Ok(Solid::new(strength, LogarithmicBulk::new(1.0, moduli()?.bulk).map_err(text)?))
}

/// O1: laws in rate form under large rotation, measured by the size of a disc.
pub fn size() -> Scene {
    fn trial<C: IntoMaterial<f64> + 'static>(
        law: fn() -> Result<C, String>,
    ) -> impl Fn(Size) -> Result<Measured, String> {
        move |size| {
            let found = turn(law()?, turns(size))?;
            Ok(Measured::new(found.growth.abs(), found.steps).stopped(found.stop))
        }
    }
    Scene {
        id: "O1",
        name: "large rotation: size",
        fails: "The disc of T19, 0.011 rad a step, ten turns (tests: 4). A particle goes straight along the tangent of its circle; a law that takes \
                its strain from the velocity gradient to first order sees the way back onto the circle as a compression, in every step.",
        metric: "growth of the mean radius; the centrifugal force alone makes 2 to 3 %",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    }
    .holds("linear elastic", "list T19", trial(elastic))
    .fails("linear elastic, small rotation", "list T19", trial(|| Ok(elastic()?.with_rate(SmallRotation).compiled())))
    .holds("neo-Hookean", "by the deformation gradient", trial(|| rubber(1.0, 1.0, 0.3)))
}

/// O2: laws in rate form under large rotation, measured by the stress.
pub fn stress() -> Scene {
    fn trial<C: IntoMaterial<f64> + 'static>(
        law: fn() -> Result<C, String>,
    ) -> impl Fn(Size) -> Result<Measured, String> {
        move |size| {
            let found = turn(law()?, turns(size))?;
            Ok(Measured::new(found.equivalent, found.steps).stopped(found.stop))
        }
    }
    Scene {
        id: "O2",
        name: "large rotation: stress",
        fails: "The same disc of a metal whose pressure is that of its volume: its size is right, but the strain that is none goes into its \
                deviator, a few per cent of E after some turns, and may make it yield.",
        metric: "largest equivalent stress over E; the centrifugal force makes 0.03",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    }
    .holds("J2 with logarithmic pressure", "list T19", trial(metal))
    .fails("J2 with logarithmic pressure, small rotation", "list T19", trial(|| {
        Ok(metal()?.with_rate(SmallRotation).compiled())
    }))
    .holds("neo-Hookean", "by the deformation gradient", trial(|| rubber(1.0, 1.0, 0.3)))
}
