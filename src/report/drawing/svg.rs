//! A canvas of SVG elements.

use super::canvas::{self, Anchor, Canvas, Colour, Point, TextStyle};
use crate::report::output;
use crate::Result;
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
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"'DejaVu Sans', Verdana, sans-serif\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }

    /// Writes the picture.
    ///
    /// # Errors
    /// [`crate::Error::Environment`] with the path.
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

fn list(points: &[Point]) -> String {
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
    fn polygon(&mut self, points: &[Point], fill: Colour) {
        self.push(format_args!(
            "<polygon points=\"{}\" fill=\"{}\"/>",
            list(points),
            hex(fill)
        ));
    }

    fn line(&mut self, points: &[Point], width: f64, colour: Colour, dash: &[f64]) {
        let dash = if dash.is_empty() {
            String::new()
        } else {
            let lengths: Vec<String> = dash.iter().map(f64::to_string).collect();
            format!(" stroke-dasharray=\"{}\"", lengths.join(" "))
        };
        let colour = hex(colour);
        self.push(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}/>",
            list(points)
        ));
    }

    fn text(&mut self, at: Point, text: &str, style: &TextStyle) {
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
                "<text {place} text-anchor=\"{anchor}\" font-size=\"{}\" fill=\"{fill}\"{weight} xml:space=\"preserve\">{}</text>",
                short(run.size),
                escaped(&run.text)
            ));
            x += canvas::run_width(&run, style.bold);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_by_hand() {
        let mut svg = Svg::new(30.0, 20.0);
        svg.polygon(&[(0.0, 0.0), (1.005, 0.0), (1.0, 2.0)], Colour(255, 0, 16));
        svg.line(&[(0.0, 1.0), (2.0, 3.0)], 1.5, Colour::INK, &[4.0, 2.0]);
        svg.text((5.0, 10.0), "a<b", &TextStyle::new(10.0, Anchor::End));
        svg.text(
            (5.0, 10.0),
            "H_{b}/h",
            &TextStyle {
                upwards: true,
                ..TextStyle::new(10.0, Anchor::Middle)
            },
        );
        let text = svg.to_text();
        for part in [
            "viewBox=\"0 0 30 20\"",
            "<polygon points=\"0,0 1,0 1,2\" fill=\"#ff0010\"/>",
            "stroke-dasharray=\"4 2\"",
            "<text x=\"5\" y=\"13.65\" text-anchor=\"end\" font-size=\"10\" fill=\"#222222\" xml:space=\"preserve\">a&lt;b</text>",
            "rotate(-90)",
            // H is 1540 of 2048 units wide, b 1300, the slash 690, h 1298; b in 0.7 of the size.
            "rotate(-90)\" x=\"-10.83\" y=\"3.65\"",
            "rotate(-90)\" x=\"-3.32\" y=\"5.45\" text-anchor=\"start\" font-size=\"7\"",
        ] {
            assert!(text.contains(part), "{part} not in\n{text}");
        }
        assert!(text.ends_with("</svg>\n"));
    }
}
