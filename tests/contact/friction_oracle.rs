//! Friction against values of an independent computation: tests/data/friction.json, conic programs that were polished
//! to rounding.

use super::friction::near;
use crate::support::checks::number;
use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use serde_json::Value;

pub fn oracle() -> serde_json::Map<String, Value> {
    let text = include_str!("../data/friction.json");
    serde_json::from_str(text).expect("the oracle is JSON")
}

fn list(value: &Value) -> Vec<f64> {
    let items = value.as_array().expect("a list");
    items.iter().map(number).collect()
}

/// The friction on the first body of all interfaces, or of a load step.
fn friction_of(report: &Value, steps: usize, step: usize) -> Vec<Value> {
    let contact = &report["contact"];
    if steps > 1 {
        return vec![contact["load_steps"][step].clone()];
    }
    let all = contact["interfaces"].as_array().expect("a list");
    all.iter()
        .filter(|i| i["friction"].is_array())
        .cloned()
        .collect()
}

#[test]
fn cases_have_the_values_of_the_oracle() {
    have_the_values_of_the_oracle("active_set");
}

#[test]
fn smalbe_has_the_values_of_the_oracle() {
    have_the_values_of_the_oracle("smalbe");
}

/// Forces to 1e-5, displacements to 1e-4, states within one node, on any ranks.
fn have_the_values_of_the_oracle(method: &str) {
    let scratch = Scratch::new(&format!("friction-{method}"));
    let mut seen = 0;
    for (name, case) in oracle() {
        let text = case["scene"].as_str().expect("a text");
        let scene = scratch.file("scene.toml", text);
        let steps = case["steps"].as_array().expect("a list");
        for ranks in [1, 2, 4] {
            let kind = ["-fetifeti_contact_type", method];
            let arguments = [&["solve", &scene, "--json", "-"][..], &kind].concat();
            let out = run_fetifeti(ranks, &arguments);
            assert_eq!(out.code, 0, "{name}, {ranks} ranks: {}", out.all());
            let report: Value = serde_json::from_str(&out.stdout).expect("JSON");
            let by = &report["contact"]["method"];
            assert!(by.as_str().is_some_and(|by| by.starts_with(method)), "{by}");
            for (k, step) in steps.iter().enumerate() {
                let what = format!("{name}, step {k}, {ranks} ranks");
                let found = friction_of(&report, steps.len(), k);
                assert!(!found.is_empty(), "{what}");
                let normal = number(&step["normal"]);
                let tangential = list(&step["tangential"]);
                let sum = |c: usize| found.iter().map(|f| list(&f["friction"])[c]).sum::<f64>();
                // The oracle leaves out the component along y, and gives the friction on the upper body.
                for (c, tangential) in [0, 2].into_iter().zip(tangential) {
                    near(sum(c).abs(), tangential.abs(), 1e-5 * normal, &what);
                }
                let count = |key: &str| -> f64 { found.iter().map(|f| number(&f[key])).sum() };
                near(count("sticking"), number(&step["stick"]), 1.0, &what);
                near(count("slipping"), number(&step["slip"]), 1.0, &what);
                assert!(
                    found.iter().all(|f| number(&f["dissipated"]) >= -1e-9),
                    "{what}"
                );
                seen += 1;
            }
            let last = steps.last().expect("there is a step");
            for probe in report["probes"].as_array().expect("a list") {
                let name = probe["name"].as_str().expect("a name");
                let wanted = list(&last["probes"][name]);
                let size = wanted.iter().fold(0.1f64, |a, v| a.max(v.abs()));
                for (u, v) in list(&probe["u"]).iter().zip(wanted) {
                    near(*u, v, 1e-4 * size, name);
                }
            }
        }
    }
    assert!(seen >= 3 * 10, "{seen}");
}
