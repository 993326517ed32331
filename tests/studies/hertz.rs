//! `study hertz --quick`: its measurements, and their independence of ranks.

use crate::support::keys::{self, Keys};
use crate::support::{mpi, program};
use lab::study::hertz::{HertzProblem, HertzReport};
use mpi::Scratch;
use program::run_fetifeti;

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study cases"),
    ("cases[]", "case title order meshes"),
    (
        "cases[].meshes[]",
        "elements dofs active converged force half_width peak iterations outer_iterations kkt pressure \
         seconds",
    ),
    ("cases[].meshes[].half_width", "fit node theory error"),
    ("cases[].meshes[].peak", "fit node theory error"),
    ("cases[].meshes[].pressure[]", "x p theory"),
];

fn quick(ranks: usize, dir: &Scratch) -> HertzReport {
    let file = dir.path(&format!("hertz-{ranks}.json"));
    let out = dir.path("");
    let args = [
        "study", "hertz", "--quick", "--quiet", "--json", &file, "--out", &out,
    ];
    let run = run_fetifeti(ranks, &args);
    assert_eq!(run.code, 0, "{}", run.all());
    keys::read(&std::fs::read_to_string(&file).expect("a report"), KEYS)
}

#[test]
fn half_width_and_peak_agree_with_the_theory() {
    let dir = Scratch::new("study-hertz");
    let [one, two] = [1, 2].map(|ranks| quick(ranks, &dir));
    assert_eq!(one.cases.len(), 3);
    for (case, other) in one.cases.iter().zip(&two.cases) {
        assert_eq!(case.meshes.len(), 3);
        assert!(case.holds(), "{}: order {}", case.case, case.order);
        for (mesh, other) in case.meshes.iter().zip(&other.meshes) {
            println!(
                "{} {}: {}",
                case.case,
                mesh.elements,
                HertzProblem::error(mesh)
            );
            assert_eq!(mesh.active, other.active);
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-5;
            assert!(near(mesh.force, other.force));
            assert!(near(mesh.half_width.fit, other.half_width.fit));
            assert!(near(mesh.peak.fit, other.peak.fit));
            assert!(mesh.kkt < 1e-6 && mesh.converged);
            // The formulas a second time, from the force: 4FR/(πE*) = a² and 3FR/(4E*) = a³.
            let stiffness = match case.case.as_str() {
                "two_cylinders" => 1.0 / (0.91 + 0.96 / 3.0),
                _ => 1.0 / 0.91,
            };
            let a = match case.case.as_str() {
                "sphere" => (0.75 * mesh.force / stiffness).cbrt(),
                "two_cylinders" => (2.0 * mesh.force / stiffness / std::f64::consts::PI).sqrt(),
                _ => (4.0 * mesh.force / stiffness / std::f64::consts::PI).sqrt(),
            };
            assert!((mesh.half_width.theory / a - 1.0).abs() < 1e-12);
            // The zone is small against the radius, as the theory requires.
            assert!(a > 0.03 && a < 0.11, "{a}");
        }
    }
    for case in ["cylinder", "two_cylinders", "sphere"] {
        for end in ["png", "svg", "csv"] {
            let file = dir.path(&format!("hertz_{case}.{end}"));
            assert!(
                std::fs::metadata(&file).is_ok_and(|m| m.len() > 200),
                "{file:?}"
            );
        }
    }
}
