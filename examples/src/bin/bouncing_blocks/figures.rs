//! Charts, histories and pictures.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::History;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Panels, Quantity, Series, Stroke, palette,
};

use examples::blocks::discs::Collision;
use examples::blocks::hertz::Row;

fn column<const N: usize>(rows: &[[f64; N]], i: usize) -> Vec<f64> {
    rows.iter().map(|r| r[i]).collect()
}

fn csv<const N: usize>(path: &Path, columns: [(&str, &str); N], rows: &[[f64; N]]) -> Result<(), CaseError> {
    let mut file = History::create(path, columns)?;
    for row in rows {
        file.push(row)?;
    }
    Ok(())
}

/// Plot the velocities of the bars' centres of mass over time.
pub fn impact(runs: &[(String, Vec<[f64; 4]>)], folder: &Path) -> Result<(), CaseError> {
    let mut chart = Chart::new(900, 600)
        .title("Two bars: velocities of the centres of mass")
        // Room for the legend on the right.
        .x(Axis::new("time").unit("ms", 1e3).range(0.0, 0.06))
        .y(Axis::new("velocity").unit("mm/s", 1e3));
    for (i, (name, rows)) in runs.iter().enumerate() {
        let t = column(rows, 0);
        let first = Series::new(format!("{name}: first"), &t, &column(rows, 1))?;
        let second = Series::new(format!("{name}: second"), &t, &column(rows, 2))?;
        chart = chart.series(first.colour(palette(i)));
        chart = chart.series(second.colour(palette(i)).stroke(Stroke::Dashed));
        let columns =
            [("time", "s"), ("velocity first", "m/s"), ("velocity second", "m/s"), ("contact stress", "Pa")];
        csv(&folder.join(format!("impact_{}.csv", name.replace(' ', "_"))), columns, rows)?;
    }
    Ok(chart.draw()?.save(folder.join("impact.png"))?)
}

/// Plot the velocity behind the joint over time.
pub fn wave(runs: &[(&str, &[[f64; 5]])], folder: &Path) -> Result<(), CaseError> {
    let mut chart = Chart::new(900, 600)
        .title("A pulse through a joint under pressure: velocity at three quarters")
        .x(Axis::new("time").unit("ms", 1e3))
        .y(Axis::new("velocity").unit("mm/s", 1e3));
    for (i, (name, rows)) in runs.iter().enumerate() {
        let series = Series::new(*name, &column(rows, 0), &column(rows, 2))?.colour(palette(i / 2));
        chart = chart.series(series.stroke(if i % 2 == 0 { Stroke::Solid } else { Stroke::Dashed }));
        let columns = [
            ("time", "s"),
            ("velocity at 1/4", "m/s"),
            ("velocity at 3/4", "m/s"),
            ("stress at 1/4", "Pa"),
            ("stress at 3/4", "Pa"),
        ];
        csv(&folder.join(format!("wave_{}.csv", name.replace([' ', ','], "_"))), columns, rows)?;
    }
    Ok(chart.draw()?.save(folder.join("wave.png"))?)
}

/// Plot the energy over time at every cell size; draw the discs at the end with the smallest.
pub fn discs(collisions: &[(u32, Collision)], folder: &Path) -> Result<(), CaseError> {
    let mut chart = Chart::new(900, 600)
        .title("Two discs: energy")
        .x(Axis::new("time").unit("s", 1.0))
        .y(Axis::new("energy").unit("J", 1.0));
    for (i, (finer, Collision { rows, .. })) in collisions.iter().enumerate() {
        let t = column(rows, 0);
        let sum: Vec<f64> = rows.iter().map(|r| r[1] + r[2]).collect();
        let label = |what: &str| format!("{what}, cell 0.05 m / {finer}");
        let kinetic = Series::new(label("kinetic"), &t, &column(rows, 1))?.colour(palette(i));
        let sum = Series::new(label("with internal"), &t, &sum)?.colour(palette(i));
        chart = chart.series(kinetic).series(sum.stroke(Stroke::Dashed));
        let columns =
            [("time", "s"), ("kinetic energy", "J"), ("internal energy", "J"), ("velocity x", "m/s")];
        csv(&folder.join(format!("discs_{finer}.csv")), columns, rows)?;
    }
    chart.draw()?.save(folder.join("discs_energy.png"))?;
    if let Some((_, finest)) = collisions.last() {
        FieldPicture::new(640, 600)
            .title("Two discs after the collision")
            .colour_by(Quantity::scalar("von_mises").unit("Pa", 1.0).map(ColourMap::Viridis))
            .draw(&finest.end)?
            .save(folder.join("discs.png"))?;
    }
    Ok(())
}

/// Plot the force over the approach of balls, and the half width of contact over time of balls and cylinders, against
/// Hertz. `part` is the approach of a ball's centre of mass over that of half spaces.
pub fn hertz(balls: &[Row], cylinders: &[Row], part: f64, folder: &Path) -> Result<(), CaseError> {
    let pressed: Vec<Row> = balls.iter().copied().filter(|r| r.approach > 0.0).collect();
    let of = |read: &dyn Fn(&Row) -> f64| pressed.iter().map(read).collect::<Vec<f64>>();
    let approach = of(&|r| r.approach);
    let force = Chart::new(720, 560)
        .x(Axis::new("approach").unit("mm", 1e3))
        .y(Axis::new("force").unit("N", 1.0))
        .series(Series::new("in and out", &approach, &of(&|r| r.force))?)
        .series(Series::new("Hertz", &approach, &of(&|r| r.hertz_force(part)))?.stroke(Stroke::Dashed));
    let mut widths = Chart::new(720, 560)
        .x(Axis::new("time").unit("ms", 1e3))
        .y(Axis::new("half width of contact").unit("mm", 1e3));
    let exact = [
        ("balls", balls, Row::ball_radius as fn(&Row) -> f64),
        ("cylinders", cylinders, Row::cylinder_width),
    ];
    for (i, (name, rows, hertz)) in exact.into_iter().enumerate() {
        let t: Vec<f64> = rows.iter().map(|r| r.time).collect();
        let width: Vec<f64> = rows.iter().map(|r| r.width).collect();
        let hertz: Vec<f64> = rows.iter().map(hertz).collect();
        widths = widths.series(Series::new(name, &t, &width)?.colour(palette(i)));
        let dashed = Series::new(format!("{name}, Hertz"), &t, &hertz)?.stroke(Stroke::Dashed);
        widths = widths.series(dashed.colour(palette(i)));
        let columns = [("time", "s"), ("approach", "m"), ("force", "N"), ("half width", "m")];
        let rows: Vec<[f64; 4]> = rows.iter().map(|r| [r.time, r.approach, r.force, r.width]).collect();
        csv(&folder.join(format!("hertz_{name}.csv")), columns, &rows)?;
    }
    let panels = Panels::new(2).title("Two balls, two cylinders: contact of Hertz");
    let panels = panels.panel("balls: force", force.draw()?).panel("width", widths.draw()?);
    Ok(panels.compose()?.save(folder.join("hertz.png"))?)
}

/// Plot the distances over time.
pub fn incline(slid: &[[f64; 3]], stuck: &[[f64; 3]], exact: f64, folder: &Path) -> Result<(), CaseError> {
    let end = slid.last().map_or(0.0, |r| r[0]);
    Chart::new(900, 600)
        .title("A block on an incline of 30 degrees")
        .x(Axis::new("time").unit("s", 1.0).range(0.0, 1.05 * end))
        .y(Axis::new("way").unit("m", 1.0))
        .series(Series::new("friction 0.3", &column(slid, 0), &column(slid, 1))?)
        .series(Series::new("friction 0.7", &column(stuck, 0), &column(stuck, 1))?)
        .series(
            Series::new("exact at the end", &[end], &[exact])?.stroke(Stroke::None).marker(Marker::Diamond),
        )
        .draw()?
        .save(folder.join("incline.png"))?;
    let columns = || [("time", "s"), ("way", "m"), ("gap", "m")];
    csv(&folder.join("incline_slides.csv"), columns(), slid)?;
    csv(&folder.join("incline_sticks.csv"), columns(), stuck)
}
