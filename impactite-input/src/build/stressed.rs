//! Initial states of a law for a given initial stress.

use std::collections::HashMap;

use impactite::materials::material::{Deformation, Length, Material, Motion, Response, StatesMut};
use impactite::parallel::{Float, RowPair};
use nalgebra::{Matrix6, Vector6};

use super::common::World;
use super::wrong::{At, Made, wrong};
use crate::formula::Formula;
use crate::model::Space;
use crate::model::body::InitialStress;
use crate::quantity::Pressure;

/// Duration of straining, s: quasi-static for all rate-dependent laws.
const SLOW: f64 = 1e6;
/// Finite-difference step of the stiffness over the largest strain, small since stiffness changes near yield; and its lower bound.
const PROBE: f64 = 1e-4;
const LEAST: f64 = 1e-8;
/// Initial volumetric strain along each axis, with the sign of the mean stress: cohesionless soil has no stiffness at zero pressure.
const START: f64 = 1e-4;
/// Largest strain change in a Newton iteration.
const STRIDE: f64 = 0.05;
/// Maximum number of Newton iterations.
const STEPS: usize = 40;
/// Tolerance of the stress over its largest component.
const EXACT: f64 = 1e-9;

/// State vector as a function of position, m.
type States<'a, const D: usize> = Box<dyn Fn([f64; D]) -> Vec<f64> + 'a>;

/// Return the initial states of a body with initial stress, for positions in m.
pub(super) fn states<'a, const D: usize>(
    world: &World<'_, D>,
    key: &str,
    spec: &InitialStress,
    material: &'a dyn Material<f64>,
    positions: &[[f64; D]],
) -> Made<States<'a, D>> {
    let formulas = components(world.space(), key, spec)?;
    for (formula, name) in formulas.iter().zip(names(world.space())) {
        let Some(formula) = formula else { continue };
        formula.check(world.space().coordinates(), true, false).at(format!("{key}.{name}"))?;
    }
    let revolved = world.revolved();
    let stress = move |x: &[f64; D]| -> [f64; 6] {
        std::array::from_fn(|n| formulas[n].as_ref().map_or(0.0, |formula| formula.at(x, revolved, 0.0)))
    };
    let place = |x: &[f64; D]| x.map(f64::to_bits);
    let mut known = HashMap::with_capacity(positions.len());
    for x in positions {
        match state(material, &stress(x)) {
            Ok(numbers) => known.insert(place(x), numbers),
            Err(why) => return wrong(key, format!("at {x:?} m: {why}")),
        };
    }
    let virgin = material.virgin();
    let new = move |x: &[f64; D]| state(material, &stress(x)).unwrap_or_else(|_| virgin.clone());
    Ok(Box::new(move |x| known.get(&place(&x)).cloned().unwrap_or_else(|| new(&x))))
}

/// Return the component names in the order xx, yy, zz, yz, xz, xy of the axes; in axisymmetric scenes the third is the hoop direction, t.
fn names(space: Space) -> [&'static str; 6] {
    match space {
        Space::Axisymmetric => ["rr", "zz", "tt", "", "", "rz"],
        Space::Full => ["xx", "yy", "zz", "yz", "xz", "xy"],
        Space::PlaneStrain | Space::PlaneStress => ["xx", "yy", "zz", "", "", "xy"],
    }
}

/// Return the stress components in the order of [`names`].
fn components(space: Space, key: &str, spec: &InitialStress) -> Made<[Option<Formula<Pressure>>; 6]> {
    let InitialStress { xx, yy, zz, yz, xz, xy, rr, tt, rz, .. } = spec;
    let mut given: Vec<(&str, Formula<Pressure>)> = [
        ("xx", xx),
        ("yy", yy),
        ("zz", zz),
        ("yz", yz),
        ("xz", xz),
        ("xy", xy),
        ("rr", rr),
        ("tt", tt),
        ("rz", rz),
    ]
    .into_iter()
    .filter_map(|(name, formula)| Some((name, formula.clone()?)))
    .collect();
    let mut take = |wanted: &str| {
        let place = given.iter().position(|(name, _)| *name == wanted)?;
        Some(given.swap_remove(place).1)
    };
    let list = names(space);
    let found = list.map(|name| if name.is_empty() { None } else { take(name) });
    match given.first() {
        None => Ok(found),
        Some((name, _)) => {
            let there: Vec<&str> = list.into_iter().filter(|name| !name.is_empty()).collect();
            wrong(format!("{key}.{name}"), format!("is no component here; there are {}", there.join(", ")))
        }
    }
}

/// Find the state of a virgin point strained to this stress (xx, yy, zz, yz, xz, xy, Pa) by Newton's method.
///
/// # Errors
/// No convergence: the stress exceeds the strength of the law, or the law has no stiffness against it.
pub(super) fn state(material: &dyn Material<f64>, stress: &[f64; 6]) -> Result<Vec<f64>, String> {
    let wanted = Vector6::from_column_slice(stress);
    if !wanted.iter().all(|s| s.is_finite()) {
        return Err(format!("{stress:?} Pa is not finite"));
    }
    if wanted == Vector6::zeros() {
        return Ok(material.virgin());
    }
    let mean = stress[0] + stress[1] + stress[2];
    let start = if mean == 0.0 { 0.0 } else { START.copysign(mean) };
    let mut strain = Vector6::new(start, start, start, 0.0, 0.0, 0.0);
    let mut missed = f64::INFINITY;
    for _ in 0..STEPS {
        let (state, found) = strained(material, &strain)?;
        let rest = wanted - found;
        missed = rest.amax();
        if missed <= EXACT * wanted.amax() {
            return Ok(state);
        }
        let mut stiffness = Matrix6::zeros();
        let size = PROBE * strain.amax().max(LEAST);
        for n in 0..6 {
            let mut probe = strain;
            probe[n] += size;
            let (_, more) = strained(material, &probe)?;
            stiffness.set_column(n, &((more - found) / size));
        }
        // Fluids have no shear stiffness: the pseudo-inverse leaves strains without effect at zero.
        let least = 1e-9 * stiffness.amax();
        let change = stiffness.svd(true, true).solve(&rest, least)?;
        let largest = change.amax();
        strain += if largest > STRIDE { change * (STRIDE / largest) } else { change };
    }
    Err(format!(
        "no strain of the material gives the stress {stress:?} Pa (xx, yy, zz, yz, xz, xy): {missed:.3e} Pa are missed; it may be beyond its strength"
    ))
}

/// Strain a virgin point slowly (tensor components xx, yy, zz, yz, xz, xy); return its state and stress.
fn strained(material: &dyn Material<f64>, strain: &Vector6<f64>) -> Result<(Vec<f64>, Vector6<f64>), String> {
    let row = |x: f64| {
        let mut row = <f64 as Float>::Row::default();
        row.as_mut().fill(x);
        row
    };
    let mut rows: Vec<_> = material.virgin().into_iter().map(row).collect();
    let pair = |x: f64| RowPair([row(x), row(x)]);
    let component = |i: usize, j: usize| strain[if i == j { i } else { 6 - i - j }];
    let gradient = std::array::from_fn(|n| pair(component(n / 3, n % 3) / SLOW));
    let deformation = [Deformation { gradient, step: pair(SLOW) }];
    let motion = Motion { deformation: &deformation, dt: SLOW, length: Length::Same(1.0) };
    let mut response = Response::default();
    let states = StatesMut { all: &mut rows, stride: material.numbers(), first: 0, groups: &[0] };
    material.advance(&motion, states, false, &mut response);
    if let Some(fault) = response.faults().iter().find(|fault| fault.lane == 0) {
        return Err(format!("the law breaks down on the way to it: {}", fault.cause));
    }
    let output = response.outputs().first().ok_or("the law says nothing")?;
    let stress = Vector6::from_fn(|n, _| output.stress[n].0[0].as_ref()[0]);
    Ok((rows.iter().map(|row| row.as_ref()[0]).collect(), stress))
}
