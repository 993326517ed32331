//! A series of a plot: points with their markers, line, and name in the legend.

use crate::drawing::canvas::{self, Canvas, CanvasPoint, Colour};

/// Shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// No marker.
    None,
    /// A disc.
    Circle,
    /// A square.
    Square,
    /// A square standing on its corner.
    Diamond,
    /// A triangle.
    Triangle,
}

/// The line that joins points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineStyle {
    /// No line.
    None,
    /// By a full line.
    Full,
    /// By a dashed line.
    Dashed,
    /// By a dotted line.
    Dotted,
}

/// A series of points.
#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend. Series of the same name in several panels appear there once; an empty name does not appear.
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
    /// The line that joins the points.
    pub line: LineStyle,
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
            line: LineStyle::Full,
        }
    }

    /// Changes the marker.
    #[must_use]
    pub fn marker(mut self, marker: Marker, filled: bool, size: f64) -> Self {
        (self.marker, self.filled, self.size) = (marker, filled, size);
        self
    }

    /// Removes the markers.
    #[must_use]
    pub fn line_only(self) -> Self {
        self.marker(Marker::None, false, 0.0)
    }

    /// Changes the line.
    #[must_use]
    pub fn line(mut self, line: LineStyle) -> Self {
        self.line = line;
        self
    }

    pub(super) fn draw(
        &self,
        canvas: &mut dyn Canvas,
        lines: &[Vec<CanvasPoint>],
        points: &[CanvasPoint],
    ) {
        let dash: &[f64] = match self.line {
            LineStyle::Dashed => &[7.0, 4.0],
            LineStyle::Dotted => &[2.0, 3.0],
            _ => &[],
        };
        if self.line != LineStyle::None {
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
    fn shape(self, (x, y): CanvasPoint, r: f64) -> Option<Vec<CanvasPoint>> {
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
