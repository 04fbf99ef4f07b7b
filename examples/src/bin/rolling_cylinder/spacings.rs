//! Distance and spin over the cell size, by contact detection.

use std::path::Path;

use examples::{CaseError, Check, Detection, Restart, case};
use mpm_core::output::History;

use crate::scene::{self, Outcome};
use crate::{Options, errors, figures, gap};

/// Repeat the runs with the other detections and at three spacings. Print and write a table, draw a picture, and return one check per
/// coefficient of friction.
pub fn compare(
    options: &Options,
    mains: &[Outcome],
    folder: &Path,
    restart: &Restart,
) -> Result<Vec<Check>, CaseError> {
    let few = &[Detection::Local, Detection::Approach][..];
    let all = &[Detection::Local, Detection::Distance, Detection::Approach];
    let detections = options.common.resolution.choose(few, all, all);
    let mut outcomes = Vec::new();
    for main in mains {
        for &detection in detections {
            for cells in [options.cells(2) / 4, options.cells(2) / 2, options.cells(2)] {
                let setup = options.setup(main.setup.incline.friction, 2, detection, cells.max(2));
                outcomes.push(match setup == main.setup {
                    true => main.clone(),
                    false => scene::roll(&setup, None, restart)?,
                });
            }
        }
    }
    println!("\n{}", table(&outcomes));
    write_table(&outcomes, folder)?;
    figures::spacings(&outcomes)?.save(folder.join("spacings.png"))?;
    Ok(mains.iter().map(|main| dependence(&outcomes, main.setup.incline.friction)).collect())
}

/// Check the spread of the distance error over the spacings: with the surface-distance test at most that of the approach test.
fn dependence(outcomes: &[Outcome], friction: f64) -> Check {
    let spread = |detection: Detection| {
        let of = outcomes.iter().filter(|o| o.setup.detection == detection);
        let of = of.filter(|o| o.setup.incline.friction == friction).map(|o| errors(o)[0]);
        let (low, high) = of.fold((f64::MAX, f64::MIN), |(l, h), e| (l.min(e), h.max(e)));
        high - low
    };
    let name = format!("mu {friction}: spread of the way over three spacings");
    let (new, old) = (spread(Detection::Local), spread(Detection::Approach));
    Check::at_most(name, new, "-", old, "old detection, this run")
}

fn table(outcomes: &[Outcome]) -> String {
    let head = ["friction", "detection", "cell m", "way", "spin", "largest gap, cells", "energy error", "s"];
    let mut rows = vec![head.map(String::from)];
    for o in outcomes {
        let percent = |x: f64| format!("{:+.2} %", 100.0 * x);
        let [way, spin] = errors(o);
        rows.push([
            o.setup.incline.friction.to_string(),
            o.setup.detection.name(),
            o.setup.spacing().to_string(),
            percent(way),
            percent(spin),
            format!("{:.3}", gap(o)),
            percent(o.totals.energy_error),
            format!("{:.1}", o.totals.wall_seconds),
        ]);
    }
    format!("Way and spin at the end against an elastic cylinder that creeps\n\n{}", case::columns(&rows))
}

fn write_table(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("friction", "-"),
        ("detection (by place among the options)", "-"),
        ("cell size", "m"),
        ("error of the way", "-"),
        ("error of the spin", "-"),
        ("largest gap", "cells"),
        ("energy error", "-"),
        ("time in steps", "s"),
    ];
    let mut file = History::create(folder.join("spacings.csv"), columns)?;
    for o in outcomes {
        let detection = f64::from(o.setup.detection as u8);
        let ([way, spin], t) = (errors(o), &o.totals);
        let friction = o.setup.incline.friction;
        file.push(&[
            friction,
            detection,
            o.setup.spacing(),
            way,
            spin,
            gap(o),
            t.energy_error,
            t.wall_seconds,
        ])?;
    }
    Ok(())
}
