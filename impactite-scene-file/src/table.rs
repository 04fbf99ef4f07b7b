//! Piecewise linear functions of time.

use std::fmt::Write;

/// Values at points of time, linear between them, constant before the first and after the last one.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    times: Vec<f64>,
    values: Vec<f64>,
}

impl Table {
    /// Create a table from pairs of time, s, and value.
    ///
    /// # Errors
    /// Fewer than two points; numbers that are not finite; times that do not increase.
    pub fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, String> {
        let (times, values): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        if times.len() < 2 {
            return Err(format!("has {} points; at least 2 are needed", times.len()));
        }
        if let Some(n) = (0..times.len()).find(|&n| !(times[n].is_finite() && values[n].is_finite())) {
            return Err(format!("point {} is ({}, {}), which is not finite", n + 1, times[n], values[n]));
        }
        if let Some(n) = (1..times.len()).find(|&n| times[n] <= times[n - 1]) {
            let (before, here) = (times[n - 1], times[n]);
            return Err(format!("times must rise: point {} is at {here} s, after {before} s", n + 1));
        }
        Ok(Table { times, values })
    }

    /// Parse two columns, counted from 1, of a text with one row per line, in units of `units`. Separators are commas, semicolons, tabs or
    /// blanks. Lines before the first row of numbers are a heading; empty lines and those that begin with `#` are skipped.
    ///
    /// # Errors
    /// Row without the columns or with an invalid number, by its line; errors of [`Table::new`].
    pub fn of_columns(text: &str, columns: [usize; 2], units: [f64; 2]) -> Result<Self, String> {
        let mut points = Vec::new();
        for (n, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            match row(line, columns) {
                Ok([time, value]) => points.push((time * units[0], value * units[1])),
                Err(_) if points.is_empty() => {}
                Err(why) => return Err(format!("line {}: {why}", n + 1)),
            }
        }
        if points.is_empty() {
            let mut why = format!("has no row of numbers in columns {} and {}", columns[0], columns[1]);
            if let Some(first) = text.lines().find(|line| !line.trim().is_empty()) {
                let _ = write!(why, "; it begins with `{}`", first.chars().take(60).collect::<String>());
            }
            return Err(why);
        }
        Table::new(points)
    }

    /// Interpolate at a time, s.
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        let after = self.times.partition_point(|t| *t <= time);
        let (Some(before), true) = (after.checked_sub(1), after < self.times.len()) else {
            return self.values[after.saturating_sub(1)];
        };
        let part = (time - self.times[before]) / (self.times[after] - self.times[before]);
        self.values[before] + part * (self.values[after] - self.values[before])
    }
}

/// Parse two numbers of a line.
fn row(line: &str, columns: [usize; 2]) -> Result<[f64; 2], String> {
    let sign = [';', ',', '\t'].into_iter().find(|sign| line.contains(*sign));
    let cells: Vec<&str> = match sign {
        Some(sign) => line.split(sign).map(str::trim).collect(),
        None => line.split_whitespace().collect(),
    };
    let number = |column: usize| {
        let cell = column.checked_sub(1).and_then(|n| cells.get(n));
        let cell = cell.ok_or_else(|| format!("has {} columns; {column} is asked for", cells.len()))?;
        let cell = cell.trim_matches('"');
        cell.parse::<f64>().map_err(|_| format!("`{cell}` in column {column} is no number"))
    };
    Ok([number(columns[0])?, number(columns[1])?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_linear_between_points_and_constant_beyond() {
        let table = Table::new([(1.0, 10.0), (2.0, 20.0), (4.0, -20.0)]).expect("a table");
        for (time, value) in
            [(0.0, 10.0), (1.0, 10.0), (1.5, 15.0), (2.0, 20.0), (3.0, 0.0), (4.0, -20.0), (9.0, -20.0)]
        {
            assert_eq!(table.at(time), value, "at {time} s");
        }
    }

    #[test]
    fn files_of_other_programs_are_read() {
        let wanted = Table::new([(0.0, 0.0), (1e-3, 2e6)]).expect("a table");
        for text in [
            "0,0\n1,2\n",
            "\u{feff}time [ms],pressure [MPa]\r\n0,0\r\n1,2\r\n\r\n",
            "# a comment\ntime;p\n0;0\n1;2",
            "t\tp\n0\t0\n# in between\n1\t2\n",
            "  0   0\n  1   2e0\n",
            "\"0\",\"0\"\n\"1\",\"2\"\n",
        ] {
            assert_eq!(Table::of_columns(text, [1, 2], [1e-3, 1e6]), Ok(wanted.clone()), "{text:?}");
        }
        let third = Table::of_columns("n,p,t\n1,0,0\n2,2,1\n", [3, 2], [1e-3, 1e6]);
        assert_eq!(third, Ok(wanted));
    }

    #[test]
    fn what_is_no_table_is_refused_by_its_line() {
        let said = |text: &str| Table::of_columns(text, [1, 2], [1.0, 1.0]).expect_err("refused");
        assert!(said("0,0\n1,x\n").starts_with("line 2: `x` in column 2"), "{}", said("0,0\n1,x\n"));
        assert!(said("0,0\n1\n").starts_with("line 2: "));
        assert!(said("0,0\n1,1\n1,2\n").contains("times must rise: point 3"));
        assert!(said("a,b\nc,d\n").contains("no row of numbers") && said("").contains("no row"));
        assert!(said("0,0\n").contains("at least 2") && said("0,0\n1,inf\n").contains("not finite"));
    }
}
