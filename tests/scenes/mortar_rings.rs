//! Two rings in contact, whose nodes do not match, under a pressure p₀ + p₂ cos 2θ outside, or with interference,
//! against the closed form (tests/data/rings.json).

use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use scene::Scene;
use serde_json::Value;

/// A quarter of the rings, with 2n × 3n and 2n × 4n elements.
fn scene(case: &Value, n: usize, order: usize) -> Scene {
    let of = |key: &str| case[key].as_f64().unwrap_or(0.0);
    let ring = |name: &str, radii: [f64; 2], around: usize, material: [f64; 2], more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nshape = {{ annulus = {{ inner = {}, outer = {}, from = 0, to = 90 }} }}\n\
             elements = [{}, {}]\nyoung = {}\npoisson = {}\n\
             dirichlet = {{ bottom = {{ y = 0 }}, top = {{ x = 0 }} }}\n{more}",
            radii[0],
            radii[1],
            2 * n,
            around * n,
            material[0],
            material[1]
        )
    };
    let pressure = format!(
        "pressure = {{ right = \"{} + {}*(x^2 - y^2)/(x^2 + y^2)\" }}\n",
        of("p0"),
        of("p2")
    );
    let inner = ring("inner", [of("i"), of("c")], 3, [of("E1"), of("nu1")], "");
    let outer = ring(
        "outer",
        [of("c"), of("o")],
        4,
        [of("E2"), of("nu2")],
        &pressure,
    );
    // The polygons of the two meshes differ by less than the interference, or count as touching.
    let text = format!(
        "physics = \"elasticity\"\norder = {order}\n{inner}{outer}[[contact]]\nbodies = [\"inner\", \"outer\"]\n\
         sides = [\"right\", \"left\"]\nadjust = {}\ngap = {}\n",
        0.05 * of("c"),
        0.0 - of("delta")
    );
    Scene::parse("rings.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The root mean square of the error of the pressure at the nodes, relative to its mean.
fn error(row: &Value, n: usize, order: usize) -> f64 {
    let scene = scene(&row["case"], n, order);
    assert!(scene.mortar_rows().next().is_some());
    let exact = |key: &str| row["at_contact"][key].as_f64().expect("a pressure");
    let (mean, wave) = (exact("pressure_mean"), exact("pressure_cos2"));
    let problem = scene.substructures(&|_| true).expect("substructures");
    with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-9);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        let solution = solver.solve().expect("a solution");
        assert!(solution.converged());
        let rows = solution.rows();
        let square = |r: &fetifeti::solution::SolvedRow| {
            let [x, y, _] = r.label.point;
            let cos2 = (x * x - y * y) / (x * x + y * y);
            let p = r.pressure().expect("an area");
            ((p - mean - wave * cos2) / mean).powi(2)
        };
        (rows.iter().map(square).sum::<f64>() / rows.len() as f64).sqrt()
    })
}

#[test]
fn rings_have_the_pressure_of_the_closed_form() {
    let text = include_str!("../data/rings.json");
    let table: Vec<Value> = serde_json::from_str(text).expect("JSON");
    assert_eq!(table.len(), 3);
    for row in &table {
        for order in [1, 2] {
            let errors = [4, 8, 16].map(|n| error(row, n, order));
            println!("order {order}: {errors:?}, {}", row["case"]);
            assert!(errors[2] < 1.2e-3, "{row}, order {order}: {errors:?}");
            let rate = (errors[0] / errors[2]).log2() / 2.0;
            assert!(
                rate > 1.3,
                "{row}, order {order}: {errors:?}, order {rate:.2}"
            );
        }
    }
}
