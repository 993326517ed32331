//! Unit tests of `crates/report/src/json/bench.rs`.

use super::*;
use crate::json::CompareContact;

fn sample(total: f64, converged: bool) -> BenchSample {
    BenchSample {
        seconds: PhaseSeconds {
            total: Some(total),
            ..PhaseSeconds::default()
        },
        outer: Some(4),
        converged,
        ..BenchSample::default()
    }
}

#[test]
fn medians_are_those_of_what_converged() {
    assert_eq!(Spread::of([]), None);
    let even = Spread::of([4.0, 1.0, 3.0, 10.0]).expect("four");
    assert_eq!((even.median, even.min, even.max), (3.5, 1.0, 10.0));
    let mut row = BenchRow {
        samples: vec![sample(3.0, true), sample(1.0, true), sample(9.0, true)],
        ..BenchRow::default()
    };
    row.samples.push(sample(100.0, false));
    row.sum_up();
    let total = row.seconds.phases.total.expect("three");
    assert_eq!((total.median, total.min, total.max), (3.0, 1.0, 9.0));
    assert_eq!(row.seconds.step.expect("steps").median, 0.75);
    assert!(row.seconds.again.is_none() && row.memory_mb.is_none());
}

#[test]
fn who_was_given_the_set_or_failed_is_not_the_fastest() {
    let row = |method: &str, total: f64, outer: Option<usize>, converged: bool| BenchRow {
        run: MethodRun {
            method: method.into(),
            contact: Some(CompareContact {
                outer,
                ..CompareContact::default()
            }),
            converged,
            ..MethodRun::default()
        },
        samples: vec![sample(total, true)],
        ..BenchRow::default()
    };
    let mut case = BenchCase {
        case: "c".into(),
        rounds: 1,
        methods: vec![
            row("fetifeti", 2.0, Some(3), true),
            row("fetifeti", 1.0, Some(3), true),
            row("bddc", 0.1, None, true),
            row("gamg", 0.2, Some(3), false),
            row("mumps", 5.0, Some(3), true),
        ],
        ..BenchCase::default()
    };
    case.sum_up();
    assert_eq!(case.fastest(false).expect("one").run.method, "mumps");
    let ratios: Vec<f64> = case.methods.iter().filter_map(|r| r.ratio).collect();
    assert_eq!(ratios, [2.0, 1.0, 0.1, 0.2, 5.0]);
}
