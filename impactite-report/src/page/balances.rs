//! Balances of mass, momentum and energy.

use maud::{Markup, html};

use super::chart::{Chart, Charts};
use super::parts::quantity;
use crate::number::{energy_error, percent, significant};
use crate::record::{Balances, Column, Record};

/// Return the columns of the balances with these names.
fn columns<'a>(balances: &'a Balances, names: &[&str]) -> Vec<&'a Column> {
    names.iter().filter_map(|name| balances.column(name)).collect()
}

/// Relative change of the mass below which it is rounding of the sum.
const ROUNDING: f64 = 1e-12;

/// Balances for display: extensive quantities per radian or depth, and momenta named after the axes.
fn of_part(record: &Record, balances: &Balances) -> Balances {
    let mut shown = balances.clone();
    let axes = record.part.axes(record.dimensions);
    for column in &mut shown.series {
        if ["kg", "kg m/s", "J"].contains(&&*column.unit) {
            column.unit = record.part.unit(&column.unit);
        }
        let place = column
            .name
            .strip_prefix("momentum ")
            .and_then(|axis| ["x", "y", "z"].iter().position(|a| *a == axis));
        if let Some(place) = place {
            column.name = match axes.get(place) {
                Some(axis) => format!("momentum {axis}"),
                None => "momentum across".into(),
            };
        }
    }
    shown
}

fn first_and_last(column: &Column) -> Option<[f64; 2]> {
    Some([*column.values.first()?, *column.values.last()?])
}

pub(super) fn balances(record: &Record, all: &mut Charts) -> Option<Markup> {
    let balances = record.balances.as_ref()?;
    let balances = &of_part(record, balances);
    let unit = |unit: &str| record.part.unit(unit);
    let errors = [
        (
            "mass",
            balances.mass_error.map(|e| percent(if e.abs() < ROUNDING { 0.0 } else { e })),
            None,
            Balances::MASS_ERROR,
        ),
        (
            "momentum",
            Some(significant(balances.momentum_error, 3)),
            balances.momentum_scale.map(|s| quantity(s, &unit("kg m/s"))),
            Balances::MOMENTUM_ERROR,
        ),
        (
            "energy",
            Some(energy_error(balances.energy_error)),
            balances.energy_scale.map(|s| quantity(s, &unit("J"))),
            Balances::ENERGY_ERROR,
        ),
    ];
    let momenta: Vec<String> =
        record.part.axes(record.dimensions).iter().map(|axis| format!("momentum {axis}")).collect();
    let momenta: Vec<&str> = momenta.iter().map(String::as_str).collect();
    let entries = [&["mass"], &momenta[..], &["kinetic energy", "internal energy"]].concat();
    let given = [
        "work",
        "friction",
        "impacts",
        "damping",
        "viscosity",
        "viscous heat",
        "conversion",
        "staggering",
        "total",
    ];
    let row = |column: &Column| {
        let [first, last] = first_and_last(column)?;
        let shown = |x: f64| quantity(x, &column.unit);
        Some(
            html! { tr { td { (column.name) } td.number { (shown(first)) } td.number { (shown(last)) } td.number { (shown(last - first)) } } },
        )
    };
    let named = [&entries[..], &given[..]].concat();
    let rows: Vec<Markup> = columns(balances, &named).into_iter().filter_map(row).collect();
    let figures = balances.column("time").and_then(|time| {
        let is_zero = |c: &Column| c.values.iter().all(|v| *v == 0.0);
        let mut energies = columns(balances, &["kinetic energy", "internal energy", "total"]);
        energies.extend(columns(balances, &given[..8]).into_iter().filter(|c| !is_zero(c)));
        let momenta = columns(balances, &momenta);
        let list = [
            ("Energy", energies),
            ("Energy error", columns(balances, &["energy error"])),
            ("Momentum", momenta.into_iter().filter(|c| !is_zero(c)).collect()),
            ("Momentum error", columns(balances, &["momentum error"])),
        ];
        let mut list: Vec<(&str, Vec<&Column>)> = list.into_iter().filter(|(_, c)| !c.is_empty()).collect();
        if balances.mass_error.is_some_and(|e| e.abs() > ROUNDING || e.is_nan()) {
            list.push(("Mass", columns(balances, &["mass"])));
        }
        let charts: Vec<Chart> = list.into_iter().map(|(t, c)| Chart::new(t.into(), time, &c)).collect();
        all.figures(&charts)
    });
    Some(html! {
        @if let Some(note) = record.part.note() { p { (note) } }
        div.wide {
            table {
                caption { "Largest errors of the run" }
                thead { tr { th { "balance" } th.number { "error" } th.number { "relative to" } } }
                @for (what, error, scale, _) in &errors {
                    @if let Some(error) = error {
                        tr { td { (what) } td.number { (error) } td.number { @if let Some(scale) = scale { (scale) } } }
                    }
                }
            }
        }
        @if !rows.is_empty() {
            br;
            div.wide {
                table {
                    thead { tr { th { "of all bodies" } th.number { "first" } th.number { "last" } th.number { "change" } } }
                    @for row in &rows { (row) }
                }
            }
        }
        @if let Some(figures) = &figures { br; (figures) }
        details {
            summary { "Definitions of the errors" }
            dl.definitions {
                @for (what, error, _, meaning) in &errors { @if error.is_some() { dt { (what) " error" } dd { (meaning) "." } } }
            }
        }
    })
}
