//! Unit tests of `crates/report/src/drawing/colormap.rs`.

use super::*;

#[test]
fn ends_middle_and_nan() {
    assert_eq!(viridis(-1.0), Colour(0x44, 0x01, 0x54));
    assert_eq!(viridis(0.5), Colour(0x21, 0x91, 0x8c));
    assert_eq!(viridis(2.0), Colour(0xfd, 0xe7, 0x25));
    assert_eq!(viridis(f64::NAN), Colour(0xb0, 0xb0, 0xb0));
}

#[test]
fn lightness_grows_evenly() {
    // Relative luminance by sRGB, then CIE lightness: strictly increasing, no step over three times the mean.
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    };
    let lightness = |c: Colour| {
        let y = 0.2126 * linear(c.0) + 0.7152 * linear(c.1) + 0.0722 * linear(c.2);
        if y > 0.008856 {
            116.0 * y.cbrt() - 16.0
        } else {
            903.3 * y
        }
    };
    let l: Vec<f64> = (0..=32)
        .map(|k| lightness(viridis(f64::from(k) / 32.0)))
        .collect();
    let mean = (l[32] - l[0]) / 32.0;
    assert!(mean > 2.0);
    assert!(
        l.windows(2)
            .all(|w| w[1] > w[0] && w[1] - w[0] < 1.5 * mean),
        "{l:?}"
    );
}
