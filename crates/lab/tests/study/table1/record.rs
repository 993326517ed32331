//! Unit tests of `crates/lab/src/study/table1/record.rs`.

use super::*;
use serde_json::json;

#[test]
fn table1_kappas_are_plain_numbers() {
    let side = Table1Side {
        multipliers: 34,
        local_multipliers: 16,
        floating_bodies: 0,
        dirichlet: PcResult {
            exact: Some(2.718541),
            estimate: Some(2.55),
            lambda_min: None,
            lambda_max: None,
            iterations: 7,
        },
        paper: Some(PaperSide {
            cond: 2.5536,
            iter: 7,
        }),
        coarse_corrected: PcResult {
            exact: Some(2.1189),
            estimate: None,
            lambda_min: None,
            lambda_max: None,
            iterations: 6,
        },
    };
    let expected = json!({
        "multipliers": 34, "local_multipliers": 16, "floating_bodies": 0, "iterations": 7,
        "exact": 2.718541, "estimate": 2.55, "paper": {"cond": 2.5536, "iter": 7},
        "coarse_corrected": {"exact": 2.1189, "estimate": null, "iterations": 6},
    });
    assert_eq!(serde_json::to_value(&side).unwrap(), expected);
}
