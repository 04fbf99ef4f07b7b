//! Checks of Taylor bars.

use examples::{Check, Totals};

use crate::scene::{END, Outcome, Parts, Setup, Space};
use crate::{SPEED, STANDARD};
use crate::{beside, points};

const LENGTH_TOLERANCE: f64 = 0.02;
const RADIUS_TOLERANCE: f64 = 0.05;
/// Tolerances of our finite elements: length, face.
const OF_ELEMENTS: [f64; 2] = [0.005, 0.02];
const MOMENTUM_TOLERANCE: f64 = 1e-11;
const ENERGY_TOLERANCE: f64 = 0.005;
/// Tolerance of the covered mass. Elements at the corner of the face that are stretched tenfold, or with angles below half a degree, become
/// cracks: a few of thousands, with the heat in them.
const COVER_TOLERANCE: f64 = 0.005;
const ADDED_TOLERANCE: f64 = 0.02;

/// Length and radius of the face by independent finite elements, m.
pub fn finite_elements(space: Space) -> [f64; 2] {
    match space {
        Space::Axisymmetric | Space::Quarter => [50.37e-3, 8.64e-3],
        Space::PlaneStrain => [52.79e-3, 15.67e-3],
    }
}

fn source(space: Space) -> &'static str {
    match space {
        Space::Axisymmetric | Space::Quarter => "axisymmetric finite elements [C]",
        Space::PlaneStrain => "plane-strain finite elements [C]",
    }
}

const LENGTH: &str = "length";
const FACE: &str = "radius of the face";

/// Check a size, mm; references exist for the speed of the paper only.
fn sized(name: String, value: f64, reference: f64, tolerance: f64, from: &str, speed: f64) -> Check {
    if speed == SPEED {
        Check::gate(name, value, "mm", reference, tolerance, from)
    } else {
        Check::unreferenced(name, value, "mm", "no reference at this speed")
    }
}

/// Check sizes, covered mass and energy of a bar. The original formulation and demonstrations of defects have the same tolerances; their
/// known failures are declared.
pub fn of(outcome: &Outcome) -> Vec<Check> {
    let Setup { name: run, space, parts, hardening, speed, .. } = outcome.setup;
    let name = |what: &str| format!("{run}: {what}");
    let [length, radius] = outcome.sizes.map(|x| 1e3 * x);
    let added = outcome.audit.energy_added() / outcome.start;
    let [l, r] = finite_elements(space).map(|x| 1e3 * x);
    let standard = hardening == STANDARD;
    let (l, from) =
        if standard { (l, source(space)) } else { (1e3 * ROD_MODEL, "rod model with B = 45 MPa [C]") };
    let (whole, free) = ("nothing uncovered, nothing covered twice", "conservation");
    let mut rows = vec![
        (Size::Length, sized(name(LENGTH), length, l, LENGTH_TOLERANCE, from, speed)),
        (
            Size::Radius,
            match standard {
                true => sized(name(FACE), radius, r, RADIUS_TOLERANCE, from, speed),
                false => Check::unreferenced(name(FACE), radius, "mm", "the rod model has none"),
            },
        ),
        (Size::Cover, {
            let name = name("mass of elements / at the start");
            Check::gate(name, outcome.covered, "-", 1.0, COVER_TOLERANCE, whole)
        }),
        (Size::Added, Check::gate(name("energy added by revisions"), added, "-", 0.0, ADDED_TOLERANCE, free)),
    ];
    for (size, row) in &mut rows {
        if let Some(reason) = known(&outcome.setup, *size) {
            *row = row.clone().known_miss(reason);
        }
    }
    let mut checks: Vec<Check> = rows.into_iter().map(|(_, row)| row).collect();
    if parts == Parts::Consistent && standard {
        let Totals { energy_error, momentum_error, .. } = outcome.totals;
        checks.push(Check::gate(name("energy error"), energy_error, "-", 0.0, ENERGY_TOLERANCE, free));
        checks.push(Check::gate(name("momentum error"), momentum_error, "-", 0.0, MOMENTUM_TOLERANCE, free));
    }
    if let Some(cause) = &outcome.broke {
        let end = Check::at_least(name("time reached"), 1e6 * outcome.time, "µs", 1e6 * END, "the end");
        checks.push(if parts == Parts::Printed { end.known_miss(&format!("broke: {cause}")) } else { end });
    }
    checks
}

/// Length of the rod model with the hardening of the paper, m.
const ROD_MODEL: f64 = 38.1e-3;

/// Measured quantity of a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Size {
    Length,
    Radius,
    Cover,
    Added,
}

/// Return the reason for a known failure of a check.
fn known(setup: &Setup, size: Size) -> Option<&'static str> {
    match (setup.parts, size) {
        (Parts::Locking, Size::Radius) => {
            Some("elements that keep their own volume lock, which this run is to show: 18 % too small")
        }
        (Parts::Printed, Size::Length) if setup.reach <= 1.0 => {
            Some("the method as printed: 2 to 30 % too short")
        }
        (Parts::Printed, Size::Radius) if setup.reach != 1.0 => Some(
            "the method as printed: 34 % too small with a reach of 2 h, about 90 % too large with 0.45 h",
        ),
        (Parts::Printed, Size::Cover) => {
            Some("the method as printed: matter uncovered and covered twice, 3 to 25 %")
        }
        (Parts::Printed, Size::Added) => {
            Some("the method as printed: revisions add 28 to 46 % of the energy at the start")
        }
        (Parts::Consistent, Size::Cover) if setup.hardening != STANDARD => {
            Some("five spacings on the radius of a face that spreads to three radii: 0.53 %")
        }
        _ => None,
    }
}

/// Return the largest known relative deficit of the face radius of a bar of fragile points: the measured value plus some hundredths. A
/// penalty `eta` below Young's modulus reduces it.
fn too_small(space: Space, cells: u32, eta: f64) -> Option<f64> {
    match (space, cells) {
        _ if eta > 1.0 => None,
        (Space::PlaneStrain, 20..25) => Some(0.08),
        (Space::PlaneStrain, 10..20) => Some(0.235),
        (Space::PlaneStrain, 5..10) => Some(0.345),
        (Space::PlaneStrain, 4) => Some(0.37),
        (Space::Quarter, 4..) => Some(0.195),
        _ => None,
    }
}

/// Check a bar by another method; `eta` is the penalty of fragile points over Young's modulus.
pub fn beside(outcome: &beside::Outcome, eta: f64) -> Vec<Check> {
    let (space, cells) = (outcome.bar.space, outcome.bar.cells);
    let [length, radius] = outcome.sizes.map(|x| 1e3 * x);
    let [l, r] = finite_elements(space).map(|x| 1e3 * x);
    let [within, of_face] = match outcome.hourglass {
        Some(_) => OF_ELEMENTS,
        None => [LENGTH_TOLERANCE, RADIUS_TOLERANCE],
    };
    let fragile = outcome.method == points::NAME;
    let name = |what: &str| format!("{}: {what}", outcome.name());
    let size = |what, value, reference, tolerance| {
        sized(name(what), value, reference, tolerance, source(space), outcome.bar.speed)
    };
    let length = size(LENGTH, length, l, within);
    let mut face = size(FACE, radius, r, of_face);
    if outcome.hourglass.is_none() && !fragile && space == Space::PlaneStrain && cells >= 10 {
        face = face.known_miss(
            "5.4 % too wide with 10 cells on the radius, 1.9 % with 4: finer grids do not come nearer",
        );
    }
    let fine = space == Space::PlaneStrain && cells >= 25 && eta <= 1.0;
    if fragile && !fine {
        face = face.known_miss(YIELDS);
    }
    let mut rows = vec![length, face];
    if let Some(most) = too_small(space, cells, eta).filter(|_| fragile && outcome.bar.speed == SPEED) {
        let what = name("part by which the face is too small");
        rows.push(Check::at_most(what, 1.0 - radius / r, "-", most, "as measured: 35 to 7 %"));
    }
    let free = "conservation";
    if let Some(share) = outcome.hourglass {
        let limit = "5 % of the internal energy";
        rows.push(Check::at_most(
            name("energy of hourglass forces / internal"),
            share,
            "-",
            HOURGLASS,
            limit,
        ));
    }
    if fragile || outcome.hourglass.is_some() {
        let Totals { energy_error, momentum_error, .. } = outcome.totals;
        rows.extend([
            Check::gate(name("energy error"), energy_error, "-", 0.0, ENERGY_TOLERANCE, free),
            Check::gate(name("momentum error"), momentum_error, "-", 0.0, MOMENTUM_TOLERANCE, free),
        ]);
    }
    if let Some((time, cause)) = &outcome.broke {
        let reason = format!("the end; broke: {cause}");
        rows.push(Check::at_least(name("time reached"), 1e6 * time, "µs", 1e6 * END, &reason));
    }
    rows
}

/// Reason for the small face of bars of fragile points.
const YIELDS: &str = "the penalty is by Young's modulus and does not yield as copper does: in plane strain 35 % with 4 cells on the radius, 22 % \
                      with 10, 7 % with 20 (4.9 % with 25); with a penalty of 5 E 27 % with 10, of 0.1 E 11 % with 10 and 4 % with 20";

/// Limit of the hourglass energy over the internal energy.
const HOURGLASS: f64 = 0.05;
