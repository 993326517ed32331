//! One panel of a plot: its axes and data.

use super::series::Series;
use crate::drawing::canvas::{self, Anchor, Canvas, CanvasPoint, Colour, TextStyle};
use crate::drawing::ticks::{self, Scale, Tick};

pub(super) const TEXT: f64 = 13.0;
const TICK_TEXT: f64 = 12.0;
pub(super) const MARGIN: f64 = 14.0;

/// One axis of a panel.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity on the axis; `_{...}` and `^{...}` are sub- and superscripts.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Positions of the ticks; if empty, they are chosen automatically.
    pub ticks: Vec<f64>,
    /// Range of the axis; `None`: the range of the data.
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
    /// Title above the panel; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The data; later series are drawn on top.
    pub series: Vec<Series>,
    /// Parts of the horizontal axis with a coloured background.
    pub bands: Vec<Band>,
}

/// A part of the horizontal axis with a coloured background.
#[derive(Debug, Clone)]
pub struct Band {
    /// Name in the legend, like that of a series.
    pub label: String,
    /// The two ends; a band of no width is drawn as a thin line.
    pub range: (f64, f64),
    /// Colour of the background.
    pub colour: Colour,
}

impl Panel {
    /// A panel without bands.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Panel {
            title: title.into(),
            x,
            y,
            series,
            bands: Vec::new(),
        }
    }

    /// A place in a figure's grid that stays empty.
    pub fn blank() -> Self {
        let axis = || Axis::new("", Scale::Linear);
        Panel::new("", axis(), axis(), Vec::new())
    }

    fn is_blank(&self) -> bool {
        self.series.is_empty() && self.title.is_empty() && self.y.label.is_empty()
    }

    /// The ranges of the axes.
    fn ranges(&self) -> [(f64, f64); 2] {
        let shown = || {
            let all = self.series.iter().flat_map(|s| &s.points);
            all.filter(|p| self.x.scale.shows(p.0) && self.y.scale.shows(p.1))
        };
        [
            self.x.limits(shown().map(|p| p.0)),
            self.y.limits(shown().map(|p| p.1)),
        ]
    }

    /// Width of the labels at the vertical axis.
    pub(super) fn label_width(&self) -> f64 {
        if self.is_blank() {
            return 0.0;
        }
        let ticks = self.y.marks(self.ranges()[1], 5);
        let widths = ticks
            .iter()
            .map(|t| canvas::text_width(&t.label, TICK_TEXT, false));
        widths.fold(0.0, f64::max)
    }

    /// Draws the panel. The labels at the vertical axis get the width `label_width`, or their own if that is larger;
    /// panels in one column get the same, so that their axes are aligned.
    pub(super) fn draw(
        &self,
        canvas: &mut dyn Canvas,
        at: CanvasPoint,
        size: (f64, f64),
        label_width: f64,
    ) {
        if self.is_blank() {
            return;
        }
        let shown = |p: &&(f64, f64)| self.x.scale.shows(p.0) && self.y.scale.shows(p.1);
        let [x_range, y_range] = self.ranges();
        let (x_ticks, y_ticks) = (self.x.marks(x_range, 6), self.y.marks(y_range, 5));

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
            at.0 + MARGIN + y_label + label_width + 9.0,
            at.0 + size.0 - 4.0,
        );
        let x_label = if self.x.label.is_empty() {
            0.9 * TEXT
        } else {
            2.2 * TEXT
        };
        let (y0, y1) = (at.1 + title, at.1 + size.1 - 2.0 * TICK_TEXT - x_label);
        let place = |scale: Scale, range: (f64, f64), v: f64| {
            (scale.forward(v) - scale.forward(range.0))
                / (scale.forward(range.1) - scale.forward(range.0))
        };
        let px = |v: f64| x0 + (x1 - x0) * place(self.x.scale, x_range, v);
        let py = |v: f64| y1 - (y1 - y0) * place(self.y.scale, y_range, v);

        if !self.title.is_empty() {
            let title = canvas::shortened(&self.title, TEXT, true, x1 - x0);
            let place = (0.5 * (x0 + x1), at.1 + 0.8 * TEXT);
            canvas.text(place, &title, &TextStyle::title(TEXT));
        }
        for band in &self.bands {
            let place = |v: f64| px(v).clamp(x0, x1);
            let (a, b) = (place(band.range.0), place(band.range.1));
            let air = (0.5 * (3.0 - (b - a))).max(0.0);
            let (a, b) = ((a - air).max(x0), (b + air).min(x1));
            canvas.polygon(&[(a, y0), (b, y0), (b, y1), (a, y1)], band.colour);
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
        // Labels that would touch their left neighbour are omitted.
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
            let points: Vec<CanvasPoint> = lines.iter().flatten().copied().collect();
            series.draw(canvas, &lines, &points);
        }
    }
}
