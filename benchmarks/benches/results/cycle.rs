//! Time shares of a smoothed particle step for several neighbour searches.

use std::path::Path;

use benchmarks::bar;
use examples::CaseError;
use examples::plug::Plug;
use examples::throughput::Spread;
use mpm_core::geometry::search::SearchMethod;
use mpm_core::output::picture::{Axis, Bars, Panels};
use mpm_core::{Axisymmetric, Solver};
use mpm_materials::library;
use sph::{Composition, Method, Sph, StepTimes};

use crate::page::{asked, table};

/// Parts of a step, as in the chart.
const PARTS: [&str; 5] = ["search", "kernels", "sums", "law", "motion"];

/// Neighbour search methods: search in every step, or sorted cells with reused lists.
const WAYS: [(&str, SearchMethod, bool); 5] = [
    ("tree", SearchMethod::BoxTree, true),
    ("PIB", SearchMethod::PointInBox, true),
    ("strip PIB", SearchMethod::StripPointInBox, true),
    ("cells", SearchMethod::SortedCells, true),
    ("cells, lists reused", SearchMethod::SortedCells, false),
];

/// Required share of the search with reused lists: for the bar and for the plate.
const ASKED: [f64; 2] = [0.15, 0.20];
/// Published share of strip PIB \[Xiao2015\].
const PRINTED: [f64; 2] = [0.41, 0.32];

/// Impact speed of the projectile, m/s.
const SPEED: f64 = 173.7;

/// Time shares of a scene with one search method.
struct Shares {
    /// Shares of the parts of a step.
    parts: [f64; 5],
    /// Spread of the search share over the rounds.
    search: Spread,
    /// Time of a step per particle, ns.
    each: f64,
    /// Number of steps per search.
    between: f64,
}

fn parts(times: &StepTimes) -> [f64; 5] {
    [times.search, times.kernels, times.sums, times.law, times.motion]
}

/// Advance a body by this number of steps, or to a time (s); return times, particle updates, and steps per search.
fn run<M: Composition<2>>(
    mut body: Sph<2, M>,
    (method, anew): (SearchMethod, bool),
    (steps, end): (u64, f64),
) -> Result<(StepTimes, f64, f64), CaseError> {
    if anew {
        body.set_search(method, 0.0)?;
    }
    body.step_at_most(f64::INFINITY)?;
    body.measure_steps();
    let (searches, from) = (body.searches(), body.steps());
    while body.steps() < steps && body.time() < end {
        body.step_at_most(f64::INFINITY)?;
    }
    let made = (body.steps() - from) as f64;
    let updates = made * body.positions().len() as f64;
    let between = made / (body.searches() - searches).max(1) as f64;
    Ok((body.step_times(), updates, between))
}

/// Run all search methods on a newly created scene each, in alternating rounds.
fn shares<M: Composition<2>>(
    body: impl Fn() -> Result<Sph<2, M>, CaseError>,
    span: (u64, f64),
    rounds: usize,
) -> Result<Vec<Shares>, CaseError> {
    let mut found: Vec<Vec<(StepTimes, f64, f64)>> = vec![Vec::new(); WAYS.len()];
    for _ in 0..rounds {
        for ((_, method, anew), runs) in WAYS.into_iter().zip(&mut found) {
            runs.push(run(body()?, (method, anew), span)?);
        }
    }
    let shares = |runs: &Vec<(StepTimes, f64, f64)>| {
        let of = |n: usize| Spread::of(runs.iter().map(|(t, ..)| parts(t)[n] / t.total()));
        let each = Spread::of(runs.iter().map(|(t, updates, _)| 1e9 * t.total() / updates));
        let parts = std::array::from_fn(|n| of(n).median);
        Shares { parts, search: of(0), each: each.median, between: runs[0].2 }
    };
    Ok(found.iter().map(shares).collect())
}

/// Build projectile and plate as one body of the plate's steel, with a moving projectile.
fn plug<M: Composition<2>>(method: M) -> Result<Sph<2, M>, CaseError> {
    let layout = Plug::PRINTED.projectile()?.and(Plug::PRINTED.plate()?);
    let steel = library::weldox_460_e().with_bulk_viscosity(0.5, 4.0)?;
    Ok(Sph::new(method, steel, &layout, |[_, z]| [0.0, if z < 0.0 { SPEED } else { 0.0 }])?)
}

/// Measure the time shares of a step, and draw their chart.
pub fn shares_of_steps(quick: bool, chart: &Path) -> Result<Option<String>, CaseError> {
    let rounds = if quick { 1 } else { 2 };
    // Complete impact of the bar; for the plug, enough steps to include some searches.
    let whole = if quick { (300, bar::END) } else { (u64::MAX, bar::END) };
    let some = (if quick { 40 } else { 60 }, f64::INFINITY);
    let (printed, updated) = (Method::printed(Axisymmetric), Method::updated(Axisymmetric));
    let scenes = [
        ("bar, as printed", 0, shares(|| bar::half(printed, bar::PRINTED), whole, rounds)?),
        ("bar, updated", 0, shares(|| bar::half(updated, bar::PRINTED), whole, rounds)?),
        ("plug, as printed", 1, shares(|| plug(printed), some, rounds)?),
        ("plug, updated", 1, shares(|| plug(updated), some, rounds)?),
    ];
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let (mut rows, mut panels) = (Vec::new(), Panels::new(2));
    for (name, kind, ways) in &scenes {
        let axis = Axis::new("share of a step").unit("%", 100.0).range(0.0, 1.0);
        let mut bars = Bars::new(620, 330, PARTS).x(axis);
        for ((way, _, anew), found) in WAYS.iter().zip(ways) {
            bars = bars.bar(*way, &found.parts);
            let search = found.search;
            let mut row = vec![name.to_string(), way.to_string()];
            row.push(format!(
                "{:.0} [{:.0} - {:.0}] %",
                100.0 * search.median,
                100.0 * search.least,
                100.0 * search.most
            ));
            row.extend(found.parts[1..].iter().map(|share| percent(*share)));
            row.push(format!("{:.0}", found.each));
            row.push(format!("{:.1}", found.between));
            row.push(match (*anew, *way) {
                (false, _) => asked(percent(ASKED[*kind]), search.median < ASKED[*kind]),
                (true, "strip PIB") => format!("the paper has {}", percent(PRINTED[*kind])),
                _ => "-".into(),
            });
            rows.push(row);
        }
        panels = panels.panel(*name, bars.draw()?);
    }
    panels.compose()?.save(chart)?;
    let mut head = vec!["scene", "neighbours by"];
    head.extend(PARTS);
    head.extend(["ns a particle", "steps a search", "asked"]);
    Ok(Some(format!(
        "## The step of smoothed particles\n\nShares of a step around the axis, one thread, medians of the rounds ({rounds}): the Taylor bar of \
         20 x 200 from its start to {}, and the plug case of {} particles (104 047 are printed), projectile and plate as one body of Weldox 460 E, over {} \
         steps from the impact. Neighbours are searched anew in every step, or by cells with a skin, lists being used again until \
         something moved half of it (the default).\n\n{}",
        if quick { "300 steps".to_string() } else { format!("{:.0} µs", 1e6 * bar::END) },
        plug(printed)?.positions().len(),
        some.0,
        table(head, &rows)
    )))
}
