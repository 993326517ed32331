//! Unit tests of `crates/report/src/tables/contact.rs`.

use super::*;
use crate::json::contact::{InterfaceKind, LoadStep, Slid};
use crate::json::Spectrum;

/// A run with `steps` outer steps and `n` interfaces of forces 1, 2, …, n.
fn sample(steps: usize, n: usize) -> ContactReport {
    ContactReport {
        method: "active_set".into(),
        candidates: 258,
        active: 130,
        factorisations: 1,
        distinct_subdomains: 1,
        steps: (1..=steps)
            .map(|k| OuterStep {
                step: k,
                method: "active_set".into(),
                active: 200 - k,
                entered: 2,
                left: 3,
                iterations: 10 + k,
                estimate: (k > 1).then(|| Spectrum::new(1.0, 4.5)),
                residual: 10f64.powi(-(k as i32)),
                tolerance: 1e-2,
                seconds: 0.25,
                ..OuterStep::default()
            })
            .collect(),
        interfaces: (1..=n)
            .map(|k| InterfaceForce {
                name: format!("b{}|b{k}", k - 1),
                kind: InterfaceKind::Contact,
                candidates: 17,
                active: k % 2,
                force: k as f64,
                largest_gap: 0.0125,
                min_multiplier: 0.0,
                max_multiplier: 2.5e-7,
                ..InterfaceForce::default()
            })
            .collect(),
        bodies: (0..n + 1)
            .map(|k| BodyBalance {
                name: format!("b{k}"),
                floating: k > 0,
                load: (-1.0).into(),
                contact: 1.0.into(),
                reaction: (k == 0).then(|| 123456.0.into()),
                imbalance: 1e-12 * k as f64,
                ..BodyBalance::default()
            })
            .collect(),
        load_steps: Vec::new(),
        updated: false,
        renewable: true,
    }
}

#[test]
fn two_interfaces_are_listed_in_full() {
    let text = contact(&sample(2, 2));
    assert!(text.contains("130 of 258 candidates touch; 1 factorisation for 1 distinct subdomain"));
    let words = |start: &str| -> Vec<String> {
        let line = text.lines().find(|l| l.trim_start().starts_with(start));
        line.expect(start)
            .split_whitespace()
            .map(String::from)
            .collect()
    };
    assert_eq!(
        words("2  "),
        ["2", "198", "2", "3", "12", "4.500", "1.0e-2", "1.0e-2", "0.250"]
    );
    assert_eq!(words("1  ")[5], "–");
    assert_eq!(
        words("b1|b2"),
        ["b1|b2", "contact", "17", "0", "2.000", "0", "2.500e-7", "0", "0.01250"]
    );
    let first = text.find("b1|b2").unwrap();
    assert!(first < text.find("b0|b1").unwrap(), "largest first");
    assert_eq!(words("b0 "), ["b0", "-1.000", "1.000", "1.235e5", "0.0e0"]);
    assert_eq!(words("b2 ")[3], "floating");
    assert!(!text.contains("more") && !text.contains("not shown"));
}

#[test]
fn many_are_cut_and_counted() {
    let text = contact(&sample(40, 180));
    assert!(
        text.contains("… and 168 more with at most 168.0 each, 84 of them open"),
        "{text}"
    );
    assert!(text.contains("… and 173 more, none of them with a larger imbalance"));
    assert!(text.contains("steps 9 to 24 of 40 are not shown"));
    assert_eq!(
        text.lines().filter(|l| l.contains("contact  ")).count(),
        12 + 1
    ); // and the head of the balance
    let imbalances = text.lines().filter(|l| l.contains("floating")).count();
    assert_eq!(imbalances, 8);
    assert!(
        text.contains("\nb180 ") && !text.contains("\nb172 "),
        "the largest imbalances"
    );
    assert!(text.lines().all(|l| l.chars().count() < 120));
}

#[test]
fn load_steps_and_second_method_have_columns() {
    let mut report = sample(3, 1);
    report.steps[2].method = "smalbe".into();
    for (k, s) in report.steps.iter_mut().enumerate() {
        s.load_step = 1 + k / 2;
    }
    report.load_steps = vec![LoadStep {
        t: 0.5,
        energy: f64::NAN,
        ..LoadStep::default()
    }];
    let text = contact(&report);
    let header = text.lines().find(|l| l.contains("κ est.")).unwrap();
    assert!(
        header.starts_with("load  step") && header.ends_with("method"),
        "{header}"
    );
    assert_eq!(text.matches("smalbe").count(), 1);
    let load = text.lines().find(|l| l.contains("0.5000")).unwrap();
    assert!(load.ends_with('–'), "{load}");
}

#[test]
fn certificate_names_the_four_conditions() {
    let mut kkt = Kkt {
        stationarity: 1e-9,
        feasibility: 2e-10,
        complementarity: 3e-13,
        min_multiplier: Some(-4e-12),
        error: None,
    };
    assert_eq!(
        certificate(&kkt),
        "stationarity 1.0e-9, feasibility 2.0e-10, complementarity 3.0e-13, sign 4.0e-12 (smallest multiplier -4.0e-12)"
    );
    kkt.min_multiplier = Some(0.25);
    assert!(certificate(&kkt).ends_with("sign 0.0e0 (smallest multiplier 2.5e-1)"));
    kkt.min_multiplier = None;
    assert_eq!(
        certificate(&kkt),
        "stationarity 1.0e-9, feasibility 2.0e-10"
    );
}

#[test]
fn a_number_that_is_missing_comes_first() {
    let mut report = sample(1, 20);
    report.interfaces[0].force = f64::NAN;
    report.bodies[0].imbalance = f64::NAN;
    let text = contact(&report);
    let interface = text.find("b0|b1").expect("the bad interface is shown");
    assert!(interface < text.find("b19|b20").unwrap());
    let balance = &text[text.find("imbalance").unwrap()..];
    assert!(balance.find("b0 ").unwrap() < balance.find("b20 ").unwrap());
}

#[test]
fn sliding_that_is_not_small_is_said() {
    let mut report = sample(2, 2);
    assert!(!contact(&report).contains("sliding"), "scalars have none");
    for (k, f) in report.interfaces.iter_mut().enumerate() {
        f.slid.largest_sliding = Some(0.01 * (k + 1) as f64);
        f.slid.sliding_over_face = Some(0.2 * (k + 1) as f64);
        f.slid.largest_turn = Some(1.0);
    }
    let text = contact(&report);
    assert!(
        text.contains("largest sliding 0.4000 of the size of a face (b1|b2)"),
        "{text}"
    );
    assert!(!text.contains("not small"), "{text}");
    report.load_steps = vec![LoadStep {
        slid: Slid {
            sliding_over_face: Some(0.6),
            largest_turn: Some(0.5),
            ..Slid::default()
        },
        ..LoadStep::default()
    }];
    let text = contact(&report);
    assert!(text.contains("over all load steps 0.6000"), "{text}");
    assert!(
        text.contains("sliding of more than 0.5 of a face")
            && text.contains("[steps] update = true"),
        "{text}"
    );
    // Where `update` is refused it is not advised.
    report.renewable = false;
    let text = contact(&report);
    assert!(
        text.contains("of the undeformed bodies, and the answer holds for these.")
            && !text.contains("update"),
        "{text}"
    );
    report.updated = true;
    let text = contact(&report);
    assert!(
        text.contains("Between two load steps this is not small"),
        "{text}"
    );
}
