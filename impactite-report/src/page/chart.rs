//! Charts: data for the script of the page, and a static drawing for pages without scripts and for paper.

use maud::{Markup, html};

use crate::number::{is_energy_error, readable, significant};
use crate::record::Column;

/// Line chart over one axis, in displayed units.
pub(crate) struct Chart {
    pub title: String,
    x: Axis,
    unit: String,
    lines: Vec<Line>,
}

struct Axis {
    label: String,
    values: Vec<f64>,
}

struct Line {
    name: String,
    values: Vec<f64>,
}

/// Approximate maximum number of points of a line on the page.
const MOST_POINTS: usize = 2000;
/// Approximate maximum number of points of a line in the static drawing.
const MOST_DRAWN: usize = 400;
/// Maximum number of lines of a chart: the number of colours.
const MOST_LINES: usize = 8;
/// Maximum ratio of dimensionless numbers that share a chart.
const ALIKE: f64 = 1e3;

fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|x| x.is_finite()).fold(0.0, |most, x| most.max(x.abs()))
}

/// Chart columns over the first one: one chart per unit, and more if there are too many lines or if dimensionless numbers differ
/// too much in size. Step counters are omitted.
pub(crate) fn charts(title: &str, columns: &[Column]) -> Vec<Chart> {
    let Some((x, rest)) = columns.split_first() else { return Vec::new() };
    let mut groups: Vec<(String, Vec<&Column>)> = Vec::new();
    for column in rest.iter().filter(|c| c.name != "step") {
        let alike = |others: &[&Column]| {
            let [a, b] = [largest(&column.values), largest(&others[0].values)];
            column.unit != "-" || a == 0.0 || b == 0.0 || (a < ALIKE * b && b < ALIKE * a)
        };
        // Energy errors are shown in per cent everywhere.
        let unit = if is_energy_error(&column.name, &column.unit) { "%" } else { &column.unit };
        let there = groups
            .iter_mut()
            .find(|(u, others)| u == unit && others.len() < MOST_LINES && (unit == "%" || alike(others)));
        match there {
            Some((_, others)) => others.push(column),
            None => groups.push((unit.into(), vec![column])),
        }
    }
    let several = groups.len() > 1;
    let chart = |(_, columns): (String, Vec<&Column>)| {
        let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
        let title = if several { format!("{title}: {}", names.join(", ")) } else { title.to_string() };
        Chart::new(title, x, &columns)
    };
    groups.into_iter().map(chart).collect()
}

impl Chart {
    /// Create a chart of these columns, of one unit, over `x`.
    pub(crate) fn new(title: String, x: &Column, columns: &[&Column]) -> Self {
        let most = columns.iter().fold(0.0, |most: f64, c| most.max(largest(&c.values)));
        let is_error = |c: &Column| is_energy_error(&c.name, &c.unit);
        let (unit, factor) = match columns.first() {
            Some(column) if is_error(column) => ("%".into(), 1.0),
            Some(column) => readable(most, &column.unit),
            None => ("-".into(), 1.0),
        };
        let factor = |c: &Column| if is_error(c) { 100.0 } else { factor };
        let (x_unit, x_factor) = readable(largest(&x.values), &x.unit);
        let label = if x_unit == "-" { x.name.clone() } else { format!("{} [{x_unit}]", x.name) };
        let rows: Vec<usize> = (0..x.values.len()).filter(|&n| x.values[n].is_finite()).collect();
        let taken = |values: &[f64], factor: f64| {
            rows.iter().map(|&n| values.get(n).map_or(f64::NAN, |v| v * factor)).collect()
        };
        let line = |c: &&Column| Line { name: c.name.clone(), values: taken(&c.values, factor(c)) };
        let lines: Vec<Line> = columns.iter().map(line).collect();
        let whole = Chart { title, x: Axis { label, values: taken(&x.values, x_factor) }, unit, lines };
        whole.thinned(MOST_POINTS)
    }

    /// True if the chart has at least one line with two finite points.
    pub(crate) fn shows(&self) -> bool {
        let numbers = |line: &Line| line.values.iter().filter(|v| v.is_finite()).count();
        self.lines.iter().any(|line| numbers(line) >= 2)
    }

    /// Thin out to about `most` points, with the extremes of every line.
    fn thinned(&self, most: usize) -> Chart {
        let rows = self.x.values.len();
        let mut kept: Vec<usize> = if rows <= most {
            (0..rows).collect()
        } else {
            let parts = (most / (2 * self.lines.len().max(1))).max(1);
            let mut kept = vec![0, rows - 1];
            for part in 0..parts {
                let range = part * rows / parts..(part + 1) * rows / parts;
                for line in &self.lines {
                    let finite = range.clone().filter(|&n| line.values[n].is_finite());
                    let by = |a: &usize, b: &usize| line.values[*a].total_cmp(&line.values[*b]);
                    kept.extend(finite.clone().min_by(by));
                    kept.extend(finite.max_by(by));
                }
            }
            kept
        };
        kept.sort_unstable();
        kept.dedup();
        let of = |values: &[f64]| kept.iter().map(|&n| values[n]).collect();
        let line = |l: &Line| Line { name: l.name.clone(), values: of(&l.values) };
        Chart {
            title: self.title.clone(),
            x: Axis { label: self.x.label.clone(), values: of(&self.x.values) },
            unit: self.unit.clone(),
            lines: self.lines.iter().map(line).collect(),
        }
    }

    /// True if x is ascending, as the script requires.
    pub(crate) fn is_ordered(&self) -> bool {
        self.x.values.windows(2).all(|w| w[0] <= w[1])
    }

    /// Export the data for the script.
    pub(crate) fn json(&self) -> serde_json::Value {
        // Seven digits: more than the resolution of a screen, and half the length; more digits for nearly constant values.
        let list = |values: &[f64]| -> serde_json::Value {
            let (low, high) = ends(values);
            let digits = digits(low.abs().max(high.abs()), high - low, 6) + 1;
            let short =
                |x: f64| significant(x, digits).parse::<f64>().ok().and_then(serde_json::Number::from_f64);
            values.iter().map(|&x| short(x).map_or(serde_json::Value::Null, Into::into)).collect()
        };
        let data: Vec<serde_json::Value> = [&self.x.values]
            .into_iter()
            .chain(self.lines.iter().map(|l| &l.values))
            .map(|v| list(v))
            .collect();
        let names: Vec<&str> = self.lines.iter().map(|l| l.name.as_str()).collect();
        serde_json::json!({ "x": self.x.label, "unit": self.unit, "lines": names, "data": data })
    }

    /// Label of the vertical axis.
    fn vertical(&self) -> String {
        match (self.lines.as_slice(), self.unit.as_str()) {
            ([line], "-") => line.name.clone(),
            ([line], unit) => format!("{} [{unit}]", line.name),
            (_, "-") => String::new(),
            (_, unit) => format!("[{unit}]"),
        }
    }

    /// Draw the chart as static SVG, with the names of its lines.
    pub(crate) fn drawn(&self) -> Markup {
        const SIZE: [f64; 2] = [560.0, 280.0];
        const LEFT: f64 = 66.0;
        const TOP: f64 = 26.0;
        const RIGHT: f64 = 16.0;
        const BOTTOM: f64 = 44.0;
        let thin = self.thinned(MOST_DRAWN);
        let x = Range::of(&thin.x.values, 0.0);
        let all: Vec<f64> = thin.lines.iter().flat_map(|l| l.values.iter().copied()).collect();
        let y = Range::of(&all, 0.05);
        let at_x = |v: f64| LEFT + x.part(v) * (SIZE[0] - LEFT - RIGHT);
        let at_y = |v: f64| SIZE[1] - BOTTOM - y.part(v) * (SIZE[1] - TOP - BOTTOM);
        let points = |line: &Line| {
            let pairs = thin.x.values.iter().zip(&line.values);
            // NaN or infinity interrupts the line.
            let mut path = String::new();
            let mut begins = true;
            for (&u, &v) in pairs {
                if v.is_finite() {
                    let command = if begins { 'M' } else { 'L' };
                    path += &format!("{command}{:.1} {:.1}", at_x(u), at_y(v));
                }
                begins = !v.is_finite();
            }
            path
        };
        html! {
            svg viewBox=(format!("0 0 {} {}", SIZE[0], SIZE[1])) role="img" aria-label=(self.title) {
                @for tick in y.ticks(5) {
                    line.grid x1=(LEFT) x2=(SIZE[0] - RIGHT) y1=(tenth(at_y(tick))) y2=(tenth(at_y(tick))) {}
                    text x=(LEFT - 8.0) y=(tenth(at_y(tick) + 4.5)) text-anchor="end" { (y.label(tick)) }
                }
                @for tick in x.ticks(6) {
                    line.grid x1=(tenth(at_x(tick))) x2=(tenth(at_x(tick))) y1=(TOP) y2=(SIZE[1] - BOTTOM) {}
                    text x=(tenth(at_x(tick))) y=(SIZE[1] - BOTTOM + 18.0) text-anchor="middle" { (x.label(tick)) }
                }
                @for (n, line) in thin.lines.iter().enumerate() {
                    path class=(format!("line c{}", n + 1)) d=(points(line)) {}
                }
                text.faint x="4" y="14" { (self.vertical()) }
                text.faint x=(SIZE[0] - RIGHT) y=(SIZE[1] - 6.0) text-anchor="end" { (self.x.label) }
            }
            @if self.lines.len() > 1 {
                div.legend {
                    @for (n, line) in self.lines.iter().enumerate() {
                        span { i class=(format!("c{}", n + 1)) {} (line.name) }
                    }
                }
            }
        }
    }
}

/// Charts drawn by the script of a page, in order.
#[derive(Default)]
pub(crate) struct Charts {
    list: Vec<serde_json::Value>,
}

impl Charts {
    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Figure of a chart: a static drawing, which the script replaces where possible.
    fn figure(&mut self, chart: &Chart) -> Markup {
        let number = chart.is_ordered().then(|| {
            self.list.push(chart.json());
            self.list.len() - 1
        });
        html! { figure.chart data-chart=[number] { figcaption { (chart.title) } (chart.drawn()) } }
    }

    /// Figures of the charts that have data.
    pub(crate) fn figures(&mut self, charts: &[Chart]) -> Option<Markup> {
        let mut figures: Vec<Markup> = charts.iter().filter(|c| c.shows()).map(|c| self.figure(c)).collect();
        match figures.len() {
            0 => None,
            1 => figures.pop(),
            _ => Some(html! { div.pair { @for figure in &figures { (figure) } } }),
        }
    }

    /// Export the data for a script element: `<` is escaped, since it could end the element.
    pub(crate) fn json(&self) -> String {
        serde_json::Value::from(self.list.clone()).to_string().replace('<', "\\u003c")
    }
}

/// Number of digits that distinguish numbers of this size with differences up to `range`: `usual`, or more for nearly equal numbers.
fn digits(size: f64, range: f64, usual: usize) -> usize {
    let alike = (size / range).log10().floor();
    if alike.is_finite() && alike > 0.0 { (usual.max(3 + alike as usize)).min(15) } else { usual }
}

fn tenth(x: f64) -> String {
    format!("{x:.1}")
}

/// Smallest and largest finite number; infinite in reverse order if there is none.
fn ends(values: &[f64]) -> (f64, f64) {
    let numbers = values.iter().copied().filter(|v| v.is_finite());
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
}

/// Range of an axis.
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// Create the range of all finite numbers, extended by a fraction on both sides.
    fn of(values: &[f64], more: f64) -> Self {
        let (mut low, mut high) = ends(values);
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        if low == high {
            let half = if low == 0.0 { 0.5 } else { 0.5 * low.abs() };
            (low, high) = (low - half, high + half);
        }
        let more = more * (high - low);
        Range { low: low - more, high: high + more }
    }

    /// Normalized position between both ends, 0 to 1.
    fn part(&self, v: f64) -> f64 {
        (v - self.low) / (self.high - self.low)
    }

    /// Format a tick with enough digits to distinguish it from its neighbours: at least 6.
    fn label(&self, tick: f64) -> String {
        significant(tick, digits(self.low.abs().max(self.high.abs()), self.high - self.low, 6))
    }

    /// Choose round numbers within the range, about `count`.
    fn ticks(&self, count: usize) -> Vec<f64> {
        let raw = (self.high - self.low) / count as f64;
        let power = 10_f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= raw).unwrap_or(raw);
        let first = (self.low / step).ceil();
        let ticks = (0..=2 * count).map(|n| (first + n as f64) * step);
        ticks.take_while(|t| *t <= self.high + 1e-9 * step).map(|t| if t == 0.0 { 0.0 } else { t }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, unit: &str, values: impl IntoIterator<Item = f64>) -> Column {
        Column { name: name.into(), unit: unit.into(), values: values.into_iter().collect() }
    }

    #[test]
    fn a_chart_a_unit_and_an_energy_error_is_per_cent() {
        let columns = [
            column("time", "s", [0.0, 8.0e-5]),
            column("step", "-", [0.0, 100.0]),
            column("kinetic energy", "J", [2000.0, 100.0]),
            column("internal energy", "J", [0.0, 1900.0]),
            column("energy error", "-", [0.0, -0.012]),
            column("momentum error", "-", [0.0, 1e-15]),
            column("friction angle", "-", [0.3, 0.4]),
        ];
        let charts = charts("Ledger", &columns);
        let json: Vec<_> = charts.iter().map(Chart::json).collect();
        assert_eq!(charts.len(), 4);
        assert_eq!(json[0]["x"], "time [µs]");
        assert_eq!((&json[0]["unit"], &json[0]["data"][1][0]), (&"kJ".into(), &2.0.into()));
        assert_eq!(json[0]["lines"], serde_json::json!(["kinetic energy", "internal energy"]));
        assert_eq!((&json[1]["unit"], &json[1]["data"][1][1]), (&"%".into(), &(-1.2).into()));
        // Dimensionless numbers of very different sizes are not drawn together.
        assert_eq!(json[2]["lines"], serde_json::json!(["momentum error"]));
        assert_eq!(charts[0].title, "Ledger: kinetic energy, internal energy");
        assert!(charts.iter().all(|c| c.shows() && c.is_ordered()));
        assert_eq!(super::charts("nothing", &[]).len(), 0);
    }

    #[test]
    fn thinning_keeps_ends_and_peaks() {
        let x = column("time", "s", (0..100_000).map(f64::from));
        let mut y = column("force", "N", (0..100_000).map(|n| f64::from(n).sin()));
        (y.values[31_415], y.values[27_182]) = (77.0, f64::NAN);
        let chart = Chart::new("f".into(), &x, &[&y]);
        let xs = &chart.x.values;
        assert!(xs.len() > MOST_POINTS / 2 && xs.len() <= MOST_POINTS + 2, "{}", xs.len());
        assert_eq!((xs[0], xs[xs.len() - 1]), (0.0, 99_999.0));
        assert!(xs.contains(&31_415.0) && chart.is_ordered());
        let back = column("x", "m", [0.0, 1.0, 0.5]);
        assert!(!Chart::new("loop".into(), &back, &[&y]).is_ordered());
    }

    /// Mass that decreases by less than a millionth.
    #[test]
    fn ticks_of_numbers_nearly_the_same_differ() {
        let range = Range::of(&[53.0, 53.00002], 0.05);
        let ticks: Vec<String> = range.ticks(5).into_iter().map(|t| range.label(t)).collect();
        let mut different = ticks.clone();
        different.dedup();
        assert!(ticks.len() > 3 && different == ticks, "{ticks:?}");
        let x = column("time", "s", [0.0, 1.0]);
        let json = Chart::new("Mass".into(), &x, &[&column("mass", "kg", [53.0, 53.000_000_02])]).json();
        assert_ne!(json["data"][1][0], json["data"][1][1]);
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(
            Range::of(&[0.0, 80.0], 0.0).ticks(8),
            [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0]
        );
        assert_eq!(Range::of(&[3.0, 3.0, f64::NAN], 0.0).ticks(3), [2.0, 3.0, 4.0]);
        assert!(Range::of(&[f64::NAN], 0.0).ticks(3).len() > 1);
    }
}
