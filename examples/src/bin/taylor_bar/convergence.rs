//! Sizes over spacings.

use std::path::Path;

use examples::{CaseError, Restart, case};
use mpm_core::output::History;
use mpm_core::output::picture::{Axis, Chart, Marker, Panels, Series, Stroke};

use crate::scene::{self, Constants, Model, Outcome, Scheme, Setup};
use crate::shape::Sizes;
use crate::{Options, WhichModel, finite_elements};

const SCHEMES: [(Scheme, &str, Marker); 3] = [
    (Scheme::LinearMusl, "linear MUSL-FLIP", Marker::Circle),
    (Scheme::GimpUsl, "GIMP USL-FLIP", Marker::Square),
    (Scheme::QuadraticApic, "quadratic USL-APIC", Marker::Triangle),
];

/// Sizes: name and accessor.
type Read = fn(&Sizes) -> f64;
const SIZES: [(&str, Read); 3] =
    [("length", |s| s.length), ("foot diameter", |s| s.foot), ("diameter at 0.2 L0", |s| s.waist)];

/// Run all methods at all spacings; print, write and draw the sizes.
pub fn study(
    options: &Options,
    constants: Constants,
    folder: &Path,
    restart: &Restart,
) -> Result<(), CaseError> {
    let space = options.model == WhichModel::Quarter;
    let model = if space { Model::Quarter } else { Model::Axisymmetric };
    let all: &[u32] = options.common.resolution.choose(&[3, 5, 8], &[5, 10, 20], &[5, 10, 20, 40]);
    let mut outcomes = Vec::new();
    for (scheme, _, _) in SCHEMES {
        for &cells in all {
            let setup = Setup { model, constants, scheme, cells, threads: options.common.threads() };
            let label = format!("convergence_{}_{}_{cells}", setup.name(), scheme.name());
            outcomes.push(scene::impact(&setup, None, restart.scene(label)?)?);
        }
    }
    println!("\nConvergence, {} model, {} constants\n\n{}", model.name(), constants.name(), table(&outcomes));
    let name = format!("convergence_{}", constants.name());
    write(&outcomes, &folder.join(format!("{name}.csv")))?;
    draw(&outcomes, constants)?.save(folder.join(format!("{name}.png")))?;
    Ok(())
}

fn table(outcomes: &[Outcome]) -> String {
    let head = ["method", "cell mm", "length mm", "foot mm", "0.2 L0 mm", "energy error", "particles", "s"];
    let mut rows = vec![head.map(String::from)];
    for o in outcomes {
        let mm = |x: f64| format!("{:.3}", 1e3 * x);
        rows.push([
            o.setup.scheme.name(),
            mm(o.setup.spacing()),
            mm(o.sizes.length),
            mm(o.sizes.foot),
            mm(o.sizes.waist),
            format!("{:+.2} %", 100.0 * o.totals.energy_error),
            o.totals.particles.to_string(),
            format!("{:.2}", o.totals.wall_seconds),
        ]);
    }
    if let Some(first) = outcomes.first() {
        let fe = finite_elements(first.setup.constants);
        let [a, b, c] = [fe.length, fe.foot, fe.waist].map(|x| format!("{:.3}", 1e3 * x));
        rows.push(["finite elements [C]".into(), "".into(), a, b, c, "".into(), "".into(), "".into()]);
    }
    case::columns(&rows)
}

fn write(outcomes: &[Outcome], path: &Path) -> Result<(), CaseError> {
    let columns = [
        ("method (1 linear-musl, 2 gimp-usl, 3 quadratic-apic)", "-"),
        ("cell size", "m"),
        ("length", "m"),
        ("foot diameter", "m"),
        ("diameter at 0.2 L0", "m"),
        ("energy error", "-"),
        ("momentum error", "-"),
        ("particles", "-"),
        ("steps", "-"),
        ("time in steps", "s"),
    ];
    let mut file = History::create(path, columns)?;
    for o in outcomes {
        let method = 1 + SCHEMES.iter().take_while(|s| s.0 != o.setup.scheme).count();
        file.push(&[
            method as f64,
            o.setup.spacing(),
            o.sizes.length,
            o.sizes.foot,
            o.sizes.waist,
            o.totals.energy_error,
            o.totals.momentum_error,
            o.totals.particles as f64,
            o.totals.steps as f64,
            o.totals.wall_seconds,
        ])?;
    }
    Ok(())
}

/// Draw each size over the cell size, with the value of finite elements.
fn draw(outcomes: &[Outcome], constants: Constants) -> Result<mpm_core::output::picture::Picture, CaseError> {
    let fe = finite_elements(constants);
    let mut panels = Panels::new(3).title(format!("Taylor bar, {} constants", constants.name()));
    for (name, read) in SIZES {
        let mut chart =
            Chart::new(640, 560).x(Axis::new("cell size").unit("mm", 1e3)).y(Axis::new(name).unit("mm", 1e3));
        let widest = outcomes.iter().map(|o| o.setup.spacing()).fold(0.0, f64::max);
        let line = Series::new("finite elements", &[0.0, widest], &[read(&fe); 2])?;
        chart = chart.series(line.stroke(Stroke::Dashed).colour([60; 3]));
        for (scheme, label, marker) in SCHEMES {
            let of: Vec<&Outcome> = outcomes.iter().filter(|o| o.setup.scheme == scheme).collect();
            let h: Vec<f64> = of.iter().map(|o| o.setup.spacing()).collect();
            let y: Vec<f64> = of.iter().map(|o| read(&o.sizes)).collect();
            chart = chart.series(Series::new(label, &h, &y)?.marker(marker));
        }
        panels = panels.panel("", chart.draw()?);
    }
    Ok(panels.compose()?)
}
