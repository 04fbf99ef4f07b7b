//! Checks of dam breaks.

use examples::martin_moyce::{FRONT as EXPERIMENT, WIDTH};
use examples::series::{interpolate, order};
use examples::{Check, largest, worst};

use crate::scene::{BEYOND, CENTRE, FRONT, GAUGED, KINETIC, Outcome, VOLUME};
use crate::setup::{DENSITY, GRAVITY, Study};
use crate::theory::{DISCHARGE, Release, WALL, depth, speed};

/// Tolerance of corner pressure and wall force over the square of a cell over width or height, the smaller: errors are of second order.
const SECOND_ORDER: f64 = 2.0;
/// Tolerance of the observed order of the mean square: the pressure is r ln r at the foot of the face.
const ORDER: f64 = 0.1;
/// Tolerance of fronts and pressures against experiments, whose release takes a tenth of the time shown.
const MEASURED: f64 = 0.1;
/// Tolerance of the volume of the level set.
const VOLUME_KEPT: f64 = 1e-3;
/// Tolerance of energy gains over the potential energy at the start: the density correction lifts the centre of mass.
const GAIN: f64 = 0.01;
/// Rounding of thousands of steps.
const MOMENTUM: f64 = 1e-11;

const LET_GO: &str = "water let go at once is ahead of water behind a gate that is pulled: the clock of the experiment starts before the gate is open";
const ALTERNATES: &str = "the pressure of single steps alternates about its mean, by the reflection, after impacts; --scheme first-order is smooth";
const FILMS: &str = "films and drops thinner than a cell fill no cell of the level set";

/// Check all runs.
pub fn of(outcomes: &[Outcome]) -> Vec<Check> {
    let mut checks = release(outcomes);
    for outcome in outcomes {
        checks.extend(match outcome.setup.study {
            Study::Release | Study::Cost => Vec::new(),
            Study::Shallow => shallow(outcome),
            Study::Column => column(outcome),
            Study::Tank => wall(outcome),
        });
    }
    if outcomes.is_empty() {
        return checks;
    }
    let momentum = worst(outcomes.iter().map(|o| o.run.totals.momentum_error));
    checks.push(Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM, "conservation"));
    checks
}

/// Check the pressure at the release: each width on grids of decreasing cells.
fn release(outcomes: &[Outcome]) -> Vec<Check> {
    let releases: Vec<&Outcome> = outcomes.iter().filter(|o| o.setup.study == Study::Release).collect();
    let mut checks = Vec::new();
    for grids in releases.chunk_by(|a, b| a.setup.aspect == b.setup.aspect) {
        let Some(finest) = grids.last() else { continue };
        let (setup, exact) = (finest.setup, Release { width: finest.setup.aspect });
        let name = |what: &str| format!("release, a/H {}: {what}", setup.aspect);
        let allowed = SECOND_ORDER / (f64::from(setup.cells) * setup.aspect.min(1.0)).powi(2);
        let series = "series of harmonic functions [C]";
        let (corner, force) = (corner(finest), force(finest));
        checks.extend([
            Check::gate(
                name("corner pressure over rho g H"),
                corner,
                "-",
                exact.pressure([0.0; 2]),
                allowed,
                series,
            ),
            Check::gate(
                name("force on the wall over rho g H^2 / 2"),
                force,
                "-",
                exact.force(),
                allowed,
                series,
            ),
        ]);
        let errors: Vec<[f64; 2]> = grids.iter().map(|o| [o.setup.spacing(), mean_square(o)]).collect();
        let observed = name("order of the root-mean-square error");
        checks.push(Check::gate(observed, order(&errors), "-", 2.0, ORDER, "second order"));
    }
    checks
}

/// Root-mean-square error of the pressure of the particles at the release, over rho g H, a cell and more from the surface: values of particles
/// at the surface are interpolated across its kink.
pub fn mean_square(outcome: &Outcome) -> f64 {
    let (width, cell) = (outcome.setup.aspect, 1.0 / f64::from(outcome.setup.cells));
    let inner = pressures(outcome).filter(|(x, _)| x[0] < width - cell && x[1] < 1.0 - cell);
    let errors: Vec<f64> = inner.map(|(x, p)| p - Release { width }.pressure(x)).collect();
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

/// Positions over H and pressures over rho g H of the particles in the first step.
fn pressures(outcome: &Outcome) -> impl Iterator<Item = ([f64; 2], f64)> {
    let (setup, snapshot) = (outcome.setup, &outcome.run.snapshots[0]);
    let values = snapshot.scalar("pressure").unwrap_or_default().iter();
    let scaled =
        move |(x, p): (&[f64; 3], &f64)| ([x[0] / setup.height, x[1] / setup.height], p / setup.pressure());
    snapshot.positions().iter().zip(values).map(scaled)
}

/// Pressure at the corner over rho g H: that of the particle there, a quarter of a cell from wall and floor, with the gradient at the corner,
/// which is that of hydrostatics.
fn corner(outcome: &Outcome) -> f64 {
    let near = |x: [f64; 2]| x[0] + x[1];
    let nearest = pressures(outcome).min_by(|a, b| near(a.0).total_cmp(&near(b.0)));
    nearest.map_or(f64::NAN, |(x, p)| p + x[1])
}

/// Force on the wall over rho g H^2 / 2: sum over the particles beside it, half a cell apart; there the gradient along x is zero.
fn force(outcome: &Outcome) -> f64 {
    let half = 0.5 / f64::from(outcome.setup.cells);
    2.0 * half * pressures(outcome).filter(|(x, _)| x[0] < half).map(|(_, p)| p).sum::<f64>()
}

/// Check a long reservoir. Shallow flow neglects accelerations across the depth, of the order of the square of depth over length, (H / (c t))^2.
fn shallow(outcome: &Outcome) -> Vec<Check> {
    let (setup, source) = (outcome.setup, "shallow flow, Ritter [C]");
    let (end, dam) = (setup.end, setup.aspect);
    let (heap, least) = (outcome.heap(), setup.front_depth() / setup.height);
    // Depths of columns are uncertain by half of the distance of particles, and with them the places of a depth, x / t = 2 - 3 sqrt(h).
    let uncertain = 0.25 / f64::from(setup.cells);
    let (at_end, in_second_half) = (end.powi(-2), (0.75 * end).powi(-2));
    let of_front = in_second_half + 1.5 * uncertain / least.sqrt() / speed(least);
    let places = || {
        (0..heap.heights.len()).map(|n| (heap.middle(n) / setup.height - dam, heap.heights[n] / setup.height))
    };
    let deep = || places().filter(|(x, _)| depth(x / end) > least);
    let error = deep().map(|(x, h)| (h - depth(x / end)).abs()).sum::<f64>() / deep().count() as f64;
    let near = || places().filter(|(x, _)| x.abs() < 0.5);
    let [found, exact] = near().fold([0.0; 2], |[a, b], (x, h)| [a + h, b + depth(x / end)]);
    let rate = |measure: usize, scale: f64| {
        let series = outcome.over_time(measure);
        let [half, whole] = [0.5 * end, end].map(|t| interpolate(series.iter().copied(), t * (1.0 - 1e-9)));
        (whole - half) / (0.5 * end) / scale
    };
    let (front, discharge) = (rate(FRONT, setup.height), rate(BEYOND, setup.height.powi(2)));
    let fastest = largest(outcome.run.snapshots.last().into_iter().flat_map(|s| s.positions()).map(|x| x[0]));
    let fastest = (fastest / setup.height - dam) / end;
    let exact_front = speed(least);
    let mut checks = vec![
        Check::gate(
            "shallow: depth at the dam over that of the theory",
            found / exact,
            "-",
            1.0,
            at_end,
            source,
        ),
        Check::at_most(
            "shallow: mean error of depths of three cells and more, of H",
            error,
            "-",
            at_end + uncertain,
            source,
        ),
        Check::gate(
            "shallow: speed of the depth of three cells over c",
            front,
            "-",
            exact_front,
            of_front,
            source,
        ),
        Check::gate(
            "shallow: discharge at the dam over H c",
            discharge,
            "-",
            DISCHARGE,
            in_second_half,
            source,
        ),
        Check::unreferenced(
            "shallow: way of the fastest particle over c t",
            fastest,
            "-",
            "2 for a front without thickness [C]",
        ),
    ];
    checks.extend(balances(outcome));
    checks
}

/// Check the front of a column against experiment. Its clock is not that of the run: it starts when the gate begins to open.
fn column(outcome: &Outcome) -> Vec<Check> {
    let source = "experiment, Martin and Moyce 1952 [V]";
    let path = fronts(outcome);
    let front = |time: f64| interpolate(path.iter().copied(), time);
    let when = |place: f64| interpolate(path.iter().map(|[t, x]| [*x, *t]), place);
    let shift = clock_shift(outcome);
    let ahead = largest(EXPERIMENT.iter().map(|[t, x]| (front(*t) / x - 1.0).abs()));
    let moved = largest(
        EXPERIMENT.iter().filter(|[t, _]| *t > shift).map(|[t, x]| (front(t - shift) / x - 1.0).abs()),
    );
    let spread = largest(EXPERIMENT[1..].iter().map(|[t, x]| (t - when(*x) - shift).abs()));
    let [early, end] = [0.8, 1.0].map(|part| part * EXPERIMENT[EXPERIMENT.len() - 1][0]);
    let late = (front(end) - front(early)) / (end - early);
    let seconds = shift * WIDTH.sqrt() / (2.0 * GRAVITY).sqrt();
    let mut checks = vec![
        Check::at_most("column: front off the experiment, largest", ahead, "-", MEASURED, source)
            .known_miss(LET_GO),
        Check::at_most(
            "column: front off the experiment with its clock shifted, largest",
            moved,
            "-",
            MEASURED,
            source,
        ),
        Check::at_most(
            "column: speed of the front at the end over sqrt(2 g a)",
            late,
            "-",
            2.0,
            "bound of Ritter, 2 sqrt(g H) [C]",
        ),
        Check::unreferenced(
            "column: shift of the clock of the experiment",
            1e3 * seconds,
            "ms",
            "mean over equal positions",
        ),
        Check::unreferenced(
            "column: largest deviation from this shift, of sqrt(a / (2 g))",
            spread,
            "-",
            "equal positions",
        ),
    ];
    checks.extend(balances(outcome));
    checks
}

/// Times over sqrt(a / (2 g)) and positions of the front over the width of the column.
pub fn fronts(outcome: &Outcome) -> Vec<[f64; 2]> {
    let second = (WIDTH / (2.0 * GRAVITY)).sqrt();
    outcome.run.series(FRONT).into_iter().map(|[t, x]| [t / second, x / WIDTH]).collect()
}

/// Mean delay of the front of the experiment at equal positions, over sqrt(a / (2 g)).
pub fn clock_shift(outcome: &Outcome) -> f64 {
    let path = fronts(outcome);
    let late = |[t, x]: &[f64; 2]| t - interpolate(path.iter().map(|[t, x]| [*x, *t]), *x);
    EXPERIMENT.iter().map(late).sum::<f64>() / EXPERIMENT.len() as f64
}

/// Check the pressure at the far wall.
fn wall(outcome: &Outcome) -> Vec<Check> {
    let source = "experiment, Buchner 2002 [V]";
    let (steps, smooth) = (gauge(outcome), smoothed(outcome));
    let arrival =
        |series: &[[f64; 2]]| series.iter().find(|row| row[1] > ARRIVED).map_or(f64::NAN, |row| row[0]);
    let plateau = |series: &[[f64; 2]]| mean(series, PLATEAU);
    let before =
        |series: &[[f64; 2]]| largest(series.iter().filter(|row| row[0] < PLATEAU[0]).map(|row| row[1]));
    let inside = || steps.windows(2).filter(|w| (PLATEAU[0]..PLATEAU[1]).contains(&w[0][0]));
    let jumps = inside().map(|w| (w[1][1] - w[0][1]).abs()).sum::<f64>() / inside().count() as f64;
    let resolved = |check: Check| {
        let check = check.judged_if(outcome.setup.cells >= 48, "the jet along the floor is two cells thick");
        check.judged_if(outcome.setup.end > PLATEAU[1], "the run ends before")
    };
    let mut checks = vec![
        resolved(Check::gate(
            "tank: arrival at the gauge over sqrt(H / g)",
            arrival(&smooth),
            "-",
            arrival(&WALL),
            MEASURED,
            source,
        )),
        resolved(
            Check::gate(
                "tank: mean pressure of the jet over rho g H",
                plateau(&steps),
                "-",
                plateau(&WALL),
                MEASURED,
                source,
            )
            .known_miss(ALTERNATES),
        ),
        Check::at_most(
            "tank: mean change of the pressure in a step over rho g H",
            jumps,
            "-",
            JUMP,
            "smooth flow",
        )
        .known_miss(ALTERNATES),
        Check::unreferenced(
            "tank: peak of the impact over rho g H",
            before(&smooth),
            "-",
            "0.687 in the experiment, with the rise of its gauge",
        ),
    ];
    checks.extend(balances(outcome));
    checks
}

/// Times over sqrt(H / g) and pressures at the gauge over rho g H, of every step.
pub fn gauge(outcome: &Outcome) -> Vec<[f64; 2]> {
    outcome.over_time(GAUGED).into_iter().map(|[t, p]| [t, p / outcome.setup.pressure()]).collect()
}

/// Pressure at the gauge as means over [`RESPONSE`].
pub fn smoothed(outcome: &Outcome) -> Vec<[f64; 2]> {
    let series = gauge(outcome);
    let around = |t: f64| mean(&series, [t - 0.5 * RESPONSE, t + 0.5 * RESPONSE]);
    let inner = series.iter().filter(|row| row[0] > RESPONSE && row[0] < outcome.setup.end - RESPONSE);
    inner.map(|row| [row[0], around(row[0])]).filter(|row| row[1].is_finite()).collect()
}

/// Time over sqrt(H / g) of means of the pressure at the gauge: 25 ms for H = 0.6 m.
const RESPONSE: f64 = 0.1;
/// Pressure over rho g H from which the water has arrived at the gauge.
const ARRIVED: f64 = 0.1;
/// Times over sqrt(H / g) between which the jet runs up the wall and its pressure varies little.
const PLATEAU: [f64; 2] = [3.2, 4.9];
/// Largest mean change of the pressure in a step, over rho g H.
const JUMP: f64 = 0.05;

/// Mean of a series between two times.
fn mean(series: &[[f64; 2]], [from, to]: [f64; 2]) -> f64 {
    let inside: Vec<[f64; 2]> = series.iter().copied().filter(|row| (from..=to).contains(&row[0])).collect();
    let area: f64 = inside.windows(2).map(|w| 0.5 * (w[1][0] - w[0][0]) * (w[0][1] + w[1][1])).sum();
    area / (inside.last().map_or(f64::NAN, |row| row[0]) - inside.first().map_or(f64::NAN, |row| row[0]))
}

/// Check volume and energy: that lost to the transfer and to impacts is shown.
fn balances(outcome: &Outcome) -> [Check; 3] {
    let (setup, run) = (outcome.setup, &outcome.run);
    let name = |what: &str| format!("{}: {what}", setup.study.name());
    let changes = run.values(VOLUME).filter(|v| *v > 0.0).map(|v| v / setup.volume() - 1.0);
    let weight = DENSITY * GRAVITY * setup.volume();
    let energy =
        || run.rows.iter().map(|(_, v)| (v[KINETIC] / weight + v[CENTRE]) / (0.5 * setup.height) - 1.0);
    let lost = -energy().next_back().unwrap_or(f64::NAN);
    [
        Check::gate(
            name("largest change of the volume"),
            worst(changes),
            "-",
            0.0,
            VOLUME_KEPT,
            "incompressible",
        )
        .known_miss(FILMS),
        Check::at_most(name("energy gained, of the potential"), largest(energy()), "-", GAIN, "conservation"),
        Check::unreferenced(
            name("energy lost at the end, of the potential"),
            lost,
            "-",
            "transfer, impacts of liquid on liquid",
        ),
    ]
}
