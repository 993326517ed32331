//! A canvas of SVG elements.

use super::canvas::{self, Anchor, Canvas, Colour, Point, TextStyle};
use super::output;
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

/// At most two digits after the point: a hundredth of a pixel is not seen.
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
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (x, y) = (short(at.0), short(at.1));
        let place = if style.upwards {
            format!(
                "transform=\"translate({x} {y}) rotate(-90)\" y=\"{}\"",
                short(0.5 * canvas::CAP_HEIGHT * style.size)
            )
        } else {
            format!(
                "x=\"{x}\" y=\"{}\"",
                short(at.1 + 0.5 * canvas::CAP_HEIGHT * style.size)
            )
        };
        let weight = if style.bold {
            " font-weight=\"bold\""
        } else {
            ""
        };
        let mut content = String::new();
        let mut raised = 0.0;
        for run in canvas::runs(text, style.size) {
            if run.raise == raised && run.raise == 0.0 {
                content.push_str(&escaped(&run.text));
            } else {
                let (dy, size) = (short(raised - run.raise), short(run.size));
                let _ = write!(
                    content,
                    "<tspan dy=\"{dy}\" font-size=\"{size}\">{}</tspan>",
                    escaped(&run.text)
                );
                raised = run.raise;
            }
        }
        self.push(format_args!(
            "<text {place} text-anchor=\"{anchor}\" font-size=\"{}\" fill=\"{}\"{weight}>{content}</text>",
            style.size,
            hex(style.colour)
        ));
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
            "<text x=\"5\" y=\"13.65\" text-anchor=\"end\" font-size=\"10\" fill=\"#222222\">a&lt;b</text>",
            "rotate(-90)",
            "H<tspan dy=\"1.8\" font-size=\"7\">b</tspan><tspan dy=\"-1.8\" font-size=\"10\">/h</tspan>",
        ] {
            assert!(text.contains(part), "{part} not in\n{text}");
        }
        assert!(text.ends_with("</svg>\n"));
    }
}
