//! M_C with few coarse functions (`-fetifeti_lifting vertices`): fewer columns, nearly the same spectrum, on any number
//! of ranks.

use crate::support::checks::number;
use crate::support::program;
use program::run_fetifeti;
use serde_json::Value;

/// Two blocks, one of them held, tied together.
const TIED: &str = "dimension = 3\nphysics = \"elasticity\"\n[grid]\nbodies = [1, 2, 1]\n\
                    subdomains = [3, 2, 2]\nelements_per_subdomain = 2\n\
                    poisson = 0.3\nload = [\"0.3*y\", -1, 0.1]\ndirichlet = [\"bottom\"]\n";

fn report(ranks: usize, scene: &str, more: &[&str]) -> Value {
    let options = ["solve", scene, "--json", "-"];
    let out = run_fetifeti(ranks, &[&options, more].concat());
    assert_eq!(out.code, 0, "{}", out.all());
    serde_json::from_str(&out.stdout).expect("a report")
}

fn scene(name: &str, text: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("a file");
    path.to_str().expect("a path").into()
}

#[test]
fn few_functions_lie_between_all_and_none() {
    let scene = scene("lifting_tied.toml", TIED);
    let kappa = |pc: &str, lifting: &str| {
        let options = ["-fetifeti_pc_type", pc, "-fetifeti_lifting", lifting];
        let found = report(1, &scene, &[&options[..], &["-fetifeti_spectrum"]].concat());
        let exact = &found["condition"]["exact"];
        let low = number(&exact["lambda_min"]);
        assert!(low > 1.0 - 1e-8, "{pc} {lifting}: {low}");
        number(&exact["lambda_max"]) / low
    };
    let (none, few) = (
        kappa("dirichlet", "all"),
        kappa("coarse_corrected", "vertices"),
    );
    let all = kappa("coarse_corrected", "all");
    assert!(
        all <= few * (1.0 + 1e-8) && few < none,
        "{all} {few} {none}"
    );
    // The functions of vertices provide most of the improvement.
    assert!(few - all < 0.5 * (none - all), "{all} {few} {none}");
}

#[test]
fn ranks_agree_and_identities_hold() {
    let scene = scene("lifting_ranks.toml", TIED);
    let mut first: Option<(f64, u64)> = None;
    for (lifting, ranks) in [("all", [1, 4]), ("vertices", [1, 2])] {
        for ranks in ranks {
            let options = [
                "-fetifeti_pc_type",
                "coarse_corrected",
                "-fetifeti_lifting",
                lifting,
            ];
            let found = report(
                ranks,
                &scene,
                &[&options[..], &["-fetifeti_check"]].concat(),
            );
            let checks = found["check"].as_object().expect("the identities");
            for (name, value) in checks {
                if let Some(v) = value.as_f64() {
                    assert!(v.abs() < 1e-8, "{ranks} ranks, {lifting}, {name}: {v:.1e}");
                }
            }
            let energy = number(&found["energy"]);
            let iterations = found["iterations"]["total"].as_u64().expect("a number");
            let (known, count) = *first.get_or_insert((energy, iterations));
            assert!((energy / known - 1.0).abs() < 1e-7, "{ranks} {lifting}");
            assert!(iterations.abs_diff(count) <= 1, "{iterations} and {count}");
        }
    }
}

#[test]
fn a_name_that_there_is_not_gets_one_sentence() {
    let scene = scene("lifting_name.toml", TIED);
    let out = run_fetifeti(1, &["solve", &scene, "-fetifeti_lifting", "edges"]);
    assert_eq!(out.code, 2, "{}", out.all());
    assert!(out.stderr.contains("-fetifeti_lifting") && out.stderr.contains("vertices"));
}
