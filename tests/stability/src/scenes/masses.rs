//! Nodes of negligible mass, and joints of very different stiffness and density.

use mpm_core::Mpm;
use mpm_core::geometry::Seeds;
use mpm_core::{Boundary, Side, TimeControl};
use verification::Scheme;
use verification::empty::empty_scene;
use verification::problems::{box_of_planes, rubber};
use verification::scene::block;

use crate::stage::{
    ApicUsl, Cubic, FlipMusl, FlipUsl, Fmpm4Usl, Linear, Quadratic, bar, bound, cells, row_of_cells, solver,
    steps, text, ul,
};
use crate::verdict::{Limit, Measured, Scene, Size, Stop};

/// T15: nodes of negligible mass.
pub fn tiny() -> Scene {
    fn trial(scheme: Scheme) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let (mut worst, mut made) = (0.0f64, 0);
            // Offsets down to the smallest weight in a cell: 1e-17 for linear shape functions, its square and cube for splines.
            for k in 1..=17 {
                let seeds = row_of_cells(4, 2, 0.25 + 10f64.powi(-k))?;
                let mut mpm = bar(scheme, 0.3, &seeds, &|x| 0.01 * (2.0 + x.sin()))?;
                let start = mpm.totals();
                let mut most = 0.0f64;
                let stop = steps(&mut mpm, 1000, |now, _| {
                    let t = now.totals();
                    let error = (t.momentum[0] - start.momentum[0]).abs() / start.momentum_scale;
                    most = if error > most || error.is_nan() { error } else { most };
                });
                made += stop.as_ref().map_or(1000, |s| s.step - 1);
                if stop.is_some() {
                    return Ok(Measured::new(f64::NAN, made).stopped(stop));
                }
                worst = if most > worst || most.is_nan() { most } else { worst };
            }
            Ok(Measured::new(worst, made))
        }
    }
    Scene {
        id: "T15",
        name: "nodes of almost no mass",
        fails: "A bar flies and swings, its outermost particle 1e-1 to 1e-17 cells behind a node at the start, 1000 steps each. Momentum over mass is \
                0/0 there: a division blows up, a cut-off loses momentum.",
        metric: "largest change of the momentum over its scale",
        limit: Limit::AtMost(1e-12),
        rows: Vec::new(),
    }
    .fails("linear FLIP-USL", "book, The step, finding 5 [C]", trial(ul(Linear, FlipUsl)))
    .holds("linear FLIP-MUSL", "list T15", trial(ul(Linear, FlipMusl)))
    .holds("quadratic FLIP-MUSL", "list T15", trial(ul(Quadratic, FlipMusl)))
    .holds("quadratic APIC", "list T15", trial(ul(Quadratic, ApicUsl)))
    .holds("cubic FLIP-MUSL", "list T15", trial(ul(Cubic, FlipMusl)))
    .holds("cubic FMPM(4)", "list T15", trial(ul(Cubic, Fmpm4Usl)))
}

/// Two parts of a bar from a plane at 0, each with number of cells, density and modulus.
struct Pair {
    cells: [usize; 2],
    density: [f64; 2],
    young: [f64; 2],
}

impl Pair {
    fn seeds(&self) -> Result<[Seeds<2>; 2], String> {
        let lattice = cells()?;
        let inner = block(&lattice, [0; 2], [self.cells[0], 1], 2);
        Ok([inner, block(&lattice, [self.cells[0] as i64, 0], [self.cells[1], 1], 2)])
    }

    /// Lowest angular frequency: E0 k0 cot(k0 L0) = E1 k1 tan(k1 L1), by bisection.
    fn frequency(&self) -> f64 {
        let [l0, l1] = self.cells.map(|l| l as f64);
        let slow = [0, 1].map(|i| (self.density[i] / self.young[i]).sqrt());
        let left = |w: f64| self.young[0] * slow[0] * w / (slow[0] * w * l0).tan();
        let right = |w: f64| self.young[1] * slow[1] * w * (slow[1] * w * l1).tan();
        // Monotonicity: the left side decreases and the right side increases until one of them is a quarter wave.
        let quarter = std::f64::consts::FRAC_PI_2;
        let (mut low, mut high) = (0.0, (quarter / (slow[0] * l0)).min(quarter / (slow[1] * l1)));
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if left(middle) > right(middle) { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// First mode at small amplitude: function of position.
    fn mode(&self, w: f64) -> impl Fn(f64) -> f64 + use<> {
        let [l0, l1] = self.cells.map(|l| l as f64);
        let k = [0, 1].map(|i| w * (self.density[i] / self.young[i]).sqrt());
        let joint = (k[0] * l0).sin() / (k[1] * l1).cos();
        move |x| if x < l0 { (k[0] * x).sin() } else { joint * (k[1] * (l0 + l1 - x)).cos() }
    }

    /// Run an oscillation; measure the worse of the error of a quarter period over 2 % and the energy change over 1
    /// %.
    fn swing(&self, mpm: &mut Mpm<2>, wanted: f64) -> Result<Measured, String> {
        let [inner, outer] = self.seeds()?;
        bound(mpm, vec![Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }])?;
        bound(mpm, box_of_planes(1..2, 0.0, 1.0))?;
        let mode = self.mode(self.frequency());
        for (n, seeds) in [inner, outer].iter().enumerate() {
            let law = rubber(self.density[n], self.young[n], 0.0)?;
            let name = ["inner", "outer"][n];
            mpm.add(name, law, seeds, |x| [1e-5 * mode(x[0]), 0.0]).map_err(text)?;
        }
        let start = mpm.totals();
        let energy = start.kinetic + start.internal;
        let outer = |mpm: &Mpm<2>| mpm.bodies()[1].totals().momentum[0];
        let (mut crossing, mut last, mut made) = (None, outer(mpm), 0);
        let quarter = 0.5 * std::f64::consts::PI / wanted;
        while crossing.is_none() && mpm.time() < 2.0 * quarter {
            let dt = match mpm.step() {
                Ok(dt) => dt,
                Err(e) => {
                    let stop = Stop { step: e.step, what: e.to_string() };
                    return Ok(Measured::new(f64::NAN, made).stopped(Some(stop)));
                }
            };
            made += 1;
            let now = outer(mpm);
            if now * last <= 0.0 {
                crossing = Some(mpm.time() - dt * now / (now - last));
            }
            last = now;
        }
        let t = mpm.totals();
        let change = ((t.kinetic + t.internal) / energy - 1.0).abs();
        let period = crossing.map_or(f64::INFINITY, |t| (t / quarter - 1.0).abs());
        let said = format!("period off by {:.2} %, energy by {:.2} %", 100.0 * period, 100.0 * change);
        let worst = if period / 0.02 > change / 0.01 { period / 0.02 } else { change / 0.01 };
        Ok(Measured::new(worst, made).since(Some(said)))
    }
}

const ADAPTED: TimeControl = TimeControl::Courant { factor: 0.4, growth: 1.1 };

const SMEARED: &str = "a smooth function smears the joint: quadratic -7.2, -4.0, -2.0 %, cubic -4.4, -2.5, -1.8 % with 10, 20, 40 soft cells, linear shape functions 0.2 %";

/// T20: stiff material joined to soft material.
pub fn stiff_and_soft() -> Scene {
    fn trial(scheme: Scheme, mean: bool) -> impl Fn(Size) -> Result<Measured, String> {
        move |size| {
            let ratio: f64 = if size == Size::Fast { 1e4 } else { 1e6 };
            let pair = Pair { cells: [1, 11], density: [1.0; 2], young: [ratio, 1.0] };
            let mut mpm = empty_scene(scheme, cells()?).ok_or("no such composition")?;
            let average = (ratio.sqrt() + 11.0) / 12.0;
            let control = if mean { TimeControl::Fixed(0.4 / average) } else { ADAPTED };
            mpm.set_time_control(control).map_err(text)?;
            pair.swing(&mut mpm, pair.frequency())
        }
    }
    Scene {
        id: "T20",
        name: "stiff joined to soft",
        fails: "A bar of 11 soft cells on one that is 1e6 times (tests: 1e4 times) as stiff. Steps by the mean wave speed blow the stiff \
                part up; steps by the fastest are a thousand to a wave of the soft one, which is then rung or damped to death.",
        metric: "worse of the error of a quarter period / 2 % and change of energy / 1 %",
        limit: Limit::AtMost(1.0),
        rows: Vec::new(),
    }
    .fails("quadratic FLIP-MUSL, step by the mean speed", "list T20", trial(ul(Quadratic, FlipMusl), true))
    .holds("linear FLIP-MUSL", "list T20", trial(ul(Linear, FlipMusl), false))
    .holds("quadratic FLIP-MUSL", "list T20", trial(ul(Quadratic, FlipMusl), false))
    .but(|row| row.noted(SMEARED))
    .holds("cubic FLIP-MUSL", "list T20", trial(ul(Cubic, FlipMusl), false))
    .but(|row| row.noted(SMEARED))
    .fails("quadratic APIC", "book, The step, finding 3: lost once a step [C]", trial(ul(Quadratic, ApicUsl), false))
}

const KINK: &str = "what filters loses energy where the velocity has a kink, at the joint, in every step (book, The step, finding 3)";

/// M1: heavy material on light material.
pub fn light_and_heavy() -> Scene {
    fn trial(scheme: Scheme, ratio: f64, claimed: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let pair = Pair { cells: [10, 2], density: [1.0, ratio], young: [1.0; 2] };
            let other = Pair { cells: [10, 2], density: [1.0, claimed], young: [1.0; 2] };
            let mut mpm = solver(scheme, 0.4)?;
            pair.swing(&mut mpm, other.frequency())
        }
    }
    Scene {
        id: "M1",
        name: "heavy on light",
        fails: "Two cells of density 1e3 (or 1e6) swing on ten of density 1. A joint where a node's velocity is that of the heavy part \
                alone, or the force of the light one is lost against it, has another period.",
        metric: "worse of the error of a quarter period / 2 % and change of energy / 1 %",
        limit: Limit::AtMost(1.0),
        rows: Vec::new(),
    }
    .fails("control: judged as 10 % lighter", "control", trial(ul(Quadratic, FlipMusl), 1e3, 0.9e3))
    .holds("linear FLIP-MUSL, 1e3", "list T20", trial(ul(Linear, FlipMusl), 1e3, 1e3))
    .holds("quadratic FLIP-MUSL, 1e3", "list T20", trial(ul(Quadratic, FlipMusl), 1e3, 1e3))
    .holds("quadratic FLIP-MUSL, 1e6", "list T20", trial(ul(Quadratic, FlipMusl), 1e6, 1e6))
    .holds("quadratic APIC, 1e3", "list T20", trial(ul(Quadratic, ApicUsl), 1e3, 1e3))
    .but(|row| row.noted(KINK))
    .holds("cubic FMPM(4), 1e3", "list T20", trial(ul(Cubic, Fmpm4Usl), 1e3, 1e3))
    .but(|row| row.noted(KINK))
}
