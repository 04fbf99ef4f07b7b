//! Scene file and machine.

use std::time::{Duration, SystemTime};

use maud::{Markup, html};

use super::parts::quantity;
use crate::record::Record;

pub(super) fn scene(record: &Record) -> Option<Markup> {
    let machine = &record.machine;
    let date = |seconds: Option<u64>| {
        // Dates end in the year 9999.
        let seconds = seconds.filter(|s| *s < 253_402_300_800)?;
        let time = SystemTime::UNIX_EPOCH + Duration::from_secs(seconds);
        Some(humantime::format_rfc3339_seconds(time).to_string().replace('T', " ").replace('Z', " UTC"))
    };
    let versions = machine.versions.iter().map(|[name, version]| format!("{name} {version}"));
    let ran = [
        ("versions", versions.collect::<Vec<_>>().join(", ")),
        ("processor", machine.features.clone()),
        ("threads", if machine.threads > 0 { machine.threads.to_string() } else { String::new() }),
        ("started", date(machine.started).unwrap_or_default()),
        ("ended", date(machine.ended).unwrap_or_default()),
    ];
    let ran: Vec<_> = ran.into_iter().filter(|(_, value)| !value.is_empty()).collect();
    if record.scene.is_empty() && record.bodies.is_empty() && record.settings.is_empty() && ran.is_empty() {
        return None;
    }
    let mass_unit = record.part.unit("kg");
    Some(html! {
        @if !record.bodies.is_empty() {
            div.wide {
                table.full {
                    caption { "Bodies at the time of the record" @if let Some(share) = record.part.share() { ", " (share) } }
                    thead { tr { th { "body" } th { "law" } th.number { "points" } th.number { "mass" } } }
                    @for body in &record.bodies {
                        tr { td.name { (body.name) } td.name { (body.material) } td.number { (body.points) } td.number { (quantity(body.mass, &mass_unit)) } }
                    }
                }
            }
        }
        @if !record.settings.is_empty() {
            h3 { "Settings" }
            div.wide { table { @for s in &record.settings { tr { td { (s.name) } td.name { (s.value) @if !s.unit.is_empty() { " " (s.unit) } } } } } }
        }
        @if !record.scene.is_empty() {
            h3 { "Scene file" }
            pre { code { (record.scene) } }
        }
        @if !ran.is_empty() {
            h3 { "The run" }
            div.wide { table { @for (name, value) in &ran { tr { td { (name) } td.name { (value) } } } } }
        }
    })
}
