//! Numbers as programs write them.

use super::Digits;

fn resolution(words: &[&str]) -> f64 {
    let mut digits = Digits::default();
    words.iter().for_each(|w| digits.see(w.as_bytes()));
    digits.resolution()
}

#[test]
fn the_last_place_of_the_longest_numbers_is_the_resolution() {
    for (words, expected) in [
        // %.12g, which leaves zeros at the end out.
        (
            &[
                "0.3",
                "0.289777747887",
                "0.0776457135308",
                "1.83697019872e-17",
            ][..],
            1e-12,
        ),
        // %.6f of numbers of different size.
        (&["0.001234", "123.456789", "-12.500000"], 1e-6),
        // %20.13E, as CalculiX's pre-processor writes.
        (&["-3.0000000000000E-01", "2.8977774788672E+00"], 1e-13),
        // Abaqus: ten digits.
        (&["-15.00000000", "2.5"], 1e-8),
        // Chosen by hand, and none at all.
        (&["0.5", "12.25", "1e-3", "-400"], 0.0),
        (&[], 0.0),
        // Fortran's exponent.
        (&["1.2345678D+03"], 1e-4),
    ] {
        let found = resolution(words);
        assert!(
            (found - expected).abs() <= 1e-12 * expected,
            "{words:?}: {found}"
        );
    }
}
