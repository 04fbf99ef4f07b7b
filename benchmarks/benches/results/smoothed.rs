//! Smoothed particles compared with other programs.

use std::path::Path;

use benchmarks::{Stepped, bar, stepped};
use examples::CaseError;
use mpm_core::{Axisymmetric, PlaneStrain};
use sph::{ArtificialStress, Composition, GradientCorrection, Method, Sph, Updated, WendlandC2};

use crate::page::{asked, table};
use crate::peers::of_particles;
use crate::sample::{Sample, Subject, alternate, attempt};

/// Required rate in three dimensions on one thread, million updates per second.
const RATE: f64 = 3.0;
/// Required ratios to the rates of LAMMPS and PySPH.
const LAMMPS: f64 = 6.0;
const PYSPH: f64 = 10.0;
/// Spacings in three dimensions, mm: about 53 000 and 200 000 particles.
const SPACINGS: [f64; 2] = [0.32, 0.204];
/// Width and length of PySPH's bar, mm, and its spacing; half of that is measured, too.
const THEIRS: [f64; 2] = [7.6, 25.4];
const COARSE: f64 = 0.384848;
/// Smoothing length of PySPH over the spacing.
const RATIO: f64 = 2.0;

/// Rounds, and particle updates per run.
#[derive(Clone, Copy)]
struct Effort {
    rounds: usize,
    updates: usize,
}

impl Effort {
    fn steps(self, particles: usize) -> u64 {
        (self.updates / particles).max(10) as u64
    }

    fn run<const D: usize, M: Composition<D>>(
        self,
        bar: Result<Sph<D, M>, CaseError>,
        threads: usize,
    ) -> Result<Measured, CaseError> {
        let mut bar = bar?;
        let steps = self.steps(bar.positions().len());
        let run = stepped(&mut bar, threads, steps)?;
        Ok(Measured { run, neighbours: bar.pairs() as f64 / run.points as f64 })
    }
}

/// Result of a run.
struct Measured {
    run: Stepped,
    /// Neighbours per particle; NaN for other programs.
    neighbours: f64,
}

impl crate::sample::Run for Measured {
    fn rate(&self) -> f64 {
        self.run.updates_per_second()
    }
}

/// Run another program for this number of steps at a spacing (mm).
fn peer(python: &Path, program: &str, spacing: f64, steps: u64) -> Result<Measured, CaseError> {
    Ok(Measured { run: of_particles(python, program, spacing, steps)?, neighbours: f64::NAN })
}

/// Measure rates and memory of this library.
fn ours(effort: Effort, space: &[f64]) -> Result<Vec<[String; 7]>, CaseError> {
    type Make<'a> = Box<dyn Fn(usize) -> Result<Measured, CaseError> + 'a>;
    let cells = bar::PRINTED;
    let mut bars: Vec<(&str, Make)> = Vec::new();
    for &spacing in space {
        let run = move |threads| effort.run(bar::in_space(1e-3 * spacing), threads);
        bars.push(("space, total Lagrangian", Box::new(run)));
    }
    let plane = move |threads| effort.run(bar::half(Method::updated(PlaneStrain), cells), threads);
    let axis = move |threads| effort.run(bar::half(Method::updated(Axisymmetric), cells), threads);
    bars.push(("plane strain, updated", Box::new(plane)));
    bars.push(("around the axis, updated", Box::new(axis)));
    let mut subjects = Vec::new();
    for (name, run) in &bars {
        for threads in [1, 2] {
            subjects.push(Subject::new(*name, move || run(threads)));
        }
    }
    let samples = alternate(&subjects, effort.rounds)?;
    let row = |(n, pair): (usize, &[Sample<Measured>])| {
        let (one, first) = (pair[0].rates(), pair[0].first());
        [
            pair[0].name.clone(),
            first.run.points.to_string(),
            format!("{:.0}", first.neighbours),
            one.text(2),
            if n < space.len() { asked(RATE, one.median >= RATE) } else { "-".into() },
            pair[1].rates().text(2),
            format!("{:.0}", first.run.bytes_per_point()),
        ]
    };
    Ok(samples.chunks_exact(2).enumerate().map(row).collect())
}

/// Format the rows of this library against another program, whose sample is the last; none if that failed.
fn beside(
    samples: &[Sample<Measured>],
    least: f64,
    absent: &mut Vec<String>,
) -> Result<Vec<[String; 7]>, CaseError> {
    let Some((theirs, ours)) = samples.split_last() else { return Ok(Vec::new()) };
    if let Some(failure) = ours.iter().find_map(|sample| sample.failure.clone()) {
        return Err(CaseError::Other(failure));
    }
    if let Some(failure) = &theirs.failure {
        eprintln!("{} is left out: {failure}", theirs.name);
        if !absent.contains(&theirs.name) {
            absent.push(theirs.name.clone());
        }
        return Ok(Vec::new());
    }
    let row = |ours: &Sample<Measured>| {
        let (one, ratio) = (ours.first(), ours.over(theirs));
        [
            ours.name.clone(),
            format!("{} ({})", one.run.points, theirs.first().run.points),
            format!("{:.0}", one.neighbours),
            ours.rates().text(2),
            format!("{}: {}", theirs.name, theirs.rates().text(3)),
            ratio.text(1),
            asked(format!("{least} times"), ratio.median >= least),
        ]
    };
    Ok(ours.iter().map(row).collect())
}

/// Rows of the comparison, and the missing programs.
type Beside = (Vec<[String; 7]>, Vec<String>);

/// Compare with LAMMPS in three and PySPH in two dimensions, on one thread.
fn peers(effort: Effort, space: &[f64], python: &Path, pysph: &Path) -> Result<Beside, CaseError> {
    let (mut rows, mut absent) = (Vec::new(), Vec::new());
    for &spacing in space {
        let particles = 53_000.0 * (SPACINGS[0] / spacing).powi(3);
        // Fewer steps for the slower programs.
        let steps = (effort.steps(particles as usize) / 2).max(10);
        let samples = attempt(
            &[
                Subject::new("space, total Lagrangian", || effort.run(bar::in_space(1e-3 * spacing), 1)),
                Subject::new("LAMMPS MACHDYN", || peer(python, "machdyn", spacing, steps)),
            ],
            effort.rounds,
        );
        rows.extend(beside(&samples, LAMMPS, &mut absent)?);
    }
    for spacing in [COARSE, 0.5 * COARSE] {
        // Particle counts as in their bar: both ends of the width are included.
        let count = |length: f64| (length / spacing).ceil() as usize;
        let counts = [count(THEIRS[0]) + 1, count(THEIRS[1])];
        let steps = (effort.steps(counts[0] * counts[1]) / 4).max(10);
        let whole = |kernel| {
            let stress = ArtificialStress::default();
            let method = Method::new(PlaneStrain, kernel, Updated, GradientCorrection, stress);
            effort.run(bar::whole(method, counts, 1e-3 * spacing), 1)
        };
        let wide = || WendlandC2::new(RATIO).map_err(|error| CaseError::Other(error.to_string()));
        let samples = attempt(
            &[
                Subject::new("plane strain, updated", || whole(WendlandC2::default())),
                Subject::new("the same, as many neighbours as theirs", || whole(wide()?)),
                Subject::new("PySPH", || peer(pysph, "pysph", spacing, steps)),
            ],
            effort.rounds,
        );
        rows.extend(beside(&samples, PYSPH, &mut absent)?);
    }
    Ok((rows, absent))
}

/// Measure rates and memory, compared with other programs.
pub fn cost(quick: bool, python: &Path, pysph: &Path) -> Result<Option<String>, CaseError> {
    let (effort, space) = if quick {
        (Effort { rounds: 3, updates: 1_000_000 }, &SPACINGS[..1])
    } else {
        (Effort { rounds: 5, updates: 4_000_000 }, &SPACINGS[..])
    };
    let ours = ours(effort, space)?;
    let (theirs, absent) = peers(Effort { rounds: 3, ..effort }, space, python, pysph)?;
    let absent = if absent.is_empty() {
        String::new()
    } else {
        format!(" Absent on this machine: {}.", absent.join(", "))
    };
    Ok(Some(format!(
        "## Smoothed particles\n\nTaylor bars of 4340 steel, Johnson-Cook with heat and Mie-Grueneisen, 7.595 x 37.97 mm, from their start at \
         181 m/s; in space by the total Lagrangian form, of 20 x 200 particles by the updated one. Million updates a second; on one thread by \
         its processor time, on two by the clock. Neighbours and bytes are those of a particle, all scratch included; {RATE} M/s are asked in \
         space on one thread.\n\n{}\n\
         Other programs, one thread, processor time, medians of three rounds in alternation: MACHDYN of LAMMPS on the bar in space \
         (Johnson-Cook, shock equation of state, as many neighbours), and the Taylor bar of PySPH's own examples (plane strain, constant yield \
         stress, shock equation of state; kernels reach four spacings, ours 2.6 unless told otherwise) as installed and with half the spacing, \
         ours of as many particles; theirs in brackets.{absent}\n\n{}",
        table(["bar", "particles", "neighbours", "one thread", "asked", "two threads", "bytes"], &ours),
        table(["bar", "particles", "neighbours", "ours", "theirs", "ours / theirs", "asked"], &theirs),
    )))
}
