//! Unit tests of `crates/report/src/tables/summary.rs`.

use super::*;

#[test]
fn solve_says_what_was_solved_and_leaves_out_what_is_not_known() {
    let mut report: SolveReport = serde_json::from_value(serde_json::json!({
        "scene": "four bodies", "ranks": 1, "threads": 2, "bodies": 4, "floating_bodies": 1, "subdomains": 16,
        "dofs": 225, "multipliers": {"local": 64, "global": 60, "active": 60}, "outer_iterations": 1,
        "iterations": {"inner": [9], "total": 9},
        "condition": {"exact": null, "estimate": {"lambda_min": 1.0, "lambda_max": 3.25, "kappa": 3.25}},
        "kkt": {"stationarity": 1e-9, "feasibility": 2e-10, "complementarity": 0.0, "min_multiplier": null},
        "energy": -0.25, "seconds": {"assemble": 0.1, "setup": 0.2, "solve": 0.3, "recover": 0.1, "total": 0.7},
        "memory_mb": 80.4, "converged_reason": "CONVERGED_RTOL", "ksp_type": "cg",
        "preconditioner": "coarse_corrected", "projector": "identity", "rtol": 1e-6,
    }))
    .unwrap();
    let text = solve(&report);
    let line = |name: &str| {
        text.lines()
            .find(|l| l.starts_with(name))
            .map(|l| l[name.len()..].trim())
    };
    assert_eq!(
        line("bodies"),
        Some("4 (1 floating), 16 subdomains on 1 rank")
    );
    assert_eq!(
        line("multipliers"),
        Some("64 in bodies, 60 between bodies (60 active)")
    );
    assert_eq!(line("iterations"), Some("9, CONVERGED_RTOL at rtol 1e-6"));
    assert_eq!(line("rounding"), None);
    assert_eq!(
        line("estimate of the run"),
        Some("κ = 3.2500   (λ_min 1.000000, λ_max 3.2500)")
    );
    assert_eq!(
        (line("exact spectrum"), line("error"), line("contact")),
        (None, None, None)
    );
    // With inequalities: the whole certificate in one line, and what is known about contact at the end.
    report.kkt.min_multiplier = Some(0.5);
    report.contact = Some(crate::json::contact::ContactReport::default());
    let text = solve(&report);
    assert!(text.contains("\nKKT conditions ") && text.contains("2.0e-10, complementarity 0.0e0"));
    assert!(text.find("\ncontact by ").unwrap() > text.find("\nmemory ").unwrap());
}
