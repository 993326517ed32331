//! Unit tests of `crates/report/src/drawing/ticks.rs`.

use super::*;

fn labels(t: &[Tick]) -> Vec<&str> {
    t.iter()
        .filter(|t| !t.label.is_empty())
        .map(|t| t.label.as_str())
        .collect()
}

#[test]
fn linear_ticks_are_round() {
    assert_eq!(
        labels(&ticks(0.0, 44.0, Scale::Linear, 5)),
        ["0", "10", "20", "30", "40"]
    );
    assert_eq!(
        labels(&ticks(-0.8, 0.1, Scale::Linear, 4)),
        ["−0.75", "−0.50", "−0.25", "0"]
    );
    assert_eq!(
        labels(&ticks(0.0, 1e-3, Scale::Linear, 5)),
        ["0", "0.0002", "0.0004", "0.0006", "0.0008", "0.0010"]
    );
    assert_eq!(
        labels(&ticks(0.0, 6e-4, Scale::Linear, 3)),
        ["0", "0.0002", "0.0004", "0.0006"]
    );
    assert_eq!(labels(&ticks(0.0, 1e-3, Scale::Linear, 4))[3], "0.00075");
    assert_eq!(
        labels(&ticks(0.0, 3e-7, Scale::Linear, 3)),
        ["0", "10^{−7}", "2·10^{−7}", "3·10^{−7}"]
    );
    assert_eq!(ticks(2.0, 2.0, Scale::Linear, 3).len(), 1);
}

#[test]
fn log_ticks_are_decades_or_one_two_five() {
    assert_eq!(
        labels(&ticks(1.0, 50.0, Scale::Log, 5)),
        ["1", "2", "5", "10", "20", "50"]
    );
    assert_eq!(
        labels(&ticks(1e-9, 1e-5, Scale::Log, 5)),
        ["10^{−9}", "10^{−8}", "10^{−7}", "10^{−6}", "10^{−5}"]
    );
    let many = ticks(1e-12, 1e12, Scale::Log, 6);
    assert!(labels(&many).len() <= 7 && labels(&many).contains(&"10^{0}"));
}

#[test]
fn ranges_hold_the_data() {
    assert_eq!(range([1.0, 41.0].into_iter(), Scale::Linear), (0.0, 43.0));
    let (low, high) = range([f64::NAN, -1.0, 1.0, 100.0].into_iter(), Scale::Log);
    assert!(low < 1.0 && low > 0.5 && high > 100.0 && high < 200.0);
    let (low, high) = range([3.0, 3.0].into_iter(), Scale::Linear);
    assert!(low < 3.0 && high > 3.0);
    assert_eq!(range(std::iter::empty(), Scale::Linear), (0.0, 1.0));
}

#[test]
fn numbers_read_well() {
    assert_eq!(number(0.25), "0.25");
    assert_eq!(number(1.0 / 3.0), "0.3333");
    assert_eq!(number(-20.0), "−20");
    assert_eq!(number(1e6), "10^{6}");
    assert_eq!(number(2.5e-7), "2.5·10^{−7}");
    assert_eq!(number(12345.6), "12346");
}
