//! Unit tests of `crates/report/src/json/solve.rs`.

use super::*;
use crate::json::{to_string, Spectrum};
use serde_json::{json, Value};

fn report() -> SolveReport {
    SolveReport {
        schema: SolveReport::SCHEMA.into(),
        version: "1.0".into(),
        petsc: "3.18.5".into(),
        converged: true,
        options: BTreeMap::from([("-fetifeti_ksp_rtol".into(), "1e-6".into())]),
        command: vec!["fetifeti".into()],
        inputs: Vec::new(),
        scene: "two bodies".into(),
        dimension: 2,
        physics: "scalar".into(),
        components: 1,
        form: "plane scalar, Q1".into(),
        ranks: 2,
        threads: 1,
        bodies: 2,
        floating_bodies: 1,
        groups: 2,
        subdomains: 8,
        dofs: 100,
        multipliers: Multipliers {
            local: 16,
            global: 18,
            active: 18,
        },
        outer_iterations: 1,
        iterations: Iterations::new(vec![7, 4]),
        condition: Condition {
            exact: None,
            estimate: Some(Spectrum::new(2.0, 5.0)),
        },
        adaptive: None,
        operators: None,
        kkt: Kkt {
            stationarity: 1e-9,
            feasibility: f64::NAN,
            complementarity: 0.0,
            min_multiplier: None,
            error: None,
        },
        certified: None,
        energy: f64::INFINITY,
        contact: None,
        error: None,
        notes: Vec::new(),
        free_motions: Vec::new(),
        warnings: Vec::new(),
        probes: Vec::new(),
        node_print: Vec::new(),
        communication: None,
        seconds: Seconds::default(),
        memory_mb: 12.5,
        converged_reason: "CONVERGED_RTOL".into(),
        ksp_type: "cg".into(),
        preconditioner: "dirichlet".into(),
        scaling: "rho".into(),
        local_solver: "multifrontal".into(),
        local_ordering: "nd".into(),
        projector: "identity".into(),
        natural_coarse: None,
        check: None,
        rtol: 1e-6,
    }
}

#[test]
fn solve_report_has_the_promised_keys() {
    let value: Value = serde_json::from_str(&to_string(&report()).unwrap()).unwrap();
    let promised = [
        "scene",
        "dimension",
        "physics",
        "components",
        "ranks",
        "bodies",
        "floating_bodies",
        "groups",
        "subdomains",
        "dofs",
        "multipliers",
        "outer_iterations",
        "iterations",
        "condition",
        "kkt",
        "energy",
        "seconds",
        "memory_mb",
        "converged_reason",
    ];
    for key in promised {
        assert!(value.get(key).is_some(), "{key}");
    }
    assert_eq!(
        value["multipliers"],
        json!({"local": 16, "global": 18, "active": 18})
    );
    assert_eq!(value["iterations"], json!({"inner": [7, 4], "total": 11}));
    let estimate = json!({"lambda_min": 2.0, "lambda_max": 5.0, "kappa": 2.5});
    assert_eq!(
        value["condition"],
        json!({"exact": null, "estimate": estimate})
    );
    let phases = [
        "read", "assemble", "setup", "solve", "recover", "evaluate", "write", "total",
    ];
    for key in phases {
        assert!(value["seconds"][key].is_number(), "{key}");
    }
    assert!(value.get("error").is_none() && value.get("contact").is_none());
}

#[test]
fn what_is_not_finite_is_null_and_comes_back() {
    let text = to_string(&report()).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    let value: Value = serde_json::from_str(&text).unwrap();
    assert!(value["energy"].is_null() && value["kkt"]["feasibility"].is_null());
    let back: SolveReport = serde_json::from_str(&text).unwrap();
    assert!(back.energy.is_nan() && back.kkt.feasibility.is_nan());
    assert_eq!(back.iterations, report().iterations);
}

#[test]
fn error_norms_appear_where_known() {
    let mut known = report();
    known.error = Some(ErrorNorms {
        l2: 1.0,
        h1: 2.0,
        energy_norm: 3.0,
    });
    let value: Value = serde_json::from_str(&to_string(&known).unwrap()).unwrap();
    assert_eq!(value["error"], json!({"l2": 1.0, "h1": 2.0, "energy": 3.0}));
}
