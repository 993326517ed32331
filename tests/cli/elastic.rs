//! `fetifeti solve` and `plan` on elastic and three-dimensional scenes: report, files, pressures, balances.

use crate::support::checks::number;
use crate::support::vtu::Vtu;
use crate::support::{mpi, program};
use std::fs;

use mpi::Scratch;
use program::{fetifeti, run_fetifeti};
use serde_json::Value;

fn vector(v: &Value) -> Vec<f64> {
    let list = v.as_array().unwrap_or_else(|| panic!("{v} is no list"));
    list.iter().map(number).collect()
}

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

/// A column of a table with the names of its columns on the first line; an empty field is NaN.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let mut names = lines.next().expect("a head").split(',');
    let k = names
        .position(|n| n == name)
        .unwrap_or_else(|| panic!("no column {name} in {csv}"));
    let value = |line: &str| {
        let field = line.split(',').nth(k).expect("a field");
        field.parse().unwrap_or(f64::NAN)
    };
    lines.map(value).collect()
}

/// Solves a scene; returns its report, its interfaces as CSV and its grid as VTU.
fn solve(scene: &str, dir: &Scratch, more: &[&str]) -> (Value, String, String) {
    let out = dir.path("out");
    let run = fetifeti(&[&["solve", scene, "--out", &out], more].concat());
    assert_eq!(run.code, 0, "{}", run.all());
    let text = |name: &str| fs::read_to_string(format!("{out}/{name}")).unwrap_or_default();
    let report = serde_json::from_str(&text("report.json")).expect("a report");
    (report, text("interfaces.csv"), text("solution.vtu"))
}

/// The attributes of a data array of a VTU file.
fn array<'a>(vtu: &'a str, name: &str) -> &'a str {
    let tag = format!("Name=\"{name}\"");
    let line = vtu.lines().find(|l| l.contains(&tag));
    line.unwrap_or_else(|| panic!("no array {name}"))
}

/// Pressure between two concentric pipes in plane strain under pressure p inside, by Lamé's solution: σ_r = A − B/r²
/// and u = (1 + ν)/E ((1 − 2ν) A r + B/r).
fn pipes(p: f64, radii: [f64; 3], young: [f64; 2], nu: f64) -> f64 {
    // Displacement at r of a pipe from a to b with pressures p inside and q outside.
    let u = |e: f64, [a, b]: [f64; 2], [p, q]: [f64; 2], r: f64| {
        let square = b * b - a * a;
        let mean = (p * a * a - q * b * b) / square;
        let lift = (p - q) * a * a * b * b / square;
        (1.0 + nu) / e * ((1.0 - 2.0 * nu) * mean * r + lift / r)
    };
    let [a, b, c] = radii;
    let apart = |q: f64| u(young[0], [a, b], [p, q], b) - u(young[1], [b, c], [q, 0.0], b);
    // The condition is linear in q.
    apart(0.0) / (apart(0.0) - apart(1.0))
}

#[test]
fn pipes_press_on_each_other_as_lame_says() {
    let dir = Scratch::new("elastic-annulus");
    let (report, csv, vtu) = solve("../../examples/scenes/annulus.toml", &dir, &[]);
    assert_eq!(report["dimension"], 2);
    assert_eq!(report["physics"], "elasticity");
    assert_eq!(report["components"], 2);
    let expected = pipes(10.0, [1.0, 1.5, 2.0], [1000.0, 2000.0], 0.3);
    let pressure = column(&csv, "pressure");
    assert_eq!(pressure.len(), 25);
    for p in &pressure {
        assert!(near(*p, expected, 0.01 * expected), "{p} {expected}");
    }
    let face = &report["contact"]["interfaces"][0];
    let largest = pressure.iter().copied().fold(0.0, f64::max);
    // The decimal text of a number may lose its last digit.
    assert!(near(
        number(&face["max_pressure"]),
        largest,
        1e-14 * largest
    ));
    // A polygon of 24 chords.
    let arc = 48.0 * 1.5 * (std::f64::consts::PI / 96.0).sin();
    assert!(near(number(&face["area"]), arc, 1e-10), "{face}");
    let areas: f64 = column(&csv, "area").iter().sum();
    assert!(near(areas, arc, 1e-10));
    // The resultant on a quarter is pressure times radius in both directions; the sum of the multipliers is not.
    let resultant = vector(&face["resultant"]);
    assert!(
        near(resultant[0], 1.5 * expected, 0.01 * expected),
        "{face}"
    );
    assert!(near(resultant[0], resultant[1], 1e-4));
    assert!(number(&face["force"]) > 1.5 * resultant[0]);
    for body in report["contact"]["bodies"].as_array().unwrap() {
        let [load, contact, reaction] =
            ["load", "contact", "reaction"].map(|key| vector(&body[key]));
        for d in 0..2 {
            assert!(near(load[d] + contact[d] + reaction[d], 0.0, 1e-12));
        }
    }
    assert!(array(&vtu, "u").contains("NumberOfComponents=\"3\""));
    assert!(array(&vtu, "stress").contains("NumberOfComponents=\"6\""));
    for name in [
        "von_mises",
        "pressure",
        "young",
        "poisson",
        "contact_pressure",
    ] {
        assert!(!array(&vtu, name).contains("Components"), "{name}");
    }
    assert!(!vtu.contains("Name=\"rho\""));
    // A point per node of each body, whatever its subdomains; averaged stress follows Lamé's solution inside the pipe,
    // where the cells around a node stand on either side of it.
    let vtu = Vtu(vtu);
    let (points, stress) = (vtu.points(), vtu.floats("PointData", "stress"));
    assert_eq!(points.len(), 2 * 9 * 25);
    // σ_r + σ_φ = 2A is constant in a pipe.
    let square = 1.5_f64.powi(2);
    let a = (10.0 - expected * square) / (square - 1.0);
    let mut compared = 0;
    for (p, s) in points.iter().zip(stress.chunks_exact(6)) {
        let r = p[0].hypot(p[1]);
        if r > 1.0 + 1e-9 && r < 1.5 - 1e-9 {
            assert!(near(s[0] + s[1], 2.0 * a, 0.1), "{p:?} {s:?} {a}");
            compared += 1;
        }
    }
    assert_eq!(compared, 7 * 25);
}

#[test]
fn blocks_have_a_map_of_pressure_and_forces_with_directions() {
    let dir = Scratch::new("elastic-blocks");
    let scene = "../../examples/scenes/blocks_3d.toml";
    let (report, csv, vtu) = solve(scene, &dir, &["-fetifeti_ksp_rtol", "1e-9"]);
    assert_eq!(report["dimension"], 3);
    assert_eq!(report["components"], 3);
    assert_eq!(
        csv.lines().next().unwrap(),
        "name,t,s,x,y,z,gap,multiplier,active,pressure,area"
    );
    let [pressure, area, force] = ["pressure", "area", "multiplier"].map(|c| column(&csv, c));
    assert_eq!(pressure.len(), 81);
    for k in 0..81 {
        assert!(near(pressure[k] * area[k], force[k], 1e-12));
    }
    // The top of the lower block is flat: 2 × 2.
    assert!(near(area.iter().sum(), 4.0, 1e-12));
    let face = &report["contact"]["interfaces"][0];
    // The lower block carries the traction on the upper one.
    assert!(near(vector(&face["resultant"])[1], 8.0, 1e-6), "{face}");
    let active = column(&csv, "active");
    let touching: f64 = (0..81).filter(|&k| active[k] == 1.0).map(|k| area[k]).sum();
    assert!(near(number(&face["area"]), touching, 1e-12));
    assert!(touching < 4.0);
    let high = &report["contact"]["bodies"][0];
    let high = match high["name"].as_str() {
        Some("high") => high,
        _ => &report["contact"]["bodies"][1],
    };
    // It floats upwards, and is held sideways.
    assert_eq!(high["floating"], true);
    assert!(number(&high["imbalance"]) < 1e-6, "{high}");
    assert_eq!(vector(&high["reaction"])[1], 0.0);
    assert!(array(&vtu, "types").contains("UInt8"));
    assert!(array(&vtu, "contact_pressure").contains("Float64"));

    let plan = fetifeti(&["plan", scene]);
    for part in [
        "8 x 4 x 8",
        "2 x 1 x 2",
        "floats (1)",
        "three-dimensional elasticity, Q1, no cure of locking",
        "1 of 2 bodies float, 1 in some",
        "share 64 edges",
    ] {
        assert!(plan.stdout.contains(part), "{part}: {}", plan.all());
    }
    let summary = run_summary(scene);
    assert!(summary.contains("physics"), "{summary}");
    assert!(summary.contains("largest pressure"), "{summary}");
}

/// The summary that `solve` prints.
fn run_summary(scene: &str) -> String {
    let run = fetifeti(&["solve", scene]);
    assert_eq!(run.code, 0, "{}", run.all());
    run.stdout
}

#[test]
fn loose_bodies_balance_in_forces_and_moments() {
    let dir = Scratch::new("elastic-moments");
    // A cantilever of three bodies, of which two float, above an obstacle that its end comes to lie on.
    let text = fs::read_to_string("../../examples/scenes/beam_2d.toml").unwrap();
    let obstacle = "\n[[obstacle]]\nbody = \"b2_0\"\nside = \"bottom\"\n\
                    plane = { point = [0, -0.05], normal = [0, 1] }\n";
    let scene = dir.path("beam.toml");
    fs::write(&scene, text + obstacle).unwrap();
    let (report, csv, _) = solve(&scene, &dir, &["-fetifeti_ksp_rtol", "1e-10"]);
    let bodies = report["contact"]["bodies"].as_array().unwrap();
    let loose: Vec<&Value> = bodies
        .iter()
        .filter(|b| b.get("moment_imbalance").is_some())
        .collect();
    assert_eq!(loose.len(), 2, "{bodies:?}");
    for body in loose {
        assert!(body["reaction"].is_null());
        assert!(number(&body["imbalance"]) < 1e-7, "{body}");
        assert!(number(&body["moment_imbalance"]) < 1e-7, "{body}");
    }
    let held = bodies.iter().find(|b| b["name"] == "b0_0").unwrap();
    let ground: f64 = column(&csv, "multiplier").iter().sum();
    assert!(ground > 0.0);
    // The wall carries the part of the load that the ground does not.
    let reaction = vector(&held["reaction"]);
    assert!(near(reaction[1], 0.2 - ground, 1e-6), "{held} {ground}");
    // A tied interface has a resultant and no pressure.
    let interfaces = report["contact"]["interfaces"].as_array().unwrap();
    let tied = interfaces.iter().find(|i| i["kind"] == "tied").unwrap();
    assert!(near(
        vector(&tied["resultant"])[1].abs(),
        reaction[1].abs(),
        1e-6
    ));
    assert!(tied.get("max_pressure").is_none());
}

#[test]
fn scalar_solids_have_pictures_and_no_vectors() {
    let dir = Scratch::new("scalar-solid");
    let (report, csv, vtu) = solve("../../examples/scenes/cube_3d.toml", &dir, &[]);
    assert_eq!(report["dimension"], 3);
    assert_eq!(report["physics"], "scalar");
    assert_eq!(csv, "", "nothing touches");
    assert!(array(&vtu, "rho").contains("Float64"));
    assert!(!array(&vtu, "u").contains("Components"));
    let picture = fs::File::open(dir.path("out/solution.png")).unwrap();
    let info = png::Decoder::new(picture).read_info().unwrap();
    assert!(info.info().width > info.info().height);
}

#[test]
fn two_ranks_write_the_same() {
    let [one, two] = ["elastic-one", "elastic-two"].map(Scratch::new);
    let scene = "../../examples/scenes/blocks_3d.toml";
    let args = ["-fetifeti_ksp_rtol", "1e-10"];
    let (a, first, _) = solve(scene, &one, &args);
    let out = two.path("out");
    let run = run_fetifeti(2, &[&["solve", scene, "--out", &out][..], &args].concat());
    assert_eq!(run.code, 0, "{}", run.all());
    let second = fs::read_to_string(format!("{out}/interfaces.csv")).unwrap();
    for name in ["multiplier", "pressure", "area", "gap"] {
        let pairs = column(&first, name).into_iter().zip(column(&second, name));
        for (x, y) in pairs {
            assert!(near(x, y, 1e-7), "{name}: {x} {y}");
        }
    }
    let text = fs::read_to_string(format!("{out}/report.json")).unwrap();
    let b: Value = serde_json::from_str(&text).unwrap();
    let resultant = |v: &Value| vector(&v["contact"]["interfaces"][0]["resultant"]);
    for (x, y) in resultant(&a).into_iter().zip(resultant(&b)) {
        assert!(near(x, y, 1e-6));
    }
}
