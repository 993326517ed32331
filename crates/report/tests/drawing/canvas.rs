//! Unit tests of `crates/report/src/drawing/canvas.rs`.

use super::*;

#[test]
fn widths_are_those_of_the_font() {
    // DejaVu Sans: the digit zero is 1303 of 2048 units wide, the capital M 1767.
    assert!((text_width("0", 2048.0, false) - 1303.0).abs() < 1.0);
    assert!((text_width("0M", 1024.0, false) - (1303.0 + 1767.0) / 2.0).abs() < 1.0);
}

#[test]
fn long_texts_are_shortened() {
    assert_eq!(shortened("left|right", 10.0, true, 200.0), "left|right");
    let short = shortened("a long name of a body | another one", 10.0, true, 80.0);
    assert!(
        short.starts_with("a long…") && short.ends_with("one"),
        "{short}"
    );
    let width = text_width(&short, 10.0, true);
    assert!(width <= 80.0 && width > 65.0, "{width}");
}

#[test]
fn scripts_are_smaller_runs() {
    let parts = runs("H_{b}/H_{s} 10^{-3}", 10.0);
    let texts: Vec<&str> = parts.iter().map(|r| r.text.as_str()).collect();
    assert_eq!(texts, ["H", "b", "/H", "s", " 10", "-3"]);
    assert!(parts[1].raise < 0.0 && parts[5].raise > 0.0 && parts[5].size < 10.0);
    // A plain underscore, as in file names, stays.
    assert_eq!(
        runs("poisson_2x2_{", 10.0)
            .iter()
            .map(|r| r.text.as_str())
            .collect::<String>(),
        "poisson_2x2_{"
    );
}
