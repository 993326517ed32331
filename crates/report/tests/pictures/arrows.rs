//! Unit tests of `crates/report/src/pictures/arrows.rs`.

use super::*;

/// n × n arrows on the unit square, with stresses between 1 and 2.
fn square(n: usize) -> Vec<Arrow> {
    let at = |k: usize| [k % n, k / n].map(|i| i as f64 / (n - 1) as f64);
    (0..n * n)
        .map(|k| Arrow {
            at: at(k),
            stress: [1.0 + at(k)[0], 0.0],
        })
        .collect()
}

#[test]
fn arrows_have_room_and_are_not_too_many() {
    for (n, width) in [(2, 400.0), (30, 60.0), (90, 400.0)] {
        let view = View {
            low: [0.0, 0.0],
            scale: width,
            origin: (7.0, 500.0),
        };
        let shown = thinned(&square(n), &view);
        assert!(!shown.is_empty() && shown.len() <= SHOWN, "{}", shown.len());
        for (k, a) in shown.iter().enumerate() {
            for b in &shown[..k] {
                let apart = width * (a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1]);
                assert!(apart >= APART, "{apart}");
            }
        }
    }
    // Where there is room for all, all are shown.
    let view = View {
        low: [0.0, 0.0],
        scale: 400.0,
        origin: (0.0, 400.0),
    };
    assert_eq!(thinned(&square(10), &view).len(), 100);
}

#[test]
fn the_largest_stress_is_finite_and_shown_where_arrows_can_be_seen() {
    let mut arrows = square(3);
    assert_eq!(largest(&arrows, 30.0), Some(2.0));
    arrows[0].stress = [f64::NAN, 1.0];
    assert_eq!(largest(&arrows, 30.0), Some(2.0));
    assert_eq!(largest(&arrows, 4.0), None);
    assert_eq!(largest(&[], 30.0), None);
}
