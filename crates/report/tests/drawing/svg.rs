//! Unit tests of `crates/report/src/drawing/svg.rs`.

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
        "<text x=\"5\" y=\"13.65\" text-anchor=\"end\" font-size=\"10\" \
         fill=\"#222222\" xml:space=\"preserve\">a&lt;b</text>",
        "rotate(-90)",
        // H is 1540 of 2048 units wide, b 1300, the slash 690, h 1298; b in 0.7 of the size.
        "rotate(-90)\" x=\"-10.83\" y=\"3.65\"",
        "rotate(-90)\" x=\"-3.32\" y=\"5.45\" text-anchor=\"start\" font-size=\"7\"",
    ] {
        assert!(text.contains(part), "{part} not in\n{text}");
    }
    assert!(text.ends_with("</svg>\n"));
}
