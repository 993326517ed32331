//! `study benchmarks --quick`: its values against their references, and their independence of ranks.

use crate::support::keys::{self, Keys};
use crate::support::sample::sample;
use crate::support::{mpi, program};
use lab::study::benchmarks::{BenchmarkReport, BenchmarksReport};
use mpi::Scratch;
use program::run_fetifeti;

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study cases"),
    ("cases[]", "case title reference skipped series"),
    ("cases[].series[]", "name order meshes"),
    (
        "cases[].series[].meshes[]",
        "mesh size scene dofs values curve outer_iterations iterations condition kkt converged seconds",
    ),
    (
        "cases[].series[].meshes[].values[]",
        "quantity ours reference error limit",
    ),
];

/// The small form of a case; its tolerances are kept.
fn quick(case: &str, ranks: usize, dir: &Scratch) -> BenchmarkReport {
    let file = dir.path(&format!("{case}-{ranks}.json"));
    let out = dir.path(&format!("{case}-{ranks}"));
    let args = [
        "study",
        "benchmarks",
        case,
        "--quick",
        "--quiet",
        "--json",
        &file,
        "--out",
        &out,
    ];
    let run = run_fetifeti(ranks, &args);
    assert_eq!(run.code, 0, "{case}: {}", run.all());
    let text = std::fs::read_to_string(&file).expect("a report");
    let mut report: BenchmarksReport = keys::read(&text, KEYS);
    assert_eq!(report.cases.len(), 1);
    let case = report.cases.remove(0);
    for mesh in case.meshes() {
        let scene = std::path::Path::new(&out).join(&mesh.scene);
        assert!(scene.is_file(), "{}", scene.display());
    }
    case
}

/// The errors of a quantity, mesh by mesh, of all series.
fn errors(case: &BenchmarkReport, quantity: &str) -> Vec<f64> {
    let values = case.meshes().flat_map(|m| &m.values);
    let found: Vec<f64> = values
        .filter(|v| v.quantity == quantity)
        .map(|v| v.error.abs())
        .collect();
    assert!(!found.is_empty(), "{}: no {quantity}", case.case);
    found
}

#[test]
fn constant_pressures_pass() {
    let dir = Scratch::new("benchmarks-patch");
    let patch = quick("patch", 1, &dir);
    // Both dimensions, two faces, two orders, two kinds of elements, two sides.
    assert_eq!(patch.meshes().count(), 32);
    assert!(errors(&patch, "pressure").iter().all(|e| *e < 1e-10));
    let three = quick("three", 2, &dir);
    assert!(errors(&three, "pressure from above")
        .iter()
        .all(|e| *e < 1e-9));
    assert!(errors(&three, "pressure from the side")
        .iter()
        .all(|e| *e < 1e-9));
}

#[test]
fn a_stack_carries_its_weight() {
    let dir = Scratch::new("benchmarks-stack");
    for ranks in [1, 3] {
        let stack = quick("stack", ranks, &dir);
        assert!(errors(&stack, "force at a joint / weight")
            .iter()
            .all(|e| *e < 1e-8));
    }
}

#[test]
fn rings_come_near_their_closed_form() {
    let dir = Scratch::new("benchmarks-rings");
    for name in ["rings", "shrink-fit"] {
        let rings = quick(name, 1, &dir);
        for series in &rings.series {
            let order = series.order.expect("an order");
            assert!(order > 1.3, "{}: {order}", series.name);
        }
        assert!(errors(&rings, "mean p").iter().all(|e| *e < 2e-3));
    }
}

#[test]
fn units_do_not_matter() {
    let dir = Scratch::new("benchmarks-units");
    let units = quick("units", 1, &dir);
    for quantity in ["pressures", "energy"] {
        assert!(errors(&units, quantity).iter().all(|e| *e < 1e-11));
    }
}

#[test]
fn round_bodies_have_the_pressures_of_half_spaces() {
    let dir = Scratch::new("benchmarks-round");
    for (name, ranks) in sample(3, [("punch", 1), ("hertz-cylinder", 1), ("roller", 2)]) {
        let case = quick(name, ranks, &dir);
        for series in &case.series {
            let finest = series.meshes.last().expect("a mesh");
            let of = |quantity: &str| {
                let mut values = finest.values.iter();
                let found = values.find(|v| v.quantity == quantity);
                found.expect("a value").error.abs()
            };
            // The end of the punch's contact is known to about half an edge, of a/16.
            let width = if name == "punch" { 0.04 } else { 0.02 };
            assert!(
                of("a") < width && of("force") < 1e-6,
                "{name}, {}",
                series.name
            );
            assert!(of("rms of p") < 0.05, "{name}, {}", series.name);
        }
        let picture = dir.path(&format!("{name}-{ranks}/benchmarks_{name}.png"));
        let size = std::fs::metadata(picture).expect("a picture").len();
        assert!(size > 1000, "{name}: {size}");
    }
}

#[test]
fn blocks_and_arches_stand_and_fall_as_statics_has_it() {
    let dir = Scratch::new("benchmarks-stand");
    for ranks in [1, 2] {
        let incline = quick("incline", ranks, &dir);
        // Both orders above the angle of friction.
        assert_eq!(errors(&incline, "not refused as sliding"), [0.0; 6]);
        let along = errors(&incline, "friction / weight along the slope");
        assert!(along.len() == 6 && along.iter().all(|e| *e < 1e-8));
    }
    let arch = quick("arch", 1, &dir);
    assert!(errors(&arch, "wrong answer").iter().all(|e| *e == 0.0));
    assert!(errors(&arch, "springings / weight")
        .iter()
        .all(|e| *e < 1e-6));
    // Sixteen voussoirs are half a percent from any number of them.
    let least = errors(&arch, "least thickness, statics / Milankovitch");
    assert!(least.iter().all(|e| *e < 5e-3), "{least:?}");
}

#[test]
fn sliding_bars_and_belts_come_near_their_closed_forms() {
    let dir = Scratch::new("benchmarks-slide");
    let belt = quick("belt", 1, &dir);
    for series in &belt.series {
        let order = series.order.expect("an order");
        assert!(order > 0.5, "{}: {order}", series.name);
    }
    assert!(errors(&belt, "T2/T1").iter().all(|e| *e < 0.015));
    let bar = quick("bar", 2, &dir);
    assert!(errors(&bar, "μ p dℓ/dF").iter().all(|e| *e < 0.01));
    assert!(errors(&bar, "F").iter().all(|e| *e < 0.02));
    let plate = quick("plate", 1, &dir);
    // The reference has three digits at A to D.
    for point in ["A", "B", "C", "D"] {
        let off = errors(&plate, &format!("u_x of {point}"));
        assert!(off.iter().all(|e| *e < 4e-3), "{point}: {off:?}");
    }
    let shoe = quick("shoe", 1, &dir);
    assert!(errors(&shoe, "friction").iter().all(|e| *e < 1e-4));
    assert!(errors(&shoe, "(way − expected) / 9 mm")
        .iter()
        .all(|e| *e < 2e-3));
}

#[test]
fn round_bodies_stick_and_slip_as_half_spaces_do() {
    let dir = Scratch::new("benchmarks-mindlin");
    let cases = [
        ("mindlin-cylinder", 1),
        ("mindlin-sphere", 1),
        ("roller-friction", 2),
    ];
    for (name, ranks) in sample(3, cases) {
        let case = quick(name, ranks, &dir);
        if name == "roller-friction" {
            assert!(errors(&case, "u_y of B").iter().all(|e| *e < 0.03));
            continue;
        }
        // Four edges in the radius of the contact of balls, eight in that of the cylinder.
        let most = if name == "mindlin-sphere" { 0.25 } else { 0.1 };
        for series in &case.series {
            let finest = series.meshes.last().expect("a mesh");
            let first = &finest.values[0];
            assert!(first.error < most, "{}: {}", series.name, first.error);
        }
    }
}

#[test]
fn unknown_cases_are_refused() {
    let run = run_fetifeti(1, &["study", "benchmarks", "nonsense"]);
    assert_eq!(run.code, 2);
    assert!(
        run.all().contains("expected one of patch, rings"),
        "{}",
        run.all()
    );
}
