//! The contact zone in a picture: closed parts as strong lines, open ones dashed, with their legend.

use super::outline;
use super::paint::View;
use crate::drawing::canvas::{self, Canvas, Colour};
use crate::drawing::raster::Raster;
use crate::pictures::paint;

/// A part of a side that may touch another body or an obstacle, usually the face of one element. If its ends coincide,
/// it is a single node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactMark {
    /// One end.
    pub from: [f64; 2],
    /// The other end.
    pub to: [f64; 2],
    /// Whether the part touches.
    pub closed: bool,
}

const CLOSED: Colour = Colour(0xe8, 0x10, 0x3c);
/// Widths of the white border on both sides of a line, together.
const BORDER: f64 = 1.4;
const SAMPLE: f64 = 34.0;
const DASH: [f64; 2] = [4.0, 3.0];
const LABELS: [(bool, &str); 2] = [(true, "in contact"), (false, "may touch, open")];

/// Height of the legend in logical pixels; zero without marks.
pub(super) fn legend_height(marks: &[ContactMark]) -> f64 {
    if marks.is_empty() {
        0.0
    } else {
        24.0
    }
}

/// Draws the marks; `spacing` is the width of a typical body in logical pixels.
pub(super) fn draw(raster: &mut Raster, marks: &[ContactMark], view: &View, spacing: f64) {
    // Where bodies are only a few pixels wide the marks must leave some of the field.
    let strong = (0.012 * spacing).clamp(1.8, 3.4).min(0.15 * spacing);
    let border = f64::min(BORDER, 0.08 * spacing);
    // Open marks are drawn first: closed ones must not be hidden where both meet.
    for closed in [false, true] {
        let these = || marks.iter().filter(move |m| m.closed == closed);
        let lines = these().filter(|m| m.from != m.to).map(|m| (m.from, m.to));
        for line in outline::joined(lines) {
            let line: Vec<_> = line.into_iter().map(|p| view.place(p)).collect();
            stroke(raster, &line, closed, [strong, border]);
        }
        for node in these().filter(|m| m.from == m.to) {
            let at = view.place(node.from);
            let radius = 1.2 * strong;
            raster.polygon(&canvas::circle(at, radius + 0.5 * border), Colour::WHITE);
            let ink = if closed { CLOSED } else { Colour(0, 0, 0) };
            raster.polygon(&canvas::circle(at, radius), ink);
            if !closed {
                raster.polygon(&canvas::circle(at, 0.6 * radius), Colour::WHITE);
            }
        }
    }
}

/// Draws samples of the two kinds of line, centred in a picture.
pub(super) fn legend(raster: &mut Raster, marks: &[ContactMark], middle: (f64, f64)) {
    let mut shown = LABELS.to_vec();
    shown.retain(|l| marks.iter().any(|m| m.closed == l.0));
    paint::legend(raster, &shown, SAMPLE, middle, |raster, (x, y), closed| {
        stroke(raster, &[(x, y), (x + SAMPLE, y)], *closed, [3.4, BORDER]);
    });
}

/// Draws a line with a white border, which is visible on every colour of a field and on the outline of a body.
fn stroke(raster: &mut Raster, line: &[(f64, f64)], closed: bool, [strong, border]: [f64; 2]) {
    if closed {
        raster.line(line, strong + border, Colour::WHITE, &[]);
        raster.line(line, strong, CLOSED, &[]);
    } else {
        raster.line(line, 0.3 * strong + border, Colour::WHITE, &[]);
        let thin = 0.3 * strong + 0.5 * border / BORDER;
        raster.line(line, thin, Colour(0, 0, 0), &DASH);
    }
}
