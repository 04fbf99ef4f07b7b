//! Table of exact cases in the staggered scheme, with and without reflection, and in the semi-staggered one, in Markdown.
#![allow(missing_docs, reason = "modules of the tests")]
#![allow(dead_code, reason = "the tests use the rest")]

#[path = "../tests/flow/common.rs"]
mod common;
#[path = "../tests/flow/gates.rs"]
mod gates;

use gates::Scheme;
use impactite_scene::StepError;

const SCHEMES: [Scheme; 3] = [gates::staggered, gates::first_order, gates::semi_staggered];

/// Rows of a case: text of each measure, and the measures by a scheme.
type Case = (String, Vec<&'static str>, Box<dyn Fn(Scheme) -> Result<Vec<f64>, StepError>>);

fn cases() -> Vec<Case> {
    let mut list: Vec<Case> = Vec::new();
    for theta in [0.01, 0.5, 0.99] {
        list.push((
            format!("water at rest, 8 + {theta} cells"),
            vec!["error of the pressure over rho g H", "largest speed after 2 s over sqrt(g H)"],
            Box::new(move |s| Ok(gates::hydrostatic(s, theta)?.to_vec())),
        ));
    }
    for cells in [16, 32, 64] {
        list.push((
            format!("column at its release, a/H 1, {cells} cells"),
            vec!["error of the wall force over rho g H^2 / 2", "error of the mean acceleration over g"],
            Box::new(move |s| Ok(gates::column(s, cells)?.to_vec())),
        ));
    }
    for cells in [16, 32, 64] {
        list.push((
            format!("standing wave, {cells} cells"),
            vec!["error of the period", "error of the amplitude after 4 periods"],
            Box::new(move |s| {
                let [period, amplitude] = gates::standing_wave(s, cells, 4)?;
                Ok(vec![period, amplitude - 1.0])
            }),
        ));
    }
    for cells in [8.0, 16.0] {
        list.push((
            format!("elliptic drop at A0 t = 2, {cells} cells a radius"),
            vec!["error of the long axis", "error of the short axis", "error of the energy"],
            Box::new(move |s| Ok(gates::elliptic_drop(s, cells)?[3].to_vec())),
        ));
    }
    for cells in [16, 32] {
        list.push((
            format!("Taylor-Green, Re 100, {cells} cells"),
            vec!["error of the amplitude"],
            Box::new(move |s| Ok(vec![gates::taylor_green(s, cells)?])),
        ));
    }
    for (cells, longest) in [(8, 4e-4), (8, 2e-4), (16, 4e-4)] {
        list.push((
            format!("start of channel flow, {cells} cells, steps of {longest} H^2 / nu"),
            vec!["largest error over the final speed"],
            Box::new(move |s| {
                let found = gates::poiseuille(s, cells, 0.1, longest)?;
                Ok(vec![found.iter().map(|[u, exact]| (u - exact).abs()).fold(0.0, f64::max)])
            }),
        ));
    }
    for cells in [8.0, 16.0] {
        list.push((
            format!("drop at rest, {cells} cells a radius"),
            vec!["error of the pressure in the first step", "after 10 ms", "largest speed, m/s"],
            Box::new(move |s| Ok(gates::drop_at_rest(s, cells, 0.01)?.to_vec())),
        ));
    }
    list.push((
        "sloshing of 20 s, 24 cells".into(),
        vec![
            "least volume less 1",
            "largest volume less 1",
            "largest divergence h/v",
            "energy not explained",
            "rise of the centroid",
        ],
        Box::new(|s| {
            let [least, most, divergence, energy, height] = gates::sloshing(s, 24, 20.0)?;
            Ok(vec![least - 1.0, most - 1.0, divergence, energy, height - 1.0])
        }),
    ));
    list
}

/// Shares as percentages, where they are not too small for it.
fn shown(value: f64, measure: &str) -> String {
    match value {
        v if measure.contains("m/s") => format!("{v:.3}"),
        v if v.abs() < 5e-5 => format!("{v:.0e}"),
        v => format!("{:+.2} %", 100.0 * v),
    }
}

fn main() {
    println!("| case | measure | staggered | without reflection | semi-staggered |\n|---|---|---|---|---|");
    for (case, measures, run) in cases() {
        let columns: Vec<_> = SCHEMES.iter().map(|scheme| run(*scheme)).collect();
        for (n, measure) in measures.iter().enumerate() {
            let values: Vec<_> = columns
                .iter()
                .map(|column| match column {
                    Ok(values) => shown(values[n], measure),
                    Err(error) => format!("stopped: {error}"),
                })
                .collect();
            println!("| {} | {measure} | {} |", if n == 0 { &case } else { "" }, values.join(" | "));
        }
    }
}
