//! Contact at nodes on an axis of symmetry, which have a small ring around them or none: a cylinder that is pressed
//! onto something soft closes by p/k everywhere.

use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use crate::support::surface_mesh::gmsh;
use serde_json::Value;

const PRESSURE: f64 = 2.0;
const STIFFNESS: f64 = 50.0;
const YOUNG: f64 = 100.0;
const RADIUS: f64 = 2.0;

/// The report of a scene on some ranks, and the rows of its interfaces by the names of their columns.
fn solved(name: &str, text: &str, ranks: usize) -> (Value, Vec<Vec<f64>>) {
    let scratch = Scratch::new(&format!("axis-{name}-{ranks}"));
    scratch.file("section.msh", &section());
    let (scene, out) = (scratch.file("scene.toml", text), scratch.path("out"));
    let args = [
        "solve",
        &scene,
        "--out",
        &out,
        "-fetifeti_ksp_rtol",
        "1e-10",
    ];
    let run = run_fetifeti(ranks, &args);
    assert_eq!(run.code, 0, "{name}: {}", run.all());
    let read = |file| std::fs::read_to_string(format!("{out}/{file}")).expect("a result");
    let csv = read("interfaces.csv");
    let mut lines = csv.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let names = lines.next().expect("names");
    let place = |name| names.iter().position(|n| *n == name).expect("a column");
    let places = ["x", "gap", "pressure", "area"].map(place);
    // A node without an area has no pressure.
    let number = |text: &str| text.parse().unwrap_or(f64::NAN);
    let rows = lines.map(|l| places.map(|k| number(l[k])).to_vec());
    let rows = rows.collect();
    (
        serde_json::from_str(&read("report.json")).expect("JSON"),
        rows,
    )
}

/// The half section of a cylinder of radius 2 and height 1 in elements of first order: quadrilaterals above triangles.
fn section() -> String {
    let at = |i: usize, j: usize| j * 7 + i;
    let mut points = Vec::new();
    for j in 0..3 {
        // Rings are no wider than others near the axis only.
        points.extend((0..7).map(|i| [RADIUS * (i as f64 / 6.0).powf(1.3), j as f64 / 2.0, 0.0]));
    }
    let mut cells = Vec::new();
    for i in 0..6 {
        cells.push(vec![at(i, 0), at(i + 1, 0), at(i + 1, 1)]);
        cells.push(vec![at(i, 0), at(i + 1, 1), at(i, 1)]);
        cells.push(vec![at(i, 1), at(i + 1, 1), at(i + 1, 2), at(i, 2)]);
    }
    let bottom = (0..6).map(|i| vec![at(i, 0), at(i + 1, 0)]).collect();
    let top = (0..6).map(|i| vec![at(i + 1, 2), at(i, 2)]).collect();
    gmsh(
        &points,
        &[("cylinder", cells), ("bottom", bottom), ("top", top)],
    )
}

/// Probes of a body along its lower face, at the height `y`.
fn probes(body: &str, y: f64) -> String {
    let one = |x| format!("[[probe]]\nname = \"{x}\"\nbody = \"{body}\"\npoint = [{x}, {y}]\n");
    [0.0, 2.0].map(one).concat()
}

/// All rows close by p/k, and so do the probes, which have come down by `lower` more; the areas are those of the disc
/// as a whole.
fn check(name: &str, text: &str, poisson: f64, lower: f64) {
    let close = PRESSURE / STIFFNESS;
    for ranks in [1, 2] {
        let (report, rows) = solved(name, text, ranks);
        let what = format!("{name}, {ranks} ranks");
        assert!(rows.len() >= 6, "{what}");
        for row in &rows {
            assert!((row[1] + close).abs() < 1e-8, "{what}: gap {row:?}");
            assert!((row[2] - PRESSURE).abs() < 1e-6, "{what}: pressure {row:?}");
        }
        let area: f64 = rows.iter().map(|row| row[3]).sum();
        let disc = std::f64::consts::PI * RADIUS * RADIUS;
        assert!((area - disc).abs() < 1e-9, "{what}: {area}");
        for probe in report["probes"].as_array().expect("probes") {
            let at = |key: &str, k: usize| probe[key][k].as_f64().expect("a number");
            let wider = poisson * PRESSURE / YOUNG * at("point", 0);
            assert!((at("u", 0) - wider).abs() < 1e-7, "{what}: {probe}");
            assert!((at("u", 1) + close + lower).abs() < 1e-7, "{what}: {probe}");
        }
    }
}

/// Pushed along its normal a cylinder stays one. With Poisson's ratio 0 nothing slips, so that friction has no force.
#[test]
fn a_cylinder_closes_a_soft_contact_evenly_to_its_axis() {
    let plane = "[[obstacle]]\nbody = \"cylinder\"\nplane = { point = [0, 0], normal = [0, 1] }\n";
    let first = "[mesh]\nfile = \"section.msh\"\n[[body]]\nname = \"cylinder\"\nsubdomains = 2\n";
    let second = "order = 2\n[[body]]\nname = \"cylinder\"\nsize = [2, 1]\nelements = [6, 2]\n\
                  subdomains = [2, 1]\n";
    for (order, body) in [("first", first), ("second", second)] {
        for (law, poisson, more) in [
            ("frictionless", 0.3, ""),
            ("friction", 0.0, "friction = 0.3\n"),
            ("elastic", 0.0, "friction = 0.3\nstick_stiffness = 20\n"),
        ] {
            let text = format!(
                "physics = \"elasticity\"\nplane = \"axisymmetric\"\n{body}young = {YOUNG}\npoisson = {poisson}\n\
                 pressure = {{ top = {PRESSURE} }}\n{plane}side = \"bottom\"\nstiffness = {STIFFNESS}\n{more}{}",
                probes("cylinder", 0.0)
            );
            check(&format!("{order}-{law}"), &text, poisson, 0.0);
        }
    }
}

/// A cylinder on another one of the same radius, which gives way by p/E of its height 1. Where the nodes of the sides
/// do not match, the node on the axis has no row of its own either.
#[test]
fn two_cylinders_close_evenly_to_their_axis() {
    for (name, elements) in [("matching", 6), ("mortar", 5)] {
        let text = format!(
            "physics = \"elasticity\"\nplane = \"axisymmetric\"\norder = 2\n\
             [[body]]\nname = \"low\"\nsize = [2, 1]\nelements = [{elements}, 2]\nyoung = {YOUNG}\npoisson = 0.3\n\
             dirichlet = {{ bottom = {{ y = 0 }} }}\n\
             [[body]]\nname = \"high\"\norigin = [0, 1]\nsize = [2, 1]\nelements = [6, 2]\nyoung = {YOUNG}\n\
             poisson = 0.3\npressure = {{ top = {PRESSURE} }}\n\
             [[contact]]\nbodies = [\"high\", \"low\"]\nstiffness = {STIFFNESS}\nfriction = 0.3\n{}",
            probes("high", 1.0)
        );
        check(name, &text, 0.3, PRESSURE / YOUNG);
    }
}
