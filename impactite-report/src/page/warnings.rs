//! Warnings of the run, with remedies.

use maud::{Markup, html};

use super::parts::quantity;
use crate::record::Record;

pub(super) fn warnings(record: &Record) -> Option<Markup> {
    if record.warnings.is_empty() {
        return None;
    }
    Some(html! {
        @for w in &record.warnings {
            div.warning {
                p { b { (w.title) } " " small { "after step " (w.step) ", t = " (quantity(w.time, "s")) } }
                p { (w.found) "." }
                @if !w.remedy.is_empty() { p { b { "What to do: " } (w.remedy) "." } }
            }
        }
    })
}
