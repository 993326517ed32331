//! Tables: aligned text for terminals and CSV for programs.

use crate::output;
use base::Result;
use serde_json::Value;
use std::fmt;
use std::path::Path;

/// A table of texts. Rules may stand between rows; only terminals show them.
#[derive(Debug, Clone)]
pub struct Table {
    columns: Vec<Column>,
    rows: usize,
    /// Rows below a rule.
    rules: Vec<usize>,
}

#[derive(Debug, Clone)]
struct Column {
    name: String,
    /// Words are aligned on the left, numbers on the right.
    words: bool,
    cells: Vec<String>,
}

/// A table that is being built, with a row for each item. A column is a name, and a cell as a function of the item.
pub struct Columns<R> {
    items: Vec<R>,
    table: Table,
}

impl Table {
    /// A table without columns, with a row for each of these items.
    pub fn of<R>(items: impl IntoIterator<Item = R>) -> Columns<R> {
        let items: Vec<R> = items.into_iter().collect();
        let table = Table {
            columns: Vec::new(),
            rows: items.len(),
            rules: Vec::new(),
        };
        Columns { items, table }
    }

    /// The names of the columns, then the cells of each row.
    fn lines(&self) -> impl Iterator<Item = Vec<&str>> {
        let names = self.columns.iter().map(|c| c.name.as_str()).collect();
        let row = |k: usize| self.columns.iter().map(|c| c.cells[k].as_str()).collect();
        std::iter::once(names).chain((0..self.rows).map(row))
    }

    /// The table as CSV by RFC 4180 (with plain line feeds), header first.
    pub fn to_csv(&self) -> String {
        let line = |cells: Vec<&str>| {
            let cells: Vec<String> = cells.into_iter().map(quoted).collect();
            cells.join(",") + "\n"
        };
        self.lines().map(line).collect()
    }

    /// Writes [`Table::to_csv`] to a file, or to standard output for `-`.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`] with the path.
    pub fn write_csv(&self, path: &Path) -> Result<()> {
        output::write_text(path, &self.to_csv())
    }
}

impl<R> Columns<R> {
    /// Adds a column of words.
    #[must_use]
    pub fn words<D: fmt::Display>(
        self,
        name: impl Into<String>,
        cell: impl FnMut(&R) -> D,
    ) -> Self {
        self.column(name, true, cell)
    }

    /// Adds a column of numbers.
    #[must_use]
    pub fn numbers<D: fmt::Display>(
        self,
        name: impl Into<String>,
        cell: impl FnMut(&R) -> D,
    ) -> Self {
        self.column(name, false, cell)
    }

    /// Adds a column for programs: numbers in full precision, nothing for unknown values.
    #[must_use]
    pub fn exact<V: Into<Value>>(
        self,
        name: impl Into<String>,
        mut cell: impl FnMut(&R) -> V,
    ) -> Self {
        let text = |value: Value| match value {
            Value::Null => String::new(),
            Value::String(text) => text,
            Value::Number(n) if n.is_f64() => exactly(n.as_f64()),
            other => other.to_string(),
        };
        self.column(name, false, |item| text(cell(item).into()))
    }

    fn column<D: fmt::Display>(
        mut self,
        name: impl Into<String>,
        words: bool,
        mut cell: impl FnMut(&R) -> D,
    ) -> Self {
        self.table.columns.push(Column {
            name: name.into(),
            words,
            cells: self.items.iter().map(|r| cell(r).to_string()).collect(),
        });
        self
    }

    /// Adds the columns of `more`, if they are to be shown.
    #[must_use]
    pub fn when(self, shown: bool, more: impl FnOnce(Self) -> Self) -> Self {
        if shown {
            more(self)
        } else {
            self
        }
    }

    /// Puts a rule between two rows where `between` says so.
    #[must_use]
    pub fn rules(mut self, between: impl Fn(&R, &R) -> bool) -> Self {
        let pairs = self.items.windows(2).zip(1..);
        let ruled = pairs.filter(|(pair, _)| between(&pair[0], &pair[1]));
        self.table.rules = ruled.map(|(_, below)| below).collect();
        self
    }

    /// The finished table.
    pub fn table(self) -> Table {
        self.table
    }
}

impl fmt::Display for Table {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widest = |c: &Column| {
            let texts = c.cells.iter().chain([&c.name]);
            texts.map(|t| t.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = self.columns.iter().map(widest).collect();
        let dashes: Vec<String> = widths.iter().map(|&w| "─".repeat(w)).collect();
        let rule = dashes.join("──");
        for (k, line) in self.lines().enumerate() {
            if k > 1 && self.rules.contains(&(k - 1)) {
                writeln!(out, "{rule}")?;
            }
            let columns = self.columns.iter().zip(&widths);
            let padded = line.iter().zip(columns).map(|(cell, (c, &w))| {
                if c.words {
                    format!("{cell:<w$}")
                } else {
                    format!("{cell:>w$}")
                }
            });
            let text = padded.collect::<Vec<_>>().join("  ");
            writeln!(out, "{}", text.trim_end())?;
            if k == 0 {
                writeln!(out, "{rule}")?;
            }
        }
        Ok(())
    }
}

/// A cell of a CSV file.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_string()
    }
}

/// The shortest text that reads back as the same number; empty if the number is unknown or not finite.
fn exactly(x: Option<f64>) -> String {
    match x {
        Some(x) if x.is_finite() && (x == 0.0 || (1e-4..1e15).contains(&x.abs())) => format!("{x}"),
        Some(x) if x.is_finite() => format!("{x:e}"),
        _ => String::new(),
    }
}

/// A number with `digits` digits after the point; a dash when it is not known or not finite.
pub fn fixed(x: Option<f64>, digits: usize) -> String {
    match x {
        Some(x) if x.is_finite() => format!("{x:.digits$}"),
        _ => "–".to_string(),
    }
}

/// A small number such as a residual, as 1.2e-9; a dash when it is not known or not finite.
pub fn scientific(x: Option<f64>) -> String {
    match x {
        Some(x) if x.is_finite() => format!("{x:.1e}"),
        _ => "–".to_string(),
    }
}

/// A condition number; in fixed notation while it is small.
pub fn condition(x: Option<f64>) -> String {
    match x {
        Some(v) if v < 1e4 => fixed(x, 2),
        _ => scientific(x),
    }
}

/// A force or a distance with four digits; a dash when it is not finite.
pub fn value(x: f64) -> String {
    match x.abs() {
        _ if !x.is_finite() => "–".to_string(),
        0.0 => "0".to_string(),
        a if (1e-3..1e5).contains(&a) => {
            let digits = (3 - a.log10().floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.3e}"),
    }
}

/// A count; a dash when it is not known.
pub fn count(n: Option<usize>) -> String {
    n.map_or_else(|| "–".to_string(), |n| n.to_string())
}

#[cfg(test)]
#[path = "../../tests/tables/table.rs"]
mod tests;
