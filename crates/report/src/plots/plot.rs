//! Line and scatter plots with one or more panels, as PNG and SVG. The legend stands below the panels, never on the
//! data.

use super::panel::{MARGIN, TEXT};
use crate::drawing::canvas::{self, Anchor, Canvas, CanvasPoint, TextStyle};
use crate::drawing::raster::Raster;
use crate::drawing::svg::Svg;
use base::Result;
use std::path::{Path, PathBuf};

pub use super::panel::{Axis, Band, Panel};
pub use super::series::{LineStyle, Marker, Series};

/// Panels in a grid under one title and above one legend.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Title at the top; may be empty.
    pub title: String,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels per row.
    pub columns: usize,
    /// Width and height of one panel with its labels, in logical pixels.
    pub panel_size: (f64, f64),
}

const TITLE_TEXT: f64 = 15.0;
const LEGEND_LINE: f64 = 22.0;
const SAMPLE: f64 = 34.0;

impl Figure {
    /// A figure of panels side by side.
    pub fn new(title: impl Into<String>, panels: Vec<Panel>) -> Self {
        let columns = panels.len().clamp(1, 3);
        let panel_size = if columns == 1 {
            (620.0, 400.0)
        } else {
            (380.0, 330.0)
        };
        Figure {
            title: title.into(),
            panels,
            columns,
            panel_size,
        }
    }

    /// Writes `stem`.png (two pixels per logical pixel) and `stem`.svg; returns their paths.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`] with the path.
    pub fn save(&self, stem: &Path) -> Result<Vec<PathBuf>> {
        let (width, height) = self.size();
        let named = |extension: &str| {
            let mut name = stem.as_os_str().to_os_string();
            name.push(extension);
            PathBuf::from(name)
        };
        let (png, svg) = (named(".png"), named(".svg"));
        let mut raster = Raster::new(width, height, 2.0);
        self.draw(&mut raster);
        raster.write_png(&png)?;
        let mut vector = Svg::new(width, height);
        self.draw(&mut vector);
        vector.write(&svg)?;
        Ok(vec![png, svg])
    }

    /// Size in logical pixels: width, height.
    pub fn size(&self) -> (f64, f64) {
        let (rows, width) = (
            self.panels.len().div_ceil(self.columns.max(1)).max(1),
            self.width(),
        );
        let legend = self.legend_grid(width).1 as f64 * LEGEND_LINE;
        (
            width,
            self.title_height() + rows as f64 * self.panel_size.1 + legend + MARGIN,
        )
    }

    fn width(&self) -> f64 {
        let content = self.columns.max(1) as f64 * self.panel_size.0 + MARGIN;
        content.max(canvas::text_width(&self.title, TITLE_TEXT, true) + 2.0 * MARGIN)
    }

    fn title_height(&self) -> f64 {
        if self.title.is_empty() {
            0.5 * MARGIN
        } else {
            2.2 * TITLE_TEXT + 0.5 * MARGIN
        }
    }

    /// The legend's entries: the first series of every name, then the first band of every name.
    fn legend(&self) -> Vec<LegendEntry<'_>> {
        let series = self.panels.iter().flat_map(|p| &p.series);
        let bands = self.panels.iter().flat_map(|p| &p.bands);
        let mut out: Vec<LegendEntry> = Vec::new();
        for entry in series
            .map(LegendEntry::Series)
            .chain(bands.map(LegendEntry::Band))
        {
            if !entry.label().is_empty() && out.iter().all(|e| e.label() != entry.label()) {
                out.push(entry);
            }
        }
        out
    }

    /// Columns, rows and column width of the legend.
    fn legend_grid(&self, width: f64) -> (usize, usize, f64) {
        let entries = self.legend();
        let widest = entries
            .iter()
            .map(|s| canvas::text_width(s.label(), TEXT, false))
            .fold(0.0, f64::max);
        let column = SAMPLE + 8.0 + widest + 26.0;
        let columns = (((width - 2.0 * MARGIN) / column) as usize).clamp(1, entries.len().max(1));
        // The number of columns is the smallest for this number of rows: five entries are 3 + 2, not 4 + 1.
        let rows = entries.len().div_ceil(columns);
        let columns = if rows == 0 {
            1
        } else {
            entries.len().div_ceil(rows)
        };
        (columns, rows, column)
    }

    /// Draws everything.
    pub fn draw(&self, canvas: &mut dyn Canvas) {
        let (width, height) = self.size();
        if !self.title.is_empty() {
            let at = (0.5 * width, 0.5 * MARGIN + TITLE_TEXT);
            canvas.text(at, &self.title, &TextStyle::title(TITLE_TEXT));
        }
        let left = 0.5 * (width - self.columns.max(1) as f64 * self.panel_size.0 - MARGIN);
        let mut label_width = vec![0.0_f64; self.columns.max(1)];
        for (k, panel) in self.panels.iter().enumerate() {
            let width = &mut label_width[k % self.columns.max(1)];
            *width = width.max(panel.label_width());
        }
        for (k, panel) in self.panels.iter().enumerate() {
            let (row, column) = (k / self.columns.max(1), k % self.columns.max(1));
            let x = left + column as f64 * self.panel_size.0;
            let y = self.title_height() + row as f64 * self.panel_size.1;
            panel.draw(canvas, (x, y), self.panel_size, label_width[column]);
        }
        let (columns, rows, column) = self.legend_grid(width);
        let top = height - 0.5 * MARGIN - rows as f64 * LEGEND_LINE;
        let start = 0.5 * (width - columns as f64 * column + 26.0);
        for (k, entry) in self.legend().into_iter().enumerate() {
            // Entries run down the columns: neighbours in the list are above each other.
            let (c, r) = (k / rows, k % rows);
            let (x, y) = (
                start + c as f64 * column,
                top + (r as f64 + 0.5) * LEGEND_LINE,
            );
            entry.draw(canvas, (x, y));
            canvas.text(
                (x + SAMPLE + 8.0, y),
                entry.label(),
                &TextStyle::new(TEXT, Anchor::Start),
            );
        }
    }
}

/// A line of the legend.
enum LegendEntry<'a> {
    Series(&'a Series),
    Band(&'a Band),
}

impl LegendEntry<'_> {
    fn label(&self) -> &str {
        match self {
            LegendEntry::Series(s) => &s.label,
            LegendEntry::Band(b) => &b.label,
        }
    }

    /// A sample of `SAMPLE` pixels to the right of a point.
    fn draw(&self, canvas: &mut dyn Canvas, (x, y): CanvasPoint) {
        let end = x + SAMPLE;
        match self {
            LegendEntry::Series(s) => {
                s.draw(canvas, &[vec![(x, y), (end, y)]], &[(x + 0.5 * SAMPLE, y)]);
            }
            LegendEntry::Band(b) => {
                let (top, bottom) = (y - 0.5 * TEXT, y + 0.5 * TEXT);
                let corners = [(x, top), (end, top), (end, bottom), (x, bottom)];
                canvas.polygon(&corners, b.colour);
            }
        }
    }
}

#[cfg(test)]
#[path = "../../tests/plots/plot.rs"]
mod tests;
