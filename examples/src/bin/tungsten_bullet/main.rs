//! A tungsten bullet goes through an aluminium plate (case 4 of Feng 2014), by the particle-contact meshfree method and by
//! the material point method: the same laws of the two metals drive both.

mod estimate;
mod figures;
mod grid;
mod particles;
mod scene;

use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use examples::{CaseError, Check, Common, Report, Totals, case, within};

use scene::{BULLET, MOMENTS, Outcome, PAPER_AREA, SPEED};

/// Tungsten bullet (28.4 mm x 8 mm) through an aluminium plate of 50 mm at 1140 m/s, by particle contacts and by MPM.
///
/// The speed of the interface and the time to perforation are compared with the theory of Tate, for common strengths and
/// for those of the printed laws in plane strain; the exit code says whether the conserved quantities are, and the speed
/// lies between the bounds of theory.
#[derive(Debug, Parser)]
#[command(name = "tungsten_bullet", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Which method
    #[arg(long, value_enum, default_value = "both")]
    method: Methods,
    /// Particles of the paper's size an axis: 2 is four times its number, 0.2 to 4 [default: 0.5, 1 or 2 by resolution]
    #[arg(long, value_name = "X", value_parser = within(0.2, 4.0))]
    refine: Option<f64>,
    /// Friction coefficient between bullet and target, 0 to 1
    #[arg(long, value_name = "MU", default_value_t = 0.0, value_parser = within(0.0, 1.0))]
    friction: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Methods {
    /// Particle contacts
    Pcmm,
    /// Material points
    Mpm,
    /// One after the other
    Both,
}

/// Speed of the interface by Tate, m/s: strengths (1.2, 1.8) and (2.2, 1.8) GPa of bullet and target, as of round bullets.
pub const INTERFACE: [f64; 2] = [760.0, 880.0];
/// When 50 mm are reached at that speed, with the faster start, s.
const THROUGH: [f64; 2] = [57.0e-6, 66.0e-6];
const MOMENTUM_TOLERANCE: f64 = 1e-11;
const MASS_TOLERANCE: f64 = 1e-9;
const ADDED_TOLERANCE: f64 = 0.02;
/// Of the kinetic energy at impact.
const ENERGY_TOLERANCE: f64 = 0.05;

fn main() -> ExitCode {
    case::exit(run(&Options::parse()))
}

fn run(options: &Options) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("tungsten_bullet")?;
    let refine = options.refine.unwrap_or(common.resolution.choose(0.5, 1.0, 2.0));
    let spacing = PAPER_AREA.sqrt() / refine;
    // The laws that both methods run with.
    let metals = [scene::tungsten()?, scene::aluminium()?];
    let (mut totals, mut checks, mut outcomes) = (Totals::default(), Vec::new(), Vec::new());
    if options.method != Methods::Mpm {
        outcomes.push(particles::shoot(metals, spacing, options.friction, common.threads())?);
    }
    if options.method != Methods::Pcmm {
        outcomes.push(grid::shoot(metals, spacing, options.friction, common.threads())?);
    }
    for outcome in &outcomes {
        outcome.save(&folder)?;
        totals = totals.plus(&outcome.totals);
        checks.extend(checks_of(outcome));
    }
    figures::draw(&outcomes, &folder)?;
    let settings = serde_json::json!({
        "refine": refine,
        "spacing": spacing,
        "particles_across_the_bullet": BULLET[1] / spacing,
        "methods": outcomes.iter().map(|o| o.name).collect::<Vec<_>>(),
        "core_seconds": outcomes.iter().map(|o| o.totals.wall_seconds).collect::<Vec<_>>(),
        "friction": options.friction,
        "threads": common.threads(),
        "impact_speed": SPEED,
    });
    Report::new("tungsten_bullet", common.resolution, settings, &totals, checks).finish(common, &folder)
}

fn checks_of(outcome: &Outcome) -> Vec<Check> {
    let name = |what: &str| format!("{}: {what}", outcome.name);
    let tate = "steady penetration, Tate [C]";
    let [slow, fast] = INTERFACE;
    let [early, late] = THROUGH.map(|t| 1e6 * t);
    let free = "conservation";
    let (speed, through) = (outcome.interface_speed(), 1e6 * outcome.through());
    // The printed law of the bullet is stronger, and a target gives way more easily in plane strain.
    let most = estimate::tate(estimate::strength(), estimate::resistance());
    let plane = "Tate, printed law, cold; plane strain [C]";
    let last = outcome.history.last().map_or(f64::NAN, |e| e.speed);
    let mut checks = vec![
        Check::at_least(name("speed of the interface, 10 to 32 µs"), speed, "m/s", slow, tate),
        Check::at_most(name("speed of the interface, 10 to 32 µs"), speed, "m/s", most, plane),
        Check::gate(
            name("speed of the interface, 10 to 32 µs"),
            speed,
            "m/s",
            0.5 * (slow + fast),
            (fast - slow) / (fast + slow),
            tate,
        )
        .noted(),
        Check::gate(
            name("50 mm are reached"),
            through,
            "µs",
            0.5 * (early + late),
            (late - early) / (late + early),
            tate,
        )
        .noted(),
        Check::shown(name("depth at 10 µs"), 1e3 * outcome.tip(MOMENTS[0]), "mm", 8.0, tate),
        Check::shown(name("depth at 32 µs"), 1e3 * outcome.tip(MOMENTS[1]), "mm", 26.0, tate),
        Check::shown(name("velocity of the bullet's mass at the end"), last, "m/s", SPEED, "at impact"),
        Check::gate(name("mass"), outcome.mass, "-", 1.0, MASS_TOLERANCE, "exact volumes"),
        Check::gate(
            name("momentum error"),
            outcome.totals.momentum_error,
            "-",
            0.0,
            MOMENTUM_TOLERANCE,
            free,
        ),
        Check::gate(name("energy error"), outcome.totals.energy_error, "-", 0.0, ENERGY_TOLERANCE, free),
    ];
    if let Some(added) = outcome.added {
        checks.push(Check::gate(name("energy added by revisions"), added, "-", 0.0, ADDED_TOLERANCE, free));
    }
    checks
}
