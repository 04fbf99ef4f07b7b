//! A row as it is written down.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;
use stability::verdict::{Expect, Judged, short};

/// A scheme in a scene, and what came of it.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// Scene.
    pub scene: String,
    /// Scheme, particles a cell and axis, factor of the step: what was tried.
    pub scheme: String,
    /// "holds" or "fails".
    pub expected: &'static str,
    /// Where that is from.
    pub source: String,
    /// What was measured; none if it is not a number.
    pub value: Option<f64>,
    /// When the criterion holds.
    pub limit: String,
    /// Value over limit, so that more than 1 fails.
    pub share: Option<f64>,
    /// Verdict.
    pub verdict: &'static str,
    /// Why it is not as expected, if known.
    pub noted: Option<String>,
    /// As expected, or as noted?
    pub known: bool,
    /// Steps made.
    pub steps: u64,
    /// Step that stopped the run.
    pub stopped_at: Option<u64>,
    /// What stopped it, or what else is to say.
    pub said: Option<String>,
    /// Seconds.
    pub seconds: f64,
}

impl Record {
    /// Of a row.
    pub fn of(judged: &Judged<'_>) -> Self {
        let (row, measured) = (judged.row, &judged.measured);
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        let stop = measured.stopped.as_ref();
        Record {
            scene: judged.scene.id.into(),
            scheme: row.scheme.clone(),
            expected: if row.expect == Expect::Holds { "holds" } else { "fails" },
            source: row.source.into(),
            value: finite(measured.value),
            limit: judged.limit.text(),
            share: finite(judged.limit.share(measured.value)),
            verdict: judged.verdict.name(),
            noted: judged.noted.map(Into::into),
            known: judged.known(),
            steps: measured.steps,
            stopped_at: stop.map(|s| s.step),
            said: stop.map(|s| s.what.clone()).or_else(|| measured.since.clone()),
            seconds: judged.seconds,
        }
    }

    /// What was measured, in words.
    pub fn found(&self) -> String {
        match (self.value, self.stopped_at) {
            (Some(value), _) => short(value),
            (None, Some(step)) => format!("stops in step {step}"),
            (None, None) => "not a number".into(),
        }
    }
}

/// All rows as a table for others.
pub fn write_csv(path: &Path, records: &[Record]) -> io::Result<()> {
    let mut file = File::create(path)?;
    writeln!(
        file,
        "scene,scheme,expected,source,value,limit,verdict,noted,steps,stopped at step,said,seconds"
    )?;
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "'"));
    for r in records {
        writeln!(
            file,
            "{},{},{},{},{},{},{},{},{},{},{},{:.3}",
            r.scene,
            quoted(&r.scheme),
            r.expected,
            quoted(&r.source),
            r.value.map_or(String::new(), |v| format!("{v:.6e}")),
            quoted(&r.limit),
            r.verdict,
            quoted(r.noted.as_deref().unwrap_or_default()),
            r.steps,
            r.stopped_at.map_or(String::new(), |s| s.to_string()),
            quoted(r.said.as_deref().unwrap_or_default()),
            r.seconds
        )?;
    }
    Ok(())
}
