//! Unit tests of `crates/lab/src/study/table1/figure.rs`.

use super::super::tables::tests::sample_row;
use super::*;

#[test]
fn every_row_of_the_paper_is_in_its_panel() {
    let rows: Vec<Table1Row> = paper::table1()
        .iter()
        .map(|r| sample_row(r.bodies, r.subdomains, r.elements))
        .collect();
    let figure = figure(&rows);
    // 6 rows vary the bodies; the row (2,2,2) starts the other two families as well: 9 and 7 points.
    let lengths: Vec<usize> = figure
        .panels
        .iter()
        .map(|p| p.series[2].points.len())
        .collect();
    assert_eq!(lengths, [6, 9, 7]);
    for panel in &figure.panels {
        assert_eq!(
            panel.series[0].points, panel.series[2].points,
            "the sample rows repeat the paper"
        );
        assert!(panel.series[0].points.windows(2).all(|w| w[0].0 < w[1].0));
    }
    assert_eq!(
        figure.panels[1].series[1].points.last(),
        Some(&(18.0, 16.4836))
    );
}

#[test]
fn some_rows_and_foreign_rows() {
    let figure = figure(&[sample_row(2, 4, 2), sample_row(3, 3, 3)]);
    let lengths: Vec<usize> = figure
        .panels
        .iter()
        .map(|p| p.series[2].points.len())
        .collect();
    assert_eq!(lengths, [0, 1, 0]);
    assert_eq!(
        figure.panels[2].series[0].points.len(),
        7,
        "the paper's points are always there"
    );
}
