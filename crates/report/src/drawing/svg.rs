//! A canvas of SVG elements.

use super::canvas::{Anchor, Canvas, CanvasPoint, Colour, TextStyle};
use crate::drawing::canvas;
use crate::output;
use base::Result;
use std::fmt::Write;
use std::path::Path;

/// An SVG picture.
pub struct Svg {
    width: f64,
    height: f64,
    body: String,
}

impl Svg {
    /// A white picture of width × height pixels.
    pub fn new(width: f64, height: f64) -> Self {
        Svg {
            width,
            height,
            body: String::new(),
        }
    }

    /// The picture as text.
    pub fn to_text(&self) -> String {
        let (w, h) = (self.width, self.height);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" font-family=\"'DejaVu Sans', Verdana, sans-serif\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }

    /// Writes the picture.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`] with the path.
    pub fn write(&self, path: &Path) -> Result<()> {
        output::write_text(path, &self.to_text())
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        self.body
            .write_fmt(element)
            .expect("writing to a String cannot fail");
        self.body.push('\n');
    }
}

fn hex(c: Colour) -> String {
    format!("#{:02x}{:02x}{:02x}", c.0, c.1, c.2)
}

/// A number with at most two digits after the point: a hundredth of a pixel is invisible.
fn short(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}

fn list(points: &[CanvasPoint]) -> String {
    let pairs: Vec<String> = points
        .iter()
        .map(|p| format!("{},{}", short(p.0), short(p.1)))
        .collect();
    pairs.join(" ")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

impl Canvas for Svg {
    fn polygon(&mut self, points: &[CanvasPoint], fill: Colour) {
        self.push(format_args!(
            "<polygon points=\"{}\" fill=\"{}\"/>",
            list(points),
            hex(fill)
        ));
    }

    fn line(&mut self, points: &[CanvasPoint], width: f64, colour: Colour, dash: &[f64]) {
        let dash = if dash.is_empty() {
            String::new()
        } else {
            let lengths: Vec<String> = dash.iter().map(f64::to_string).collect();
            format!(" stroke-dasharray=\"{}\"", lengths.join(" "))
        };
        let colour = hex(colour);
        self.push(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" \
             stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}/>",
            list(points)
        ));
    }

    fn text(&mut self, at: CanvasPoint, text: &str, style: &TextStyle) {
        let runs = canvas::runs(text, style.size);
        let down = 0.5 * canvas::CAP_HEIGHT * style.size;
        let weight = if style.bold {
            " font-weight=\"bold\""
        } else {
            ""
        };
        let fill = hex(style.colour);
        // Sub- and superscripts become separate texts at computed places: not every viewer can anchor a text of several
        // pieces. A text of one piece is anchored by the viewer, and so fits the viewer's font.
        let total: f64 = runs
            .iter()
            .map(|run| canvas::run_width(run, style.bold))
            .sum();
        let (anchor, mut x) = match style.anchor {
            Anchor::Middle if runs.len() == 1 => ("middle", 0.0),
            Anchor::End if runs.len() == 1 => ("end", 0.0),
            anchor => ("start", -anchor.share() * total),
        };
        for run in runs {
            let place = if style.upwards {
                format!(
                    "transform=\"translate({} {}) rotate(-90)\" x=\"{}\" y=\"{}\"",
                    short(at.0),
                    short(at.1),
                    short(x),
                    short(down - run.raise)
                )
            } else {
                format!(
                    "x=\"{}\" y=\"{}\"",
                    short(at.0 + x),
                    short(at.1 + down - run.raise)
                )
            };
            self.push(format_args!(
                "<text {place} text-anchor=\"{anchor}\" font-size=\"{}\" \
                 fill=\"{fill}\"{weight} xml:space=\"preserve\">{}</text>",
                short(run.size),
                escaped(&run.text)
            ));
            x += canvas::run_width(&run, style.bold);
        }
    }
}

#[cfg(test)]
#[path = "../../tests/drawing/svg.rs"]
mod tests;
