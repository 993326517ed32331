//! The interface between plots and their output formats, and the one font of all pictures. Two canvases exist:
//! [`super::raster::Raster`] (PNG) and [`super::svg::Svg`].
//!
//! The font is DejaVu Sans, embedded in the program: a picture looks the same on every machine.

use ab_glyph::{Font, FontRef, GlyphId};
use std::sync::OnceLock;

/// A position in logical pixels, y downwards.
pub type CanvasPoint = (f64, f64);

/// An opaque colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// Text and axes.
    pub const INK: Colour = Colour(0x22, 0x22, 0x22);
    /// Grid lines.
    pub const GRID: Colour = Colour(0xe4, 0xe4, 0xe4);
    /// The background.
    pub const WHITE: Colour = Colour(0xff, 0xff, 0xff);
    /// Eight colours that colour-blind readers can tell apart (Okabe and Ito).
    pub const CYCLE: [Colour; 8] = [
        Colour(0x00, 0x72, 0xb2),
        Colour(0xd5, 0x5e, 0x00),
        Colour(0x00, 0x9e, 0x73),
        Colour(0xcc, 0x79, 0xa7),
        Colour(0xe6, 0x9f, 0x00),
        Colour(0x56, 0xb4, 0xe9),
        Colour(0x80, 0x5a, 0x3c),
        Colour(0x66, 0x66, 0x66),
    ];
}

/// The part of a text that is placed at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The left end.
    Start,
    /// The middle.
    Middle,
    /// The right end.
    End,
}

impl Anchor {
    /// The part of a text's width that lies before its anchor.
    pub(super) fn share(self) -> f64 {
        match self {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        }
    }
}

/// The style of a text. In the text `_{...}` is a subscript and `^{...}` a superscript.
#[derive(Debug, Clone, Copy)]
pub struct TextStyle {
    /// Size in logical pixels.
    pub size: f64,
    /// Colour.
    pub colour: Colour,
    /// Horizontal anchor; the vertical one is the middle of the capital letters.
    pub anchor: Anchor,
    /// Bold instead of regular.
    pub bold: bool,
    /// Whether the text reads upwards instead of to the right.
    pub upwards: bool,
}

impl TextStyle {
    /// Regular ink-coloured text that reads to the right.
    pub fn new(size: f64, anchor: Anchor) -> Self {
        TextStyle {
            size,
            colour: Colour::INK,
            anchor,
            bold: false,
            upwards: false,
        }
    }

    /// The style of titles: bold ink-coloured text, centred at its position.
    pub fn title(size: f64) -> Self {
        TextStyle {
            bold: true,
            ..TextStyle::new(size, Anchor::Middle)
        }
    }
}

/// A surface to draw on.
pub trait Canvas {
    /// Fills a polygon.
    fn polygon(&mut self, points: &[CanvasPoint], fill: Colour);
    /// Draws a polyline of a width; `dash` holds lengths of strokes and gaps in turn, and is empty for a full line.
    fn line(&mut self, points: &[CanvasPoint], width: f64, colour: Colour, dash: &[f64]);
    /// Draws a text with its anchor at a point.
    fn text(&mut self, at: CanvasPoint, text: &str, style: &TextStyle);
}

/// The font, regular or bold.
pub(super) fn font(bold: bool) -> &'static FontRef<'static> {
    static REGULAR: OnceLock<FontRef<'static>> = OnceLock::new();
    static BOLD: OnceLock<FontRef<'static>> = OnceLock::new();
    let load = |bytes: &'static [u8]| {
        FontRef::try_from_slice(bytes).expect("the font inside the program is sound")
    };
    if bold {
        BOLD.get_or_init(|| load(dejavu::sans::bold()))
    } else {
        REGULAR.get_or_init(|| load(dejavu::sans::regular()))
    }
}

/// Height of the capital letters of DejaVu Sans over its em (1493 of 2048 font units).
pub(super) const CAP_HEIGHT: f64 = 0.729;

/// Font units per em.
pub(super) fn em(bold: bool) -> f64 {
    f64::from(font(bold).units_per_em().unwrap_or(2048.0))
}

/// A piece of a text in one size: its characters, its size and how far its baseline is raised.
pub(super) struct TextRun {
    pub text: String,
    pub size: f64,
    pub raise: f64,
}

/// Splits a text at its sub- and superscripts.
pub(super) fn runs(text: &str, size: f64) -> Vec<TextRun> {
    let mut out: Vec<TextRun> = Vec::new();
    let mut push = |text: &str, size: f64, raise: f64| {
        if !text.is_empty() {
            out.push(TextRun {
                text: text.to_string(),
                size,
                raise,
            });
        }
    };
    let mut rest = text;
    while let Some(start) = rest.find("_{").into_iter().chain(rest.find("^{")).min() {
        let Some(length) = rest[start..].find('}') else {
            break;
        };
        push(&rest[..start], size, 0.0);
        let raise = if rest[start..].starts_with('_') {
            -0.18
        } else {
            0.36
        };
        push(&rest[start + 2..start + length], 0.7 * size, raise * size);
        rest = &rest[start + length + 1..];
    }
    push(rest, size, 0.0);
    out
}

/// The glyphs of a run with their places behind its start, and its width, in logical pixels.
pub(super) fn glyphs(run: &TextRun, bold: bool) -> (Vec<(GlyphId, f64)>, f64) {
    let (font, unit) = (font(bold), run.size / em(bold));
    let mut out: Vec<(GlyphId, f64)> = Vec::new();
    let mut x = 0.0;
    for c in run.text.chars() {
        let id = font.glyph_id(c);
        if let Some((last, _)) = out.last() {
            x += unit * f64::from(font.kern_unscaled(*last, id));
        }
        out.push((id, x));
        x += unit * f64::from(font.h_advance_unscaled(id));
    }
    (out, x)
}

/// Width of a run in logical pixels.
pub(super) fn run_width(run: &TextRun, bold: bool) -> f64 {
    glyphs(run, bold).1
}

/// Width of a text in logical pixels.
pub fn text_width(text: &str, size: f64, bold: bool) -> f64 {
    runs(text, size)
        .iter()
        .map(|run| run_width(run, bold))
        .sum()
}

/// The text, shortened in its middle by an ellipsis if it does not fit into a width: in the name of an interface both
/// bodies remain visible.
pub fn shortened(text: &str, size: f64, bold: bool, width: f64) -> String {
    if text_width(text, size, bold) <= width {
        return text.to_string();
    }
    let letters: Vec<char> = text.chars().collect();
    let cut = |kept: usize| -> String {
        let start: String = letters[..kept.div_ceil(2)].iter().collect();
        let end: String = letters[letters.len() - kept / 2..].iter().collect();
        format!("{}…{}", start.trim_end(), end.trim_start())
    };
    let fits = |kept: &usize| text_width(&cut(*kept), size, bold) <= width;
    cut((1..letters.len()).rev().find(fits).unwrap_or(0))
}

/// Points of a circle as a polygon, fine enough for markers.
pub fn circle(centre: CanvasPoint, radius: f64) -> Vec<CanvasPoint> {
    (0..24)
        .map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / 24.0;
            (
                centre.0 + radius * angle.cos(),
                centre.1 + radius * angle.sin(),
            )
        })
        .collect()
}

#[cfg(test)]
#[path = "../../tests/drawing/canvas.rs"]
mod tests;
