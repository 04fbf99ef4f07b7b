//! Stored result of a row.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;
use stability::verdict::{Expect, Judged, short};

/// Result of a scheme in a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// Scene.
    pub scene: String,
    /// Scheme, particles per cell and axis, time step factor.
    pub scheme: String,
    /// Expected result: "holds" or "fails".
    pub expected: &'static str,
    /// Source of the expectation.
    pub source: String,
    /// Measured value; none for NaN.
    pub value: Option<f64>,
    /// Limit of the criterion.
    pub limit: String,
    /// Ratio of value to limit: more than 1 fails.
    pub share: Option<f64>,
    /// Verdict on the row.
    pub verdict: &'static str,
    /// Known cause of an unexpected result, if any.
    pub noted: Option<String>,
    /// True if the result is as expected or as noted.
    pub known: bool,
    /// Number of steps.
    pub steps: u64,
    /// Step that stopped the run.
    pub stopped_at: Option<u64>,
    /// Failure message, or a remark.
    pub said: Option<String>,
    /// Run time, s.
    pub seconds: f64,
}

impl Record {
    /// Create the record of a judged row.
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

    /// Describe the measured value.
    pub fn found(&self) -> String {
        match (self.value, self.stopped_at) {
            (Some(value), _) => short(value),
            (None, Some(step)) => format!("stops in step {step}"),
            (None, None) => "not a number".into(),
        }
    }
}

/// Write all rows as a CSV table.
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
