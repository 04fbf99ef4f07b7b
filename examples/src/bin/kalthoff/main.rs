//! Kalthoff-Winkler plate by the fragile points method \[Shen2022\]: a plate with two notches is struck between them, and a crack
//! propagates at about 70 degrees; at higher speeds, in a yielding steel with thermal softening, a shear band forms ahead of the notch
//! instead.

mod band;
mod checks;
mod figures;
mod setup;

use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use examples::cracks::{self, CrackOption, Plane, Softening};
use examples::fragile::Joint;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use band::Band;
use setup::{Files, Setup, Steel};

/// A steel plate with two notches that is struck between them at 33 m/s; the upper half of it.
///
/// As printed (incomplete flux, strength alone), and by a symmetric flux with fracture energy, in plane strain and in plane stress, on two
/// sets of random points each; then a steel that yields, at a low and a high speed. Start, angle and speed of the crack are judged. The exit
/// code says whether all are within the tolerances. Writes pictures, CSV histories and ParaView series.
#[derive(Debug, Parser)]
#[command(name = "kalthoff", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Which runs
    #[arg(long, value_enum, default_value = "all")]
    runs: Runs,
    /// Flux between cells, of one run in place of those of the case
    #[arg(long, value_enum)]
    flux: Option<Joint>,
    /// When faces open, of one run in place of those of the case
    #[arg(long, value_enum)]
    cracks: Option<CrackOption>,
    /// Cells of a cohesive face while it softens
    #[arg(long, value_enum, default_value = "joined")]
    softening: Softening,
    /// Plane strain or plane stress [default: as `runs` says]
    #[arg(long, value_enum)]
    plane: Option<Plane>,
    /// Points, one run each, 200 to 1000000 [default: 2500; 6516,11995; 6516,11995,26000 by resolution; as printed 6516 and 11995]
    #[arg(long, value_name = "N,N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(200..=1_000_000))]
    points: Vec<u32>,
    /// Seeds of the random points, one run each [default: 1,2]
    #[arg(long, value_name = "SEED,SEED", value_delimiter = ',')]
    seed: Vec<u64>,
    /// Speed of the projectile, m/s, 1 to 300; the edge moves at half of it
    #[arg(long, value_name = "M/S", default_value_t = 33.0, value_parser = within(1.0, 300.0))]
    speed: f64,
    /// Speed of the projectile at which a steel that yields is to make a band of shear, m/s, 1 to 300; its faces stay closed
    #[arg(long, value_name = "M/S", default_value_t = 160.0, value_parser = within(1.0, 300.0))]
    band_speed: f64,
    /// Plastic strain at which a steel that yields bears no shear any more, 0.01 to 10
    #[arg(long, value_name = "STRAIN", default_value_t = 0.15, value_parser = within(0.01, 10.0))]
    collapse: f64,
    /// Strength in tension, MPa, 10 to 100000
    #[arg(long, value_name = "MPA", default_value_t = 1773.0, value_parser = within(10.0, 1e5))]
    strength: f64,
    /// Strength in shear, MPa, of criteria that are mixed, 10 to 100000
    #[arg(long, value_name = "MPA", default_value_t = 1773.0, value_parser = within(10.0, 1e5))]
    shear_strength: f64,
    /// Fracture energy of cohesive faces, kJ/m^2, 0.01 to 10000
    #[arg(long, value_name = "KJ/M2", default_value_t = 22.13, value_parser = within(0.01, 1e4))]
    energy: f64,
    /// Penalty over Young's modulus, 0.1 to 100
    #[arg(long, value_name = "ETA", default_value_t = 5.0, value_parser = within(0.1, 100.0))]
    eta: f64,
    /// Friction of cracks that close, 0 to 1
    #[arg(long, value_name = "MU", default_value_t = 0.0, value_parser = within(0.0, 1.0))]
    friction: f64,
    /// Width of the notch, mm, 0 to 10: its sides touch when they have come so much closer (never in steel that yields)
    #[arg(long, value_name = "MM", default_value_t = 0.3, value_parser = within(0.0, 10.0))]
    gap: f64,
    /// End, us, 1 to 1000
    #[arg(long, value_name = "US", default_value_t = 90.0, value_parser = within(1.0, 1000.0))]
    end: f64,
    /// ParaView frames a run, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

/// Width of a notch whose sides never touch, m.
const OPEN: f64 = 0.01;

/// Which runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Runs {
    /// As printed: incomplete flux, strength alone, plane strain
    Printed,
    /// Symmetric flux, cohesive faces, plane strain and plane stress
    Cohesive,
    /// A steel that yields and softens with heat: at a low speed, and at one at which a band of shear goes ahead
    Yielding,
    /// One after the other
    All,
}

impl Options {
    fn setups(&self) -> Vec<Setup> {
        use {CrackOption as C, Joint as F, Plane as P, Steel as S};
        let given = |list: &[u32]| if self.points.is_empty() { list.to_vec() } else { self.points.clone() };
        let printed = given(self.common.resolution.choose(&[2500], &[6516, 11995], &[6516, 11995]));
        let ours = given(self.common.resolution.choose(&[2500], &[6516, 11995], &[6516, 11995, 26000]));
        let banded = given(self.common.resolution.choose(&[2500], &[11995], &[24000]));
        let seeds = if self.seed.is_empty() { vec![1, 2] } else { self.seed.clone() };
        let is = |runs| self.runs == runs || self.runs == Runs::All;
        let mut kinds: Vec<Kind> = Vec::new();
        if self.flux.is_some() || self.cracks.is_some() {
            let (flux, cracks) = (self.flux.unwrap_or(F::Symmetric), self.cracks.unwrap_or(C::Cohesive));
            kinds.push((S::Elastic, flux, cracks, P::Strain, self.speed, &ours));
        } else {
            if is(Runs::Printed) {
                kinds.push((S::Elastic, F::Incomplete, C::Strength, P::Strain, self.speed, &printed));
            }
            if is(Runs::Cohesive) {
                for plane in [P::Strain, P::Stress] {
                    kinds.push((S::Elastic, F::Symmetric, C::Cohesive, plane, self.speed, &ours));
                }
            }
            if is(Runs::Yielding) {
                let modes = [(self.speed, C::Cohesive), (self.band_speed, C::None)];
                kinds.extend(modes.map(|(speed, cracks)| {
                    (S::Yielding, F::Symmetric, cracks, P::Strain, speed, &banded[..])
                }));
            }
        }
        let mut setups = Vec::new();
        for (steel, flux, cracks, plane, speed, points) in kinds {
            for &points in points {
                for &seed in if steel == S::Yielding { &seeds[..1] } else { &seeds[..] } {
                    setups.push(Setup {
                        steel,
                        flux,
                        cracks,
                        softening: self.softening,
                        plane: if steel == S::Yielding { plane } else { self.plane.unwrap_or(plane) },
                        points,
                        seed,
                        speed,
                        strength: 1e6 * self.strength,
                        shear_strength: 1e6 * self.shear_strength,
                        energy: 1e3 * self.energy,
                        eta: self.eta,
                        friction: self.friction,
                        collapse: self.collapse,
                        // Sides that slide along each other by more than a cell width shall not interlock.
                        gap: if steel == S::Yielding { OPEN } else { 1e-3 * self.gap },
                        end: 1e-6 * self.end,
                        threads: self.common.threads(),
                    });
                }
            }
        }
        // Identical setups are run once.
        setups.dedup_by(|a, b| a == b);
        setups
    }
}

/// Parameters of a group of runs, and the numbers of points.
type Kind<'a> = (Steel, Joint, CrackOption, Plane, f64, &'a [u32]);

/// Run and its results.
struct Run {
    setup: Setup,
    outcome: cracks::Outcome,
    band: Option<Band>,
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("kalthoff")?;
    let files = Files { folder: &folder, frames: options.frames };
    let mut runs: Vec<Run> = Vec::new();
    for setup in options.setups() {
        let cells = setup.cells()?;
        let outcome = cracks::tear(&setup.torn(&cells, &files)?, restart)?;
        outcome.write_history(&folder.join(format!("history_{}.csv", setup.name())))?;
        let band =
            (setup.steel == Steel::Yielding).then(|| Band::of(&setup, &outcome.snapshot)).transpose()?;
        runs.push(Run { setup, outcome, band });
    }
    figures::draw(&runs, &folder)?;
    let totals = runs.iter().fold(Totals::default(), |sum, run| sum.plus(&run.outcome.totals));
    let settings = serde_json::json!({
        "runs": runs.iter().map(|run| run.setup).collect::<Vec<_>>(),
        "threads": options.common.threads(),
    });
    Report::new("kalthoff", options.common.resolution, settings, &totals, checks::of(&runs))
        .finish(&options.common, &folder)
}
