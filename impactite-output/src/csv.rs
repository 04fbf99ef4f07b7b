//! Histories: CSV files with one row of numbers per output time.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::{OutputError, WholeFile, check_name};

/// Column of a [`History`]: name and unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name of the quantity, such as "length".
    pub name: String,
    /// Unit, such as "m"; "" or "-" if dimensionless.
    pub unit: String,
}

impl Column {
    /// Create a column called `name` in `unit` ("-" if dimensionless).
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }

    /// Title in the header: `length [m]`.
    #[must_use]
    pub fn title(&self) -> String {
        let unit = if self.unit.is_empty() { "-" } else { &self.unit };
        format!("{} [{unit}]", self.name)
    }
}

impl From<(&str, &str)> for Column {
    fn from((name, unit): (&str, &str)) -> Self {
        Self::new(name, unit)
    }
}

/// CSV file that grows by one row per output time and is flushed after each row, so that it can be watched during
/// the run. Numbers have the shortest form that reads back to the same bits.
///
/// ```
/// use impactite_output::History;
/// # let folder = std::env::temp_dir().join("impactite-doc-history");
/// # std::fs::create_dir_all(&folder)?;
/// # let path = folder.join("bar.csv");
/// let mut history = History::create(&path, [("time", "s"), ("length", "m")])?;
/// history.push(&[0.0, 0.0324])?;
/// history.push(&[1.0e-6, 0.0322])?;
/// assert_eq!(std::fs::read_to_string(&path)?, "time [s],length [m]\n0,0.0324\n1e-6,0.0322\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct History {
    path: PathBuf,
    columns: Vec<Column>,
    file: BufWriter<File>,
    rows: usize,
}

impl History {
    /// Create (or replace) the file at `path`, with its header.
    ///
    /// # Errors
    /// No column, a name that is empty or used twice, a path that is no regular file, or a file that cannot be created.
    pub fn create<C: Into<Column>>(
        path: impl AsRef<Path>,
        columns: impl IntoIterator<Item = C>,
    ) -> Result<Self, OutputError> {
        let path = path.as_ref().to_path_buf();
        let columns: Vec<Column> = columns.into_iter().map(Into::into).collect();
        if columns.is_empty() {
            return Err(OutputError::value("number of columns", 0, "at least 1"));
        }
        for (i, column) in columns.iter().enumerate() {
            check_name("a column", &column.name)?;
            if columns[..i].iter().any(|c| c.name == column.name) {
                let name = column.name.clone();
                return Err(OutputError::Name { what: "a column", name, why: "each name may be used once" });
            }
        }
        let header: Vec<String> = columns.iter().map(|c| quoted(&c.title())).collect();
        let mut file = WholeFile::create(&path)?;
        writeln!(file, "{}", header.join(",")).map_err(OutputError::file("write", &path))?;
        let file = BufWriter::new(file.settle()?);
        Ok(Self { path, columns, file, rows: 0 })
    }

    /// Append a row, one number per column, and flush.
    ///
    /// # Errors
    /// A row of the wrong length (nothing is written), or a full disk.
    pub fn push(&mut self, row: &[f64]) -> Result<(), OutputError> {
        if row.len() != self.columns.len() {
            return Err(OutputError::Length {
                what: format!("row {} of `{}`", self.rows, self.path.display()),
                found: row.len(),
                expected: self.columns.len(),
            });
        }
        let line: Vec<String> = row.iter().map(|x| number(*x)).collect();
        self.write_line(&line.join(","))?;
        self.rows += 1;
        Ok(())
    }

    /// Columns.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Number of rows written.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn write_line(&mut self, line: &str) -> Result<(), OutputError> {
        let written = writeln!(self.file, "{line}").and_then(|()| self.file.flush());
        written.map_err(OutputError::file("write", &self.path))
    }
}

/// Format a number as the shortest text that reads back to the same bits: `0.0324`, `1e-6`, `NaN`.
fn number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || (1.0e-4..1.0e7).contains(&size) || !x.is_finite() {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// Quote a header that contains a comma or a quotation mark.
fn quoted(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}
