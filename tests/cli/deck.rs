//! `fetifeti solve deck.inp`: displacements and forces as CalculiX prints them.

use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use deck::{read_dat, DatQuantity, DatTable};
use serde_json::Value;

const DECK: &str = "../../crates/deck/tests/block.inp";

/// The tables in a file.
fn tables(path: &str) -> Vec<DatTable> {
    read_dat(&std::fs::read_to_string(path).expect(path))
}

/// Solves a deck on some ranks and compares its tables with CalculiX's, to `tolerance` of the largest displacement and
/// the largest force of the file.
fn compare(name: &str, ranks: usize, tolerance: f64) -> Value {
    compare_along(name, ranks, tolerance, [0, 1, 2])
}

/// As [`compare`], of forces only the components from `axes`.
fn compare_along<const N: usize>(
    name: &str,
    ranks: usize,
    tolerance: f64,
    axes: [usize; N],
) -> Value {
    let scratch = Scratch::new(&format!("deck_{name}_{ranks}"));
    let (out, json) = (scratch.path("out"), scratch.path("report.json"));
    let deck = format!("../../crates/deck/tests/{name}.inp");
    let rtol = ["-fetifeti_ksp_rtol", "1e-10"];
    let files = ["solve", &deck, "--out", &out, "--json", &json];
    let run = run_fetifeti(ranks, &[&files[..], &rtol].concat());
    assert_eq!(run.code, 0, "{}", run.all());
    let ours = tables(&format!("{out}/{name}.dat"));
    let theirs = tables(&format!("../../crates/deck/tests/{name}.dat"));
    assert_eq!(ours.len(), theirs.len());
    let moves = |t: &DatTable| t.quantity == DatQuantity::Displacement;
    let largest = |of: bool| {
        let tables = theirs.iter().filter(|t| moves(t) == of);
        let all = tables.flat_map(|t| &t.rows).flat_map(|r| r.vector);
        all.fold(0.0_f64, |m, x| m.max(x.abs()))
    };
    for (a, b) in ours.iter().zip(&theirs) {
        assert_eq!(
            (a.quantity, &a.set, a.time, a.rows.len()),
            (b.quantity, &b.set, b.time, b.rows.len())
        );
        let size = largest(moves(b));
        for (p, q) in a.rows.iter().zip(&b.rows) {
            assert_eq!((p.id, p.local), (q.id, q.local));
            for (d, (x, y)) in p.vector.iter().zip(q.vector).enumerate() {
                if !moves(b) && !axes.contains(&d) {
                    continue;
                }
                let away = (x - y).abs();
                assert!(
                    away <= tolerance * size,
                    "{p:?}, not {q:?} in {:?}",
                    b.quantity
                );
            }
        }
    }
    serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap()
}

/// Steps, local axes, amplitudes and reduced integration: what `ccx block` has printed, up to its last digit.
#[test]
fn a_deck_has_the_displacements_and_forces_of_calculix() {
    for ranks in [1, 2] {
        let report = compare("block", ranks, 2e-6);
        let printed = report["node_print"].as_array().expect("tables");
        // Two *NODE PRINT in the first and in the second step, one in the third.
        assert_eq!(printed.len(), 5);
        assert_eq!(printed[0]["set"], "REV");
        for key in ["nodes", "forces"] {
            assert_eq!(printed[0][key].as_array().unwrap().len(), 10, "{key}");
        }
        assert!(printed[1].get("forces").is_none() && printed[1].get("total_force").is_none());
        // TOTALS=ONLY; the whole load is 7 along x.
        assert!(printed[4].get("forces").is_none());
        let total = printed[4]["total_force"][0].as_f64().expect("a force");
        assert!((total + 7.0).abs() < 1e-9, "{total}");
    }
}

/// Forces at nodes with load and support, at the nodes of a tie, and where bodies press on each other: forces of ties
/// count, forces of contact do not.
#[test]
fn forces_between_bodies_are_those_of_calculix() {
    for ranks in [1, 2, 4] {
        for (name, tolerance) in [("tied", 1e-6), ("pressed", 1e-3)] {
            let forces_only = |report: &Value| report["node_print"][0]["forces"].clone();
            let report = compare(name, ranks, tolerance);
            // All loads and all reactions are in balance.
            let mut sums = [0.0; 3];
            for node in forces_only(&report).as_array().expect("forces") {
                (0..3).for_each(|d| sums[d] += node[d + 1].as_f64().expect("a number"));
            }
            assert!(sums.iter().all(|s| s.abs() < 1e-9), "{name}: {sums:?}");
        }
    }
}

/// Soft contact and friction with a stick slope in four steps: nodes stick, slip and part, meet again and slide back,
/// and slide on with less friction. Each step begins where friction has slid to before.
#[test]
fn soft_contact_and_friction_of_a_deck_are_those_of_calculix() {
    for ranks in [1, 2] {
        let report = compare("rough", ranks, 2e-6);
        let contact = &report["contact"]["interfaces"][0];
        assert_eq!(
            (&contact["slipping"], &contact["sticking"]),
            (&6.into(), &0.into())
        );
        // With the coefficient 0.1 of the last step the face bears a tenth of the load of 0.03.
        let friction: Vec<f64> = serde_json::from_value(contact["friction"].clone()).unwrap();
        let size = friction.iter().map(|f| f * f).sum::<f64>().sqrt();
        assert!(size > 0.0029 && size < 0.003, "{size}");
    }
    // In a plane of symmetry friction is along one direction.
    compare("mirrored", 1, 2e-6);
}

/// A disc with nodes on its axis under pressure, gravity, a force and a spin. CalculiX's disc consists of flat wedges
/// of 2°; radially it prints what the inner nodes of a wedge bear without its faces.
#[test]
fn a_disc_has_the_displacements_and_axial_forces_of_calculix() {
    for ranks in [1, 2] {
        let report = compare_along("ring", ranks, 2e-4, [1]);
        // Of a ring CalculiX prints the force on 2°: supports bear what nothing else does.
        let total = report["node_print"][1]["total_force"][1].as_f64();
        assert!(
            (total.expect("a force") - 1.752802).abs() < 1e-4,
            "{total:?}"
        );
    }
}

#[test]
fn a_deck_that_is_not_solved_is_refused_with_its_line() {
    let scratch = Scratch::new("deck_refused");
    let text = std::fs::read_to_string(DECK).unwrap();
    let deck = scratch.file("plastic.inp", &text.replace("*STATIC", "*FREQUENCY"));
    let run = run_fetifeti(1, &["solve", &deck]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(
        run.stderr.contains("*FREQUENCY") && run.stderr.contains("line"),
        "{}",
        run.stderr
    );
}

/// Four squares on a pulled plate; nodes 5 and 10 are at one place, and `more` says what joins them.
fn cut_plate(upper: [u32; 4], more: &str) -> String {
    let [a, b, c, d] = upper;
    format!(
        "*NODE, NSET=N\n1,0,0\n2,1,0\n3,2,0\n4,0,1\n5,1,1\n6,2,1\n7,0,2\n8,1,2\n9,2,2\n10,1,1\n\
         *ELEMENT, TYPE=CPS4, ELSET=E\n1,1,2,5,4\n2,2,3,6,5\n3,4,{a},{b},7\n4,{c},6,9,{d}\n\
         *MATERIAL, NAME=M\n*ELASTIC\n1000,0.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n{more}\
         *BOUNDARY\n1,1,2\n2,2\n3,2\n*STEP\n*STATIC\n*CLOAD\n7,2,1\n8,2,4\n9,2,1\n\
         *NODE PRINT, NSET=N\nU\n*END STEP\n"
    )
}

/// A deck that is cut between two of its nodes is solved as it is: the cut opens, unless equations join them.
#[test]
fn a_cut_deck_is_solved_and_said() {
    let scratch = Scratch::new("deck_cut");
    let json = scratch.path("report.json");
    let joined = "*EQUATION\n2\n10,1,1,5,1,-1\n2\n10,2,1,5,2,-1\n";
    let solve = |name: &str, deck: &str| {
        let deck = scratch.file(name, deck);
        let run = run_fetifeti(1, &["solve", &deck, "--json", &json]);
        assert_eq!(run.code, 0, "{}", run.all());
        let report: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
        let notes = report["notes"].to_string();
        let said = run.stdout.contains("nodes 5 and 10 are both at")
            && notes.contains("nodes 5 and 10 are both at");
        (report["energy"].as_f64().expect("energy"), said, notes)
    };
    let (whole, none, notes) = solve("whole.inp", &cut_plate([5, 8, 5, 8], ""));
    assert!(!none, "{notes}");
    let (same, none, notes) = solve("joined.inp", &cut_plate([10, 8, 10, 8], joined));
    assert!(!none, "{notes}");
    let (cut, said, notes) = solve("cut.inp", &cut_plate([10, 8, 10, 8], ""));
    assert!(said && notes.contains("as CalculiX does"), "{notes}");
    assert!(
        (same - whole).abs() < 1e-7 * whole.abs(),
        "{same}, not {whole}"
    );
    // Energies are negative: half the work of the forces, with a minus.
    assert!(cut < 1.1 * whole, "{cut} beside {whole}");
    // As the mesh of a scene the same file is refused.
    scratch.file(
        "cut.toml",
        "[mesh]\nfile = \"cut.inp\"\n[[body]]\nname = \"E\"\ndirichlet = [\"all\"]\n",
    );
    let run = run_fetifeti(1, &["solve", &scratch.path("cut.toml")]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(
        run.stderr.contains("nodes 5 and 10 are both at"),
        "{}",
        run.stderr
    );
}

/// Equations join the two sides of the cut again: then the direct solution is ours, and `compare` finds both alike.
#[test]
fn equations_are_in_the_problem_that_is_compared() {
    let scratch = Scratch::new("deck_compare");
    let joined = "*EQUATION\n2\n10,1,1,5,1,-1\n2\n10,2,1,5,2,-1\n";
    let deck = scratch.file("joined.inp", &cut_plate([10, 8, 10, 8], joined));
    let json = scratch.path("compare.json");
    let tight = ["-fetifeti_ksp_rtol", "1e-10"];
    let args = ["compare", &deck, "--with", "mumps", "--json", &json];
    let run = run_fetifeti(1, &[&args[..], &tight].concat());
    assert_eq!(run.code, 0, "{}", run.all());
    let report: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    let rows = report["rows"].as_array().expect("a list");
    let has = |name: &str| rows.iter().any(|r| r["method"] == name);
    assert!(has("fetifeti") && has("mumps"), "{report}");
    for method in rows {
        assert_eq!(method["converged"], true, "{method}");
        let error = method["error"].as_f64().expect("an error");
        assert!(error < 1e-9, "{method}");
    }
}

/// Three columns of two squares under pressure, with gaps 0.01, 0.01 and −0.01. The slave nodes of the first and the
/// third, and the master nodes of the second, are in the node set that ADJUST names: gaps of the first and the third
/// column count as none.
fn columns(adjust: &str) -> String {
    let (mut nodes, mut cells) = (String::new(), String::new());
    for (c, gap) in [0.01, 0.01, -0.01].into_iter().enumerate() {
        for (k, y) in [0.0, 1.0, 1.0 + gap, 2.0 + gap].into_iter().enumerate() {
            for side in 0..2 {
                nodes += &format!("{},{},{y}\n", 10 * c + 2 * k + side + 1, 2 * c + side);
            }
        }
        for k in 0..2 {
            let first = 10 * c + 4 * k + 1;
            let [a, b, d] = [first + 1, first + 3, first + 2];
            cells += &format!("{},{first},{a},{b},{d}\n", 2 * c + k + 1);
        }
    }
    format!(
        "*NODE,NSET=N\n{nodes}*ELEMENT,TYPE=CPE4,ELSET=E\n{cells}*NSET,NSET=MOVED\n5,6,13,14,25,26\n\
         *NSET,NSET=BASE\n1,2,11,12,21,22\n*SURFACE,NAME=UP\n2,S1\n4,S1\n6,S1\n\
         *SURFACE,NAME=DOWN\n1,S3\n3,S3\n5,S3\n\
         *MATERIAL,NAME=M\n*ELASTIC\n1000,0\n*SOLID SECTION,ELSET=E,MATERIAL=M\n\
         *SURFACE INTERACTION,NAME=I\n*CONTACT PAIR,INTERACTION=I,SMALL SLIDING,{adjust}\nUP,DOWN\n\
         *BOUNDARY\nN,1\nBASE,2\n*STEP\n*STATIC\n*DLOAD\n2,P3,5.\n4,P3,5.\n6,P3,5.\n\
         *NODE PRINT,NSET=N\nU\n*END STEP\n"
    )
}

#[test]
fn contact_pairs_move_the_nodes_of_a_set_onto_the_master() {
    let scratch = Scratch::new("deck_adjust");
    let json = scratch.path("report.json");
    let rtol = ["-fetifeti_ksp_rtol", "1e-12"];
    for (adjust, gaps) in [
        ("ADJUST=MOVED", [0.0, 0.01, 0.0]),
        ("ADJUST=0.02", [0.0, 0.0, 0.0]),
        ("TYPE=NODE TO SURFACE", [0.01, 0.01, -0.01]),
    ] {
        let deck = scratch.file("columns.inp", &columns(adjust));
        let run = run_fetifeti(1, &[&["solve", &deck, "--json", &json][..], &rtol].concat());
        assert_eq!(run.code, 0, "{}", run.all());
        let report: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
        for (c, gap) in gaps.into_iter().enumerate() {
            // Poisson's ratio is 0: every square is shorter by 5/1000.
            for (node, uy) in [(3, -0.005), (5, -0.005 - gap), (7, -0.01 - gap)] {
                let row = &report["node_print"][0]["nodes"][8 * c + node];
                let found = row[2].as_f64().expect("a number");
                assert!((found - uy).abs() < 1e-9, "{adjust}: {row}, not {uy}");
            }
        }
    }
    for (adjust, message) in [
        (
            "ADJUST=NOWHERE",
            "line 50: *CONTACT PAIR: there is no node set NOWHERE",
        ),
        (
            "ADJUST=BASE",
            "line 51: the node set of ADJUST has no node of the slave surface UP",
        ),
    ] {
        let deck = scratch.file("columns.inp", &columns(adjust));
        let run = run_fetifeti(1, &["solve", &deck]);
        assert_eq!(run.code, 2, "{}", run.all());
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
}
