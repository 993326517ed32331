//! Balances of bodies: reactions are what the elements say, and everything on a body adds up to nothing.

use crate::support::checks::number;
use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use deck::{read_dat, DatQuantity};
use serde_json::Value;
use std::fmt::Write;
use std::fs;

const CASES: &str = "../../tests/data/cases";

/// Solves a file on some ranks; returns the report.
fn solve(file: &str, dir: &Scratch, ranks: usize, more: &[&str]) -> Value {
    let (out, json) = (dir.path("out"), dir.path("report.json"));
    let run = run_fetifeti(
        ranks,
        &[&["solve", file, "--out", &out, "--json", &json], more].concat(),
    );
    assert_eq!(run.code, 0, "{}", run.all());
    assert!(!run.stderr.contains("Warning"), "{}", run.stderr);
    serde_json::from_str(&fs::read_to_string(json).expect("a report")).expect("JSON")
}

/// A force by components; a number is one component, and what is missing has none.
fn force(v: &Value) -> Vec<f64> {
    match v {
        Value::Null => vec![0.0; 3],
        Value::Array(list) => list.iter().map(number).collect(),
        x => vec![number(x)],
    }
}

fn body<'a>(report: &'a Value, name: &str) -> &'a Value {
    let all = report["contact"]["bodies"].as_array().expect("bodies");
    let found = all.iter().find(|b| b["name"] == name);
    found.unwrap_or_else(|| panic!("no body {name} in {all:?}"))
}

/// Every body's forces add up to nothing, by components, and so do the moments; `tolerance` is relative. `from` is the
/// first component that counts.
fn all_balance(report: &Value, tolerance: f64, from: usize) {
    let bodies = report["contact"]["bodies"].as_array().expect("bodies");
    let keys = ["load", "springs", "contact", "reaction"];
    let all = bodies.iter().flat_map(|b| keys.map(|k| force(&b[k])));
    let size = all.flatten().fold(0.0_f64, |a, x| a.max(x.abs()));
    for body in bodies {
        let parts: Vec<Vec<f64>> = keys.iter().map(|k| force(&body[*k])).collect();
        let c = parts[0].len();
        for d in from..c {
            let rest: f64 = parts.iter().map(|p| p[d]).sum();
            assert!(
                rest.abs() <= 10.0 * tolerance * size,
                "{rest:e} along {d}: {body}"
            );
        }
        assert!(number(&body["imbalance"]) <= tolerance, "{body}");
        for key in ["moment_imbalance", "held_moment_imbalance"] {
            if let Some(moment) = body.get(key) {
                assert!(number(moment) <= tolerance, "{key}: {body}");
            }
        }
    }
}

fn near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance, "{found:?}, not {expected:?}");
    }
}

/// A block on a base with turned axes bears 10 by its base, on one rank and on two; the forces that the deck prints are
/// the reactions.
#[test]
fn reactions_in_turned_systems_count() {
    let deck = format!("{CASES}/10_balance_of_inclined_support.inp");
    for ranks in [1, 2] {
        let dir = Scratch::new(&format!("balance-turned-{ranks}"));
        let report = solve(&deck, &dir, ranks, &[]);
        let low = body(&report, "LOW");
        near(&force(&low["reaction"]), &[0.0, 0.0, 10.0], 1e-6);
        all_balance(&report, 1e-6, 0);
        let dat = dir.path("out/10_balance_of_inclined_support.dat");
        let tables = read_dat(&fs::read_to_string(dat).expect("tables"));
        let forces = tables
            .iter()
            .find(|t| t.quantity == DatQuantity::TotalForce);
        let total = forces.expect("forces").rows[0].vector;
        near(&force(&low["reaction"]), &total, 1e-5);
    }
}

/// Polygons in rings do not match: each term of a mortar row has a lever arm of its own.
#[test]
fn moments_of_mortar_rows_are_those_of_all_their_nodes() {
    let deck = format!("{CASES}/11_balance_of_moments.inp");
    for ranks in [1, 2] {
        let dir = Scratch::new(&format!("balance-rings-{ranks}"));
        let report = solve(&deck, &dir, ranks, &["-fetifeti_ksp_rtol", "1e-11"]);
        let middle = body(&report, "MID");
        assert!(number(&middle["moment_imbalance"]) < 1e-9, "{middle}");
        assert!(middle["reaction"].is_null());
        all_balance(&report, 1e-9, 0);
    }
}

/// The springs below the lower block bear what lies on it.
#[test]
fn springs_are_a_force_of_their_own() {
    let scene = format!("{CASES}/21_spring_balance.toml");
    for ranks in [1, 2] {
        let dir = Scratch::new(&format!("balance-springs-{ranks}"));
        let report = solve(&scene, &dir, ranks, &["-fetifeti_ksp_rtol", "1e-10"]);
        let low = body(&report, "low");
        near(&force(&low["springs"])[1..], &[1.0], 1e-8);
        near(&force(&low["contact"])[1..], &[-1.0], 1e-8);
        assert!(body(&report, "high").get("springs").is_none());
        all_balance(&report, 1e-8, 0);
    }
}

/// Springs and given displacements that grow over load steps, and an obstacle: at the last step the foundation, which
/// is pressed in by 0.3 more than it was at t = 0.5, has the force k u of a rigid plate.
#[test]
fn springs_follow_load_steps_and_meet_obstacles() {
    let text = r#"
title = "a stiff plate on springs, pressed down in steps, and beside it a stop"
dimension = 2
physics = "elasticity"
[steps]
count = 3
dirichlet = "t"
[[body]]
name = "plate"
size = [2, 0.5]
elements = [8, 2]
subdomains = [2, 1]
young = 1e6
poisson = 0
spring = { bottom = 10 }
dirichlet = { left = { x = 0 } }
[[body]]
name = "punch"
origin = [0, 0.5]
size = [2, 0.5]
elements = [8, 2]
subdomains = [2, 1]
young = 1e6
poisson = 0
dirichlet = { top = { x = 0, y = -0.3 } }
[[contact]]
bodies = ["plate", "punch"]
[[obstacle]]
body = "plate"
side = "bottom"
plane = { point = [0, -0.2], normal = [0, 1] }
"#;
    let dir = Scratch::new("balance-steps");
    let scene = dir.path("steps.toml");
    fs::write(&scene, text).unwrap();
    let report = solve(&scene, &dir, 1, &["-fetifeti_ksp_rtol", "1e-9"]);
    let plate = body(&report, "plate");
    // The springs are at the stop: 10 per area, over a length of 2, times 0.2.
    near(&force(&plate["springs"])[1..], &[4.0], 1e-3);
    // Whatever the punch presses with beyond that is borne by the stop.
    let punch = force(&body(&report, "punch")["reaction"])[1];
    let stop = report["contact"]["interfaces"].as_array().unwrap();
    let stop = stop.iter().find(|i| i["kind"] == "obstacle").unwrap();
    let on_stop = number(&stop["force"]);
    assert!(on_stop > 1e4, "{stop}");
    assert!(
        (punch + 4.0 + on_stop).abs() < 1e-5 * on_stop,
        "{punch} {on_stop}"
    );
    all_balance(&report, 1e-6, 0);
}

/// Rings balance along their axis: a ring that stands on springs and is pushed on by another one.
#[test]
fn rings_balance_along_the_axis() {
    let text = r#"
title = "two rings, one on springs"
dimension = 2
physics = "elasticity"
plane = "axisymmetric"
[[body]]
name = "low"
origin = [1, 0]
size = [1, 1]
order = 2
elements = 6
subdomains = [2, 1]
young = 1000
poisson = 0.3
spring = { bottom = 7 }
[[body]]
name = "high"
origin = [1, 1]
size = [1, 1]
order = 2
elements = 6
subdomains = [2, 1]
young = 1000
poisson = 0.3
traction = { top = [0, -2] }
dirichlet = { right = { x = 0 } }
[[contact]]
bodies = ["low", "high"]
"#;
    let dir = Scratch::new("balance-rings-axial");
    let scene = dir.path("rings.toml");
    fs::write(&scene, text).unwrap();
    let report = solve(&scene, &dir, 1, &["-fetifeti_ksp_rtol", "1e-10"]);
    // 2 on the area π (2² − 1²).
    let expected = 2.0 * 3.0 * std::f64::consts::PI;
    near(
        &force(&body(&report, "low")["springs"])[1..],
        &[expected],
        1e-7,
    );
    let high = body(&report, "high");
    near(&force(&high["reaction"])[1..], &[0.0], 1e-7);
    // The wall holds the ring radially: inwards.
    assert!(force(&high["reaction"])[0] < 0.0, "{high}");
    assert!(high.get("held_moment_imbalance").is_none());
    all_balance(&report, 1e-8, 1);
}

/// Scalars: a body on springs below a loaded one, of which the sides with given values bear the rest.
#[test]
fn scalars_balance_with_springs_and_given_values() {
    let text = r#"
title = "membranes"
[[body]]
name = "a"
size = [1, 1]
elements = 8
subdomains = [2, 2]
spring = { bottom = "5 + x" }
load = -1
dirichlet = { left = "0.1*y" }
[[body]]
name = "b"
origin = [0, 1]
size = [1, 1]
elements = 8
subdomains = [2, 2]
load = -3
dirichlet = { top = 0.2 }
[[contact]]
bodies = ["a", "b"]
"#;
    for ranks in [1, 2] {
        let dir = Scratch::new(&format!("balance-scalar-{ranks}"));
        let scene = dir.path("scalar.toml");
        fs::write(&scene, text).unwrap();
        let report = solve(&scene, &dir, ranks, &["-fetifeti_ksp_rtol", "1e-10"]);
        near(&force(&body(&report, "a")["load"]), &[-1.0], 1e-12);
        assert!(force(&body(&report, "a")["springs"])[0].abs() > 1e-3);
        assert!(force(&body(&report, "b")["reaction"])[0] > 1.0);
        all_balance(&report, 1e-8, 0);
    }
}

/// Nodes and cells of a box of n × n × n hexahedra from `low` to `high`, with numbers above `first`.
fn brick(deck: &mut String, name: &str, first: usize, n: usize, low: [f64; 3], high: [f64; 3]) {
    let m = n + 1;
    let id = |i: usize, j: usize, k: usize| first + 1 + i + m * (j + m * k);
    writeln!(deck, "*NODE").unwrap();
    for k in 0..m.pow(3) {
        let place = [k % m, k / m % m, k / m / m];
        let x: [f64; 3] =
            std::array::from_fn(|d| low[d] + (high[d] - low[d]) * place[d] as f64 / n as f64);
        writeln!(deck, "{}, {}, {}, {}", first + 1 + k, x[0], x[1], x[2]).unwrap();
    }
    writeln!(deck, "*ELEMENT, TYPE=C3D8, ELSET={name}").unwrap();
    for e in 0..n.pow(3) {
        let [i, j, k] = [e % n, e / n % n, e / n / n];
        let ring = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let corners = [0, 1].map(|up| ring.map(|(a, b)| id(i + a, j + b, k + up).to_string()));
        writeln!(deck, "{}, {}", first + 1 + e, corners.concat().join(", ")).unwrap();
    }
    for (side, k) in [("LOW", 0), ("TOP", n)] {
        writeln!(deck, "*NSET, NSET={name}_{side}").unwrap();
        for place in 0..m * m {
            writeln!(deck, "{},", id(place % m, place / m, k)).unwrap();
        }
        let layer = if k == 0 { 0 } else { n - 1 };
        writeln!(deck, "*SURFACE, NAME={name}_S{side}, TYPE=ELEMENT").unwrap();
        for e in layer * n * n..(layer + 1) * n * n {
            writeln!(deck, "{}, S{}", first + 1 + e, if k == 0 { 1 } else { 2 }).unwrap();
        }
    }
}

const MATERIAL: &str = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SURFACE INTERACTION, NAME=I\n\
    *SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n";

/// Equations hang a block on another one, below which a third lies in contact with different nodes: forces of equations
/// count on both bodies, and nodes in contact bear no force from outside, though rows have many nodes.
#[test]
fn forces_of_equations_and_of_mortar_rows_count_at_their_nodes() {
    let mut deck = String::new();
    brick(&mut deck, "BASE", 0, 2, [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]);
    brick(&mut deck, "MID", 1000, 3, [0.0, 0.0, 1.0], [1.0, 1.0, 2.0]);
    brick(&mut deck, "UP", 2000, 3, [0.0, 0.0, 3.0], [1.0, 1.0, 4.0]);
    for name in ["BASE", "MID", "UP"] {
        writeln!(deck, "*SOLID SECTION, ELSET={name}, MATERIAL=M").unwrap();
    }
    deck += MATERIAL;
    deck += "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nMID_SLOW, BASE_STOP\n";
    for d in 1..=3 {
        writeln!(deck, "*EQUATION\n2\nUP_LOW, {d}, 1., MID_TOP, {d}, -1.").unwrap();
    }
    deck += "*BOUNDARY\nBASE_LOW, 1, 3\n*BOUNDARY\nUP_TOP, 1, 2\n*STEP\n*STATIC\n*DSLOAD\nUP_STOP, P, 4.\n\
        *CLOAD\n1064, 1, 0.5\n*NODE PRINT, NSET=MID_LOW\nRF\n*NODE PRINT, NSET=BASE_LOW, TOTALS=ONLY\nRF\n*END STEP\n";
    for ranks in [1, 2] {
        let dir = Scratch::new(&format!("balance-equations-{ranks}"));
        let file = dir.path("equations.inp");
        fs::write(&file, &deck).unwrap();
        let report = solve(&file, &dir, ranks, &["-fetifeti_ksp_rtol", "1e-10"]);
        near(
            &force(&body(&report, "UP")["load"]),
            &[0.0, 0.0, -4.0],
            1e-9,
        );
        near(&force(&body(&report, "UP")["contact"])[2..], &[4.0], 1e-6);
        near(
            &force(&body(&report, "BASE")["reaction"])[2..],
            &[4.0],
            1e-6,
        );
        near(
            &force(&body(&report, "MID")["load"]),
            &[0.5, 0.0, 0.0],
            1e-12,
        );
        all_balance(&report, 1e-7, 0);
        let dat = fs::read_to_string(dir.path("out/equations.dat")).expect("tables");
        for table in read_dat(&dat).iter() {
            match &table.set[..] {
                "MID_LOW" => {
                    let forces = table.rows.iter().flat_map(|r| r.vector);
                    assert!(forces.clone().count() > 40);
                    forces.for_each(|f| assert!(f.abs() < 1e-6, "{table:?}"));
                }
                _ => near(
                    &table.rows[0].vector,
                    &force(&body(&report, "BASE")["reaction"]),
                    1e-5,
                ),
            }
        }
    }
}

/// A base whose lower nodes are held along turned axes in two directions and along a coordinate in the third, with
/// given displacements, and a block on it: CalculiX's rule for RF, as sums, is the reaction.
#[test]
fn turned_and_plain_supports_share_nodes() {
    let mut deck = String::new();
    brick(&mut deck, "BASE", 0, 2, [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]);
    brick(&mut deck, "UP", 1000, 2, [0.0, 0.0, 1.0], [1.0, 1.0, 2.0]);
    for name in ["BASE", "UP"] {
        writeln!(deck, "*SOLID SECTION, ELSET={name}, MATERIAL=M").unwrap();
    }
    deck += MATERIAL;
    deck += "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nUP_SLOW, BASE_STOP\n\
        *TRANSFORM, NSET=BASE_LOW, TYPE=R\n0.6, 0.8, 0., -0.8, 0.6, 0.\n*BOUNDARY\nBASE_LOW, 1, 3\n\
        *STEP\n*STATIC\n*BOUNDARY\nBASE_LOW, 1, 1, 0.01\nUP_TOP, 1, 2\nUP_TOP, 3, 3, -0.02\n\
        *NODE PRINT, NSET=BASE_LOW, TOTALS=ONLY, GLOBAL=YES\nRF\n*NODE PRINT, NSET=UP_TOP, TOTALS=ONLY\nRF\n\
        *END STEP\n";
    let dir = Scratch::new("balance-shared-nodes");
    let file = dir.path("shared.inp");
    fs::write(&file, &deck).unwrap();
    let report = solve(&file, &dir, 1, &["-fetifeti_ksp_rtol", "1e-10"]);
    all_balance(&report, 1e-7, 0);
    let dat = fs::read_to_string(dir.path("out/shared.dat")).expect("tables");
    for table in read_dat(&dat).iter() {
        let name = table.set.split('_').next().expect("a name");
        let reaction = force(&body(&report, name)["reaction"]);
        assert!(reaction[2].abs() > 1.0, "{reaction:?}");
        near(&table.rows[0].vector, &reaction, 1e-5 * reaction[2].abs());
    }
}
