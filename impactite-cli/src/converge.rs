//! Convergence study: one scene at several resolutions, as a sweep over the factor of its sizes.

use std::sync::atomic::AtomicBool;

use impactite::parallel::Team;
use impactite::scene::Solver;
use impactite_input::model::SceneFile;
use impactite_input::model::body::Mesh;
use impactite_input::{SceneEstimate, Size, Source};
use impactite_report::convergence::{
    CHART, CheckConvergence, Convergence, JSON, Level, MeasureConvergence, RefinedKey, TABLE,
};
use impactite_report::write_convergence;

use crate::CliError;
use crate::job::{Job, Measured, Outcome, seconds_a_step};
use crate::sweep::{Point, Values, begin, go_on, run_folder};

/// Relative difference between a size and its level, up to which the size belongs to the level: rounding of texts.
const ROUNDING: f64 = 1e-9;
/// Relative difference between a number of points and its expected growth under refinement, beyond which the levels are dissimilar.
const UNLIKE: f64 = 0.1;

/// Levels of a convergence study.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// Number of levels; an order needs three.
    pub levels: u32,
    /// Ratio of the sizes of neighbouring levels.
    pub ratio: f64,
    /// True if the scene as written is the finest level, false if it is the coarsest.
    pub coarser: bool,
    /// Keys whose values are scaled; the keys of [`Source::sizes`] if empty.
    pub keys: Vec<String>,
}

impl Default for Refinement {
    fn default() -> Self {
        Refinement { levels: 3, ratio: 2.0, coarser: false, keys: Vec::new() }
    }
}

impl Refinement {
    /// Factors of the sizes, coarsest level first.
    #[must_use]
    pub fn factors(&self) -> Vec<f64> {
        let power = |n: u32| self.ratio.powi(n as i32);
        let levels = 0..self.levels;
        if self.coarser {
            levels.rev().map(power).collect()
        } else {
            levels.map(|n| power(n).recip()).collect()
        }
    }
}

/// Run a scene at several resolutions, each in a folder of its own (`001`, the coarsest, ...); then write the table `converge.csv`, the object
/// `converge.json`, the chart `converge.png` and the page `converge.html`. All levels are set up before the first run, and the cost of each is in the
/// log.
///
/// # Errors
/// Fewer than two levels, a ratio below 1.2; a scene without measures; sizes that cannot be refined; errors of
/// [`sweep`](crate::sweep::sweep).
pub fn converge(base: &Job, refinement: &Refinement, stop: &AtomicBool) -> Result<Convergence, CliError> {
    if refinement.levels < 2 {
        return Err(CliError::option(
            "--levels",
            format!("{} is not allowed; it must be 2 or more", refinement.levels),
        ));
    }
    if !(refinement.ratio >= 1.2 && refinement.ratio.is_finite()) {
        return Err(CliError::option(
            "--ratio",
            format!("{} is not allowed; it must be 1.2 or more", refinement.ratio),
        ));
    }
    let scene = base.source.parse()?;
    let refused = |key: &str, why: &str, help: String| {
        CliError::from(impactite_input::InputError::from(Box::new(base.source.fault_at(
            key,
            why,
            Some(help),
        ))))
    };
    if scene.measures.is_empty() {
        let help = "`impactite list measures` has what can be measured".to_string();
        return Err(refused("measures", "the scene has no measures, whose convergence is studied", help));
    }
    let sizes = base.source.sizes(&scene)?;
    let keys = match &refinement.keys[..] {
        [] => sizes.iter().map(|size| size.key.clone()).collect(),
        given => given.to_vec(),
    };
    for (parameter, users) in base.source.shared_parameters(&scene, &keys) {
        tracing::warn!(
            "the resolution is written with `{parameter}`, and so are {}, which stay as they are; where they belong to the resolution: \
             `--refine` with the keys to scale, as `--refine parameters.{parameter}` for a length",
            users.join(", ")
        );
    }
    let (source, parameter) = base.source.scaled(&sizes, &keys)?;
    let base = Job { source, ..base.clone() };
    let factors = refinement.factors();
    let values =
        Values { key: format!("parameters.{parameter}"), list: factors.iter().map(f64::to_string).collect() };
    let mut coarser: Option<(SceneFile, SceneEstimate)> = None;
    for (n, (factor, value)) in factors.iter().zip(&values.list).enumerate() {
        let source = base.source.set(&format!("{}={value}", values.key))?;
        let scene = source.parse()?;
        for (scaled, size) in source.sizes(&scene)?.iter().zip(&sizes) {
            if (scaled.value / (factor * size.value) - 1.0).abs() > ROUNDING {
                let why = format!(
                    "is {:.6e} {unit} at level {}; it must be {:.6e} {unit}, as all sizes are refined together",
                    scaled.value,
                    n + 1,
                    factor * size.value,
                    unit = size.unit
                );
                return Err(refused(&size.key, &why, format!("`--refine {}` scales it, too", size.key)));
            }
        }
        let mut solver = source.build(&scene)?;
        impactite_input::measured::Measures::new(&source, &scene, &*solver)?;
        let ahead = source.estimate(&scene, &mut *solver)?;
        let seconds = cost_of_a_step(&base, &mut *solver, scene.end.value)?;
        tracing::info!(
            "level {} of {}, {} = {:.4e} {}: {} points, {}, steps: {}",
            n + 1,
            factors.len(),
            sizes[0].key,
            factor * sizes[0].value,
            sizes[0].unit,
            ahead.bodies.iter().map(|body| body.points).sum::<usize>(),
            ahead.memory(),
            ahead.cost(seconds)
        );
        if let Some((scene, before)) = &coarser {
            warn_of_unlike(scene, before, &ahead, refinement.ratio);
        }
        coarser = Some((scene, ahead));
    }
    let (mut plan, _lock) = begin(&base, std::slice::from_ref(&values), Some(refinement.ratio))?;
    let points = go_on(&base, &mut plan, stop)?;
    conclude(&base, &values, refinement.ratio, &points)
}

/// Measure the wall-clock time per step with the threads of a job, s.
fn cost_of_a_step(base: &Job, solver: &mut dyn Solver, end: f64) -> Result<Option<f64>, CliError> {
    let team = Team::new(base.threads()).map_err(|e| CliError::option("--threads", e.to_string()))?;
    solver.set_team(team);
    seconds_a_step(solver, end)
}

/// Warn of the body whose growth in points differs most from uniform refinement, if the difference exceeds [`UNLIKE`].
fn warn_of_unlike(scene: &SceneFile, coarse: &SceneEstimate, fine: &SceneEstimate, ratio: f64) {
    let growth = coarse.bodies.iter().zip(&fine.bodies).map(|(coarse, fine)| {
        let mesh = scene.expanded.get(&coarse.name).and_then(|body| body.mesh.as_ref());
        let dimensions = if matches!(mesh, Some(Mesh::Bars(_))) { 1 } else { scene.space.dimensions() };
        (&coarse.name, fine.points as f64 / coarse.points as f64, ratio.powi(dimensions as i32))
    });
    let off = |growth: f64, expected: f64| (growth / expected).ln().abs();
    let worst = growth.max_by(|a, b| off(a.1, a.2).total_cmp(&off(b.1, b.2)));
    if let Some((name, growth, expected)) =
        worst.filter(|(_, growth, expected)| (growth / expected - 1.0).abs() > UNLIKE)
    {
        tracing::warn!(
            "bodies.{name}: {growth:.2} times as many points at the next level, and not {expected:.2}: its shape is no multiple of the sizes, or \
             depends on them; observed orders are uncertain"
        );
    }
}

/// Analyse the runs of a convergence study and write its files. The sizes of the scene in `base` are scaled by the key of `factors`.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn conclude(
    base: &Job,
    factors: &Values,
    ratio: f64,
    points: &[Point],
) -> Result<Convergence, CliError> {
    let scene = base.source.parse()?;
    let sizes = |value: &String| {
        let source: Source = base.source.set(&format!("{}={value}", factors.key))?;
        source.sizes(&source.parse()?)
    };
    let sizes: Vec<Vec<Size>> = factors.list.iter().map(sizes).collect::<Result<_, _>>()?;
    let refined = sizes.first().into_iter().flatten().enumerate().map(|(n, size)| RefinedKey {
        key: size.key.clone(),
        unit: size.unit.into(),
        values: sizes.iter().map(|level| level[n].value).collect(),
    });
    let outcomes: Vec<Option<&Outcome>> = points.iter().map(|point| point.outcome.as_ref().ok()).collect();
    let measure = |(m, (name, unit)): (usize, (String, String))| {
        let value = |outcome: &Option<&Outcome>| {
            outcome.and_then(|o| o.measures.get(m)).map_or(f64::NAN, |Measured(_, value, _)| *value)
        };
        MeasureConvergence::new(name, &unit, outcomes.iter().map(value).collect(), ratio)
    };
    let measures: Vec<MeasureConvergence> =
        impactite_input::measured::columns(&scene).into_iter().enumerate().map(measure).collect();
    let level = |(n, point): (usize, &Point)| {
        let outcome = point.outcome.as_ref();
        Level {
            folder: run_folder(n + 1),
            factor: factors.list[n].parse().unwrap_or(f64::NAN),
            particles: outcome.ok().map(|o| o.particles),
            steps: outcome.ok().map(|o| o.steps),
            wall_seconds: outcome.ok().map(|o| o.wall_seconds),
            error: outcome.err().cloned(),
        }
    };
    let finest = outcomes.last().copied().flatten();
    let checks = finest.into_iter().flat_map(|outcome| outcome.checks.clone());
    let study = Convergence {
        case: scene.title.clone(),
        ratio,
        refined: refined.collect(),
        levels: points.iter().enumerate().map(level).collect(),
        checks: checks.map(|check| CheckConvergence::new(check, &measures)).collect(),
        measures,
    };
    let folder = &base.folder;
    let json = serde_json::to_string(&study).map_err(|e| CliError::option(JSON, e.to_string()))?;
    impactite::output::write_whole(folder.join(TABLE), study.csv()?)?;
    impactite::output::write_whole(folder.join(JSON), json + "\n")?;
    if let Some(picture) = study.chart()? {
        picture.save(folder.join(CHART))?;
    }
    if base.report {
        write_convergence(&study, folder)?;
    }
    Ok(study)
}
