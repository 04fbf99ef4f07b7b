//! Convergence of the measures of a scene under refinement: observed order, extrapolated value, error band.
//!
//! The procedure is that of \[Celik2008\] with the grid convergence index of \[Roache1994\], for levels whose sizes have a constant ratio r.
//! With the value f1 of the finest level, f2 and f3 of the next coarser ones, and the differences e21 = f2 - f1 and e32 = f3 - f2:
//!
//! | result | formula |
//! |---|---|
//! | observed order | p = ln(e32 / e21) / ln r |
//! | extrapolated value | f1 - e21 / (r^p - 1) |
//! | error band | 1.25 abs(e21) / (r^p - 1) |
//!
//! Both require differences of one sign that fall. Other sequences have a [`Trend`] in words.

use impactite_output::OutputError;
use impactite_output::picture::{Axis, Chart, Marker, Panels, Picture, Series, Stroke};
use serde::Serialize;

use crate::error::ReportError;
use crate::number::{quantity, readable, significant};
use crate::record::Check;

/// Safety factor of the grid convergence index for three levels.
const SAFETY: f64 = 1.25;
/// Relative difference below which values are equal within rounding: sums over many points and steps.
const ROUNDING: f64 = 1e-10;
/// Observed orders outside of which an extrapolated value is doubtful: the methods are of first or second order.
const USUAL_ORDERS: std::ops::RangeInclusive<f64> = 0.5..=3.0;

/// Behaviour of a measure under refinement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Trend {
    /// Differences of one sign that fall.
    Monotone,
    /// Differences of alternating sign that fall.
    Oscillating,
    /// Differences that do not fall.
    Diverging,
    /// Equal values on the three finest levels, within rounding.
    Unchanged,
    /// Equal values on the two finest levels, within rounding, and another one before them.
    Settled,
    /// Two levels, which have no order.
    TwoLevels,
    /// A level without a finite value.
    Incomplete,
}

impl Trend {
    /// The trend in words for a table.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Trend::Monotone => "monotone",
            Trend::Oscillating => "oscillates",
            Trend::Diverging => "does not converge",
            Trend::Unchanged => "unchanged within rounding",
            Trend::Settled => "two finest equal within rounding",
            Trend::TwoLevels => "order unknown",
            Trend::Incomplete => "a level has no value",
        }
    }

    /// Explanation of the words, where needed.
    fn note(self) -> Option<&'static str> {
        match self {
            Trend::Oscillating => {
                Some("differences between levels change their sign; order and limit are unknown")
            }
            Trend::Diverging => {
                Some("differences between levels do not fall; localisation or contact may need finer cells")
            }
            Trend::Settled => Some("faster than can be measured, or by chance; a further level shows which"),
            Trend::TwoLevels => Some("two levels; the order needs three"),
            Trend::Monotone | Trend::Unchanged | Trend::Incomplete => None,
        }
    }
}

/// A measure on all levels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasureConvergence {
    /// Name of the measure.
    pub name: String,
    /// SI unit; "-" for dimensionless numbers.
    pub unit: String,
    /// Values, coarsest level first; NaN (in JSON `null`) for a level that failed.
    pub values: Vec<f64>,
    /// Behaviour on the three finest levels.
    pub trend: Trend,
    /// Observed order p, for a monotone trend.
    pub order: Option<f64>,
    /// Value for vanishing size.
    pub extrapolated: Option<f64>,
    /// Error band: half width of the interval about the extrapolated value.
    pub band: Option<f64>,
}

impl MeasureConvergence {
    /// Analyse `values`, coarsest level first, of sizes with the ratio `ratio` > 1 from level to level.
    ///
    /// ```
    /// use impactite_report::convergence::MeasureConvergence;
    /// // 1 + h^2 for h = 0.4, 0.2, 0.1.
    /// let measure = MeasureConvergence::new("length", "m", vec![1.16, 1.04, 1.01], 2.0);
    /// assert!((measure.order.unwrap() - 2.0).abs() < 1e-12);
    /// assert!((measure.extrapolated.unwrap() - 1.0).abs() < 1e-12);
    /// assert!((measure.band.unwrap() - 1.25 * 0.01).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>, values: Vec<f64>, ratio: f64) -> Self {
        let (trend, order, limit) = analysis(&values, ratio);
        let (extrapolated, band) = limit.unzip();
        MeasureConvergence { name: name.into(), unit: unit.into(), values, trend, order, extrapolated, band }
    }

    /// Trend in words, with a remark on a doubtful order.
    #[must_use]
    pub fn words(&self) -> String {
        let doubt = match self.order {
            Some(p) if p < *USUAL_ORDERS.start() => ", slowly",
            Some(p) if p > *USUAL_ORDERS.end() => ", too fast for the method",
            _ => "",
        };
        format!("{}{doubt}", self.trend.words())
    }

    fn note(&self) -> Option<&'static str> {
        match self.order {
            Some(p) if p < *USUAL_ORDERS.start() => {
                Some("an order below 0.5; the extrapolated value is uncertain")
            }
            Some(p) if p > *USUAL_ORDERS.end() => Some(
                "an order above 3; the coarse levels are not in the asymptotic range, and the band is too narrow",
            ),
            _ => self.trend.note(),
        }
    }
}

/// Compute trend, observed order, and extrapolated value with its band.
fn analysis(values: &[f64], ratio: f64) -> (Trend, Option<f64>, Option<(f64, f64)>) {
    let unknown = |trend| (trend, None, None);
    if values.len() < 2 || values.iter().any(|f| !f.is_finite()) {
        return unknown(Trend::Incomplete);
    }
    let finest = &values[values.len().saturating_sub(3)..];
    let rounding = ROUNDING * finest.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    let f1 = finest[finest.len() - 1];
    if finest.iter().all(|f| (f - f1).abs() <= rounding) {
        return (Trend::Unchanged, None, Some((f1, 0.0)));
    }
    let &[f3, f2, _] = finest else { return unknown(Trend::TwoLevels) };
    let (e21, e32) = (f2 - f1, f3 - f2);
    if e21.abs() <= rounding {
        return (Trend::Settled, None, Some((f1, 0.0)));
    }
    if e21.abs() >= e32.abs() {
        return unknown(Trend::Diverging);
    }
    // r^p, computed directly from the differences.
    let growth = e32 / e21;
    if growth < 0.0 {
        return unknown(Trend::Oscillating);
    }
    let error = e21 / (growth - 1.0);
    (Trend::Monotone, Some(growth.ln() / ratio.ln()), Some((f1 - error, SAFETY * error.abs())))
}

/// Judgement of a check by the extrapolated value with its band.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The whole band is within the tolerance.
    Passed,
    /// The whole band is outside of the tolerance.
    Failed,
    /// The band crosses the limit of the tolerance.
    Undecided,
    /// No extrapolated value.
    Unknown,
}

impl Verdict {
    /// The judgement in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Verdict::Passed => "passed",
            Verdict::Failed => "FAILED",
            Verdict::Undecided => "undecided: the band crosses the tolerance",
            Verdict::Unknown => "unknown: no extrapolated value",
        }
    }
}

/// Check of the scene on the finest level, and by extrapolation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckConvergence {
    /// Check of the finest level.
    #[serde(flatten)]
    pub check: Check,
    /// Verdict on the extrapolated value.
    pub extrapolated: Verdict,
}

impl CheckConvergence {
    /// Judge `check`, of the finest level, by the extrapolated value of its measure.
    #[must_use]
    pub fn new(check: Check, measures: &[MeasureConvergence]) -> Self {
        let measure = measures.iter().find(|m| m.name == check.name);
        let limit = measure.and_then(|m| m.extrapolated.zip(m.band));
        let extrapolated = match (limit, check.reference, check.tolerance) {
            (Some((value, band)), Some(reference), Some(tolerance)) => {
                let scale = if reference == 0.0 { 1.0 } else { reference.abs() };
                let (off, allowed) = ((value - reference).abs(), tolerance * scale);
                match () {
                    () if off + band <= allowed => Verdict::Passed,
                    () if off - band > allowed => Verdict::Failed,
                    () => Verdict::Undecided,
                }
            }
            _ => Verdict::Unknown,
        };
        CheckConvergence { check, extrapolated }
    }
}

/// Refined key of the scene, with its values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RefinedKey {
    /// Path of the key, such as `method.mpm.cell`.
    pub key: String,
    /// SI unit of the key.
    pub unit: String,
    /// Values, coarsest level first.
    pub values: Vec<f64>,
}

/// Refinement level: a run with its own sizes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Level {
    /// Folder of the run, relative to that of the study.
    pub folder: String,
    /// Factor of all sizes.
    pub factor: f64,
    /// Number of points at the end.
    pub particles: Option<usize>,
    /// Number of steps.
    pub steps: Option<u64>,
    /// Wall-clock time in steps, s.
    pub wall_seconds: Option<f64>,
    /// Error of a run that failed.
    pub error: Option<String>,
}

/// Convergence of a scene: the keys of the JSON object of `converge.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Convergence {
    /// Title of the scene.
    pub case: String,
    /// Ratio of the sizes of neighbouring levels.
    pub ratio: f64,
    /// Keys that are refined together; the first is the size of charts and headings.
    pub refined: Vec<RefinedKey>,
    /// Levels, coarsest first.
    pub levels: Vec<Level>,
    /// Measures, in the order of the scene.
    pub measures: Vec<MeasureConvergence>,
    /// Checks of the finest level.
    pub checks: Vec<CheckConvergence>,
}

/// Name of the table file in the folder of a study.
pub const TABLE: &str = "converge.csv";
/// Name of the JSON file in the folder of a study.
pub const JSON: &str = "converge.json";
/// Name of the chart file in the folder of a study.
pub const CHART: &str = "converge.png";
/// Name of the page in the folder of a study.
pub const PAGE: &str = "converge.html";
/// Names of all files in the folder of a study, besides the folders of the runs.
pub const FILES: [&str; 4] = [TABLE, JSON, CHART, PAGE];

/// Significant digits of values in tables.
const DIGITS: usize = 6;

impl Convergence {
    /// Sizes of the first refined key, with their unit: headings of the levels.
    #[must_use]
    pub fn sizes(&self) -> Vec<String> {
        let sizes = self.refined.first();
        sizes.map_or_else(Vec::new, |key| key.values.iter().map(|x| quantity(*x, &key.unit, 4)).collect())
    }

    /// Head and rows of the printed table, one measure per row.
    pub(crate) fn table(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let head = ["measure", "unit"].map(String::from).into_iter().chain(self.sizes());
        let head = head.chain(["order", "extrapolated", "band", "convergence"].map(String::from)).collect();
        let shown = |x: Option<f64>, digits| x.map_or_else(|| "-".into(), |x| significant(x, digits));
        let row = |m: &MeasureConvergence| {
            let values = m.values.iter().map(|x| significant(*x, DIGITS));
            let band = m.band.map_or_else(|| "-".into(), |band| format!("± {}", significant(band, 2)));
            [m.name.clone(), m.unit.clone()]
                .into_iter()
                .chain(values)
                .chain([
                    shown(m.order.map(|p| (100.0 * p).round() / 100.0), 3),
                    shown(m.extrapolated, DIGITS),
                    band,
                    m.words(),
                ])
                .collect()
        };
        (head, self.measures.iter().map(row).collect())
    }

    /// Explanations of words in the table: `does not converge: ...`.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = Vec::new();
        for measure in &self.measures {
            if let Some(note) = measure.note().map(|note| format!("{}: {note}", measure.words()))
                && !notes.contains(&note)
            {
                notes.push(note);
            }
        }
        notes
    }

    /// Format lines for a terminal: the table, its notes, failed levels, and the checks with the failed ones first.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let (head, rows) = self.table();
        let all: Vec<&Vec<String>> = std::iter::once(&head).chain(&rows).collect();
        let width = |column: usize| all.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..head.len()).map(width).collect();
        let line = |row: &&Vec<String>| {
            let cell = |(n, cell): (usize, &String)| match n {
                // Left-align words, right-align numbers.
                0 | 1 => format!("{cell:<width$}", width = widths[n]),
                _ if n + 1 == widths.len() => cell.clone(),
                _ => format!("{cell:>width$}", width = widths[n]),
            };
            row.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ").trim_end().to_string()
        };
        let mut lines: Vec<String> = all.iter().map(line).collect();
        lines.extend(self.notes());
        for level in &self.levels {
            lines.extend(level.error.as_ref().map(|why| format!("{} failed: {why}", level.folder)));
        }
        let mut checks: Vec<&CheckConvergence> = self.checks.iter().collect();
        checks.sort_by_key(|c| c.check.rank());
        lines.extend(checks.into_iter().map(|c| self.check_line(c)));
        lines
    }

    fn check_line(&self, CheckConvergence { check, extrapolated }: &CheckConvergence) -> String {
        let measure = self.measures.iter().find(|m| m.name == check.name);
        let limit =
            measure.and_then(|m| m.extrapolated.zip(m.band)).map_or_else(String::new, |(value, band)| {
                format!(" {} ± {}", significant(value, DIGITS), significant(band, 2))
            });
        let allowed = match check.reference {
            Some(0.0) => significant(check.tolerance.unwrap_or(0.0), 3),
            _ => format!("{} %", significant(100.0 * check.tolerance.unwrap_or(0.0), 3)),
        };
        format!(
            "check {name}: finest {finest} ({value}), extrapolated {words}{limit}; reference {reference} {unit} ± {allowed}, {source}",
            name = check.name,
            finest = if check.pass == Some(true) { "passed" } else { "FAILED" },
            value = significant(check.value, DIGITS),
            words = extrapolated.words(),
            reference = significant(check.reference.unwrap_or(f64::NAN), DIGITS),
            unit = check.unit,
            source = check.source,
        )
    }

    /// Format the table as CSV, with all digits: refined keys first, then one measure per row. Absent numbers are empty.
    ///
    /// # Errors
    /// None in practice: the table is written to memory.
    pub fn csv(&self) -> Result<String, ReportError> {
        let mut file = csv::Writer::from_writer(Vec::new());
        let number = |x: f64| if x.is_finite() { format!("{x:?}") } else { String::new() };
        let maybe = |x: Option<f64>| x.map_or_else(String::new, number);
        let levels = (1..=self.levels.len()).map(|n| format!("level {n}"));
        let ends = ["order", "extrapolated", "band", "convergence"].map(String::from);
        let mut rows: Vec<Vec<String>> =
            vec![["measure", "unit"].map(String::from).into_iter().chain(levels).chain(ends).collect()];
        let mut push = |name: &str, unit: &str, values: &[f64], ends: [String; 4]| {
            let values = values.iter().map(|x| number(*x));
            rows.push([name, unit].map(String::from).into_iter().chain(values).chain(ends).collect());
        };
        for key in &self.refined {
            push(&key.key, &key.unit, &key.values, ["", "", "", "refined"].map(String::from));
        }
        for m in &self.measures {
            push(
                &m.name,
                &m.unit,
                &m.values,
                [maybe(m.order), maybe(m.extrapolated), maybe(m.band), m.words()],
            );
        }
        let written = rows.iter().try_for_each(|row| file.write_record(row));
        let damaged = |why: String| ReportError::damaged(TABLE.as_ref(), why);
        written.map_err(|e| damaged(e.to_string()))?;
        let bytes = file.into_inner().map_err(|e| damaged(e.to_string()))?;
        String::from_utf8(bytes).map_err(|e| damaged(e.to_string()))
    }

    /// Draw a chart of each measure over the first refined size, with the extrapolated value and its band at size zero. `None` without a
    /// measure that has two finite values.
    ///
    /// # Errors
    /// A picture that cannot be drawn.
    pub fn chart(&self) -> Result<Option<Picture>, OutputError> {
        let Some(size) = self.refined.first() else { return Ok(None) };
        let coarsest = size.values.first().copied().unwrap_or(1.0);
        let (size_unit, size_factor) = readable(coarsest, &size.unit);
        let mut charts = Vec::new();
        for m in &self.measures {
            let finite = || m.values.iter().filter(|x| x.is_finite());
            if finite().count() < 2 {
                continue;
            }
            let (unit, factor) = readable(finite().fold(0.0, |most: f64, x| most.max(x.abs())), &m.unit);
            let mut chart = Chart::new(WIDTH, 520)
                .x(Axis::new(&size.key)
                    .unit(&size_unit, size_factor)
                    .range(-0.05 * coarsest, 1.05 * coarsest))
                .y(Axis::new(&m.name).unit(unit, factor))
                .series(Series::new("levels", &size.values, &m.values)?.marker(Marker::Circle));
            if let (Some(limit), Some(band)) = (m.extrapolated, m.band) {
                let (h, f) =
                    (size.values.last().copied().unwrap_or(0.0), m.values.last().copied().unwrap_or(limit));
                let to = Series::new(
                    "extrapolated, with its band",
                    &[h, 0.0, 0.0, 0.0],
                    &[f, limit, limit + band, limit - band],
                )?;
                chart = chart.series(to.stroke(Stroke::Dashed));
            }
            charts.push(chart.draw()?);
        }
        if charts.is_empty() {
            return Ok(None);
        }
        let across = charts.len().min(3);
        // Average width of the letters of a title: at most 12 pixels.
        let title = match format!("Convergence: {}", self.case) {
            title if title.chars().count() <= WIDTH * across / 12 => title,
            _ => "Convergence".into(),
        };
        let panels = charts.into_iter().fold(Panels::new(across).title(title), |all, one| all.panel("", one));
        panels.compose().map(Some)
    }
}

/// Width of a chart, pixels.
const WIDTH: usize = 640;

#[cfg(test)]
mod tests {
    use super::*;

    /// Sequence f0 + c h^p for sizes with a constant ratio, coarsest first.
    fn sequence(f0: f64, c: f64, p: f64, ratio: f64, levels: i32) -> Vec<f64> {
        (0..levels).rev().map(|n| f0 + c * (0.1 * ratio.powi(n)).powf(p)).collect()
    }

    fn measure(values: &[f64], ratio: f64) -> MeasureConvergence {
        MeasureConvergence::new("f", "m", values.to_vec(), ratio)
    }

    #[test]
    fn powers_of_the_size_have_their_order_and_limit() {
        for ratio in [2.0, 1.5] {
            for p in [1.0, 2.0, 1.5] {
                for (f0, c) in [(3.0, 0.7), (-3.0, 0.7), (0.0, -2.0), (1e9, 1e8)] {
                    for levels in [3, 5] {
                        let values = sequence(f0, c, p, ratio, levels);
                        let found = measure(&values, ratio);
                        assert_eq!(found.trend, Trend::Monotone);
                        // Differences are about a hundredth of the values: two digits of sixteen are lost, and some more in quotients.
                        let order = found.order.expect("an order");
                        assert!((order - p).abs() < 1e-11, "{p} {ratio} {f0}: {order}");
                        let limit = found.extrapolated.expect("a limit");
                        let scale = f0.abs().max(c.abs());
                        assert!((limit - f0).abs() < 1e-12 * scale, "{p} {ratio} {f0}: {limit}");
                        let error = (values[values.len() - 1] - f0).abs();
                        assert!((found.band.expect("a band") - 1.25 * error).abs() < 1e-12 * scale);
                        assert_eq!(found.words(), "monotone");
                    }
                }
            }
        }
    }

    /// The example of [Celik2008] has another ratio at each level; with a constant one the formulas are those of [Roache1994]:
    /// GCI = 1.25 / (r^p - 1) abs((f2 - f1) / f1).
    #[test]
    fn the_band_is_the_grid_convergence_index() {
        let found = measure(&[0.923, 0.9505, 0.9609], 2.0);
        let p: f64 = ((0.9505f64 - 0.923) / (0.9609 - 0.9505)).ln() / 2f64.ln();
        let index = 1.25 / (2f64.powf(p) - 1.0) * ((0.9505 - 0.9609) / 0.9609f64).abs();
        assert!((found.order.expect("an order") - p).abs() < 1e-12);
        assert!((found.band.expect("a band") / 0.9609 - index).abs() < 1e-12);
    }

    #[test]
    fn a_measure_that_crosses_zero_has_a_limit() {
        // 0.01 - h^2 with h = 0.2, 0.1, 0.05: the value of the middle level is zero.
        let found = measure(&[-0.03, 0.0, 0.0075], 2.0);
        assert!((found.order.expect("an order") - 2.0).abs() < 1e-12);
        assert!((found.extrapolated.expect("a limit") - 0.01).abs() < 1e-15);
        // The finest value is zero, so that a relative band would be zero.
        let found = measure(&[-0.3, -0.1, 0.0], 2.0);
        assert!((found.extrapolated.expect("a limit") - 0.1).abs() < 1e-15);
        assert!((found.band.expect("a band") - 0.125).abs() < 1e-15);
    }

    #[test]
    fn sequences_without_an_order_have_words() {
        let trend = |values: &[f64]| {
            let found = measure(values, 2.0);
            assert!(found.order.is_none());
            (found.trend, found.extrapolated, found.band)
        };
        assert_eq!(trend(&[1.0, 2.0, 1.5]), (Trend::Oscillating, None, None));
        assert_eq!(trend(&[1.0, 2.0, 0.0]), (Trend::Diverging, None, None));
        assert_eq!(trend(&[1.0, 2.0, 4.0]), (Trend::Diverging, None, None));
        assert_eq!(trend(&[1.0, 2.0, 3.0]), (Trend::Diverging, None, None), "equal differences");
        assert_eq!(trend(&[1.0, 1.0, 3.0]), (Trend::Diverging, None, None));
        assert_eq!(trend(&[2.0, 2.0, 2.0]), (Trend::Unchanged, Some(2.0), Some(0.0)));
        assert_eq!(trend(&[0.0, 0.0, 0.0]), (Trend::Unchanged, Some(0.0), Some(0.0)));
        assert_eq!(trend(&[2.0 + 4e-15, 2.0 - 2e-15, 2.0]), (Trend::Unchanged, Some(2.0), Some(0.0)));
        assert_eq!(trend(&[1.0, 2.0, 2.0, 2.0]), (Trend::Unchanged, Some(2.0), Some(0.0)));
        assert_eq!(trend(&[1.0, 2.0, 2.0]), (Trend::Settled, Some(2.0), Some(0.0)));
        assert_eq!(trend(&[1.0, 2.0]), (Trend::TwoLevels, None, None));
        assert_eq!(trend(&[2.0, 2.0]), (Trend::Unchanged, Some(2.0), Some(0.0)));
        assert_eq!(trend(&[1.0, f64::NAN, 2.0]), (Trend::Incomplete, None, None));
        assert_eq!(trend(&[f64::INFINITY, 1.0, 2.0]), (Trend::Incomplete, None, None));
        assert_eq!(measure(&sequence(1.0, 1.0, 0.2, 2.0, 3), 2.0).words(), "monotone, slowly");
        assert_eq!(
            measure(&sequence(1.0, 1.0, 6.0, 2.0, 3), 2.0).words(),
            "monotone, too fast for the method"
        );
    }

    #[test]
    fn checks_are_judged_by_the_whole_band() {
        // Limit 1, band 0.0125.
        let measures =
            [measure(&[1.16, 1.04, 1.01], 2.0), MeasureConvergence::new("g", "m", vec![1.0, 2.0, 4.0], 2.0)];
        let verdict = |name: &str, reference: f64, tolerance: f64| {
            let check = Check::within(name, 1.01, "m", reference, tolerance, "");
            CheckConvergence::new(check, &measures).extrapolated
        };
        assert_eq!(verdict("f", 1.0, 0.02), Verdict::Passed);
        assert_eq!(verdict("f", 1.0, 0.01), Verdict::Undecided);
        assert_eq!(verdict("f", 1.1, 0.05), Verdict::Failed);
        assert_eq!(verdict("f", 0.0, 1.1), Verdict::Passed, "the tolerance of zero is absolute");
        assert_eq!(verdict("g", 4.0, 0.1), Verdict::Unknown);
        assert_eq!(verdict("h", 4.0, 0.1), Verdict::Unknown);
    }

    /// Study with a measure of first order, an unchanged one, a diverging one, and a failed level.
    fn study() -> Convergence {
        let of = |name: &str, values: [f64; 3]| MeasureConvergence::new(name, "m", values.to_vec(), 2.0);
        let measures = vec![
            of("length", [1.4, 1.2, 1.1]),
            of("height, \"mean\"", [2.0, 2.0, 2.0]),
            of("depth", [1.0, 2.0, 4.0]),
        ];
        let check = Check::within("length", 1.1, "m", 1.0, 0.05, "exact");
        let level =
            |n: i32| Level { folder: format!("00{}", n + 1), factor: 0.5f64.powi(n), ..Level::default() };
        Convergence {
            case: "A <bar>".into(),
            ratio: 2.0,
            refined: vec![RefinedKey {
                key: "method.mpm.cell".into(),
                unit: "m".into(),
                values: vec![0.004, 0.002, 0.001],
            }],
            levels: (0..3).map(level).collect(),
            checks: vec![CheckConvergence::new(check, &measures)],
            measures,
        }
    }

    #[test]
    fn the_table_is_for_people_and_programs() {
        let study = study();
        let lines = study.lines().join("\n");
        for words in [
            "measure",
            "4 mm",
            "1 mm",
            "± 0.12",
            "unchanged within rounding",
            "does not converge: differences between levels do not fall; localisation or contact may need finer cells",
            "check length: finest FAILED (1.1), extrapolated undecided",
        ] {
            assert!(lines.contains(words), "no {words:?} in\n{lines}");
        }
        let csv = study.csv().expect("a table");
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
        assert_eq!(
            rows.iter().map(|row| row[0].to_string()).collect::<Vec<_>>(),
            ["method.mpm.cell", "length", "height, \"mean\"", "depth"]
        );
        assert!(rows[1][5].starts_with('1') && rows[3][5].is_empty(), "{csv}");
        let json = serde_json::to_value(&study).expect("JSON");
        assert_eq!(json["checks"][0]["extrapolated"], "undecided");
        assert_eq!(json["measures"][2]["trend"], "diverging");
        assert!(study.chart().expect("a chart").is_some());
    }
}
