//! Line and scatter plots with one or more panels, as PNG and SVG. The legend stands below the panels, never on the data.

use super::canvas::{self, Anchor, Canvas, Colour, Point, TextStyle};
use super::raster::Raster;
use super::svg::Svg;
use super::ticks::{self, Scale, Tick};
use crate::Result;
use std::path::{Path, PathBuf};

/// Shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Nothing.
    None,
    /// A disc.
    Circle,
    /// A square.
    Square,
    /// A square on its corner.
    Diamond,
    /// A triangle.
    Triangle,
}

/// How points are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// Not at all.
    None,
    /// By a full line.
    Full,
    /// By a dashed line.
    Dashed,
    /// By a dotted line.
    Dotted,
}

/// Points that belong together.
#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend; series of equal name in several panels appear there once; empty: not in the legend.
    pub label: String,
    /// (x, y). A point that the axes cannot show (NaN, ≤ 0 on a log axis) is left out and interrupts the line.
    pub points: Vec<(f64, f64)>,
    /// Colour of line and markers.
    pub colour: Colour,
    /// Shape of the points.
    pub marker: Marker,
    /// Filled or hollow markers.
    pub filled: bool,
    /// Radius of the markers in logical pixels.
    pub size: f64,
    /// How the points are joined.
    pub line: Line,
}

impl Series {
    /// Filled discs joined by a full line.
    pub fn new(label: impl Into<String>, points: Vec<(f64, f64)>, colour: Colour) -> Self {
        Series {
            label: label.into(),
            points,
            colour,
            marker: Marker::Circle,
            filled: true,
            size: 4.0,
            line: Line::Full,
        }
    }

    /// Changes the marker.
    #[must_use]
    pub fn marker(mut self, marker: Marker, filled: bool, size: f64) -> Self {
        (self.marker, self.filled, self.size) = (marker, filled, size);
        self
    }

    /// Changes the line.
    #[must_use]
    pub fn line(mut self, line: Line) -> Self {
        self.line = line;
        self
    }
}

/// One axis of a panel.
#[derive(Debug, Clone)]
pub struct Axis {
    /// What it measures; `_{...}` and `^{...}` are sub- and superscripts.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Where the ticks go; found automatically when empty.
    pub ticks: Vec<f64>,
    /// What it shows; everything when `None`.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// An axis with automatic range and ticks.
    pub fn new(label: impl Into<String>, scale: Scale) -> Self {
        Axis {
            label: label.into(),
            scale,
            ticks: Vec::new(),
            range: None,
        }
    }

    /// Puts labelled ticks at these numbers.
    #[must_use]
    pub fn at(mut self, ticks: impl Into<Vec<f64>>) -> Self {
        self.ticks = ticks.into();
        self
    }

    fn limits(&self, values: impl Iterator<Item = f64>) -> (f64, f64) {
        self.range
            .unwrap_or_else(|| ticks::range(values.chain(self.ticks.iter().copied()), self.scale))
    }

    fn marks(&self, limits: (f64, f64), wanted: usize) -> Vec<Tick> {
        if self.ticks.is_empty() {
            return ticks::ticks(limits.0, limits.1, self.scale, wanted);
        }
        let inside = self
            .ticks
            .iter()
            .filter(|&&t| t >= limits.0 && t <= limits.1);
        inside
            .map(|&at| Tick {
                at,
                label: ticks::number(at),
            })
            .collect()
    }
}

/// One plot.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Written above; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is shown, later ones on top.
    pub series: Vec<Series>,
}

/// Panels in a grid under one title and above one legend.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Written at the top; may be empty.
    pub title: String,
    /// Row by row.
    pub panels: Vec<Panel>,
    /// Panels per row.
    pub columns: usize,
    /// Width and height of one panel with its labels, in logical pixels.
    pub panel_size: (f64, f64),
}

const TEXT: f64 = 13.0;
const TICK_TEXT: f64 = 12.0;
const TITLE_TEXT: f64 = 15.0;
const MARGIN: f64 = 14.0;
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

    /// The legend's entries: the first series of every name.
    fn legend(&self) -> Vec<&Series> {
        let mut out: Vec<&Series> = Vec::new();
        for series in self.panels.iter().flat_map(|p| &p.series) {
            if !series.label.is_empty() && out.iter().all(|s| s.label != series.label) {
                out.push(series);
            }
        }
        out
    }

    /// Columns, rows and column width of the legend.
    fn legend_grid(&self, width: f64) -> (usize, usize, f64) {
        let entries = self.legend();
        let widest = entries
            .iter()
            .map(|s| canvas::text_width(&s.label, TEXT, false))
            .fold(0.0, f64::max);
        let column = SAMPLE + 8.0 + widest + 26.0;
        let columns = (((width - 2.0 * MARGIN) / column) as usize).clamp(1, entries.len().max(1));
        // As few columns as the same number of rows allows: five entries are 3 + 2, not 4 + 1.
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
            let style = TextStyle {
                bold: true,
                ..TextStyle::new(TITLE_TEXT, Anchor::Middle)
            };
            canvas.text(
                (0.5 * width, 0.5 * MARGIN + TITLE_TEXT),
                &self.title,
                &style,
            );
        }
        let left = 0.5 * (width - self.columns.max(1) as f64 * self.panel_size.0 - MARGIN);
        for (k, panel) in self.panels.iter().enumerate() {
            let (row, column) = (k / self.columns.max(1), k % self.columns.max(1));
            let x = left + column as f64 * self.panel_size.0;
            let y = self.title_height() + row as f64 * self.panel_size.1;
            panel.draw(canvas, (x, y), self.panel_size);
        }
        let (columns, rows, column) = self.legend_grid(width);
        let top = height - 0.5 * MARGIN - rows as f64 * LEGEND_LINE;
        let start = 0.5 * (width - columns as f64 * column + 26.0);
        for (k, series) in self.legend().into_iter().enumerate() {
            // Down the columns: neighbours in the list stand under each other.
            let (c, r) = (k / rows, k % rows);
            let (x, y) = (
                start + c as f64 * column,
                top + (r as f64 + 0.5) * LEGEND_LINE,
            );
            series.draw(
                canvas,
                &[vec![(x, y), (x + SAMPLE, y)]],
                &[(x + 0.5 * SAMPLE, y)],
            );
            canvas.text(
                (x + SAMPLE + 8.0, y),
                &series.label,
                &TextStyle::new(TEXT, Anchor::Start),
            );
        }
    }
}

impl Series {
    fn draw(&self, canvas: &mut dyn Canvas, lines: &[Vec<Point>], points: &[Point]) {
        let dash: &[f64] = match self.line {
            Line::Dashed => &[7.0, 4.0],
            Line::Dotted => &[2.0, 3.0],
            _ => &[],
        };
        if self.line != Line::None {
            for line in lines.iter().filter(|l| l.len() > 1) {
                canvas.line(line, 1.6, self.colour, dash);
            }
        }
        for &p in points {
            for (radius, colour) in [(self.size, self.colour), (self.size - 1.6, Colour::WHITE)] {
                if let Some(shape) = self.marker.shape(p, radius) {
                    canvas.polygon(&shape, colour);
                }
                if self.filled {
                    break;
                }
            }
        }
    }
}

impl Marker {
    fn shape(self, (x, y): Point, r: f64) -> Option<Vec<Point>> {
        let r = r.max(0.1);
        match self {
            Marker::None => None,
            Marker::Circle => Some(canvas::circle((x, y), r)),
            Marker::Square => {
                let s = 0.9 * r;
                Some(vec![
                    (x - s, y - s),
                    (x + s, y - s),
                    (x + s, y + s),
                    (x - s, y + s),
                ])
            }
            Marker::Diamond => {
                let s = 1.25 * r;
                Some(vec![(x, y - s), (x + s, y), (x, y + s), (x - s, y)])
            }
            Marker::Triangle => {
                let s = 1.3 * r;
                Some(vec![
                    (x, y - s),
                    (x + 0.87 * s, y + 0.5 * s),
                    (x - 0.87 * s, y + 0.5 * s),
                ])
            }
        }
    }
}

impl Panel {
    fn draw(&self, canvas: &mut dyn Canvas, at: Point, size: (f64, f64)) {
        let all = || self.series.iter().flat_map(|s| &s.points);
        let shown = |p: &&(f64, f64)| self.x.scale.shows(p.0) && self.y.scale.shows(p.1);
        let x_range = self.x.limits(all().filter(shown).map(|p| p.0));
        let y_range = self.y.limits(all().filter(shown).map(|p| p.1));
        let (x_ticks, y_ticks) = (self.x.marks(x_range, 6), self.y.marks(y_range, 5));

        let tick_width = y_ticks
            .iter()
            .map(|t| canvas::text_width(&t.label, TICK_TEXT, false))
            .fold(0.0, f64::max);
        let y_label = if self.y.label.is_empty() {
            0.0
        } else {
            1.7 * TEXT
        };
        let title = if self.title.is_empty() {
            10.0
        } else {
            2.0 * TEXT
        };
        let (x0, x1) = (
            at.0 + MARGIN + y_label + tick_width + 9.0,
            at.0 + size.0 - 4.0,
        );
        let (y0, y1) = (at.1 + title, at.1 + size.1 - 2.0 * TICK_TEXT - 2.2 * TEXT);
        let place = |scale: Scale, range: (f64, f64), v: f64| {
            (scale.forward(v) - scale.forward(range.0))
                / (scale.forward(range.1) - scale.forward(range.0))
        };
        let px = |v: f64| x0 + (x1 - x0) * place(self.x.scale, x_range, v);
        let py = |v: f64| y1 - (y1 - y0) * place(self.y.scale, y_range, v);

        if !self.title.is_empty() {
            let style = TextStyle {
                bold: true,
                ..TextStyle::new(TEXT, Anchor::Middle)
            };
            canvas.text((0.5 * (x0 + x1), at.1 + 0.8 * TEXT), &self.title, &style);
        }
        for t in &x_ticks {
            if !t.label.is_empty() {
                canvas.line(&[(px(t.at), y0), (px(t.at), y1)], 1.0, Colour::GRID, &[]);
            }
        }
        for t in &y_ticks {
            if !t.label.is_empty() {
                canvas.line(&[(x0, py(t.at)), (x1, py(t.at))], 1.0, Colour::GRID, &[]);
            }
        }
        // Labels that would touch their left neighbour are left out.
        let mut free = f64::NEG_INFINITY;
        for t in &x_ticks {
            let (x, length) = (px(t.at), if t.label.is_empty() { 3.0 } else { 5.0 });
            canvas.line(&[(x, y1), (x, y1 + length)], 1.0, Colour::INK, &[]);
            let half = 0.5 * canvas::text_width(&t.label, TICK_TEXT, false);
            if !t.label.is_empty() && x - half > free {
                canvas.text(
                    (x, y1 + 5.0 + 0.9 * TICK_TEXT),
                    &t.label,
                    &TextStyle::new(TICK_TEXT, Anchor::Middle),
                );
                free = x + half + 4.0;
            }
        }
        let mut free = f64::INFINITY;
        for t in &y_ticks {
            let (y, length) = (py(t.at), if t.label.is_empty() { 3.0 } else { 5.0 });
            canvas.line(&[(x0 - length, y), (x0, y)], 1.0, Colour::INK, &[]);
            if !t.label.is_empty() && y + 0.5 * TICK_TEXT < free {
                canvas.text(
                    (x0 - 9.0, y),
                    &t.label,
                    &TextStyle::new(TICK_TEXT, Anchor::End),
                );
                free = y - 0.5 * TICK_TEXT - 1.0;
            }
        }
        canvas.line(&[(x0, y0), (x0, y1), (x1, y1)], 1.2, Colour::INK, &[]);
        let below = y1 + 5.0 + 1.8 * TICK_TEXT + 0.8 * TEXT;
        canvas.text(
            (0.5 * (x0 + x1), below),
            &self.x.label,
            &TextStyle::new(TEXT, Anchor::Middle),
        );
        let style = TextStyle {
            upwards: true,
            ..TextStyle::new(TEXT, Anchor::Middle)
        };
        canvas.text(
            (at.0 + MARGIN + 0.4 * TEXT, 0.5 * (y0 + y1)),
            &self.y.label,
            &style,
        );

        let inside = |v: f64, r: (f64, f64)| v >= r.0 && v <= r.1;
        for series in &self.series {
            let mut lines = vec![Vec::new()];
            for p in &series.points {
                if shown(&p) && inside(p.0, x_range) && inside(p.1, y_range) {
                    lines
                        .last_mut()
                        .expect("never empty")
                        .push((px(p.0), py(p.1)));
                } else {
                    lines.push(Vec::new());
                }
            }
            let points: Vec<Point> = lines.iter().flatten().copied().collect();
            series.draw(canvas, &lines, &points);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes down what is drawn.
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
        let dir = super::super::output::tests::Scratch::new("plot");
        let paths = figure(Scale::Linear, vec![])
            .save(&dir.0.join("sub/fig.v1"))
            .unwrap();
        assert!(paths[0].ends_with("sub/fig.v1.png") && paths[1].ends_with("sub/fig.v1.svg"));
        assert!(paths
            .iter()
            .all(|p| std::fs::metadata(p).unwrap().len() > 500));
    }
}
