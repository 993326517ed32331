//! The contact zone in a picture: closed parts as strong lines, open ones dashed, with their legend.

use super::arrows::{self, Arrow};
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
    /// Whether and how the part touches.
    pub touch: Touch,
}

/// How a part of a side touches the other side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Touch {
    /// The sides are apart.
    Open,
    /// They touch without friction.
    Closed,
    /// They touch and stick.
    Sticks,
    /// They touch and slip.
    Slips,
}

impl Touch {
    /// All of them, in the order in which they are drawn: closed parts must not be hidden where they meet open ones.
    const ALL: [Touch; 4] = [Touch::Open, Touch::Closed, Touch::Slips, Touch::Sticks];

    /// The kind of a node of this state of friction; `touches` says whether a node that neither sticks nor slips
    /// touches, as one that given values hold does.
    pub fn of_state(state: Option<&str>, touches: bool) -> Touch {
        match (state, touches) {
            (Some("stick"), _) => Touch::Sticks,
            (Some("slip"), _) => Touch::Slips,
            (_, true) => Touch::Closed,
            (_, false) => Touch::Open,
        }
    }

    fn colour(self) -> Colour {
        match self {
            Touch::Open => Colour(0, 0, 0),
            Touch::Closed => CLOSED,
            Touch::Sticks => STICKS,
            Touch::Slips => SLIPS,
        }
    }

    fn label(self) -> &'static str {
        match self {
            Touch::Open => "may touch, open",
            Touch::Closed => "in contact",
            Touch::Sticks => "sticks",
            Touch::Slips => "slips",
        }
    }
}

/// Contact on the first field of a picture.
#[derive(Debug, Clone, Copy, Default)]
pub struct Marked<'a> {
    /// The parts of sides that may touch another body or an obstacle, as they are shown.
    pub contact: &'a [ContactMark],
    /// The stresses of contact with friction on the first body of each interface.
    pub tractions: &'a [Arrow],
}

const CLOSED: Colour = Colour(0xe8, 0x10, 0x3c);
/// Blue and orange, which also those tell apart who do not see red and green as different.
const STICKS: Colour = Colour(0x1b, 0x5f, 0xe0);
const SLIPS: Colour = Colour(0xff, 0x7f, 0x0e);
/// Widths of the white border on both sides of a line, together.
const BORDER: f64 = 1.4;
const SAMPLE: f64 = 34.0;
const DASH: [f64; 2] = [4.0, 3.0];

/// Width and height of the legend in logical pixels; zero without marks.
pub(super) fn legend_size(marks: &[ContactMark], arrow: Option<&str>) -> (f64, f64) {
    if marks.is_empty() {
        (0.0, 0.0)
    } else {
        let width = paint::legend_width(&entries(marks, arrow), SAMPLE);
        (width + BORDER + 16.0, 24.0)
    }
}

/// The kinds of line that there are, and the arrow, `None`, if it has a label.
fn entries<'a>(marks: &[ContactMark], arrow: Option<&'a str>) -> Vec<(Option<Touch>, &'a str)> {
    let order = [Touch::Closed, Touch::Sticks, Touch::Slips, Touch::Open];
    let there = order
        .iter()
        .filter(|t| marks.iter().any(|m| m.touch == **t));
    let lines = there.map(|t| (Some(*t), t.label()));
    lines.chain(arrow.map(|label| (None, label))).collect()
}

/// Draws the marks; `spacing` is the width of a typical body in logical pixels.
pub(super) fn draw(raster: &mut Raster, marks: &[ContactMark], view: &View, spacing: f64) {
    // Where bodies are only a few pixels wide the marks must leave some of the field.
    let strong = (0.012 * spacing).clamp(1.8, 3.4).min(0.15 * spacing);
    let border = f64::min(BORDER, 0.08 * spacing);
    for touch in Touch::ALL {
        let closed = touch != Touch::Open;
        let these = || marks.iter().filter(move |m| m.touch == touch);
        let lines = these().filter(|m| m.from != m.to).map(|m| (m.from, m.to));
        for line in outline::joined(lines) {
            let line: Vec<_> = line.into_iter().map(|p| view.place(p)).collect();
            stroke(raster, &line, touch, [strong, border]);
        }
        for node in these().filter(|m| m.from == m.to) {
            let at = view.place(node.from);
            let radius = 1.2 * strong;
            raster.polygon(&canvas::circle(at, radius + 0.5 * border), Colour::WHITE);
            raster.polygon(&canvas::circle(at, radius), touch.colour());
            if !closed {
                raster.polygon(&canvas::circle(at, 0.6 * radius), Colour::WHITE);
            }
        }
    }
}

/// Draws samples of the kinds of line, and of an arrow with its label if there is one, centred in a picture.
pub(super) fn legend(
    raster: &mut Raster,
    marks: &[ContactMark],
    arrow: Option<&str>,
    middle: (f64, f64),
) {
    let shown = entries(marks, arrow);
    paint::legend(raster, &shown, SAMPLE, middle, |raster, (x, y), what| {
        let to = (x + SAMPLE, y);
        match what {
            Some(touch) => stroke(raster, &[(x, y), to], *touch, [3.4, BORDER]),
            None => arrows::stroke(raster, (x, y), to),
        }
    });
}

/// Draws a line with a white border, which is visible on every colour of a field and on the outline of a body.
fn stroke(raster: &mut Raster, line: &[(f64, f64)], touch: Touch, [strong, border]: [f64; 2]) {
    if touch != Touch::Open {
        raster.line(line, strong + border, Colour::WHITE, &[]);
        raster.line(line, strong, touch.colour(), &[]);
    } else {
        raster.line(line, 0.3 * strong + border, Colour::WHITE, &[]);
        let thin = 0.3 * strong + 0.5 * border / BORDER;
        raster.line(line, thin, touch.colour(), &DASH);
    }
}
