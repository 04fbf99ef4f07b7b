//! Checks: results in comparison with references.

use maud::{Markup, html};

use super::parts::quantity;
use crate::number::{is_energy_error, percent, significant};
use crate::record::{Check, Record};

/// Checks, failed ones first.
pub(super) fn checks(record: &Record) -> Option<Markup> {
    if record.checks.is_empty() {
        return None;
    }
    let mut rows: Vec<&Check> = record.checks.iter().collect();
    rows.sort_by_key(|check| check.rank());
    Some(html! {
        div.wide {
            table.full {
                thead { tr { th { "quantity" } th { "result" } th.number { "this run" } th.number { "reference" } th.number { "difference" } th.number { "allowed" } th.source { "source" } } }
                @for check in rows {
                    tr {
                        td.name { (check.name) }
                        td { (result(check)) }
                        td.number { (of_check(check, check.value)) }
                        td.number { @if let Some(r) = check.reference { (of_check(check, r)) } }
                        td.number { (difference(check)) }
                        td.number { (allowed(check)) }
                        td.source { small { (check.source) @if let Some(reason) = &check.known { br; "expected failure: " (reason) } } }
                    }
                }
            }
        }
    })
}

/// Format a number of a check with its unit.
fn of_check(check: &Check, x: f64) -> String {
    if is_energy_error(&check.name, &check.unit) { percent(x) } else { quantity(x, &check.unit) }
}

/// Difference in per cent of the reference, or in the unit if the reference is 0.
fn difference(check: &Check) -> String {
    match check.reference {
        Some(0.0) => of_check(check, check.value),
        Some(r) => {
            let share = check.value / r - 1.0;
            if share.is_finite() { format!("{:+.2} %", 100.0 * share) } else { String::new() }
        }
        None => String::new(),
    }
}

pub(super) fn allowed(check: &Check) -> String {
    match (check.tolerance, check.reference) {
        (Some(t), Some(0.0)) => format!("± {}", of_check(check, t).trim_start_matches('+')),
        (Some(t), _) => format!("± {} %", significant(100.0 * t, 3)),
        _ => String::new(),
    }
}

fn result(check: &Check) -> Markup {
    match check.pass {
        Some(true) => html! { span.good { "passed" } },
        Some(false) => html! { b.bad { "failed" } },
        None => html! { span.faint { "not judged" } },
    }
}
