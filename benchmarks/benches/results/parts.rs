//! Solids whose parts are chosen at run time, against the same solids of types.

use std::sync::Arc;
use std::time::Instant;

use examples::CaseError;
use impactite_simd::Float;
use mpm_materials::material::{Deformation, Length, Motion, Response, StatesMut};
use mpm_materials::{
    Constitutive, IntoMaterial, JohnsonCookDamage, Material, PlasticStrainLimit, Removed, library,
};

use crate::page::table;

type Law = Arc<dyn Material<f64>>;
type Row = <f64 as Float>::Row;

/// Number of groups in a call, as of a block of particles, and of calls in a round.
const GROUPS: usize = 16;
const CALLS: usize = 256;

/// Return the time of one update at velocity gradients of this size, 1/s: the shortest of some rounds, ns.
fn time(law: &Law, gradient: f64, rounds: usize) -> f64 {
    let (numbers, lanes) = (law.numbers(), Row::default().as_ref().len());
    let spread = |x: f64| {
        let mut row = Row::default();
        row.as_mut().fill(x);
        row
    };
    let mut rows: Vec<Row> = (0..GROUPS * CALLS).flat_map(|_| law.virgin()).map(spread).collect();
    let mut deformation: Vec<Deformation<Row>> = vec![Deformation::default(); GROUPS / 2];
    let mut seed = 1_u64;
    for group in 0..GROUPS {
        for lane in 0..lanes {
            for component in 0..9 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let random = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
                deformation[group / 2].gradient[component].0[group % 2].as_mut()[lane] = gradient * random;
            }
            deformation[group / 2].step.0[group % 2].as_mut()[lane] = 1e-8;
        }
    }
    let (mut response, mut shortest) = (Response::default(), f64::INFINITY);
    for _ in 0..rounds {
        let start = Instant::now();
        for call in 0..CALLS {
            let groups: [u32; GROUPS] = std::array::from_fn(|n| (n + call * GROUPS) as u32);
            let motion = Motion { deformation: &deformation, dt: 1e-8, length: Length::Same(1e-3) };
            let states = StatesMut { all: &mut rows, stride: numbers, first: 0, groups: &groups };
            law.advance(&motion, states, true, &mut response);
        }
        shortest = shortest.min(start.elapsed().as_secs_f64());
    }
    1e9 * shortest / (GROUPS * CALLS * lanes) as f64
}

/// Measure the cost of parts that are chosen at run time.
pub fn cost(quick: bool) -> Result<Option<String>, CaseError> {
    let limit = PlasticStrainLimit::new(3.0)?;
    let removed = library::aluminium_6061_t6().with_failure(Removed(limit));
    let damaged = library::steel_4340().with_failure(JohnsonCookDamage::steel_4340());
    macro_rules! pair {
        ($name:literal, $law:expr) => {
            ($name, $law.into_material(), $law.compiled().into_material())
        };
    }
    let laws: [(&str, Law, Law); 8] = [
        pair!("Johnson-Cook, Mie-Grueneisen (`copper_taylor`)", library::copper_taylor()),
        pair!("the same with rate and heat (`copper_ofhc`)", library::copper_ofhc()),
        pair!("the same, removed at a plastic strain", removed),
        pair!("the same with Johnson-Cook damage", damaged),
        pair!("linear hardening, logarithmic pressure (`arne_tool_steel`)", library::arne_tool_steel()),
        pair!("Steinberg-Guinan (`copper_steinberg`)", library::copper_steinberg()),
        pair!("viscoplasticity with damage (`weldox_460_e`)", library::weldox_460_e()),
        pair!("the same, uncoupled (`weldox_460_e_uncoupled`)", library::weldox_460_e_uncoupled()),
    ];
    let rounds = if quick { 4 } else { 40 };
    let mut rows = Vec::new();
    for (name, values, types) in &laws {
        for (motion, gradient) in [("elastic", 1e2), ("plastic", 1e5)] {
            let (values, types) = (time(values, gradient, rounds), time(types, gradient, rounds));
            let ratio = values / types;
            rows.push([
                (*name).into(),
                motion.into(),
                format!("{types:.1}"),
                format!("{values:.1}"),
                format!("{ratio:.2}"),
            ]);
        }
    }
    let title = ["solid", "motion", "of types, ns", "of values, ns", "ratio"];
    Ok(Some(format!(
        "## Laws of run-time parts\n\nNanoseconds of an update of a point by the called law, {GROUPS} groups a call, all in the cache of the processor: a `Solid` of types, \
         compiled for this table, and the same one by the kernels of values (`AnySolid`), which scene files have. The first four have kernels of their own.\n\n{}",
        table(title, &rows)
    )))
}
