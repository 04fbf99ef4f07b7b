//! Checks of Taylor bars.

use examples::{Check, largest, worst};

use crate::scene::{Form, Outcome, ROOM, Setup};

/// Finite element reference, in mm and K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Impact speed, m/s.
    pub speed: f64,
    /// Length and face diameter: means of two axisymmetric codes (at 224 m/s of one).
    pub length: f64,
    pub face: f64,
    /// Results of one code with 12 elements per radius: diameter at a fifth of the initial length, largest temperature rise.
    pub waist: f64,
    pub rise: f64,
}

/// References at the speeds of the paper. Lengths are accurate to 0.1 %, faces to 1 %.
pub const REFERENCES: [Reference; 3] = [
    Reference { speed: 181.0, length: 34.575, face: 10.016, waist: 8.32, rise: 220.0 },
    Reference { speed: 224.0, length: 32.98, face: 11.32, waist: 8.57, rise: 344.0 },
    Reference { speed: 270.0, length: 31.185, face: 12.83, waist: 8.77, rise: 503.0 },
];

const CODES: &str = "two axisymmetric finite element codes [C]";
const CODE: &str = "axisymmetric finite elements [C]";
const UNKNOWN: &str = "no reference at this speed";
const VISCOUS: &str = "the viscosity of pairs is proportional to the spacing";
const DAMAGED: &str = "they fail with `--failing`; the references know no failure";
pub const COARSE: &str = "fewer than the printed 20 particles over the radius";
/// Particles per radius in the paper.
pub const CELLS: u32 = 20;

/// Tolerances of the original formulation, mm: errors of the paper against experiment in length and face.
const PRINTED: [f64; 2] = [0.8, 0.3];
/// Relative tolerances of the updated and total Lagrangian forms: length, face.
const OURS: [f64; 2] = [0.01, 0.03];
/// Tolerance of the temperature rise; the accuracy of the reference is unknown.
const RISE: f64 = 0.1;
/// Limit of the energy of the zero-energy penalty over the internal energy: usual limit of hourglass energy.
const SPRINGS: f64 = 0.05;
/// Tolerance of the energy removed or added by stabilisation, over that at impact.
const STABILISED: f64 = 0.02;
const MOMENTUM: f64 = 1e-11;
const MASS: f64 = 1e-12;

/// Return the reference at a speed.
pub fn reference(speed: f64) -> Option<Reference> {
    REFERENCES.into_iter().find(|r| r.speed == speed)
}

/// Return the tolerances of length and face.
fn sizes(setup: &Setup, reference: &Reference) -> [f64; 2] {
    match setup.form {
        Form::Printed => [PRINTED[0] / reference.length, PRINTED[1] / reference.face],
        Form::Updated | Form::Total => OURS,
    }
}

/// Return the tolerance of the energy: velocity gradients of the laws exclude the mirror images of a wall, which forces include.
fn energy(form: Form) -> f64 {
    match form {
        Form::Printed | Form::Updated => 0.02,
        Form::Total => 1e-3,
    }
}

/// Check sizes, temperature and energy of a run.
pub fn of(outcome: &Outcome) -> Vec<Check> {
    let Outcome { setup, sizes: found, peaks, totals, .. } = outcome;
    let known = reference(setup.speed);
    let fine = setup.cells >= CELLS;
    let name = |what: &str| format!("{}: {what}", setup.words());
    let size = |what: &str, value: f64, reference: Option<(f64, f64)>, source: &str| match reference {
        Some((reference, tolerance)) => {
            Check::gate(name(what), 1e3 * value, "mm", reference, tolerance, source)
        }
        None => Check::unreferenced(name(what), 1e3 * value, "mm", UNKNOWN),
    };
    let [length, face] = known.map_or([0.0; 2], |r| sizes(setup, &r));
    let what = "largest rise of temperature";
    let mut rise = Check::unreferenced(name(what), peaks.temperature - ROOM, "K", UNKNOWN);
    if let Some(r) = known {
        rise = Check::gate(name(what), peaks.temperature - ROOM, "K", r.rise, RISE, CODE);
    }
    if let Some(reason) = known_rise(setup) {
        rise = rise.known_miss(reason);
    }
    let free = "conservation";
    let mut face = size("diameter of the face", found.face, known.map(|r| (r.face, face)), CODES);
    if let Some(reason) = known_face(setup) {
        face = face.known_miss(reason);
    }
    let mut rows = vec![
        size("length", found.length, known.map(|r| (r.length, length)), CODES)
            .judged_if(fine || setup.form != Form::Updated, VISCOUS),
        face.judged_if(fine, COARSE),
        size("diameter at 0.2 L0", found.waist, known.map(|r| (r.waist, OURS[1])), CODE)
            .judged_if(fine, COARSE),
        rise.judged_if(fine, COARSE),
    ];
    let error = Check::gate(name("energy error"), totals.energy_error, "-", 0.0, energy(setup.form), free);
    if setup.form == Form::Total {
        let usual = "5 % of the internal energy";
        rows.push(error);
        rows.push(Check::at_most(
            name("energy of the penalty / internal"),
            outcome.springs,
            "-",
            SPRINGS,
            usual,
        ));
        return rows;
    }
    let mut taken = Check::gate(
        name("energy taken by stabilisation / at impact"),
        outcome.impacts,
        "-",
        0.0,
        STABILISED,
        free,
    );
    if let Some(reason) = known_taken(setup) {
        taken = taken.known_miss(reason);
    }
    rows.extend([error, taken].map(|row| row.judged_if(fine, COARSE)));
    rows
}

/// Return the reason for a known failure of the temperature check.
fn known_rise(setup: &Setup) -> Option<&'static str> {
    let hot = "single particles at the face, which flow about each other, are hotter than those around them";
    let single = "as at 181 m/s: the hottest particle is 89 K above its neighbours, the next ones are 9 % too hot, the hottest thousandth \
        2 %; 9, 14, 12, 10 % with 14, 20, 28, 40 over the radius";
    let edge = "12 and 18 % too hot at 224 and 270 m/s, with 10, 20 and 40 over the radius alike; that of the elements is of 12";
    match setup.form {
        Form::Total if setup.speed > 200.0 => Some(edge),
        Form::Printed | Form::Updated if setup.speed == 181.0 => Some(hot),
        Form::Printed if setup.speed == 270.0 => Some(single),
        _ => None,
    }
}

/// Return the reason for a known failure of the face check.
fn known_face(setup: &Setup) -> Option<&'static str> {
    let wide = "0.41 mm too wide, 0.3 mm asked: 0.29 mm while artificial stress followed the stress at once, which added energy";
    (setup.form == Form::Printed && setup.speed == 270.0).then_some(wide)
}

/// Return the reason for a known failure of the stabilisation check.
fn known_taken(setup: &Setup) -> Option<&'static str> {
    match setup.form {
        Form::Updated => Some("the viscosity of pairs takes 3.6 to 5 %, which is booked and does not heat"),
        _ => None,
    }
}

/// Check conservation in all runs.
pub fn of_books(runs: &[&Outcome]) -> Vec<Check> {
    let momentum = largest(runs.iter().map(|o| o.totals.momentum_error));
    let mass = 1.0 + worst(runs.iter().map(|o| o.mass - 1.0));
    let damaged = runs.iter().map(|o| o.peaks.damaged).sum::<usize>() as f64;
    vec![
        Check::gate("momentum error along the axis, worst run", momentum, "-", 0.0, MOMENTUM, "conservation"),
        Check::gate("mass / that of the bar, worst run", mass, "-", 1.0, MASS, "conservation"),
        Check::unreferenced("particles with a Johnson-Cook damage of one, all runs", damaged, "-", DAMAGED),
    ]
}
