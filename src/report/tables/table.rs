//! Tables: aligned text for terminals and CSV for programs.

use crate::report::output;
use crate::Result;
use std::fmt;
use std::path::Path;

/// Alignment of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// For words.
    Left,
    /// For numbers.
    Right,
}

/// A table of texts. Rules may be put between rows; only terminals show them.
#[derive(Debug, Clone)]
pub struct Table {
    header: Vec<String>,
    align: Vec<Align>,
    rows: Vec<Vec<String>>,
    rules: Vec<usize>,
}

impl Table {
    /// An empty table with right-aligned columns of these names.
    pub fn new<S: Into<String>>(header: impl IntoIterator<Item = S>) -> Self {
        let header: Vec<String> = header.into_iter().map(Into::into).collect();
        Table {
            align: vec![Align::Right; header.len()],
            header,
            rows: Vec::new(),
            rules: Vec::new(),
        }
    }

    /// Changes the alignment of one column, counted from zero; a column that does not exist is ignored.
    #[must_use]
    pub fn align(mut self, column: usize, align: Align) -> Self {
        if let Some(a) = self.align.get_mut(column) {
            *a = align;
        }
        self
    }

    /// Appends a row; missing cells are empty, surplus ones are dropped.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        let mut cells: Vec<String> = cells.into_iter().map(Into::into).collect();
        cells.resize(self.header.len(), String::new());
        self.rows.push(cells);
    }

    /// Puts a rule after the last row.
    pub fn rule(&mut self) {
        self.rules.push(self.rows.len());
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The table as CSV by RFC 4180 (with plain line feeds), header first.
    pub fn to_csv(&self) -> String {
        let mut text = String::new();
        for row in std::iter::once(&self.header).chain(&self.rows) {
            let cells: Vec<String> = row.iter().map(|c| quoted(c)).collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text
    }

    /// Writes [`Table::to_csv`] to a file, or to standard output for `-`.
    ///
    /// # Errors
    /// [`crate::Error::Environment`] with the path.
    pub fn write_csv(&self, path: &Path) -> Result<()> {
        output::write_text(path, &self.to_csv())
    }
}

impl fmt::Display for Table {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut widths = vec![0; self.header.len()];
        for row in std::iter::once(&self.header).chain(&self.rows) {
            for (w, cell) in widths.iter_mut().zip(row) {
                *w = (*w).max(cell.chars().count());
            }
        }
        let rule = widths
            .iter()
            .map(|&w| "─".repeat(w))
            .collect::<Vec<_>>()
            .join("──");
        let line = |row: &[String]| {
            let mut text = String::new();
            for (k, ((cell, &w), align)) in row.iter().zip(&widths).zip(&self.align).enumerate() {
                if k > 0 {
                    text.push_str("  ");
                }
                match align {
                    Align::Left => text.push_str(&format!("{cell:<w$}")),
                    Align::Right => text.push_str(&format!("{cell:>w$}")),
                }
            }
            text.trim_end().to_string()
        };
        writeln!(out, "{}", line(&self.header))?;
        writeln!(out, "{rule}")?;
        for (k, row) in self.rows.iter().enumerate() {
            if k > 0 && self.rules.contains(&k) {
                writeln!(out, "{rule}")?;
            }
            writeln!(out, "{}", line(row))?;
        }
        Ok(())
    }
}

/// A cell of a CSV file.
pub(crate) fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_string()
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
#[path = "../../../tests/inside/report/tables/table.rs"]
mod tests;
