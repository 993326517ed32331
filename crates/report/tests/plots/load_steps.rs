//! Unit tests of `crates/report/src/plots/load_steps.rs`.

use super::*;
use crate::scratch::Scratch;

#[test]
fn counts_are_round() {
    assert_eq!(counts(1), [0.0, 1.0]);
    assert_eq!(counts(11), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
    assert_eq!(counts(3_000_000).last(), Some(&3e6));
    for most in 1..3000 {
        assert!((2..=7).contains(&counts(most).len()), "{most}");
    }
}

#[test]
fn the_files_hold_the_steps() {
    let steps: Vec<LoadStep> = (1..=4)
        .map(|k| LoadStep {
            t: 0.25 * f64::from(k),
            outer_iterations: 3,
            iterations: 20 + k as usize,
            active: 10 * k as usize,
            energy: if k == 2 { f64::NAN } else { -f64::from(k * k) },
            contact_force: 0.1 * f64::from(k),
            ..LoadStep::default()
        })
        .collect();
    let panels = figure(&steps, "").panels;
    let last = |k: usize| panels[k].series[0].points[3];
    assert_eq!(
        [last(0), last(1), last(2)],
        [(1.0, -16.0), (1.0, 0.4), (1.0, 40.0)]
    );
    let dir = Scratch::new("load-steps");
    let paths = write(&steps, "ramp", &dir.0).unwrap();
    assert!(paths.iter().all(|p| p.exists()));
    let text = std::fs::read_to_string(dir.0.join("steps.csv")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[2], "0.5,3,22,20,,0.2");
    assert_eq!(lines.len(), 5);
}
