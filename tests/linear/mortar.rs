//! Exact condition numbers with mortar rows, against an independent dense computation (tests/data/mortar2d.json): two
//! scalar bodies of n × n subdomains side by side, held at their outer sides, with different meshes.

use crate::support::session::with_session;
use fetifeti::feti::{MethodSettings, PcType};
use fetifeti::scene::Scene;
use fetifeti::FetiFeti;
use serde_json::Value;

/// The scene of a row of the table; the first body carries the multipliers.
fn scene(row: &Value) -> Scene {
    let n = row["subdomains"].as_u64().expect("a count");
    let body = |name: &str, x: usize, side: &str, elements: &str, rho: &Value| {
        let m = n * row[elements].as_u64().expect("a count");
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{x}, 0]\nsize = 1\nelements = {m}\nsubdomains = {n}\n\
             rho = {rho}\nload = 1\ndirichlet = [\"{side}\"]\n"
        )
    };
    let a = body("a", 0, "left", "elements_multiplier_side", &row["rho"][0]);
    let b = body("b", 1, "right", "elements_other_side", &row["rho"][1]);
    Scene::parse(
        "mortar.toml",
        &format!("{a}{b}[[tie]]\nbodies = [\"a\", \"b\"]\n"),
    )
    .expect("a scene")
}

#[test]
fn kappa_is_that_of_the_oracle() {
    let text = include_str!("../data/mortar2d.json");
    let table: Vec<Value> = serde_json::from_str(text).expect("JSON");
    assert_eq!(table.len(), 8);
    for row in table {
        for (pc, key) in [
            (PcType::Dirichlet, "full M_D"),
            (PcType::CoarseCorrected, "full M_C"),
        ] {
            let problem = scene(&row).substructures(&|_| true).expect("substructures");
            let expected = row[key].as_f64().expect("κ");
            let what = format!("{row}, {key}");
            with_session(move |session| {
                let settings = MethodSettings {
                    pc_type: Some(pc),
                    ..MethodSettings::default()
                };
                let solver = FetiFeti::new(session, problem, settings).expect("set up");
                let s = solver
                    .spectrum()
                    .expect("eigenvalues")
                    .expect("multipliers");
                let kappa = s.lambda_max / s.lambda_min;
                assert!((kappa / expected - 1.0).abs() < 1e-5, "{what}: {kappa}");
                assert!(
                    (s.lambda_min - 1.0).abs() < 1e-8,
                    "{what}: {}",
                    s.lambda_min
                );
            });
        }
    }
}
