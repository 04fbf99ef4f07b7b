//! Fragile points with known failures: unit cells, E = rho = 1 unless stated otherwise.

use std::f64::consts::PI;
use std::sync::Arc;

use fpm::{
    Cells, Cohesive, Criterion, Domain, Flux, Fpm, Incomplete, MaximumTension, Method, NoCracks, Notch,
    Penalty, Symmetric, relaxed, scattered,
};
use impactite_geometry::Cuboid;
use impactite_geometry::structured::box_mesh;
use impactite_scene::{PlaneStrain, Solver, StepError, Stopped, TimeControl, Watch};
use mpm_materials::{LinearElastic, Moduli, NeoHookean};

use super::locking::{LENGTH, THICK, frequency, shape};
use crate::stage::text;
use crate::verdict::{Limit, Measured, Row, Scene, Size, Stop};

/// Linear elastic law with modulus 1 and density 1.
fn unit(poisson: f64) -> Result<LinearElastic<f64>, String> {
    LinearElastic::new(1.0, Moduli::young_poisson(1.0, poisson).map_err(text)?).map_err(text)
}

/// Unit square cells from the origin.
fn squares(counts: [usize; 2]) -> Result<Cells<2>, String> {
    let body = Cuboid::new([0.0; 2], counts.map(|n| n as f64)).map_err(text)?;
    Cells::of_mesh(&box_mesh(&body, counts).map_err(text)?).map_err(text)
}

/// Random points with spacing 1 in a box from the origin.
fn scatter(size: [f64; 2], seed: u64) -> Result<(Vec<[f64; 2]>, Domain<2>), String> {
    let domain = Domain::cuboid([0.0; 2], size).map_err(text)?;
    let points = scattered(&domain, seed, |_| 1.0).map_err(text)?;
    Ok((relaxed(points, &domain, 3).map_err(text)?, domain))
}

fn notch(from: [f64; 2], to: [f64; 2]) -> Result<Notch<2>, String> {
    Notch::segment(from, to).map_err(text)
}

/// Create a method of this flux with this penalty and criterion.
fn with<X: Flux, C: Criterion>(flux: X, eta: f64, cracks: C) -> Result<Method<PlaneStrain, X, C>, String> {
    Ok(Method::new(PlaneStrain, flux, Penalty::new(eta).map_err(text)?, cracks))
}

/// Default penalty.
fn usual() -> f64 {
    Penalty::default().eta()
}

/// Result of a run, or the number of steps and the error that stopped it; an error message if the setup failed.
type Ran<T> = Result<Result<T, (u64, StepError)>, String>;

/// Convert the result of a run to a measure.
fn measured(steps: u64, ran: Result<f64, StepError>) -> Measured {
    match ran {
        Ok(value) => Measured::new(value, steps),
        Err(error) => {
            Measured::new(f64::NAN, steps).stopped(Some(Stop { step: error.step, what: error.to_string() }))
        }
    }
}

/// P1: checkerboard velocities.
pub fn checkerboard() -> Scene {
    fn trial(flux: impl Flux, eta: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            // End time before short waves from the surface reach the middle.
            let (amplitude, end) = (1e-4, 5.0);
            let sign = |[x, y]: [f64; 2]| {
                if (x.floor() + y.floor()) as i64 % 2 == 0 { amplitude } else { -amplitude }
            };
            let cells = squares([40, 40])?;
            let method = with(flux, eta, NoCracks)?;
            let mut body = Fpm::new(method, unit(0.3)?, &cells, |x| [sign(x), 0.0]).map_err(text)?;
            body.set_watch(Watch::off());
            let ran = body.run_until(end).map(|()| {
                let middle = |i: &usize| body.reference()[*i].iter().all(|x| (18.0..22.0).contains(x));
                let moved = |i: usize| body.displacements()[i][0].abs() / (amplitude * end);
                (0..cells.len()).filter(middle).map(moved).fold(0.0, f64::max)
            });
            Ok(measured(body.steps(), ran))
        }
    }
    Scene {
        id: "P1",
        name: "alternating velocities of fragile points",
        fails: "Velocities that alternate from cell to cell on squares: neighbours on both sides of a cell move alike, so that no gradient sees them, and \
                jumps of both sides cancel in the symmetric flux, too. Only the penalty holds cells back.",
        metric: "largest displacement in the middle over that of free flight",
        limit: Limit::AtMost(0.1),
        rows: Vec::new(),
    }
    .holds("symmetric flux, penalty 5 E", "gates 4.7", trial(Symmetric, usual()))
    .holds("incomplete flux, penalty 5 E", "gates 4.7", trial(Incomplete, usual()))
    .fails("symmetric flux, no penalty", "gates 4.7", trial(Symmetric, 0.0))
    .fails("incomplete flux, no penalty", "gates 4.7", trial(Incomplete, 0.0))
}

/// P2: penalty that is too stiff.
pub fn stiff_penalty() -> Scene {
    fn trial(flux: impl Flux, eta: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            const LONG: usize = 120;
            let hump = |x: f64| {
                let part = ((x - 0.5 * LONG as f64) / 12.0).clamp(-1.0, 1.0);
                1e-6 * (0.5 * PI * part).cos().powi(2)
            };
            let (cells, method) = (squares([LONG, 3])?, with(flux, eta, NoCracks)?);
            let mut bar = Fpm::new(method, unit(0.0)?, &cells, |x| [hump(x[0]), 0.0]).map_err(text)?;
            let ran = bar.run_until(2.0 * LONG as f64).map(|()| {
                let (mut wrong, mut all) = (0.0, 0.0);
                // Leapfrog velocities are at the middle of the last step.
                let half = 0.5 * bar.clock().last.unwrap_or(0.0);
                for (i, x) in bar.reference().iter().enumerate() {
                    let now = bar.velocities()[i][0] + half * bar.accelerations()[i][0];
                    wrong += (now - hump(x[0])).powi(2);
                    all += hump(x[0]).powi(2);
                }
                (wrong / all).sqrt()
            });
            Ok(measured(bar.steps(), ran))
        }
    }
    Scene {
        id: "P2",
        name: "a penalty that is too stiff",
        fails: "A hump of velocity in the middle of a free bar of 120 squares, 24 of them wide, is where and what it was after a wave has been along the bar \
                twice. A large penalty makes short waves too fast, and ripples run ahead.",
        metric: "velocity that is off then, root mean square, over that of the hump",
        limit: Limit::AtMost(0.2),
        rows: Vec::new(),
    }
    .holds("symmetric flux, penalty 5 E", "cases 3", trial(Symmetric, usual()))
    .holds("incomplete flux, penalty 5 E", "cases 3", trial(Incomplete, usual()))
    .holds("incomplete flux, penalty 10 E", "cases 0", trial(Incomplete, 10.0))
    .fails("symmetric flux, penalty 100 E", "cases 3", trial(Symmetric, 100.0))
    .fails("incomplete flux, penalty 100 E", "cases 3", trial(Incomplete, 100.0))
}

/// P3: cells without neighbours.
pub fn alone() -> Scene {
    /// Run a rotating block whose middle cells are disconnected on all four sides.
    fn trial(flux: impl Flux, of_limit: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let cuts = [
                ([4.0, 4.0], [5.0, 4.0]),
                ([4.0, 5.0], [5.0, 5.0]),
                ([4.0, 4.0], [4.0, 5.0]),
                ([5.0, 4.0], [5.0, 5.0]),
                // Chain of cells: a column that is disconnected on both sides.
                ([7.0, -1.0], [7.0, 8.0]),
                ([8.0, -1.0], [8.0, 8.0]),
            ];
            let mut cells = squares([9, 9])?;
            for (from, to) in cuts {
                cells = cells.with_notch(&notch(from, to)?).map_err(text)?;
            }
            let rate = 1e-3;
            let spin = |[x, y]: [f64; 2]| [-rate * (y - 4.5) + rate * (x - 4.5), rate * (x - 4.5)];
            let method = with(flux, usual(), NoCracks)?;
            let mut block = Fpm::new(method, rubber()?, &cells, spin).map_err(text)?;
            block.set_watch(Watch::off());
            let dt = of_limit * block.critical_time_step();
            block.set_time_control(TimeControl::Fixed(dt)).map_err(text)?;
            let (before, rigid) = (Solver::totals(&block), block.rigid_cells());
            let ran = block.run_until(600.0).map(|()| {
                let (after, account) = (Solver::totals(&block), block.account());
                let moved =
                    (0..2).map(|d| (after.momentum[d] - before.momentum[d]).abs() / account.momentum_scale);
                // Weighting: momentum to 1e-12 counts as energy to 1e-3.
                moved.map(|p| 1e9 * p).fold(account.energy_error().abs(), f64::max)
            });
            let energies = format!("{rigid} cells move as rigid ones");
            Ok(measured(block.steps(), ran).since(Some(energies)))
        }
    }
    Scene {
        id: "P3",
        name: "cells without neighbours, and in a chain",
        fails: "A block that turns and strains, with one cell that is cut off and a column of which only the foot is not. Neighbours of such cells do not tell a \
                gradient: least squares divide by nothing. They have to move as rigid ones, and be counted.",
        metric: "the larger of energy that no book has over the most there was, and 1e9 times the same of momentum",
        limit: Limit::AtMost(1e-3),
        rows: Vec::new(),
    }
    .holds("symmetric flux", "gates 4.7", trial(Symmetric, 0.9))
    .holds("incomplete flux", "gates 4.7", trial(Incomplete, 0.9))
    .fails("symmetric flux, steps of 1.5 of the stable one", "control", trial(Symmetric, 1.5))
}

fn rubber() -> Result<NeoHookean<f64>, String> {
    NeoHookean::new(1.0, Moduli::young_poisson(1.0, 0.3).map_err(text)?).map_err(text)
}

/// P3 for a bar of one row.
pub fn chain() -> Scene {
    fn trial(flux: impl Flux, rows: usize) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            const LONG: f64 = 40.0;
            let mode = |[x, _]: [f64; 2]| [1e-6 * (PI * x / LONG).cos(), 0.0];
            let (cells, method) = (squares([LONG as usize, rows])?, with(flux, usual(), NoCracks)?);
            let mut bar = Fpm::new(method, unit(0.0)?, &cells, mode).map_err(text)?;
            let part = |bar: &Fpm<2, _>| -> f64 {
                bar.reference().iter().zip(bar.velocities()).map(|(x, v)| mode(*x)[0] * v[0]).sum()
            };
            let (mut before, mut turns) = (part(&bar), Vec::new());
            while turns.len() < 3 {
                let dt = match bar.step_at_most(f64::INFINITY) {
                    Ok(dt) => dt,
                    Err(error) => return Ok(measured(bar.steps(), Err(error))),
                };
                let now = part(&bar);
                if now * before < 0.0 {
                    turns.push(bar.time() - 0.5 * dt - dt * now / (now - before));
                }
                before = now;
            }
            // Half a wavelength along the bar: the period is 2 L / c.
            let period = turns[2] - turns[0];
            let said = format!("{} of {} cells move as rigid ones", bar.rigid_cells(), cells.len());
            Ok(Measured::new((2.0 * LONG / period - 1.0).abs(), bar.steps()).since(Some(said)))
        }
    }
    Scene {
        id: "P3c",
        name: "a bar of one row of fragile points",
        fails: "A free bar of 40 squares along swings in its lowest mode. In one row neighbours lie in a line and no cell has a gradient: the penalty alone \
                holds them, and the bar is five times as stiff. Two rows are enough. The solver counts such cells.",
        metric: "error of the frequency",
        limit: Limit::AtMost(0.01),
        rows: Vec::new(),
    }
    .holds("symmetric flux, two rows", "own", trial(Symmetric, 2))
    .holds("incomplete flux, two rows", "own", trial(Incomplete, 2))
    .fails("symmetric flux, one row", "gates 4.7", trial(Symmetric, 1))
    .fails("incomplete flux, one row", "gates 4.7", trial(Incomplete, 1))
}

/// T11 with fragile points: near-incompressible bending.
pub fn beam() -> Scene {
    const NU: f64 = 0.4999;
    /// Run the beam of T11 with cells of 1/finer.
    fn trial(
        flux: impl Flux,
        nu: f64,
        finer: usize,
        random: bool,
    ) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            // Unit cells: the beam size grows with the number of cells, and the frequency decreases accordingly.
            let [long, thick] = [LENGTH, THICK].map(|n| n * finer);
            let cells = if random {
                let (points, domain) = scatter([long as f64, thick as f64], 5)?;
                Cells::voronoi(&points, &domain).map_err(text)?
            } else {
                squares([long, thick])?
            };
            let mode = |x: f64| shape(x / long as f64);
            let method = with(flux, usual(), NoCracks)?;
            let mut beam = Fpm::new(method, unit(nu)?, &cells, |x| [0.0, 1e-5 * mode(x[0])]).map_err(text)?;
            let part = |beam: &Fpm<2, _>| -> f64 {
                let each = beam.reference().iter().zip(beam.velocities()).zip(beam.masses());
                each.map(|((x, v), m)| m * v[1] * mode(x[0])).sum()
            };
            let quarter = 0.5 * PI / frequency(nu) * finer as f64;
            let (mut before, start) = ((0.0, part(&beam)), part(&beam));
            while beam.time() < 2.5 * quarter {
                if let Err(error) = beam.step_at_most(f64::INFINITY) {
                    return Ok(measured(beam.steps(), Err(error)));
                }
                let now = (beam.time(), part(&beam));
                if now.1 <= 0.0 {
                    let zero = before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1);
                    return Ok(Measured::new(((quarter / zero).powi(2) - 1.0).abs(), beam.steps()));
                }
                before = now;
            }
            Ok(Measured::new(1.0, beam.steps()).since(Some(format!("no turn; {:.2} left", before.1 / start))))
        }
    }
    Scene {
        id: "T11f",
        name: "near-incompressible bending of fragile points",
        fails: "The free beam of T11 at nu = 0.4999. Every cell asks its volume to stay: four squares through the beam make it nine times too stiff, eight twice. Random cells have more freedom.",
        metric: "stiffness over that of theory, less 1 (by the frequency)",
        limit: Limit::AtMost(0.20),
        rows: Vec::new(),
    }
    .holds("symmetric flux, 32 x 4 squares, nu 0.3", "control", trial(Symmetric, 0.3, 1, false))
    .holds("incomplete flux, 32 x 4 squares, nu 0.3", "control", trial(Incomplete, 0.3, 1, false))
    .fails("symmetric flux, 32 x 4 squares", "own", trial(Symmetric, NU, 1, false))
    .fails("symmetric flux, 64 x 8 squares", "own", trial(Symmetric, NU, 2, false))
    .fails("symmetric flux, as many as 32 x 4 random cells", "own", trial(Symmetric, NU, 1, true))
    .holds("symmetric flux, as many as 64 x 8 random cells", "cases 3", trial(Symmetric, NU, 2, true))
    .holds("symmetric flux, as many as 96 x 12 random cells", "cases 3", trial(Symmetric, NU, 3, true))
    .but(Row::slow)
    .fails("incomplete flux, 32 x 4 squares", "own", trial(Incomplete, NU, 1, false))
    .fails("incomplete flux, as many as 32 x 4 random cells", "own", trial(Incomplete, NU, 1, true))
}

/// T11 with fragile points: flutter at near-incompressibility.
pub fn flutter() -> Scene {
    fn trial(nu: f64, flux: impl Flux) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let (points, domain) = scatter([12.0, 12.0], 5)?;
            let cells = Cells::voronoi(&points, &domain).map_err(text)?;
            let swirl = |[x, y]: [f64; 2]| [1e-5 * (0.5 * y).sin(), 1e-5 * (0.5 * x).sin()];
            let method = with(flux, usual(), NoCracks)?;
            let mut block = Fpm::new(method, unit(nu)?, &cells, swirl).map_err(text)?;
            let Err(error) = (0..20_000).try_for_each(|_| block.step_at_most(f64::INFINITY).map(|_| ()))
            else {
                return Ok(Measured::new(0.0, block.steps()).since(Some("it did not stop".into())));
            };
            let said = error.to_string();
            let remedy = ["larger penalty", "Method::symmetric"].iter().all(|way| said.contains(way));
            let named = matches!(error.what, Stopped::Point { .. });
            Ok(Measured::new(f64::from(remedy && named), error.step).since(Some(said)))
        }
    }
    Scene {
        id: "T11w",
        name: "near-incompressible fragile points that flutter",
        fails: "A swirl in a block of random cells at nu = 0.4999. What the incomplete flux works on jumps goes with the modulus of longitudinal waves, the penalty with Young's: energy comes from nowhere, and a run that goes on ends in numbers that are none.",
        metric: "stops, names the cell and what helps (1) or not (0)",
        limit: Limit::AtLeast(1.0),
        rows: Vec::new(),
    }
    .holds("incomplete flux", "own", trial(0.4999, Incomplete))
    .fails("symmetric flux, which does not", "control", trial(0.4999, Symmetric))
    .fails("incomplete flux, nu 0.3", "control", trial(0.3, Incomplete))
}

/// P5: wave through a closed crack.
pub fn closed() -> Scene {
    /// Orientation of the cut in the middle of squares or random cells.
    #[derive(Clone, Copy)]
    enum Cut {
        Straight,
        Oblique,
    }
    /// Run a compression (-1) or tension (1) pulse through a cut bar; measure its ratio to that of a whole bar.
    fn trial(flux: impl Flux, sign: f64, cut: Cut) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let (long, high, width) = (60.0, 6.0, 25.0);
            let passed = |open: bool| -> Ran<(f64, f64, u64)> {
                let slit = match cut {
                    Cut::Straight => notch([30.0, -1.0], [30.0, high + 1.0])?,
                    Cut::Oblique => notch([28.5, -1.0], [31.5, high + 1.0])?,
                };
                let cells = match cut {
                    Cut::Straight => squares([60, 6])?,
                    Cut::Oblique => {
                        let (points, domain) = scatter([long, high], 3)?;
                        let points = slit.lined(points, &domain, 1.0).map_err(text)?;
                        Cells::voronoi(&points, &domain).map_err(text)?
                    }
                };
                let cells = if open { cells.with_notch(&slit).map_err(text)? } else { cells };
                let mut bar = Fpm::new(with(flux, usual(), NoCracks)?, unit(0.0)?, &cells, |_| [0.0; 2])
                    .map_err(text)?;
                bar.set_friction(0.5).map_err(text)?;
                let pulse =
                    move |t: f64| [sign * 1e-4 * (PI * (t / width).clamp(0.0, 1.0)).sin().powi(2), 0.0];
                bar.load_faces(|f| f.normal[0] > 0.5, Arc::new(pulse)).map_err(text)?;
                // Pulse crest at 15.
                if let Err(error) = bar.run_until(45.0 + 0.5 * width) {
                    return Ok(Err((bar.steps(), error)));
                }
                let near = |i: &usize| (bar.reference()[*i][0] - 15.0).abs() < 1.5;
                let (mut sum, mut volume) = (0.0, 0.0);
                for i in (0..cells.len()).filter(near) {
                    sum += bar.masses()[i] * bar.nominal_stresses()[i][0][0];
                    volume += bar.masses()[i];
                }
                Ok(Ok((sum / volume, bar.account().energy_error(), bar.steps())))
            };
            let (whole, cut) = match (passed(false)?, passed(true)?) {
                (Ok(whole), Ok(cut)) => (whole, cut),
                (Err((steps, error)), _) | (_, Err((steps, error))) => {
                    return Ok(measured(steps, Err(error)));
                }
            };
            let said = format!("energy {:+.1e}", cut.1);
            Ok(Measured::new((cut.0 / whole.0 - 1.0).abs().max(50.0 * cut.1.abs()), cut.2).since(Some(said)))
        }
    }
    Scene {
        id: "P5",
        name: "a wave through a closed crack",
        fails: "A pulse of stress, 25 cells long, through a bar that is cut in the middle. What presses the sides together goes through as through a whole bar, and \
                energy is kept to 1e-3 (a fiftieth of the limit); what draws them apart comes back.",
        metric: "stress at its crest behind the cut over that in a whole bar, less 1, or 50 times the energy that no book has",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    }
    .holds("symmetric flux, squares, compression", "gates 4.7", trial(Symmetric, -1.0, Cut::Straight))
    .holds("incomplete flux, squares, compression", "gates 4.7", trial(Incomplete, -1.0, Cut::Straight))
    .holds("symmetric flux, random cells along an oblique cut, compression", "own", trial(Symmetric, -1.0, Cut::Oblique))
    .fails("symmetric flux, squares, tension", "gates 4.7", trial(Symmetric, 1.0, Cut::Straight))
}

/// P5 with friction: sliding of a closed crack.
pub fn slides() -> Scene {
    const FRICTION: f64 = 0.3;
    const PRESSURE: f64 = 1e-3;
    /// Fraction by which the push exceeds the friction limit.
    const OVER: f64 = 0.2;
    /// Position of the cut.
    #[derive(Clone, Copy)]
    enum Cut {
        Squares,
        /// Random cells with rows of points along the cut if true, without otherwise.
        Random(bool),
    }
    fn trial(flux: impl Flux, cut: Cut, push: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let size = [16.0, 8.0];
            let slit = notch([-1.0, 4.0], [size[0] + 1.0, 4.0])?;
            let cells = match cut {
                Cut::Squares => squares([16, 8])?,
                Cut::Random(lined) => {
                    let (mut points, domain) = scatter(size, 7)?;
                    if lined {
                        points = slit.lined(points, &domain, 1.0).map_err(text)?;
                    }
                    Cells::voronoi(&points, &domain).map_err(text)?
                }
            };
            let cells = cells.with_notch(&slit).map_err(text)?;
            let mut blocks =
                Fpm::new(with(flux, usual(), NoCracks)?, unit(0.3)?, &cells, |_| [0.0; 2]).map_err(text)?;
            blocks.set_friction(FRICTION).map_err(text)?;
            blocks.hold_faces(|f| f.normal[1] < -0.5, Arc::new(|_| [Some(0.0); 2])).map_err(text)?;
            // Load history: slow normal pressure, then a tangential push 20 % above the friction limit.
            let (pressed, pushed, end) = (160.0, 100.0, 460.0);
            let load = move |t: f64| {
                let (down, along) = ((t / pressed).min(1.0), ((t - pressed) / pushed).clamp(0.0, 1.0));
                [push * FRICTION * PRESSURE * along, -PRESSURE * down]
            };
            blocks.load_faces(|f| f.normal[1] > 0.5, Arc::new(load)).map_err(text)?;
            let ran = blocks.run_until(end).map(|()| {
                let (cracks, mut slip, mut area) = (blocks.cracks(), 0.0, 0.0);
                for crack in &cracks {
                    slip += crack.area * crack.gap[1];
                    area += crack.area;
                }
                // Net force: the push beyond the friction limit accelerates the upper block, 4 high.
                let most = OVER * FRICTION * PRESSURE / 4.0;
                let (rise, held) = (pushed * OVER / (1.0 + OVER), end - pressed - pushed);
                let wanted = most * (0.5 * held * held + 0.5 * rise * held + rise * rise / 6.0);
                let friction = Solver::exchange(&blocks).friction / (PRESSURE * slip);
                (1.0 - slip / area / wanted).max((friction / FRICTION - 1.0).abs())
            });
            let heat = format!("friction made {:.2e}", Solver::exchange(&blocks).friction);
            Ok(measured(blocks.steps(), ran).since(Some(heat)))
        }
    }
    Scene {
        id: "P5f",
        name: "a closed crack that rubs",
        fails: "A block on another one, cut from the same cells, is pressed down and pushed along a fifth harder than friction bears: the rest of the push moves \
                it. Faces of random cells are not in line, and catch each other.",
        metric: "error of friction, by its work over slip, or what is missing of the slip of rigid blocks, whichever is larger",
        limit: Limit::AtMost(0.10),
        rows: Vec::new(),
    }
    .holds("symmetric flux, squares", "gates 4.7", trial(Symmetric, Cut::Squares, 1.0 + OVER))
    .holds("incomplete flux, squares", "gates 4.7", trial(Incomplete, Cut::Squares, 1.0 + OVER))
    .holds("symmetric flux, random cells, points in rows along the cut", "own", trial(Symmetric, Cut::Random(true), 1.0 + OVER))
    .fails("symmetric flux, random cells", "own", trial(Symmetric, Cut::Random(false), 1.0 + OVER))
    .fails("symmetric flux, squares, pushed less than friction bears", "control", trial(Symmetric, Cut::Squares, 1.0 - OVER))
}

/// P6: cracks in cells of half the size.
pub fn halved() -> Scene {
    /// Run a strip under tension; return the crack work per crack area, J/m^2, and the number of steps.
    fn strip(cracks: impl Criterion, flux: impl Flux, finer: usize) -> Ran<(f64, u64)> {
        let (h, counts) = (1e-3 / finer as f64, [20, 10].map(|n| n * finer));
        let (length, width, depth) = (20e-3, 10e-3, 4e-3);
        let body = Cuboid::new([0.0; 2], [length, width]).map_err(text)?;
        let cells = Cells::of_mesh(&box_mesh(&body, counts).map_err(text)?).map_err(text)?;
        let slit = notch([0.5 * length, -h], [0.5 * length, depth])?;
        let cells = cells.with_notch(&slit).map_err(text)?;
        let steel =
            LinearElastic::new(7850.0, Moduli::young_poisson(200e9, 0.3).map_err(text)?).map_err(text)?;
        let mut strip = Fpm::new(with(flux, usual(), cracks)?, steel, &cells, |_| [0.0; 2]).map_err(text)?;
        for side in [-1.0, 1.0] {
            let pull = move |t: f64| [Some(side * 2.0 * (t / 20e-6).min(1.0)), None];
            strip.drive_faces(|f| f.normal[0] * side > 0.5, Arc::new(pull)).map_err(text)?;
        }
        if let Err(error) = strip.run_until(130e-6) {
            return Ok(Err((strip.steps(), error)));
        }
        if strip.fragments().len() < 2 {
            return Err("the strip is still one".into());
        }
        Ok(Ok((strip.dissipated() / (width - depth), strip.steps())))
    }
    fn trial(flux: impl Flux, cracks: impl Criterion) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let (coarse, fine) = match (strip(cracks, flux, 1)?, strip(cracks, flux, 2)?) {
                (Ok(coarse), Ok(fine)) => (coarse, fine),
                (Err((steps, error)), _) | (_, Err((steps, error))) => {
                    return Ok(measured(steps, Err(error)));
                }
            };
            let said = format!("{:.0} and {:.0} J/m^2", coarse.0, fine.0);
            Ok(Measured::new((fine.0 / coarse.0 - 1.0).abs(), coarse.1 + fine.1).since(Some(said)))
        }
    }
    Scene {
        id: "P6",
        name: "cracks in cells of half the size",
        fails: "A notched strip of steel, 20 mm x 10 mm, is drawn apart, of cells of 1 and of 0.5 mm. Faces that bear nothing once they reach a strength of 200 MPa \
                take what the cells beside them held: half as much in cells of half the size. Cohesive faces of 20 kJ/m^2 take that.",
        metric: "work of an area of crack in cells of half the size over that in the others, less 1",
        limit: Limit::AtMost(0.10),
        rows: Vec::new(),
    }
    .holds("symmetric flux, cohesive faces", "gates 4.7", move |size| trial(Symmetric, Cohesive::new(200e6, 2e4).map_err(text)?)(size))
    .holds("incomplete flux, cohesive faces", "gates 4.7", move |size| trial(Incomplete, Cohesive::new(200e6, 2e4).map_err(text)?)(size))
    .fails("symmetric flux, strength alone", "gates 4.7", move |size| trial(Symmetric, MaximumTension::new(200e6).map_err(text)?)(size))
    .fails("incomplete flux, strength alone", "gates 4.7", move |size| trial(Incomplete, MaximumTension::new(200e6).map_err(text)?)(size))
}
