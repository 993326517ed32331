//! Exact condition numbers with mortar rows, against an independent dense computation (tests/data/mortar2d.json): two
//! scalar bodies of n × n subdomains side by side, held at their outer sides, with different meshes.

use crate::support::checks::identities;
use crate::support::session::with_session;
use fetifeti::settings::{MethodSettings, PcType};
use fetifeti::FetiFeti;
use scene::Scene;
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
        for (pc, key, coupled) in [
            (PcType::Dirichlet, "full M_D", usize::MAX),
            (PcType::Dirichlet, "full M_D", 0),
            (PcType::CoarseCorrected, "full M_C", usize::MAX),
            (PcType::CoarseCorrected, "full M_C", 0),
        ] {
            let problem = scene(&row).substructures(&|_| true).expect("substructures");
            let expected = row[key].as_f64().expect("κ");
            let what = format!("{row}, {key}, {coupled}");
            with_session(move |session| {
                let settings = MethodSettings::default().pc_type(pc).coupled(coupled);
                let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
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

/// κ and λ_min with ρ of both sides, m₁ and m₂ elements along a subdomain's side and 4 × 4 subdomains.
fn spectrum(rho: [f64; 2], m: [usize; 2], pc: PcType) -> [f64; 2] {
    let row = serde_json::json!({
        "subdomains": 4, "rho": rho, "elements_multiplier_side": m[0], "elements_other_side": m[1]
    });
    let problem = scene(&row).substructures(&|_| true).expect("substructures");
    with_session(move |session| {
        let settings = MethodSettings::default().pc_type(pc).coupled(0);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        identities(&solver, 1e-7, "jumps");
        let found = solver.spectrum().expect("eigenvalues");
        let s = found.expect("multipliers");
        [s.lambda_max / s.lambda_min, s.lambda_min]
    })
}

#[test]
fn jumps_cost_neither_digits_nor_iterations() {
    for m in [[6, 4], [4, 6]] {
        for (pc, most) in [(PcType::Dirichlet, 21.0), (PcType::CoarseCorrected, 2.51)] {
            for jump in [1.0, 1e4, 1e6, 1e8, 1e12] {
                for rho in [[1.0, jump], [jump, 1.0]] {
                    let [kappa, least] = spectrum(rho, m, pc);
                    let what = format!("{m:?}, {rho:?}, {pc:?}: {kappa}, {least}");
                    println!("{what}");
                    assert!(kappa < most && (least - 1.0).abs() < 1e-9, "{what}");
                }
            }
        }
    }
}

/// Two rows of two bodies with different meshes: nodes at which four bodies meet are of both sides of different joints.
fn crossing(rho: f64) -> String {
    let body = |i: usize, j: usize| {
        let held = ["dirichlet = [\"left\"]\n", ""][i];
        let elements = [[8, 12], [6, 9]][i][j];
        let rho = if i == j { rho } else { 1.0 };
        format!(
            "[[body]]\nname = \"b{i}{j}\"\norigin = [{i}, {j}]\nsize = 1\nelements = {elements}\n\
             subdomains = {}\nrho = {rho:e}\nload = 1\n{held}",
            [2, 3][j]
        )
    };
    let pairs = [
        ["b00", "b10"],
        ["b01", "b11"],
        ["b00", "b01"],
        ["b10", "b11"],
    ];
    let tie = |[a, b]: [&str; 2]| format!("[[tie]]\nbodies = [\"{a}\", \"{b}\"]\n");
    let bodies = [body(0, 0), body(1, 0), body(0, 1), body(1, 1)].concat();
    bodies + &pairs.map(tie).concat()
}

#[test]
fn bodies_that_meet_at_a_point_keep_their_digits() {
    for rho in [1.0, 1e6, 1e12] {
        let scene = Scene::parse("s.toml", &crossing(rho)).expect("a scene");
        let problems = [0, usize::MAX].map(|coupled| {
            let problem = scene.substructures(&|_| true).expect("substructures");
            (coupled, problem)
        });
        let found = problems.map(|(coupled, problem)| {
            with_session(move |session| {
                let settings = MethodSettings::default().coupled(coupled);
                let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
                identities(&solver, 1e-7, "crossing");
                let s = solver.spectrum().expect("eigenvalues");
                let s = s.expect("multipliers");
                [s.lambda_min, s.lambda_max]
            })
        });
        println!("{rho:e}: {found:?}");
        let [[least, most], [_, dense]] = found;
        assert!((least - 1.0).abs() < 1e-8, "{rho:e}: {found:?}");
        assert!((most / dense - 1.0).abs() < 1e-2, "{rho:e}: {found:?}");
    }
}
