//! Small elements of a page.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};

use crate::error::ReportError;
use crate::number;

/// Maximum size of an embedded picture, bytes.
const MOST_BYTES: u64 = 16 << 20;

/// Encode a file as a data URI.
pub(super) fn data_uri(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", STANDARD.encode(bytes))
}

/// Embed the picture in `file` in the page.
///
/// # Errors
/// A file that cannot be read, is too large, or is no picture that browsers support.
pub(super) fn picture(folder: &Path, file: &str, about: &str) -> Result<Markup, ReportError> {
    let path = folder.join(file);
    let ending = file.rsplit_once('.').map_or(String::new(), |(_, ending)| ending.to_lowercase());
    let kind = match ending.as_str() {
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "webp" => "image/webp",
        "svg" => "image/svg+xml",
        _ => return Err(ReportError::damaged(&path, "it must be a PNG, JPEG, WebP or SVG file")),
    };
    let size = std::fs::metadata(&path).map_err(ReportError::read(&path))?.len();
    if size > MOST_BYTES {
        let why = format!("{} are more than a page should hold, {}", bytes(size), bytes(MOST_BYTES));
        return Err(ReportError::damaged(&path, why));
    }
    let sides = if ending == "png" { Some(sides(&path)?) } else { None };
    let content = std::fs::read(&path).map_err(ReportError::read(&path))?;
    let [width, height] = [0, 1].map(|n| sides.map(|sides| sides[n]));
    Ok(html! { img src=(data_uri(kind, &content)) alt=(about) width=[width] height=[height]; })
}

/// Read width and height of a PNG file, pixels.
fn sides(path: &Path) -> Result<[u32; 2], ReportError> {
    let file = File::open(path).map_err(ReportError::read(path))?;
    let reader = png::Decoder::new(BufReader::new(file)).read_info();
    let reader = reader.map_err(|error| ReportError::damaged(path, format!("no PNG picture: {error}")))?;
    Ok([reader.info().width, reader.info().height])
}

/// Format a number with its unit, to four digits.
pub(super) fn quantity(x: f64, unit: &str) -> String {
    number::quantity(x, unit, 4)
}

/// Note in place of an element that cannot be shown, with the error. File names are relative to the folder of the page.
pub(super) fn missing(error: &ReportError, folder: &Path) -> Markup {
    html! { p.note { (error.to_string().replace(&format!("{}/", folder.display()), "")) } }
}

/// Format a wall-clock time in common units.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if (100.0..1e10).contains(&s) => {
            humantime::format_duration(Duration::from_secs(s.round() as u64)).to_string()
        }
        s => number::quantity(s, "s", 3),
    }
}

/// Format a size in bytes.
pub(super) fn bytes(size: u64) -> String {
    match size as f64 {
        b if b >= 1e9 => format!("{:.1} GB", 1e-9 * b),
        b if b >= 1e6 => format!("{:.1} MB", 1e-6 * b),
        b if b >= 1e3 => format!("{:.1} kB", 1e-3 * b),
        b => format!("{b} B"),
    }
}

/// Percent-encode a name for a URL.
pub(super) fn address(name: &str) -> String {
    name.bytes().fold(String::new(), |out, b| match b {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'/' => {
            out + &char::from(b).to_string()
        }
        b => out + &format!("%{b:02X}"),
    })
}

/// Table of names and numbers, each with a bar proportional to the number.
pub(super) fn bars(rows: &[(String, f64, String)]) -> Markup {
    let most = rows.iter().fold(0.0, |most: f64, (_, x, _)| most.max(*x));
    html! {
        div.wide {
            table.bars.full {
                @for (name, x, shown) in rows {
                    tr {
                        td { (name) }
                        td.number { (shown) }
                        td { div.bar style=(format!("width:{:.1}%", if most > 0.0 { 100.0 * x / most } else { 0.0 })) {} }
                    }
                }
            }
        }
    }
}
