//! Motions without energy of elements with few points of integration.

use crate::support::mpi::{Output, Scratch};
use crate::support::program::run_fetifeti;
use serde_json::Value;

/// Solves a file; its report, if there is one.
fn solve(ranks: usize, file: &str, more: &[&str]) -> (Output, Value) {
    let first = [
        "solve",
        file,
        "--quiet",
        "--json",
        "-",
        "-fetifeti_ksp_rtol",
        "1e-10",
    ];
    let run = run_fetifeti(ranks, &[&first[..], more].concat());
    let report = serde_json::from_str(&run.stdout).unwrap_or(Value::Null);
    (run, report)
}

/// The displacements that the first table of a report has.
fn printed(report: &Value) -> Vec<[f64; 3]> {
    let rows = report["node_print"][0]["nodes"]
        .as_array()
        .expect("a table");
    let of = |row: &Value| [1, 2, 3].map(|d| row[d].as_f64().expect("a number"));
    rows.iter().map(of).collect()
}

/// The error of a solve that is refused, on some ranks.
fn refused(ranks: usize, file: &str) -> String {
    let (run, _) = solve(ranks, file, &[]);
    assert_eq!(run.code, 2, "{}", run.all());
    run.stderr
}

/// The pulled column: u_z of CalculiX 2.20, and no turn about the axis.
#[test]
fn a_pulled_column_of_wedges_does_not_turn() {
    for ranks in [1, 2] {
        let (run, report) = solve(
            ranks,
            "../../tests/data/cases/04c_wedge_column_pulled.inp",
            &[],
        );
        assert_eq!(run.code, 0, "{}", run.all());
        let top = printed(&report);
        for u in &top {
            assert!((u[2] - 8.741_655e-4).abs() < 1e-9, "{u:?}");
        }
        // The sum of r × u about the centroid.
        let about = [[-1.0, -1.0], [2.0, -1.0], [-1.0, 2.0]];
        let turn: f64 = top
            .iter()
            .zip(about)
            .map(|(u, r)| r[0] * u[1] - r[1] * u[0])
            .sum();
        assert!(turn.abs() < 1e-12, "{turn:e}");
        let notes = report["notes"].to_string();
        let said = "wedges of 6 nodes with 2 points of integration leave 3 motions without energy";
        assert!(notes.contains(said), "{notes}");
    }
    // With six points there is no such motion; CalculiX has no such element.
    let full = ["-fetifeti_full_integration"];
    let (run, report) = solve(
        1,
        "../../tests/data/cases/04c_wedge_column_pulled.inp",
        &full,
    );
    assert_eq!(run.code, 0, "{}", run.all());
    assert!(report.get("notes").is_none(), "{}", report["notes"]);
    assert!((printed(&report)[0][2] - 8.73e-4).abs() < 2e-6);
}

/// A torque drives what nothing holds: the sentence names the motion and the remedy, which works.
#[test]
fn a_twisted_column_of_wedges_is_refused_with_the_remedy() {
    let file = "../../tests/data/cases/04b_wedge_column_torque.inp";
    for ranks in [1, 2] {
        let said = refused(ranks, file);
        for part in [
            "`COL`",
            "the load drives a motion without energy of its wedges of 6 nodes with 2 points",
            "no support, tie or contact holds",
            "-fetifeti_full_integration",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
    let (run, report) = solve(1, file, &["-fetifeti_full_integration"]);
    assert_eq!(run.code, 0, "{}", run.all());
    // Force and reaction are a torque of 30 over a column of length 2.
    let turned = printed(&report)
        .iter()
        .flatten()
        .fold(0.0_f64, |a, u| a.max(u.abs()));
    assert!((1e-3..2e-2).contains(&turned), "{turned}");
}

/// A column of wedges along an axis, as a deck: `digits` of its coordinates are written.
fn column(n: usize, axis: [[f64; 3]; 3], digits: usize, load: [f64; 3], turn: f64) -> String {
    let point = |x: [f64; 3]| [0, 1, 2].map(|d| (0..3).map(|k| x[k] * axis[k][d]).sum::<f64>());
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let mut text = String::from("*NODE\n");
    for k in 0..=n {
        for (j, [x, y]) in corners.into_iter().enumerate() {
            let [x, y, z] = point([x, y, k as f64]);
            let id = 3 * k + j + 1;
            text += &format!("{id}, {x:.digits$}, {y:.digits$}, {z:.digits$}\n");
        }
    }
    text += "*ELEMENT, TYPE=C3D6, ELSET=COL\n";
    for k in 0..n {
        let nodes: Vec<String> = (1..=6).map(|j| (3 * k + j).to_string()).collect();
        text += &format!("{}, {}\n", k + 1, nodes.join(", "));
    }
    let top = [3 * n + 1, 3 * n + 2, 3 * n + 3];
    text += &format!(
        "*NSET, NSET=BASE\n1, 2, 3\n*NSET, NSET=TOP\n{}, {}, {}\n",
        top[0], top[1], top[2]
    );
    text += "*MATERIAL, NAME=M\n*ELASTIC\n200000., 0.3\n*SOLID SECTION, ELSET=COL, MATERIAL=M\n";
    text += "*STEP\n*STATIC\n*BOUNDARY\nBASE, 1, 3\n*CLOAD\n";
    for (node, [x, y]) in top.into_iter().zip(corners) {
        let about = [-turn * (y - 1.0 / 3.0), turn * (x - 1.0 / 3.0), 0.0];
        let force = point([0, 1, 2].map(|d| load[d] + about[d]));
        for (d, f) in force.into_iter().enumerate() {
            text += &format!("{node}, {}, {f:.15e}\n", d + 1);
        }
    }
    text + "*NODE PRINT, NSET=TOP\nU\n*END STEP\n"
}

const UPRIGHT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Three axes at right angles, none along a coordinate.
const TURNED: [[f64; 3]; 3] = [
    [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0],
    [-2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0],
    [1.0 / 3.0, -2.0 / 3.0, 2.0 / 3.0],
];

/// Long columns, and columns whose coordinates have few digits: a motion that costs but their rounding is none. The
/// displacement along the axis is that of CalculiX for 30 wedges, 8.974162e-3.
#[test]
fn long_and_rounded_columns_do_not_turn() {
    let scratch = Scratch::new("wedge-columns");
    for (axis, digits) in [
        (UPRIGHT, 3),
        (TURNED, 16),
        (TURNED, 9),
        (TURNED, 6),
        (TURNED, 5),
    ] {
        let deck = scratch.file(
            "column.inp",
            &column(30, axis, digits, [0.0, 0.0, 10.0], 0.0),
        );
        let (run, report) = solve(1, &deck, &[]);
        assert_eq!(run.code, 0, "{digits}: {}", run.all());
        for u in printed(&report) {
            let along: f64 = (0..3).map(|d| u[d] * axis[2][d]).sum();
            assert!(
                (along - 8.974_162e-3).abs() < 2e-5 * 8.97e-3 + 1e-8,
                "{digits}: {along:e}"
            );
            let across = (u.iter().map(|x| x * x).sum::<f64>() - along * along)
                .max(0.0)
                .sqrt();
            assert!(across < 1e-2 * along, "{digits}: {across:e}");
        }
        let turned = scratch.file("turned.inp", &column(30, axis, digits, [0.0; 3], 10.0));
        assert!(
            refused(1, &turned).contains("wedges of 6 nodes"),
            "{digits}"
        );
    }
}

/// The same column as a scene, in any number of subdomains and on any number of ranks; other elements, too: a column of
/// C3D20R, whose height grows in CalculiX by 2.714144e-3 under 10 N at each of the 8 nodes of its end.
#[test]
fn columns_in_subdomains_have_the_same_answer() {
    let scratch = Scratch::new("weak-scenes");
    scratch.file("column.inp", &column(30, UPRIGHT, 9, [0.0; 3], 0.0));
    let scene = |subdomains: usize, integration: &str| {
        format!(
            "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"column.inp\"\n[[body]]\nname = \"COL\"\n\
             young = 200000\npoisson = 0.3\nsubdomains = {subdomains}\nintegration = \"{integration}\"\n\
             dirichlet = {{ BASE = 0 }}\ntraction = {{ TOP = [0, 0, 60] }}\n\
             [[probe]]\nname = \"tip\"\npoint = [0, 0, 30]\n"
        )
    };
    for (subdomains, ranks) in [(1, 1), (3, 1), (4, 2), (7, 3)] {
        let file = scratch.file("column.toml", &scene(subdomains, "reduced"));
        let (run, report) = solve(ranks, &file, &[]);
        assert_eq!(run.code, 0, "{subdomains}: {}", run.all());
        let u = &report["probes"][0]["u"];
        let [x, y, z] = [0, 1, 2].map(|d| u[d].as_f64().expect("a number"));
        assert!((z - 8.974_162e-3).abs() < 1e-8, "{subdomains}: {z:e}");
        assert!(
            (x - 3e-5).abs() < 1e-9 && (y - 3e-5).abs() < 1e-9,
            "{subdomains}: {x:e} {y:e}"
        );
    }
    let file = scratch.file("column.toml", &scene(3, "full"));
    let (run, report) = solve(1, &file, &[]);
    assert_eq!(run.code, 0, "{}", run.all());
    assert!(report.get("notes").is_none(), "{}", report["notes"]);
    let file = scratch.file("column.toml", &scene(3, "selective"));
    assert!(refused(1, &file).contains("\"incompatible\""));
}

/// A deck of a clamped block of C3D8, a column of wedges tied to it, and a block of C3D8 tied to its top.
fn between_blocks(held: &str, load: &str) -> String {
    let cube = |first: usize, low: f64| {
        let mut text = String::new();
        for k in 0..8 {
            let [x, y, z] = [k & 1, k >> 1 & 1, k >> 2].map(|b| b as f64);
            let (x, y, z) = (3.0 * x - 1.0, 3.0 * y - 1.0, low + z);
            text += &format!("{}, {x}, {y}, {z}\n", first + k);
        }
        text
    };
    let cell = |id: usize, n: usize| {
        let order = [0, 1, 3, 2, 4, 5, 7, 6].map(|k| (n + k).to_string());
        format!("{id}, {}\n", order.join(", "))
    };
    let mut text = format!("*NODE\n{}{}", cube(1, -1.0), cube(51, 2.0));
    for k in 0..3 {
        for (j, [x, y]) in [[0.1, 0.2], [1.1, 0.15], [0.2, 1.1]]
            .into_iter()
            .enumerate()
        {
            text += &format!("{}, {x}, {y}, {k}\n", 21 + 3 * k + j);
        }
    }
    text += &format!("*ELEMENT, TYPE=C3D8, ELSET=LOW\n{}", cell(1, 1));
    text +=
        "*ELEMENT, TYPE=C3D6, ELSET=COL\n2, 21, 22, 23, 24, 25, 26\n3, 24, 25, 26, 27, 28, 29\n";
    text += &format!("*ELEMENT, TYPE=C3D8, ELSET=HIGH\n{}", cell(4, 51));
    text += "*SURFACE, NAME=A\n1, S2\n*SURFACE, NAME=B\n2, S1\n*SURFACE, NAME=C\n3, S2\n*SURFACE, NAME=D\n4, S1\n\
             *TIE, NAME=T1\nB, A\n*TIE, NAME=T2\nC, D\n*NSET, NSET=BASE\n1, 2, 3, 4\n*NSET, NSET=TOP\n55, 56, 57, 58\n\
             *MATERIAL, NAME=M\n*ELASTIC\n200000., 0.3\n";
    for set in ["LOW", "COL", "HIGH"] {
        text += &format!("*SOLID SECTION, ELSET={set}, MATERIAL=M\n");
    }
    format!(
        "{text}*STEP\n*STATIC\n*BOUNDARY\nBASE, 1, 3\n{held}*CLOAD\n{load}*NODE PRINT, NSET=TOP\nU\n*END STEP\n"
    )
}

/// Where ties see the motions of the column, they count: what stands on it turns with its last triangle. Held there,
/// the torque finds a way; not held, it is refused, and the sentence names the elements.
#[test]
fn ties_see_the_motions_of_a_column() {
    let scratch = Scratch::new("tied-columns");
    let torque = "55, 1, 10.\n57, 1, -10.\n";
    let loose = scratch.file("loose.inp", &between_blocks("", torque));
    for ranks in [1, 2] {
        let said = refused(ranks, &loose);
        for part in [
            "\"COL\"",
            "\"HIGH\"",
            "wedges of 6 nodes",
            "-fetifeti_full_integration",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
    let (run, _) = solve(1, &loose, &["-fetifeti_full_integration"]);
    assert_eq!(run.code, 0, "{}", run.all());
    // Held against the turn, the block carries the torque itself.
    let held = between_blocks("55, 1, 2\n57, 1, 1\n", "58, 3, 10.\n");
    let held = scratch.file("held.inp", &held);
    let mut all = Vec::new();
    for ranks in [1, 2] {
        let (run, report) = solve(ranks, &held, &[]);
        assert_eq!(run.code, 0, "{}", run.all());
        let top = printed(&report);
        assert!(top.iter().flatten().all(|u| u.abs() < 0.05), "{top:?}");
        all.push(top);
    }
    for (a, b) in all[0].iter().flatten().zip(all[1].iter().flatten()) {
        assert!((a - b).abs() < 1e-8, "{a} {b}");
    }
}
