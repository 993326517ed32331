//! Unit tests of `src/contact/piecewise_quadratic.rs`.

use super::*;

/// The slope of ½ a t² − b t + ½ Σ k (t − x)₊² along a line, with springs (k, x).
fn slope<'a>(a: f64, b: f64, springs: &'a [(f64, f64)]) -> impl Fn(f64) -> [f64; 2] + 'a {
    move |t| {
        let mut sums = [a * t - b, a];
        for &(k, x) in springs.iter().filter(|(_, x)| t > *x) {
            sums[0] += k * (t - x);
            sums[1] += k;
        }
        sums
    }
}

#[test]
fn the_minimum_is_found_on_any_piece() {
    // (a, b), springs, and where the slope vanishes.
    let none: &[(f64, f64)] = &[];
    let cases = [
        ((2.0, 1.0), none, 0.5),
        ((1.0, 40.0), none, 40.0),
        ((1.0, 1.0), &[(1e9, 0.25)], 0.25),
        ((1.0, 8.0), &[(3.0, 2.0), (1e6, 5.0)], 3.5),
        ((0.0, 3.0), &[(1.0, 1e6)], 1e6 + 3.0),
    ];
    for ((a, b), springs, at) in cases {
        let slope = slope(a, b, springs);
        let far = line_minimum(&slope, true, &Tuning::DEFAULT).expect("it falls");
        assert!((far - at).abs() < 1e-8 * at, "{far} {at}");
        let near = line_minimum(&slope, false, &Tuning::DEFAULT).expect("it falls");
        assert!((near - at.min(1.0)).abs() < 1e-8, "{near} {at}");
    }
}

#[test]
fn what_does_not_fall_has_none() {
    assert_eq!(line_minimum(|t| [t, 1.0], true, &Tuning::DEFAULT), None);
    assert_eq!(
        line_minimum(|_| [f64::NAN, 1.0], true, &Tuning::DEFAULT),
        None
    );
    // A function that falls for ever ends, too.
    assert!(line_minimum(|_| [-1.0, 0.0], true, &Tuning::DEFAULT).is_some_and(|t| t > 1e12));
}
