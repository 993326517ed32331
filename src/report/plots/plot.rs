//! Line and scatter plots with one or more panels, as PNG and SVG. The legend stands below the panels, never on the
//! data.

use super::panel::{MARGIN, TEXT};
use crate::report::drawing::canvas::{self, Anchor, Canvas, Point, TextStyle};
use crate::report::drawing::raster::Raster;
use crate::report::drawing::svg::Svg;
use crate::Result;
use std::path::{Path, PathBuf};

pub use super::panel::{Axis, Band, Panel};
pub use super::series::{Line, Marker, Series};

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
    /// [`crate::Error::Environment`] with the path.
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
    fn legend(&self) -> Vec<Entry<'_>> {
        let series = self.panels.iter().flat_map(|p| &p.series);
        let bands = self.panels.iter().flat_map(|p| &p.bands);
        let mut out: Vec<Entry> = Vec::new();
        for entry in series.map(Entry::Series).chain(bands.map(Entry::Band)) {
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
enum Entry<'a> {
    Series(&'a Series),
    Band(&'a Band),
}

impl Entry<'_> {
    fn label(&self) -> &str {
        match self {
            Entry::Series(s) => &s.label,
            Entry::Band(b) => &b.label,
        }
    }

    /// A sample of `SAMPLE` pixels to the right of a point.
    fn draw(&self, canvas: &mut dyn Canvas, (x, y): Point) {
        let end = x + SAMPLE;
        match self {
            Entry::Series(s) => {
                s.draw(canvas, &[vec![(x, y), (end, y)]], &[(x + 0.5 * SAMPLE, y)]);
            }
            Entry::Band(b) => {
                let (top, bottom) = (y - 0.5 * TEXT, y + 0.5 * TEXT);
                let corners = [(x, top), (end, top), (end, bottom), (x, bottom)];
                canvas.polygon(&corners, b.colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::drawing::canvas::Colour;
    use crate::report::drawing::ticks::Scale;

    /// A canvas that records the calls.
    #[derive(Default)]
    struct Recorder {
        lines: Vec<(Vec<Point>, Colour)>,
        polygons: Vec<(Vec<Point>, Colour)>,
        texts: Vec<(Point, String)>,
    }

    impl Canvas for Recorder {
        fn polygon(&mut self, points: &[Point], fill: Colour) {
            self.polygons.push((points.to_vec(), fill));
        }
        fn line(&mut self, points: &[Point], _: f64, colour: Colour, _: &[f64]) {
            self.lines.push((points.to_vec(), colour));
        }
        fn text(&mut self, at: Point, text: &str, _: &TextStyle) {
            self.texts.push((at, text.to_string()));
        }
    }

    const RED: Colour = Colour(200, 0, 0);

    fn figure(scale: Scale, points: Vec<(f64, f64)>) -> Figure {
        let panel = Panel {
            title: "a".into(),
            x: Axis::new("x", Scale::Linear),
            y: Axis::new("y", scale),
            series: vec![Series::new("data", points, RED)],
            bands: Vec::new(),
        };
        Figure::new("both", vec![panel.clone(), panel])
    }

    #[test]
    fn points_lie_where_the_ticks_say() {
        let figure = figure(Scale::Log, vec![(0.0, 1.0), (1.0, 10.0), (2.0, 100.0)]);
        let mut drawn = Recorder::default();
        figure.draw(&mut drawn);
        let curve = &drawn.lines.iter().find(|l| l.1 == RED).unwrap().0;
        assert_eq!(curve.len(), 3);
        let label = |text: &str| drawn.texts.iter().find(|t| t.1 == text).unwrap().0;
        assert!(
            (label("10").1 - curve[1].1).abs() < 1e-9 && (label("100").1 - curve[2].1).abs() < 1e-9
        );
        assert!(
            (curve[1].1 - 0.5 * (curve[0].1 + curve[2].1)).abs() < 1e-9,
            "equal ratios are equal steps"
        );
        // A label in the legend once, although two panels have the series.
        assert_eq!(drawn.texts.iter().filter(|t| t.1 == "data").count(), 1);
    }

    #[test]
    fn everything_lies_inside_the_picture() {
        let figure = figure(Scale::Linear, vec![(0.0, -1e-7), (1e6, 2e-7)]);
        let mut drawn = Recorder::default();
        figure.draw(&mut drawn);
        let (w, h) = figure.size();
        let corners = drawn.lines.iter().chain(&drawn.polygons).flat_map(|l| &l.0);
        for p in corners.chain(drawn.texts.iter().map(|t| &t.0)) {
            assert!(p.0 > 0.0 && p.0 < w && p.1 > 0.0 && p.1 < h, "{p:?}");
        }
        // The legend lies below the axes' labels.
        let y = |text: &str| drawn.texts.iter().find(|t| t.1 == text).unwrap().0 .1;
        assert!(y("data") > y("x") + TEXT);
    }

    #[test]
    fn what_cannot_be_shown_interrupts_the_line() {
        let figure = figure(
            Scale::Log,
            vec![
                (0.0, 1.0),
                (1.0, 2.0),
                (2.0, 0.0),
                (3.0, 3.0),
                (4.0, f64::NAN),
            ],
        );
        let mut drawn = Recorder::default();
        figure.draw(&mut drawn);
        let curves: Vec<usize> = drawn
            .lines
            .iter()
            .filter(|l| l.1 == RED)
            .map(|l| l.0.len())
            .collect();
        assert_eq!(curves, [2, 2, 2]); // one per panel, and the sample in the legend
        assert_eq!(
            drawn.polygons.iter().filter(|p| p.1 == RED).count(),
            3 + 3 + 1
        );
    }

    #[test]
    fn both_files_are_written() {
        let dir = crate::report::output::tests::Scratch::new("plot");
        let paths = figure(Scale::Linear, vec![])
            .save(&dir.0.join("sub/fig.v1"))
            .unwrap();
        assert!(paths[0].ends_with("sub/fig.v1.png") && paths[1].ends_with("sub/fig.v1.svg"));
        assert!(paths
            .iter()
            .all(|p| std::fs::metadata(p).unwrap().len() > 500));
    }

    #[test]
    fn bands_lie_under_their_part_of_the_axis() {
        const BLUE: Colour = Colour(200, 220, 255);
        let mut figure = figure(Scale::Linear, vec![(0.0, 1.0), (1.0, 3.0), (2.0, 2e4)]);
        let band = |from: f64, to: f64| Band {
            label: "zone".into(),
            range: (from, to),
            colour: BLUE,
        };
        figure.panels[0].bands = vec![band(1.0, 2.0), band(0.0, 0.0), band(-9.0, -5.0)];
        figure.panels[1].series[0].points[2].1 = 4.0; // short labels: the axes would stand elsewhere
        figure.columns = 1;
        figure.panels.push(Panel::blank());
        let mut drawn = Recorder::default();
        figure.draw(&mut drawn);
        let curves: Vec<_> = drawn.lines.iter().filter(|l| l.1 == RED).collect();
        let at = |k: usize| curves[0].0[k].0;
        let bands: Vec<_> = drawn.polygons.iter().filter(|p| p.1 == BLUE).collect();
        assert_eq!(bands.len(), 3 + 1, "three in the panel, one in the legend");
        let ends = |k: usize| (bands[k].0[0].0, bands[k].0[1].0);
        assert!((ends(0).0 - at(1)).abs() < 1e-9 && (ends(0).1 - at(2)).abs() < 1e-9);
        assert!(
            ends(1).0 <= at(0) && ends(1).1 - ends(1).0 >= 1.5,
            "a single point is seen"
        );
        assert_eq!(drawn.texts.iter().filter(|t| t.1 == "zone").count(), 1);
        // Panels above each other have their axes in the same place.
        for k in 0..3 {
            assert!((curves[1].0[k].0 - at(k)).abs() < 1e-9);
        }
    }
}
