//! Cell crossing of particles.

use std::f64::consts::PI;

use mpm_core::TimeControl;
use verification::problems::rubber;
use verification::{Case, Problem, Scheme};

use crate::stage::{
    ApicUsl, CpGimp, Cubic, FlipMusl, FlipUsl, Fmpm4Usl, Gimp, Linear, Means, Quadratic, Random, bar, cells,
    energy, row_of_cells, steps, text, tl, ul,
};
use crate::verdict::{Limit, Measured, Row, Scene, Size, Stop};

/// Limit of ten per cent, which the list of scenes permits for FMPM(4).
fn filtered(row: Row) -> Row {
    row.limit(Limit::AtMost(0.10))
}

/// T1: energy of a drifting, vibrating bar.
pub fn drift() -> Scene {
    fn trial(scheme: Scheme) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let case = Case { problem: Problem::Drift, scheme, per_axis: 2, cells: 20, courant: 0.3 };
            let outcome = case.run();
            let stop = outcome.failure.clone();
            let stop = stop.map(|what| Stop { step: outcome.work.steps + 1, what });
            Ok(Measured::new(outcome.get("energy").abs(), outcome.work.steps).stopped(stop))
        }
    }
    let scene = Scene {
        id: "T1",
        name: "drifting, vibrating bar",
        fails: "A bar flies at 0.05 c and swings with 0.05 c, ten periods. The gradient of the hat jumps at nodes, so that a particle \
                that crosses gets a kick; with USL a node that one particle barely touches is thrown out.",
        metric: "change of energy, mean of the last period against the first",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    };
    let row = |s: Scene, scheme: Scheme| s.holds(scheme.name(), "list T1 [C]", trial(scheme));
    let scene = scene
        .fails("linear FLIP-USL", "list T1 [C]", trial(ul(Linear, FlipUsl)))
        .fails("linear FMPM(4)", "list T1 [C]", trial(ul(Linear, Fmpm4Usl)))
        .but(filtered)
        .fails("linear FLIP-MUSL", "book, The step, finding 6 [C]", trial(ul(Linear, FlipMusl)));
    let held = [
        ul(Gimp, FlipMusl),
        ul(CpGimp, FlipMusl),
        ul(Quadratic, FlipMusl),
        ul(Quadratic, ApicUsl),
        ul(Cubic, FlipMusl),
        ul(Cubic, ApicUsl),
        tl(Linear, FlipMusl),
        tl(Quadratic, ApicUsl),
    ];
    let scene = held.into_iter().fold(scene, row);
    row(scene, ul(Cubic, Fmpm4Usl)).but(filtered)
}

/// T2: order of convergence at large strain.
pub fn order() -> Scene {
    fn trial(scheme: Scheme, per_axis: usize) -> impl Fn(Size) -> Result<Measured, String> {
        move |size| {
            let grids = if size == Size::Fast { [8, 16, 32] } else { [16, 32, 64] };
            let (mut errors, mut steps) = (Vec::new(), 0);
            for cells in grids {
                let case = Case { problem: Problem::Axes, scheme, per_axis, cells, courant: 0.2 };
                let outcome = case.run();
                steps += outcome.work.steps;
                if let Some(what) = outcome.failure {
                    let stop = Stop { step: outcome.work.steps + 1, what };
                    return Ok(Measured::new(f64::NAN, steps).stopped(Some(stop)));
                }
                errors.push((cells as f64, outcome.get("u")));
            }
            // Order between the two finest grids, where a stalling or growing error is visible.
            let (coarse, fine) = (errors[1], errors[2]);
            let order = (coarse.1 / fine.1).ln() / (fine.0 / coarse.0).ln();
            Ok(Measured::new(order, steps))
        }
    }
    let scene = Scene {
        id: "T2",
        name: "order of convergence at 31 % strain",
        fails: "A square pulsates (V3, manufactured). When particles cross cells, sums over particles no longer are the integrals \
                they stand for: errors of hats rise with refinement, those of smoother functions stall.",
        metric: "order of the error of displacement between the two finest grids",
        limit: Limit::AtLeast(1.5),
        rows: Vec::new(),
    };
    scene
        .fails("linear FLIP-MUSL, 2", "list T2 [C]", trial(ul(Linear, FlipMusl), 2))
        .fails("uGIMP FLIP-USL, 2", "list T2 [C]", trial(ul(Gimp, FlipUsl), 2))
        .fails("quadratic FLIP-USL, 2", "list T2 [C]", trial(ul(Quadratic, FlipUsl), 2))
        .holds("cpGIMP FLIP-USL, 2", "list T2 [C]", trial(ul(CpGimp, FlipUsl), 2))
        .holds("cubic FLIP-USL, 3", "list T2 [C]", trial(ul(Cubic, FlipUsl), 3))
        .holds("quadratic FLIP-USL, 8", "list T2 [C]", trial(ul(Quadratic, FlipUsl), 8))
        .but(Row::slow)
        .holds("TL linear FLIP-USL, 2", "list T2 [C]", trial(tl(Linear, FlipUsl), 2))
        .holds("TL quadratic APIC, 2", "list T2 [C]", trial(tl(Quadratic, ApicUsl), 2))
}

/// Motion of a bar of 20 cells: drift and vibration.
#[derive(Clone, Copy)]
struct Flight {
    scheme: Scheme,
    drift: f64,
    swing: f64,
    /// Largest random shift of a particle along each axis, in particle spacings.
    jitter: f64,
    periods: u64,
}

impl Flight {
    /// Measure the energy change between the first and the last period.
    fn fly(self) -> Result<Measured, String> {
        let length = 20.0;
        let mut seeds = row_of_cells(20, 2, 0.0)?;
        let mut random = Random::new(1);
        for x in &mut seeds.positions {
            for d in 0..2 {
                x[d] += 0.5 * self.jitter * random.number();
            }
        }
        let dt = 0.3 / (1.0 + self.drift);
        let period = (2.0 * length / dt).round() as u64;
        let velocity = move |x: f64| self.drift + self.swing * (PI * x / length).cos();
        let mut mpm = bar(self.scheme, dt, &seeds, &velocity)?;
        let count = self.periods * period;
        let mut means = Means::new(count, self.periods);
        let stop = steps(&mut mpm, count, |now, step| means.add(step, energy(&now.totals())));
        let made = stop.as_ref().map_or(count, |s| s.step - 1);
        Ok(Measured::new(means.change().abs(), made).stopped(stop))
    }
}

/// H1: numerical heating at hypervelocity.
pub fn hypervelocity() -> Scene {
    fn trial(scheme: Scheme) -> impl Fn(Size) -> Result<Measured, String> {
        move |size| {
            let periods = if size == Size::Fast { 4 } else { 10 };
            Flight { scheme, drift: 10.0, swing: 1e-3, jitter: 0.0, periods }.fly()
        }
    }
    Scene {
        id: "H1",
        name: "heating at hypervelocity",
        fails: "A bar swings with 1e-3 c while it flies at 10 c. Every crossing of a cell that makes a force makes heat, and there \
                are thousands of them; the kinetic energy to feed on is 1e8 times that of the swing.",
        metric: "change of energy about the centre of mass, mean of the last period against the first",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    }
    .holds("linear FLIP-USL", "step of 0.027 h/c: limit only at 4e-4 cells [I]", trial(ul(Linear, FlipUsl)))
    .holds("linear FLIP-MUSL", "small strain: crossings cancel [I]", trial(ul(Linear, FlipMusl)))
    .holds("uGIMP FLIP-MUSL", "as T1 [I]", trial(ul(Gimp, FlipMusl)))
    .holds("quadratic FLIP-MUSL", "as T1 [I]", trial(ul(Quadratic, FlipMusl)))
    .fails("quadratic APIC", "finding 3: short steps, each filtered [C]", trial(ul(Quadratic, ApicUsl)))
    .holds("cubic FLIP-MUSL", "as T1 [I]", trial(ul(Cubic, FlipMusl)))
    .holds("TL linear FLIP-MUSL", "as T1 [I]", trial(tl(Linear, FlipMusl)))
}

/// Cause of the energy loss of APIC with the quadratic spline; FMPM(4) loses 30 % in the same bar, FLIP gains 3 %.
const FILTER: &str = "APIC averages over uneven neighbours: lost are 3, 6, 14, 38 % at shifts of 0, 0.1, 0.2, 0.4, at any amplitude and step, \
                      and in the reference configuration, too";

/// J1: random particle packing.
pub fn jitter() -> Scene {
    fn trial(scheme: Scheme) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| Flight { scheme, drift: 0.05, swing: 0.05, jitter: 0.4, periods: 10 }.fly()
    }
    Scene {
        id: "J1",
        name: "random packing",
        fails: "The bar of T1, its particles shifted at random by up to 0.4 of their spacing along both axes. Sums over such particles are poor \
                integrals, whatever crosses.",
        metric: "change of energy, mean of the last period against the first",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    }
    .fails("linear FLIP-USL", "as T1 [C]", trial(ul(Linear, FlipUsl)))
    .fails("linear FLIP-MUSL", "as T1 [C]", trial(ul(Linear, FlipMusl)))
    .holds("uGIMP FLIP-MUSL", "as T1 [I]", trial(ul(Gimp, FlipMusl)))
    .but(|row| row.noted("10.9 % gained at steps of 0.3 h/c, 5.4 % at 0.15: crossings at large strain feed what nothing damps (book, The step, finding 10)"))
    .holds("quadratic FLIP-MUSL", "as T1 [I]", trial(ul(Quadratic, FlipMusl)))
    .holds("quadratic APIC", "as T1 [I]", trial(ul(Quadratic, ApicUsl)))
    .but(|row| row.noted(FILTER))
    .holds("cubic FLIP-MUSL", "as T1 [I]", trial(ul(Cubic, FlipMusl)))
    .holds("cubic APIC", "as T1 [I]", trial(ul(Cubic, ApicUsl)))
    .but(|row| row.noted(FILTER))
    .holds("TL linear FLIP-MUSL", "as T1 [I]", trial(tl(Linear, FlipMusl)))
}

/// B1: body thinner than a cell.
pub fn thin() -> Scene {
    fn trial(scheme: Scheme) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let length = 20.0;
            let mut seeds = row_of_cells(20, 2, 0.0)?;
            // Keep one of the two particle layers: half a cell thick.
            let kept = |x: &[f64; 2]| x[1] < 0.5;
            seeds.volumes.truncate(seeds.positions.iter().filter(|x| kept(x)).count());
            seeds.positions.retain(kept);
            let mut mpm = verification::empty::empty_scene(scheme, cells()?).ok_or("no such composition")?;
            let dt = 0.3;
            mpm.set_time_control(TimeControl::Fixed(dt)).map_err(text)?;
            let velocity = move |x: [f64; 2]| [0.01 * (PI * x[0] / length).cos(), 0.05];
            mpm.add("strip", rubber(1.0, 1.0, 0.0)?, &seeds, velocity).map_err(text)?;
            let count = (10.0 * 2.0 * length / dt).round() as u64;
            let mut means = Means::new(count, 10);
            let stop = steps(&mut mpm, count, |now, step| means.add(step, energy(&now.totals())));
            let made = stop.as_ref().map_or(count, |s| s.step - 1);
            Ok(Measured::new(means.change().abs(), made).stopped(stop))
        }
    }
    Scene {
        id: "B1",
        name: "thinner than a cell",
        fails: "A strip half a cell thick, one layer of particles, swings along itself with 0.01 c and flies across 20 cells. It has no inside: \
                every node is at its surface, and some hold almost nothing.",
        metric: "change of energy, mean of the last of ten periods against the first",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    }
    .fails("linear FLIP-USL", "book, The step, finding 5 [C]", trial(ul(Linear, FlipUsl)))
    .holds("linear FLIP-MUSL", "book, The step, finding 5 [C]", trial(ul(Linear, FlipMusl)))
    .holds("uGIMP FLIP-MUSL", "list T3 [C]", trial(ul(Gimp, FlipMusl)))
    .holds("quadratic FLIP-MUSL", "list T3 [C]", trial(ul(Quadratic, FlipMusl)))
    .holds("quadratic APIC", "list T3 [C]", trial(ul(Quadratic, ApicUsl)))
    .holds("cubic FLIP-MUSL", "list T3 [C]", trial(ul(Cubic, FlipMusl)))
    .holds("TL linear FLIP-MUSL", "list T3 [C]", trial(tl(Linear, FlipMusl)))
}
