//! The bounds of the error, and where the iteration stops by them, are the same on any number of ranks.

use crate::support::checks::number;
use crate::support::program;
use program::run_fetifeti;
use serde_json::Value;

fn solve(ranks: usize, scene: &str, more: &[&str]) -> Value {
    let args = [&["solve", scene, "--json", "-"], more].concat();
    let out = run_fetifeti(ranks, &args);
    assert_eq!(out.code, 0, "{ranks} ranks, {scene}: {}", out.all());
    serde_json::from_str(&out.stdout).unwrap_or_else(|e| panic!("{e}: {}", out.all()))
}

/// Largest relative difference of bounds. Their correction stops at a tenth of a residual that rounding may change.
const SAME: f64 = 1e-6;

#[test]
fn bounds_do_not_depend_on_the_ranks() {
    for name in ["model_contact", "mortar_2d", "coefficients_checkerboard"] {
        let scene = format!("../../examples/scenes/{name}.toml");
        let options = ["-fetifeti_certify", "-fetifeti_ksp_rtol", "1e-4"];
        let of = |ranks| {
            let certified = solve(ranks, &scene, &options)["certified"].clone();
            let total = &certified["discretisation"]["total"];
            [&certified["most"], &certified["least"], total].map(number)
        };
        let one = of(1);
        assert!(
            0.0 < one[1] && one[1] < one[0] && one[0] < one[2],
            "{name}: {one:?}"
        );
        for ranks in [2, 4] {
            for (a, b) in one.iter().zip(of(ranks)) {
                assert!((a - b).abs() <= SAME * a, "{name}, {ranks} ranks: {a} {b}");
            }
        }
    }
}

#[test]
fn the_iteration_stops_at_the_discretisation_error_on_any_ranks() {
    for name in ["model_contact", "model_tied"] {
        let scene = format!("../../examples/scenes/{name}.toml");
        let all = solve(1, &scene, &["-fetifeti_ksp_rtol", "1e-10"]);
        let iterations = |r: &Value| number(&r["iterations"]["total"]);
        let one = solve(1, &scene, &["-fetifeti_rtol", "auto"]);
        for report in [&one, &solve(4, &scene, &["-fetifeti_rtol", "auto"])] {
            let certified = &report["certified"];
            let [most, total] =
                [&certified["most"], &certified["discretisation"]["total"]].map(number);
            assert!(most <= 0.1 * total, "{name}: {most} {total}");
            assert!(number(&report["rtol"]) > 1e-6, "{name}");
            assert!(iterations(report) < iterations(&all), "{name}");
            assert_eq!(report["converged"], true, "{name}");
        }
    }
}
