//! Pictures and charts.

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{ParticleSize, Snapshot};

use crate::gurney;
use crate::scene::{self, Outcome};
use crate::setup::{CHARGE, GURNEY, Lit, Setup};

/// Plot the speed of the cases over the expansion of the products.
pub fn speeds(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(900, 600)
        .title("Cases of copper around TNT")
        .x(Axis::new("volume of the products over that of the charge"))
        .y(Axis::new("mean speed of the case").unit("m/s", 1.0));
    let mut cases: Vec<f64> = Vec::new();
    for outcome in outcomes {
        let setup = &outcome.setup;
        let n = cases.iter().position(|&c| c == setup.case).unwrap_or(cases.len());
        let ratio = setup.mass_ratio();
        let (v, u): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(|r| (r.volume, r.speed)).unzip();
        let stroke = if setup.lit == Lit::Axis { Stroke::Solid } else { Stroke::Dotted };
        let name = format!("M/C {ratio:.2}, lit {}", setup.lit.words());
        chart = chart.series(Series::new(name, &v, &u)?.colour(palette(n)).stroke(stroke).width(2.0));
        if n == cases.len() {
            cases.push(setup.case);
            let end = v.last().copied().unwrap_or(1.0);
            let v: Vec<f64> = (0..=60).map(|k| 1.0 + (end - 1.0) * f64::from(k) / 60.0).collect();
            let u: Vec<f64> = v.iter().map(|&v| gurney::speed(setup, v)).collect();
            let name = format!("M/C {ratio:.2}, Gurney");
            chart = chart.series(Series::new(name, &v, &u)?.colour([60; 3]).stroke(Stroke::Dashed));
        }
    }
    Ok(chart.draw()?)
}

/// Plot the speed at the end over the mass ratio.
pub fn ratios(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(820, 560)
        .x(Axis::new("mass of the case over that of the charge"))
        .y(Axis::new("mean speed of the case").unit("m/s", 1.0));
    for (n, lit) in [Lit::Axis, Lit::All].into_iter().enumerate() {
        let of: Vec<&Outcome> = outcomes.iter().filter(|o| o.setup.lit == lit).collect();
        if of.is_empty() {
            continue;
        }
        let points = |of: &dyn Fn(&Outcome) -> f64, which: &[&Outcome]| -> (Vec<f64>, Vec<f64>) {
            which.iter().map(|o| (o.setup.mass_ratio(), of(o))).unzip()
        };
        let (m, u) = points(&|o| o.last().speed, &of);
        let (_, w) = points(&|o| o.alone.0.last().map_or(f64::NAN, |r| r[1]), &of);
        let words = lit.words();
        chart = chart
            .series(Series::new(format!("lit {words}"), &m, &u)?.colour(palette(n)).marker(Marker::Circle))
            .series(
                Series::new(format!("lit {words}, finite differences"), &m, &w)?
                    .colour(palette(n))
                    .marker(Marker::Square)
                    .stroke(Stroke::Dotted),
            );
    }
    let Some(first) = outcomes.first() else { return Ok(chart.draw()?) };
    let cases: Vec<Setup> =
        (0..=40).map(|k| Setup { case: CHARGE * (0.08 + 0.0085 * f64::from(k)), ..first.setup }).collect();
    let m: Vec<f64> = cases.iter().map(Setup::mass_ratio).collect();
    let estimate: Vec<f64> = cases.iter().map(|s| gurney::speed(s, s.expansion)).collect();
    chart = chart.series(
        Series::new("Gurney, energy given off by the products", &m, &estimate)?
            .colour([60; 3])
            .stroke(Stroke::Dashed),
    );
    for (constant, grey) in GURNEY.into_iter().zip([140, 180]) {
        let u: Vec<f64> = m.iter().map(|&m| gurney::thin(constant, m)).collect();
        let name = format!("Gurney, {:.2} km/s [M]", 1e-3 * constant);
        chart = chart.series(Series::new(name, &m, &u)?.colour([grey; 3]));
    }
    Ok(chart.draw()?)
}

/// Draw the case that breaks, coloured by pieces, in the gas.
pub fn pieces(outcome: &Outcome, counts: &[usize]) -> Result<Picture, CaseError> {
    let setup = &outcome.setup;
    let title = format!(
        "A case of copper around TNT, M/C {:.2}: {} particles",
        setup.mass_ratio(),
        outcome.totals.particles
    );
    let mut panels = Panels::new(2).title(title);
    let reach = 1.25 * outcome.last().radius;
    for (look, snapshot) in outcome.snapshots.iter().enumerate() {
        let found = scene::pieces(outcome, look)?;
        let parts = snapshot.scalar("part")?;
        // Gas is lightest, then failed points, then pieces; pieces of similar mass are rarely neighbours on the case.
        let colour = |(piece, &part): (&Option<usize>, &f64)| match piece {
            Some(p) => 3.0 + (p * 5 % 11) as f64,
            None if part > 0.5 => 1.5,
            None => 0.0,
        };
        let colours = found.of.iter().zip(parts).map(colour).collect();
        let sizes = (0..snapshot.len()).map(|n| snapshot.size_of(n)).collect();
        let flat =
            Snapshot::new(2, snapshot.time(), 0, snapshot.positions().to_vec(), ParticleSize::Each(sizes))?
                .with_scalar("piece", colours)?;
        let piece = Quantity::scalar("piece")
            .label("0: gas, 1.5: failed, pieces")
            .range(0.0, 13.0)
            .map(ColourMap::Viridis);
        let picture =
            FieldPicture::new(540, 480).colour_by(piece).bounds([-reach; 2], [reach; 2]).draw(&flat)?;
        panels = panels.panel(format!("{:.1} µs, {} pieces", 1e6 * snapshot.time(), counts[look]), picture);
    }
    Ok(panels.compose()?)
}
