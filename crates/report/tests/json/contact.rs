//! Unit tests of `crates/report/src/json/contact.rs`.

use super::*;
use serde_json::{json, Value};

#[test]
fn keys_are_those_that_programs_read() {
    let report = ContactReport {
        method: "active_set".into(),
        steps: vec![OuterStep::default()],
        interfaces: vec![InterfaceForce {
            kind: InterfaceKind::Obstacle,
            ..InterfaceForce::default()
        }],
        bodies: vec![BodyBalance::default()],
        ..ContactReport::default()
    };
    let value = serde_json::to_value(&report).unwrap();
    let step = json!({
        "load_step": 0, "step": 0, "method": "", "active": 0, "entered": 0, "left": 0, "iterations": 0,
        "estimate": null, "exact": null, "wrong": 0, "residual": 0.0, "tolerance": 0.0, "seconds": 0.0,
    });
    let interface = json!({
        "name": "", "kind": "obstacle", "candidates": 0, "active": 0, "force": 0.0, "largest_gap": 0.0,
        "smallest_gap": 0.0, "min_multiplier": 0.0, "max_multiplier": 0.0,
    });
    let body = json!({
        "name": "", "floating": false, "load": 0.0, "contact": 0.0, "reaction": null, "imbalance": 0.0,
    });
    let expected = json!({
        "method": "active_set", "candidates": 0, "active": 0, "factorisations": 0, "distinct_subdomains": 0,
        "steps": [step], "interfaces": [interface], "bodies": [body],
    });
    assert_eq!(value, expected, "no key load_steps without load steps");
    let words: Vec<Value> = [
        InterfaceKind::Contact,
        InterfaceKind::Tied,
        InterfaceKind::Mixed,
    ]
    .map(|k| {
        let word = serde_json::to_value(k).unwrap();
        assert_eq!(word, k.name());
        word
    })
    .to_vec();
    assert_eq!(words, ["contact", "tied", "mixed"]);
}

#[test]
fn what_is_not_finite_is_null_and_comes_back() {
    let report = ContactReport {
        steps: vec![OuterStep {
            residual: f64::NAN,
            tolerance: f64::INFINITY,
            ..OuterStep::default()
        }],
        bodies: vec![BodyBalance {
            reaction: Some(f64::NAN.into()),
            load: Amount(vec![1.5, f64::NAN]),
            imbalance: f64::NAN,
            ..BodyBalance::default()
        }],
        load_steps: vec![LoadStep {
            t: 0.5,
            energy: f64::NEG_INFINITY,
            ..LoadStep::default()
        }],
        ..ContactReport::default()
    };
    let text = crate::json::to_string(&report).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    let back: ContactReport = serde_json::from_str(&text).unwrap();
    assert!(back.steps[0].residual.is_nan() && back.steps[0].tolerance.is_nan());
    let load = &back.bodies[0].load.0;
    assert!(load[0] == 1.5 && load[1].is_nan() && load.len() == 2);
    assert!(back.bodies[0].reaction.is_none() && back.bodies[0].imbalance.is_nan());
    assert!(back.load_steps[0].energy.is_nan() && back.load_steps[0].t == 0.5);
}
