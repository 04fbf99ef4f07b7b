//! Common parts of all pages: file name, style, and HTML document around a body.

use impactite_output::printable;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// File name of the page in the folder of its run.
pub const FILE: &str = "report.html";

const STYLE: &str =
    concat!(include_str!("../../vendor/uplot/uPlot.min.css"), "\n", include_str!("style.css"));
/// Content security policy: no external resources.
const POLICY: &str =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// Assemble a complete page from a title and a body.
pub(super) fn document(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { (body) }
        }
    };
    // Escape control characters in titles of scenes.
    printable(&page.into_string()).into_owned()
}
