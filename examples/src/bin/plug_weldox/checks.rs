//! What a shot is held against.

use examples::Check;

use crate::scene::Outcome;
use crate::setup::{Constants, Form, PLATE, PROJECTILE};

/// Residual speed, m/s, by Recht and Ipson, of a limit of 154.3 m/s from memory.
pub const RECHT_IPSON: f64 = 72.5;
/// The same, accepted from and to, m/s.
const ACCEPTED: [f64; 2] = [65.0, 80.0];
const LIMIT: &str = "Recht and Ipson [C], of a limit of 154.3 m/s [M]";
/// The plug is as wide as the projectile \[S\].
const PLUG: f64 = 0.07;
/// The projectile is hardly deformed \[S\]: parts of its radius and length.
const WIDER: f64 = 0.04;
const SHORTER: f64 = 0.01;
const ENERGY: f64 = 0.02;
const MOMENTUM: f64 = 1e-11;
const MASS: f64 = 1e-12;
/// Of the kinetic energy at impact, what artificial stress may make.
const MADE: f64 = 0.03;
const CUT: &str = "a plug is cut by damage";
const PARTS: &str = "0.1 (2001) and 0.15 (later) at 0.4 mm: particles in the band part before their law fails, as kernels of the present \
                     configuration bear ever less there";
const THIN: &str = "as printed, 0.4 mm: 8.1 mm (2001) and 8.9 mm (later) by the mass, and 9.2 mm at the widest (2001): what failed flies apart";
const COLLAR: &str = "11.3 mm at 0.4 mm: particles of the rim that part with the plug hang on at its rear";
const HANGS: &str = "at 0.4 mm and 160 µs a thread of particles is left";
/// From this many spacings on the radius on the band in which the plate shears is narrow enough.
const RESOLVED: usize = 20;
const BAND: &str = "bands of sheared particles are millimetres wide";

/// Rows of a shot.
pub fn of(outcome: &Outcome) -> Vec<Check> {
    let (setup, last) = (&outcome.setup, outcome.last());
    let name = |what: &str| format!("{}: {what}", setup.name());
    let shown = |what: &str, value: f64, unit: &str, remark: &str| {
        Check::unreferenced(name(what), value, unit, remark)
    };
    let paper = setup.speed == crate::SPEED;
    let mut checks = Vec::new();
    if paper {
        checks.push(Check::remembered(name("residual velocity"), last.projectile, "m/s", RECHT_IPSON, LIMIT));
        let within = f64::from(u8::from((ACCEPTED[0]..=ACCEPTED[1]).contains(&last.projectile)));
        checks.push(shown(
            "residual velocity is 65 to 80 m/s",
            within,
            "-",
            "1: it is; accepted [C] of a limit [M]",
        ));
    } else {
        checks.push(shown("residual velocity", last.projectile, "m/s", "at the end"));
    }
    let free = outcome.free_from();
    let through = f64::from(u8::from(free.is_some()));
    let resolved = |check: Check| check.judged_if(setup.cells() >= RESOLVED, BAND);
    // Of the mass that flies with the projectile: a disc of the plate's thickness.
    let density = setup.constants.density();
    let radius = (last.flying / (std::f64::consts::PI * density * PLATE[1])).sqrt();
    let plug = |what: &str, value: f64| {
        let source = "radius of the projectile [S]";
        resolved(Check::gate(name(what), 1e3 * value, "mm", 1e3 * PROJECTILE[0], PLUG, source))
    };
    let by_form = |check: Check| if setup.form == Form::Printed { check.known_miss(THIN) } else { check };
    let most = |what: &str, value: f64, bound: f64, source: &str| {
        Check::at_most(name(what), value, "-", bound, source)
    };
    let error = |what: &str, value: f64, allowed: f64| {
        Check::gate(name(what), value, "-", 0.0, allowed, "conservation")
    };
    let perforated = Check::gate(name("plate perforated"), through, "-", 1.0, 0.0, "plugging [S]");
    let [wide, long] = last.projectile_size;
    let hardly = "hardly deformed [S]";
    let cut = last.failed as f64 / setup.rows();
    let what = name("particles that failed, of a row through the plate");
    let by_damage = Check::at_least(what, cut, "-", 1.0, CUT);
    checks.extend([
        resolved(if setup.constants == Constants::Coupled {
            perforated.known_miss(HANGS)
        } else {
            perforated
        }),
        by_form(plug("radius of what flies, by its mass", radius)),
        resolved(by_damage.known_miss(PARTS)),
        most("projectile, wider by", wide / PROJECTILE[0] - 1.0, WIDER, hardly),
        most("projectile, shorter by", 1.0 - long / PROJECTILE[1], SHORTER, hardly),
        Check::gate(name("mass"), outcome.mass, "-", 1.0, MASS, "exact volumes"),
        error("momentum error", outcome.totals.momentum_error, MOMENTUM),
        error("energy error", outcome.totals.energy_error, ENERGY),
    ]);
    if let Some(time) = free {
        let widest = plug("widest radius of the plug", last.plug[2]);
        checks.extend([
            match (setup.form, setup.constants) {
                (Form::Printed, Constants::Later) => widest,
                (_, Constants::Later) => widest.known_miss(COLLAR),
                _ => by_form(widest),
            },
            shown("plug is free from", 1e6 * time, "µs", "plug and rim hang together before"),
            shown("velocity of the plug", last.plug[0], "m/s", "its centre of mass"),
            shown(
                "mass of the plug, intact",
                1e3 * last.plug[1],
                "g",
                "19.7 g: a disc as wide as the projectile",
            ),
        ]);
    }
    let first = outcome.rows.first().map_or(f64::NAN, |row| row.energies[0]);
    let [a, b, c, d, e] = last.energies.map(|part| part / first);
    checks.push(most(
        "energy made by what is no law, of that at impact",
        -e,
        MADE,
        "artificial stress, booked",
    ));
    for (what, part) in [
        ("kinetic energy of the projectile", a),
        ("kinetic energy of plug and plate", b),
        ("internal energy", c),
        ("friction", d),
        ("taken by contact, stabilisation and renewals", e),
    ] {
        checks.push(shown(what, part, "-", "of the kinetic energy at impact"));
    }
    checks
}
