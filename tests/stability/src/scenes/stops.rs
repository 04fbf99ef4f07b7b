//! Breakdowns that must stop the run and report their location.

use std::sync::Arc;

use mpm_core::{
    BlockGrid, Deformable, DenseGrid, FieldForce, Flip, GridStorage, Method, Mpm, Musl, PlaneStrain,
    QuadraticBSpline, Stopped, TimeControl,
};
use verification::Scheme;
use verification::empty::empty_scene;
use verification::problems::rubber;
use verification::scene::block;

use crate::stage::{
    ApicUsl, CpGimp, Cubic, FlipMusl, FlipUsl, Linear, Quadratic, bar, cells, named, row_of_cells, solver,
    text, tl, ul, until_stopped,
};
use crate::verdict::{Limit, Measured, Scene, Size, Stop};

/// Measure 1 if the run stopped as required, else 0, with its message.
fn said(good: bool, step: u64, what: Option<String>) -> Measured {
    let said = what.or_else(|| Some("it did not stop".into()));
    Measured::new(f64::from(good), step).since(said)
}

/// T14: inverted volumes.
pub fn inverted() -> Scene {
    fn trial(scheme: Scheme, speed: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            // Collision of two halves within a cell: dt grad v is below -1 there.
            let seeds = row_of_cells(10, 2, 0.0)?;
            let middle = 4.5;
            let v = move |x: f64| if x < middle { speed } else { -speed };
            let mut mpm = bar(scheme, 0.3, &seeds, &v)?;
            let Some(error) = until_stopped(&mut mpm, 3) else { return Ok(said(false, 3, None)) };
            let near = named(&error).is_some_and(|(body, _, x)| body == "bar" && (x[0] - middle).abs() < 2.0);
            let cause = error.to_string().contains("inverted") || error.to_string().contains("volume");
            Ok(said(near && cause, error.step, Some(error.to_string())))
        }
    }
    Scene {
        id: "T14",
        name: "turned inside out",
        fails: "Two halves of a bar run into each other with 0.9 cells a step each. Points there get a negative volume; a law that \
                takes its logarithm goes on with NaN, one that does not with its mirror image.",
        metric: "stops within three steps and names body, particle there and cause (1) or not (0)",
        limit: Limit::AtLeast(1.0),
        rows: Vec::new(),
    }
    .fails("control: a tenth of the speed", "control", trial(ul(Linear, FlipMusl), 0.3))
    .holds("linear FLIP-MUSL", "list T14", trial(ul(Linear, FlipMusl), 3.0))
    .holds("linear FLIP-USL", "list T14", trial(ul(Linear, FlipUsl), 3.0))
    .holds("cpGIMP FLIP-MUSL", "list T14", trial(ul(CpGimp, FlipMusl), 3.3))
    .holds("TL linear FLIP-MUSL", "list T14", trial(tl(Linear, FlipMusl), 3.0))
}

/// T21: NaN force.
pub fn not_a_number() -> Scene {
    fn trial(scheme: Scheme, seeded: bool) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let lattice = cells()?;
            let seeds = block(&lattice, [0; 2], [12; 2], 2);
            let dt = 0.2;
            let mut mpm = solver(scheme, dt)?;
            let bad = seeds.positions[301];
            // Force on one particle: NaN from the start of step 101 on.
            let drive =
                Arc::new(
                    move |start: &[f64; 2], t: f64| {
                        if seeded && *start == bad && t > 99.5 * dt { [f64::NAN, 0.0] } else { [0.0; 2] }
                    },
                );
            let law = rubber(1.0, 1.0, 0.3)?;
            mpm.add_body(
                Deformable::new("block", law, &seeds)
                    .moving(|x| [0.01 * x[1].sin(), 0.0])
                    .with_field_force(FieldForce { acceleration: drive }),
            )
            .map_err(text)?;
            let Some(error) = until_stopped(&mut mpm, 110) else { return Ok(said(false, 110, None)) };
            // Tolerance: from the nodes of one particle to those of another, plus half a cell for a reported bin
            // centre.
            let reach = 0.5 + scheme.kernel.nodes(1) as f64;
            let near = named(&error).is_some_and(|(body, _, x)| {
                body == "block" && (0..2).all(|d| (x[d] - bad[d]).abs() <= reach)
            });
            let law = error.to_string().contains("neo-Hookean") && error.to_string().contains("not a number");
            Ok(said(near && law && error.step == 101, error.step, Some(error.to_string())))
        }
    }
    Scene {
        id: "T21",
        name: "not a number",
        fails: "The force on one particle of 576 is NaN from step 101 on. Without a check it is all over the grid three steps later.",
        metric: "stops in step 101 and names body, a particle within reach, law and cause (1) or not (0)",
        limit: Limit::AtLeast(1.0),
        rows: Vec::new(),
    }
    .fails("control: no NaN", "control", trial(ul(Quadratic, ApicUsl), false))
    .holds("linear FLIP-MUSL", "list T21", trial(ul(Linear, FlipMusl), true))
    .holds("quadratic APIC", "list T21", trial(ul(Quadratic, ApicUsl), true))
    .holds("cubic FLIP-USL", "list T21", trial(ul(Cubic, FlipUsl), true))
    .holds("TL quadratic APIC", "list T21", trial(tl(Quadratic, ApicUsl), true))
}

/// Run a stone that moves along x, beside one at rest.
fn throw(grid: impl GridStorage<f64, 2> + 'static) -> Result<Measured, String> {
    let method = Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain);
    let mut mpm = Mpm::new(method, grid);
    let lattice = cells()?;
    mpm.add("rock", rubber(1.0, 1.0, 0.3)?, &block(&lattice, [1; 2], [2; 2], 2), |_| [0.0; 2])
        .map_err(text)?;
    let seeds = block(&lattice, [5; 2], [2; 2], 2);
    mpm.add("stone", rubber(1.0, 1.0, 0.3)?, &seeds, |_| [1.0, 0.0]).map_err(text)?;
    mpm.set_time_control(TimeControl::Fixed(0.3)).map_err(text)?;
    for step in 0..60 {
        let Err(error) = mpm.step() else { continue };
        let what = error.to_string();
        // The error must name one of the foremost particles, with body and position.
        let mut front = f64::MIN;
        mpm.bodies()[1].for_each(&mut |p| front = front.max(p.position[0]));
        let named = match &error.what {
            Stopped::Outside { body, position, .. } => body == "stone" && position[0] > front - 1.0,
            _ => false,
        };
        return Ok(said(named, step, Some(what)));
    }
    Ok(said(false, 60, None))
}

/// T16: particle leaving the grid.
pub fn leaving() -> Scene {
    Scene {
        id: "T16",
        name: "off the grid",
        fails: "A stone flies off the end of a grid of fixed size. An array is read beyond its end, or the particle is gone without a word.",
        metric: "stops and names body, particle in front and place (1) or not (0)",
        limit: Limit::AtLeast(1.0),
        rows: Vec::new(),
    }
    .fails("control: block grid, which has no end", "control", |_| throw(BlockGrid::new(cells()?)))
    .holds("dense grid", "list T16", |_| throw(DenseGrid::new(cells()?, [-4; 2], [15; 2]).map_err(text)?))
}

/// Run the debris on a grid of fixed size: it must stop, not lose particles.
fn walled() -> Result<Measured, String> {
    let grid = DenseGrid::new(cells()?, [-16; 2], [15; 2]).map_err(text)?;
    let method = Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain);
    let mut mpm = Mpm::new(method, grid);
    mpm.set_time_control(TimeControl::Courant { factor: 0.4, growth: 1.1 }).map_err(text)?;
    let seeds = block(&cells()?, [-2; 2], [4; 2], 2);
    let law = rubber(1.0, 1e-8, 0.3)?;
    mpm.add("debris", law, &seeds, |x| [1e4 * (x[0] + 0.5), 1e4 * x[1]]).map_err(text)?;
    let start = mpm.totals();
    for step in 0..2000 {
        if let Err(e) = mpm.step() {
            let stop = Stop { step: e.step, what: e.to_string() };
            return Ok(Measured::new(f64::NAN, step).stopped(Some(stop)));
        }
    }
    Ok(Measured::new((mpm.totals().mass / start.mass - 1.0).abs(), 2000))
}

/// T16: debris on a sparse grid.
pub fn debris() -> Scene {
    fn trial(scheme: Scheme) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let seeds = block(&cells()?, [-2; 2], [4; 2], 2);
            let mut mpm = empty_scene(scheme, cells()?).ok_or("no such composition")?;
            mpm.set_time_control(TimeControl::Courant { factor: 0.4, growth: 1.1 }).map_err(text)?;
            let law = rubber(1.0, 1e-8, 0.3)?;
            mpm.add("debris", law, &seeds, |x| [1e4 * (x[0] + 0.5), 1e4 * x[1]]).map_err(text)?;
            let start = mpm.totals();
            let mut worst = 0.0f64;
            for step in 0..2000 {
                if let Err(e) = mpm.step() {
                    let stop = Stop { step: e.step, what: e.to_string() };
                    return Ok(Measured::new(f64::NAN, step).stopped(Some(stop)));
                }
                let t = mpm.totals();
                let p = (0..2).map(|d| (t.momentum[d] - start.momentum[d]).abs()).fold(0.0, f64::max);
                let lost = (p / start.momentum_scale).max((t.mass / start.mass - 1.0).abs());
                worst = if lost > worst || lost.is_nan() { lost } else { worst };
                if t.particles != start.particles {
                    worst = f64::INFINITY;
                }
            }
            Ok(Measured::new(worst, 2000))
        }
    }
    Scene {
        id: "T16d",
        name: "debris",
        fails: "A block bursts at 25 km/s on a grid that goes where the particles are, 2000 steps: 64 particles over 1e3 cells.",
        metric: "largest change of mass or momentum, over its scale",
        limit: Limit::AtMost(1e-12),
        rows: Vec::new(),
    }
    .fails("quadratic FLIP-MUSL, dense grid", "list T16: static array", |_| walled())
    .holds("linear FLIP-MUSL", "list T16", trial(ul(Linear, FlipMusl)))
    .holds("quadratic APIC", "list T16", trial(ul(Quadratic, ApicUsl)))
    .holds("cubic FLIP-USL", "list T16", trial(ul(Cubic, FlipUsl)))
}
