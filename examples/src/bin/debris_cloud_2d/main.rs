//! Debris cloud of an aluminium disc of 2 mm that hits a plate of 1 mm at 5 km/s, in plane strain (case 3 of Feng 2014), by
//! the particle-contact meshfree method: shock pressure, arrival time and front of the cloud against theory.

mod figures;
mod scene;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Report, Restart, case};

use scene::{END, Outcome, PLATE, SHOCK, SPEED};

/// Aluminium disc (2 mm) on an aluminium plate (1 mm x 16 mm) at 5 km/s by the particle-contact meshfree method.
///
/// Arrival of the shock and reach of the cloud are compared with the Hugoniot; the exit code says whether they are
/// within the tolerances. Plane strain: a cylinder, not a sphere.
#[derive(Debug, Parser)]
#[command(name = "debris_cloud_2d", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Particles across the thickness of the plate, 4 to 60; the paper has about 21 [default: 6 in smoke, else 21]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=60))]
    layers: Option<u32>,
    /// ParaView frames, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

/// Tolerance of the shock pressure, from so many particles across the plate on: the front takes some of them.
const PRESSURE_TOLERANCE: [(u32, f64); 2] = [(21, 0.01), (10, 0.03)];
/// Tolerance of the arrival: the front is two spacings wide, and the shock of the round disc slows down.
const ARRIVAL_TOLERANCE: f64 = 0.06;
/// Tolerance of the mean velocity of a disc and the strip of plate as wide as it: the plate beside it takes part, and the
/// rim of the disc flies past.
const CLOUD_TOLERANCE: f64 = 0.1;
const MOMENTUM_TOLERANCE: f64 = 1e-11;
/// Tolerance of the energy that revisions do not explain.
const ENERGY_TOLERANCE: f64 = 0.02;
const ADDED_TOLERANCE: f64 = 0.02;

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("debris_cloud_2d")?;
    let layers = options.layers.unwrap_or(common.resolution.choose(6, 21, 21));
    let outcome =
        scene::impact(PLATE[0] / f64::from(layers), common.threads(), &folder, options.frames, restart)?;
    figures::draw(&outcome, &folder)?;
    let audit = &outcome.audit;
    let settings = serde_json::json!({
        "layers": layers,
        "threads": common.threads(),
        "impact_speed": SPEED,
        "end": END,
        "elements_deleted": audit.removed.elements,
        "elements_created": audit.created.elements,
        "deleted_for_contact_small_angle_large_angle_short_edge": audit.flaws,
    });
    Report::new("debris_cloud_2d", common.resolution, settings, &outcome.totals, checks_of(&outcome, layers))
        .finish(common, &folder)
}

fn checks_of(outcome: &Outcome, layers: u32) -> Vec<Check> {
    // Like materials: the particle speed behind the shock is half the impact speed.
    let [density, sound, slope, _] = SHOCK;
    let particle = 0.5 * SPEED;
    let wave = sound + slope * particle;
    let pressure = density * wave * particle;
    let hugoniot = "Hugoniot [C]";
    // Release at most doubles the particle speed: upper bound of the rear face.
    let reach = 2.0 * particle * (END - PLATE[0] / wave) + PLATE[0];
    // Momentum balance of the disc and the strip of plate as wide as it.
    let disc = std::f64::consts::FRAC_PI_4 * scene::DIAMETER * scene::DIAMETER;
    let mean = SPEED * disc / (disc + scene::DIAMETER * PLATE[0]);
    let free = "conservation";
    let start = outcome.start;
    let removed = outcome.audit.removed.energy / start;
    let added = outcome.audit.energy_added() / start;
    let stored = outcome.audit.stored_energy / start;
    let Outcome { shock, arrival, front, cloud, bound, mass, .. } = *outcome;
    let (energy, momentum) = (outcome.totals.energy_error, outcome.totals.momentum_error);
    let fine = PRESSURE_TOLERANCE.into_iter().find(|(least, _)| layers >= *least);
    vec![
        Check::gate(
            "pressure of the shock",
            1e-9 * shock,
            "GPa",
            1e-9 * pressure,
            fine.map_or(PRESSURE_TOLERANCE[1].1, |(_, tolerance)| tolerance),
            hugoniot,
        )
        .judged_if(fine.is_some(), "the front takes some of less than ten layers")
        .known_miss("1.03 % at standard; why is not known"),
        Check::gate(
            "shock at the last layer of the plate",
            1e6 * arrival,
            "µs",
            1e6 * outcome.rear / wave,
            ARRIVAL_TOLERANCE,
            hugoniot,
        ),
        Check::at_most("front of the cloud near the axis", 1e3 * front, "mm", 1e3 * reach, hugoniot),
        Check::at_least(
            "front of the cloud near the axis",
            1e3 * front,
            "mm",
            1e3 * mean * END,
            "mean momentum [C]",
        ),
        Check::unreferenced("mass faster than the impact", outcome.jet, "-", "jet of the rim"),
        Check::unreferenced(
            "fastest particle",
            outcome.fastest,
            "m/s",
            "jet of the rim; the impact has 5000 m/s",
        ),
        Check::gate("mean velocity of the cloud", cloud, "m/s", mean, CLOUD_TOLERANCE, "mean momentum [C]"),
        Check::gate("mass", mass, "-", 1.0, 1e-9, "exact volumes"),
        Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM_TOLERANCE, free),
        Check::gate("energy error, but for revisions", energy, "-", 0.0, ENERGY_TOLERANCE, free),
        Check::gate("energy added by revisions", added, "-", 0.0, ADDED_TOLERANCE, free),
        Check::unreferenced("energy in particles without elements", stored, "-", "audit"),
        Check::unreferenced("energy of the elements they deleted", removed, "-", "audit"),
        Check::unreferenced("particles in elements at the end", bound, "-", "audit"),
    ]
}
