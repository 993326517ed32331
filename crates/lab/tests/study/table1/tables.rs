//! Unit tests of `crates/lab/src/study/table1/tables.rs`.

use super::super::paper;
use super::super::record::PaperSide;
use super::*;

/// A row whose numbers are simple functions of the size.
pub fn sample_row(bodies: usize, subdomains: usize, elements: usize) -> Table1Row {
    let paper = paper::lookup(bodies, subdomains, elements);
    let side = |paper: Option<PaperSide>, kappa: f64| Table1Side {
        multipliers: 34,
        local_multipliers: 16,
        floating_bodies: 0,
        dirichlet: PcResult {
            exact: Some(kappa),
            estimate: None,
            lambda_min: None,
            lambda_max: None,
            iterations: 7,
        },
        paper,
        coarse_corrected: PcResult {
            exact: Some(1.0 + 0.3 * kappa),
            estimate: Some(f64::NAN),
            lambda_min: None,
            lambda_max: None,
            iterations: 6,
        },
    };
    Table1Row {
        bodies,
        subdomains,
        elements,
        whole_interface: side(
            paper.map(|p| p.whole_interface),
            paper.map_or(9.0, |p| p.whole_interface.cond),
        ),
        middle_third: side(
            paper.map(|p| p.middle_third),
            paper.map_or(9.0, |p| p.middle_third.cond),
        ),
    }
}

#[test]
fn table1_shows_both_columns() {
    let text = table1(&[sample_row(2, 4, 2), sample_row(3, 3, 3)]).to_string();
    let words: Vec<&str> = text.lines().nth(2).unwrap().split_whitespace().collect();
    let expected = "2 4 2 7.1076 10 7.1076 – 7 3.1323 6 4.9790 9 4.9790 – 7 2.4937 6"
        .split(' ')
        .collect::<Vec<_>>();
    assert_eq!(words, expected);
    assert!(text.lines().nth(3).unwrap().contains('–'));
}

#[test]
fn csv_leaves_unknown_cells_empty() {
    let csv = table1_csv(&[sample_row(3, 3, 3)]).to_csv();
    let mut lines = csv.lines();
    assert_eq!(lines.next().unwrap().split(',').count(), 23);
    assert_eq!(
        lines.next().unwrap(),
        "3,3,3,34,0,,,9,,7,3.6999999999999997,,6,34,0,,,9,,7,3.6999999999999997,,6"
    );
}
