//! Kernels without contact.

use std::path::Path;
use std::process::Command;

use examples::CaseError;
use examples::throughput::{self, Job, Kernel, Measured, Spread, Way, cube_of, measure, timed};
use mpm_core::{
    Apic, CpGimp, CubicBSpline, Deformable, Flip, Float, Fmpm, FullSpace, IntoKernels, Linear, Method, Mpm,
    Musl, QuadraticBSpline, Team, Usl,
};
use mpm_materials::{Constitutive, IntoMaterial, LinearElastic, Moduli, NeoHookean, Solid};

use crate::page::table;
use crate::sample::{Sample, Subject, alternate, attempt};

const KERNELS: [Kernel; 3] =
    [Kernel::LinearMuslElastic, Kernel::LinearMuslJohnsonCook, Kernel::QuadraticApicUsl];

fn rounds(quick: bool) -> usize {
    if quick { 3 } else { 5 }
}
fn job(kernel: Kernel, particles: usize, threads: usize) -> Job {
    let steps = (20_000_000 / particles as u64).clamp(20, 200);
    Job { kernel, particles, threads, steps, way: Way::default() }
}

/// Measure the timing noise: the same job under two names.
pub fn noise(quick: bool) -> Result<Option<String>, CaseError> {
    let mut rows = Vec::new();
    for threads in [1, 2] {
        let job = job(Kernel::LinearMuslElastic, 200_000, threads);
        let run = || measure::<f64>(&job);
        let samples = alternate(&[Subject::new("A", run), Subject::new("A", run)], 2 * rounds(quick))?;
        rows.push([
            threads.to_string(),
            samples[0].rates().text(1),
            samples[1].rates().text(1),
            samples[0].over(&samples[1]).text(3),
        ]);
    }
    Ok(Some(format!(
        "## Noise\n\nOne job under two names, `linear-musl-elastic` at 195 112 particles: a ratio of two programs inside \
         the last column's range is no difference.\n\n{}",
        table(["threads", "A", "A again", "ratio, round by round"], &rows)
    )))
}

/// Instructions of hand-written kernels, from the description of the yardstick: 27 000 particles.
const THEIR_INSTRUCTIONS: [u32; 3] = [249, 289, 416];
const OUR_INSTRUCTIONS: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/tests/instructions.csv"));

/// Run the yardstick once.
pub fn by_hand(program: &Path, kernel: &str, scene: &'static str, job: &Job) -> Result<Measured, CaseError> {
    Ok(elsewhere(&throughput::hand_written(program, kernel, scene, job)?, kernel, scene, job))
}

/// Run this library's `throughput` once, as built for this machine or at another commit.
fn our_program(program: &Path, job: &Job) -> Result<Measured, CaseError> {
    let mut command = Command::new(program);
    command
        .args(["--kernel", job.kernel.name(), "--particles", &job.particles.to_string(), "--json"])
        .args(["--threads", &job.threads.to_string(), "--steps", &job.steps.to_string(), "--out"])
        .arg(std::env::temp_dir().join("impactite-elsewhere"));
    // Builds of earlier commits without this option support one way only.
    if job.way == Way::Inlined {
        command.args(["--way", "inlined"]);
    }
    let found = throughput::printed(&mut command)?;
    let run = &found["settings"]["runs"][0];
    if !run["particle_updates_per_second"].is_number() {
        return Err(CaseError::Other(format!("{}: no rate in {found}", program.display())));
    }
    Ok(elsewhere(run, job.kernel.name(), job.kernel.scene(), job))
}

/// Convert the results of another program.
fn elsewhere(found: &serde_json::Value, kernel: &str, scene: &'static str, job: &Job) -> Measured {
    let number = |key: &str| found[key].as_f64().unwrap_or(f64::NAN);
    Measured {
        kernel: kernel.into(),
        scene,
        particles: number("particles") as usize,
        cells: 0,
        threads: job.threads,
        steps: job.steps,
        seconds: number("seconds"),
        grid_seconds: f64::NAN,
        particle_updates_per_second: number("particle_updates_per_second"),
        bytes_per_particle: number("bytes_per_particle") as usize,
        bytes_per_node: 0,
        checksum: String::new(),
        momentum_drift: 0.0,
        energy_drift: 0.0,
        total_bytes_per_particle: 0.0,
        grid_bytes: 0,
        bits: 64,
    }
}

/// Geometric mean and minimum of ratios.
#[derive(Default)]
struct Ratios(Vec<f64>);

impl Ratios {
    fn text(&self) -> String {
        let mean = (self.0.iter().map(|r| r.ln()).sum::<f64>() / self.0.len() as f64).exp();
        let worst = self.0.iter().copied().fold(f64::INFINITY, f64::min);
        format!("geometric mean {mean:.2}, worst {worst:.2}")
    }
}

/// Compare the called law with the inlined law and, if given, with a build at another commit. Each runs in its own process, so
/// that none reuses memory of another.
pub fn ways(
    quick: bool,
    current: Option<&Path>,
    previous: Option<&Path>,
) -> Result<Option<String>, CaseError> {
    let Some(current) = current else {
        eprintln!("skipped: give a built throughput with --throughput PROGRAM");
        return Ok(None);
    };
    let sizes: &[usize] = if quick { &[200_000] } else { &[200_000, 2_000_000] };
    let mut rows = Vec::new();
    // Ratios: called and inlined over the other commit, and called over inlined.
    let mut ratios = [Ratios::default(), Ratios::default(), Ratios::default()];
    for kernel in KERNELS {
        for &particles in sizes {
            for threads in [1, 2] {
                let called = job(kernel, particles, threads);
                let inlined = Job { way: Way::Inlined, ..called };
                let mut subjects = vec![
                    Subject::new("called", || our_program(current, &called)),
                    Subject::new("inlined", || our_program(current, &inlined)),
                ];
                if let Some(previous) = previous {
                    subjects.push(Subject::new("before", || our_program(previous, &called)));
                }
                let samples = alternate(&subjects, rounds(quick))?;
                let mut over = |n: usize, samples: [&Sample; 2]| {
                    let ratio = samples[0].over(samples[1]);
                    ratios[n].0.push(ratio.median);
                    ratio.text(2)
                };
                let between = over(2, [&samples[0], &samples[1]]);
                let before = samples.get(2).map(|before| {
                    [before.rates().text(1), over(0, [&samples[0], before]), over(1, [&samples[1], before])]
                });
                let [rate, of_called, of_inlined] = before.unwrap_or(["-", "-", "-"].map(String::from));
                rows.push([
                    kernel.name().to_string(),
                    samples[0].first().particles.to_string(),
                    threads.to_string(),
                    rate,
                    samples[0].rates().text(1),
                    samples[1].rates().text(1),
                    of_called,
                    of_inlined,
                    between,
                ]);
            }
        }
    }
    let against = match previous {
        Some(_) => format!(
            "Over the commit before: called {} (0.95 and 0.90 are asked), inlined {} (0.99 is asked).",
            ratios[0].text(),
            ratios[1].text()
        ),
        None => "No other commit was measured (`--previous PROGRAM`).".into(),
    };
    Ok(Some(format!(
        "## The law behind a call\n\nA pass calls the law for some groups of particles at once, which is what scenes do, or has it \
         inlined, which `Deformable::inlined` asks for. {against} Called over inlined: {}.\n\n{}",
        ratios[2].text(),
        table(
            [
                "kernel",
                "particles",
                "threads",
                "before",
                "called",
                "inlined",
                "called / before",
                "inlined / before",
                "called / inlined"
            ],
            &rows
        )
    )))
}

/// Compare with hand-written kernels: built without flags, and built for this machine.
pub fn yardstick(
    quick: bool,
    program: Option<&Path>,
    native: Option<&Path>,
) -> Result<Option<String>, CaseError> {
    let Some(program) = program else {
        eprintln!("skipped: give a built yardstick with --yardstick PROGRAM");
        return Ok(None);
    };
    let sizes: &[usize] = if quick { &[200_000] } else { &[30_000, 200_000, 2_000_000] };
    let mut rows = Vec::new();
    let (mut plain, mut natives) = (Ratios::default(), Ratios::default());
    for (kernel, name) in KERNELS.into_iter().zip(["K1", "K2", "K3"]) {
        for &particles in sizes {
            for threads in [1, 2] {
                let job = job(kernel, particles, threads);
                let mut subjects = vec![
                    Subject::new("theirs", || by_hand(program, name, kernel.scene(), &job)),
                    Subject::new("ours", || measure::<f64>(&job)),
                ];
                if let Some(native) = native {
                    subjects.push(Subject::new("native", || our_program(native, &job)));
                }
                let samples = alternate(&subjects, rounds(quick))?;
                let ratio = samples[1].over(&samples[0]);
                let of_native = samples.get(2).map(|native| (native, native.over(&samples[0])));
                if particles > 30_000 {
                    plain.0.push(ratio.median);
                    natives.0.extend(of_native.as_ref().map(|(_, ratio)| ratio.median));
                }
                let [rate, over] = match &of_native {
                    Some((native, ratio)) => [native.rates().text(1), ratio.text(2)],
                    None => ["-".into(), "-".into()],
                };
                rows.push([
                    kernel.name().to_string(),
                    samples[1].first().particles.to_string(),
                    threads.to_string(),
                    samples[1].rates().text(1),
                    rate,
                    samples[0].rates().text(1),
                    ratio.text(2),
                    over,
                ]);
            }
        }
    }
    let counts: Vec<[String; 5]> = OUR_INSTRUCTIONS
        .lines()
        .skip(1)
        .zip(THEIR_INSTRUCTIONS)
        .filter_map(|(line, theirs)| {
            let mut cells = line.split(',');
            let [name, called, inlined] = [cells.next()?, cells.next()?, cells.next()?];
            let ratio = called.parse::<f64>().ok()? / f64::from(theirs);
            Some([name.into(), called.into(), inlined.into(), theirs.to_string(), format!("{ratio:.2}")])
        })
        .collect();
    let natives = match native {
        Some(_) => natives.text(),
        None => "not measured (`--native PROGRAM`)".into(),
    };
    Ok(Some(format!(
        "## Against hand-written kernels\n\nThe same steps written by hand for this class of machine, without types \
         to choose from, errors, output, time control or identities of particles; compiled for this machine. \
         Ours as built without flags, and for this machine likewise: `-C target-cpu=native`. All in huge pages. Ratios from \
         200 000 particles on: without flags {}, for this machine {natives} (0.95 and 0.85 are asked).\n\n{}\nInstructions a particle and \
         step at 27 000 particles, by callgrind; a test keeps ours within 2 %:\n\n{}",
        plain.text(),
        table(
            [
                "kernel",
                "particles",
                "threads",
                "ours",
                "ours, for this machine",
                "by hand",
                "ratio",
                "its ratio"
            ],
            &rows
        ),
        table(["kernel", "called", "inlined", "by hand", "called / by hand"], &counts)
    )))
}

/// Measure the cost per particle over the number of particles.
pub fn sizes(quick: bool) -> Result<Option<String>, CaseError> {
    let sizes: &[usize] = if quick {
        &[30_000, 100_000, 300_000]
    } else {
        &[30_000, 100_000, 300_000, 1_000_000, 3_000_000, 5_000_000]
    };
    let mut rows = Vec::new();
    for kernel in KERNELS {
        for threads in [1, 2] {
            let jobs: Vec<Job> =
                sizes.iter().map(|n| Job { steps: 30, ..job(kernel, *n, threads) }).collect();
            let subjects: Vec<Subject> =
                jobs.iter().map(|job| Subject::new("", move || measure::<f64>(job))).collect();
            let samples = alternate(&subjects, rounds(quick).min(3))?;
            let nanoseconds =
                |s: &Sample| Spread::of(s.runs.iter().map(|r| 1e9 / r.particle_updates_per_second)).median;
            let flat = Spread::of(samples.iter().skip(1).map(nanoseconds));
            let mut cells: Vec<String> = samples.iter().map(|s| format!("{:.1}", nanoseconds(s))).collect();
            cells.resize(6, "-".into());
            let [a, b, c, d, e, f] = cells.try_into().unwrap_or_default();
            let spread = format!("{:.0} %", 100.0 * (flat.most / flat.least - 1.0));
            rows.push([kernel.name().into(), threads.to_string(), a, b, c, d, e, f, spread]);
        }
    }
    Ok(Some(format!(
        "## Cost over size\n\nNanoseconds a particle and step, 30 steps, medians; the last column is the largest over the \
         least from 10^5 on (15 % is asked).\n\n{}",
        table(["kernel", "threads", "3e4", "1e5", "3e5", "1e6", "3e6", "5e6", "spread"], &rows)
    )))
}

fn elastic<T: Float>() -> Result<LinearElastic<T>, CaseError> {
    let of = T::of;
    Ok(LinearElastic::new(of(1.0), Moduli::bulk_shear(of(1.0 + 1.6 / 3.0), of(0.8))?)?)
}

/// Build a cube of a law with about this number of particles.
fn cube<T: Float, L: IntoMaterial<T>>(
    particles: usize,
    method: impl IntoKernels<T, 3>,
    law: L,
) -> Result<Mpm<3, T>, CaseError> {
    cube_of(particles, method, |seeds| Deformable::new("cube", law, seeds))
}

fn of_method<T: Float>(particles: usize, method: impl IntoKernels<T, 3>) -> Result<Measured, CaseError>
where
    LinearElastic<T>: IntoMaterial<T>,
{
    let job = job(Kernel::LinearMuslElastic, particles, 1);
    timed(&job, cube(particles, method, elastic::<T>()?)?)
}

/// Measure shape functions x transfers x precisions.
pub fn compositions(quick: bool) -> Result<Option<String>, CaseError> {
    let particles = if quick { 30_000 } else { 200_000 };
    let mut subjects = Vec::new();
    macro_rules! of {
        ($($name:literal: $shape:expr, $transfer:expr, $scheme:expr;)*) => {$(
            subjects.push(Subject::new($name, move || {
                of_method::<f64>(particles, Method::new($shape, $transfer, $scheme, FullSpace).compiled())
            }));
            subjects.push(Subject::new($name, move || {
                of_method::<f32>(particles, Method::new($shape, $transfer, $scheme, FullSpace).compiled())
            }));
        )*};
    }
    of! {
        "linear, FLIP, MUSL": Linear, Flip, Musl;
        "linear, FMPM(2), USL": Linear, Fmpm::<2>, Usl;
        "cpGIMP, FLIP, MUSL": CpGimp, Flip, Musl;
        "cpGIMP, APIC, USL": CpGimp, Apic, Usl;
        "cpGIMP, FMPM(2), USL": CpGimp, Fmpm::<2>, Usl;
        "quadratic, FLIP, MUSL": QuadraticBSpline, Flip, Musl;
        "quadratic, APIC, USL": QuadraticBSpline, Apic, Usl;
        "quadratic, FMPM(2), USL": QuadraticBSpline, Fmpm::<2>, Usl;
        "cubic, FLIP, MUSL": CubicBSpline, Flip, Musl;
        "cubic, APIC, USL": CubicBSpline, Apic, Usl;
        "cubic, FMPM(2), USL": CubicBSpline, Fmpm::<2>, Usl;
    }
    let samples = attempt(&subjects, 3);
    let rows: Vec<[String; 7]> = samples
        .chunks(2)
        .map(|pair| {
            let (double, single) = (&pair[0], &pair[1]);
            if let Some(failure) = double.failure.as_ref().or(single.failure.as_ref()) {
                let step = failure.split(" at ").next().unwrap_or("a step");
                let mut row = ["-"; 7].map(String::from);
                (row[0], row[1]) = (double.name.clone(), format!("fails in {step}"));
                return row;
            }
            [
                double.name.clone(),
                double.rates().text(1),
                single.rates().text(1),
                format!("{:.2}", single.over(double).median),
                double.first().bytes_per_particle.to_string(),
                format!("{:.0}", double.first().total_bytes_per_particle),
                format!("{:.0}", single.first().total_bytes_per_particle),
            ]
        })
        .collect();
    Ok(Some(format!(
        "## Compositions\n\nA cube of linear elasticity, {particles} particles, one thread. Bytes a particle: what it \
         carries in f64, and with grid, tiles and all scratch in f64 and f32. The time step is three tenths of a cell over \
         the wave speed.\n\n{}",
        table(["method", "f64", "f32", "f32 / f64", "bytes", "with scratch", "f32"], &rows)
    )))
}

/// Measure memory and speed of laws.
pub fn laws(quick: bool) -> Result<Option<String>, CaseError> {
    let particles = if quick { 30_000 } else { 200_000 };
    let moduli = || Moduli::bulk_shear(1.0 + 1.6 / 3.0, 0.8);
    let neo = move || -> Result<Measured, CaseError> {
        let job = job(Kernel::QuadraticApicUsl, particles, 1);
        let law = NeoHookean::new(1.0, moduli()?)?;
        timed(&job, cube(particles, Method::new(QuadraticBSpline, Apic, Usl, FullSpace), law)?)
    };
    let plastic = move || -> Result<Measured, CaseError> {
        let job = job(Kernel::LinearMuslElastic, particles, 1);
        let strength =
            mpm_materials::J2::new(0.8, mpm_materials::strength::VoceHardening::new(0.05, 0.08, 10.0)?)?;
        let eos = mpm_materials::MieGruneisen::new(1.0, 1.24, 1.49, 2.0)?;
        let law = Solid::new(strength, eos).compiled();
        timed(&job, cube(particles, Method::new(Linear, Flip, Musl, FullSpace), law)?)
    };
    let samples = alternate(
        &[
            Subject::new("linear elastic, linear shape functions, FLIP", move || {
                of_method::<f64>(particles, Method::new(Linear, Flip, Musl, FullSpace))
            }),
            Subject::new("neo-Hookean, quadratic, APIC", neo),
            Subject::new("Voce + Mie-Grueneisen, linear shape functions, FLIP", plastic),
            Subject::new("Johnson-Cook + Mie-Grueneisen + heat, linear shape functions, FLIP", move || {
                measure::<f64>(&job(Kernel::LinearMuslJohnsonCook, particles, 1))
            }),
        ],
        3,
    )?;
    let asked = ["150", "260", "-", "210"];
    let rows: Vec<[String; 5]> = samples
        .iter()
        .zip(asked)
        .map(|(s, asked)| {
            [
                s.name.clone(),
                s.rates().text(1),
                s.first().bytes_per_particle.to_string(),
                format!("{:.0}", s.first().total_bytes_per_particle),
                asked.into(),
            ]
        })
        .collect();
    Ok(Some(format!(
        "## Laws\n\n{particles} particles, f64, one thread. Bytes a particle: what it carries; with grid, tiles and all \
         scratch; the most that is asked for the latter.\n\n{}",
        table(["law and method", "rate", "carried", "with scratch", "asked"], &rows)
    )))
}

/// Compare single with double precision.
pub fn single(quick: bool) -> Result<Option<String>, CaseError> {
    let particles = if quick { 30_000 } else { 200_000 };
    let mut rows = Vec::new();
    for kernel in [Kernel::LinearMuslElastic, Kernel::QuadraticApicUsl] {
        let job = Job { steps: 100, ..job(kernel, particles, 1) };
        let samples = alternate(
            &[Subject::new("f64", || measure::<f64>(&job)), Subject::new("f32", || measure::<f32>(&job))],
            rounds(quick),
        )?;
        let [x, v] = match kernel {
            Kernel::QuadraticApicUsl => {
                let method = || Method::new(QuadraticBSpline, mpm_core::Mls, Usl, FullSpace);
                differences(particles, method(), method())?
            }
            _ => {
                let method = || Method::new(Linear, Flip, Musl, FullSpace);
                differences(particles, method(), method())?
            }
        };
        rows.push([
            kernel.name().into(),
            samples[1].over(&samples[0]).text(2),
            format!("{x:.1e}"),
            format!("{v:.1e}"),
            format!("{:.2e}", samples[1].first().momentum_drift),
            format!("{:.1e}", samples[1].first().energy_drift - samples[0].first().energy_drift),
        ]);
    }
    Ok(Some(format!(
        "## Single precision\n\n{particles} particles, one thread, 100 steps. Largest difference of a position in \
         cells and of a velocity over the largest one, for a linear elastic cube; momentum drift of f32 (of the sum of \
         m |v|); difference of the relative drift of energy.\n\n{}",
        table(["kernel", "f32 / f64", "position", "velocity", "momentum, f32", "energy, f32 - f64"], &rows)
    )))
}

/// Largest differences after 100 steps: of positions, in cells, and of velocities, over the largest one.
fn differences(
    particles: usize,
    double: impl IntoKernels<f64, 3>,
    single: impl IntoKernels<f32, 3>,
) -> Result<[f64; 2], CaseError> {
    let a = states::<f64>(particles, double)?;
    let b = states::<f32>(particles, single)?;
    let (mut x, mut v, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (p, q) in a.iter().zip(&b) {
        for d in 0..3 {
            x = x.max((p[d] - q[d]).abs());
            v = v.max((p[d + 3] - q[d + 3]).abs());
            most = most.max(p[d + 3].abs());
        }
    }
    Ok([x, v / most])
}

/// Return positions and velocities after 100 steps, by number.
fn states<T: Float>(particles: usize, method: impl IntoKernels<T, 3>) -> Result<Vec<[f64; 6]>, CaseError>
where
    LinearElastic<T>: IntoMaterial<T>,
{
    let mut mpm = cube(particles, method, elastic::<T>()?)?;
    mpm.set_team(Team::new(1).map_err(|e| CaseError::Other(e.to_string()))?);
    for _ in 0..100 {
        mpm.step()?;
    }
    let mut all = vec![[0.0; 6]; mpm.particles()];
    for body in mpm.bodies() {
        body.for_each(&mut |p| {
            all[p.number][..3].copy_from_slice(&p.position);
            all[p.number][3..].copy_from_slice(&p.velocity);
        });
    }
    Ok(all)
}
