//! Cells that are folded at a corner, or that run clockwise.

use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use serde_json::Value;

fn solve(ranks: usize, file: &str) -> (String, Value) {
    let args = [
        "solve",
        file,
        "--quiet",
        "--json",
        "-",
        "-fetifeti_ksp_rtol",
        "1e-10",
    ];
    let run = run_fetifeti(ranks, &args);
    assert_eq!(run.code, 0, "{}", run.all());
    (run.stderr, serde_json::from_str(&run.stdout).expect("JSON"))
}

/// det J is negative at a corner and positive wherever the cell is integrated: a warning, and E A u / L.
#[test]
fn a_cell_that_is_folded_at_a_corner_is_solved_with_a_warning() {
    for ranks in [1, 2] {
        let (stderr, report) = solve(ranks, "../../tests/data/cases/06_corner_jacobian.inp");
        let force = report["node_print"][0]["total_force"][2]
            .as_f64()
            .expect("a force");
        assert!((force - 133.33).abs() < 0.01, "{force}");
        let warnings = report["warnings"].as_array().expect("warnings");
        assert_eq!(warnings.len(), 1);
        let warning = warnings[0].as_str().expect("text");
        for part in [
            "`A`: cell 1, a hexahedron of 20 nodes",
            "folded at its node 2",
            "Jacobian",
        ] {
            assert!(warning.contains(part), "{warning}");
        }
        assert!(stderr.contains(&format!("Warning: {warning}")), "{stderr}");
    }
    // Farther out, a point of integration is folded: CalculiX says "nonpositive jacobian determinant".
    let scratch = Scratch::new("folded");
    let text =
        std::fs::read_to_string("../../tests/data/cases/06_corner_jacobian.inp").expect("a deck");
    let far = scratch.file(
        "far.inp",
        &text
            .replace("-0.2500013", "-0.45")
            .replace("1.2500013", "1.45"),
    );
    let run = run_fetifeti(1, &["solve", &far]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(
        run.stderr
            .contains("cell 1, a hexahedron of 20 nodes, is folded"),
        "{}",
        run.stderr
    );
}

/// A collapsed quadrilateral has no volume at two of its nodes, and is a triangle.
#[test]
fn cells_without_volume_at_a_node_are_solved_with_a_warning() {
    let scratch = Scratch::new("collapsed");
    // A strip from x = 0 to 2; the quarter points of its second cell are those at the tip of a crack.
    let deck = "*NODE\n1, 0, 0\n2, 1, 0\n3, 2, 0\n4, 0, 1\n5, 1, 1\n6, 2, 1\n7, .5, 0\n8, 1.25, 0\n9, 1, .5\n\
                10, .5, 1\n\
                11, 1.5, 1\n12, 0, .5\n13, 2, .5\n*ELEMENT, TYPE=CPS8, ELSET=E\n1, 1, 2, 5, 4, 7, 9, 10, 12\n\
                2, 2, 3, 6, 5, 8, 13, 11, 9\n*NSET, NSET=L\n1, 4, 12\n*NSET, NSET=R\n3, 6, 13\n\
                *MATERIAL, NAME=M\n*ELASTIC\n10., 0.\n*SOLID SECTION, ELSET=E, MATERIAL=M\n1.\n*STEP\n*STATIC\n\
                *BOUNDARY\nL, 1, 1\n1, 2, 2\nR, 1, 1, 0.2\n*NODE PRINT, NSET=R, TOTALS=ONLY\nRF\n*END STEP\n";
    let (stderr, report) = solve(1, &scratch.file("quarter.inp", deck));
    // The strain is the same everywhere: quadratic cells have linear displacements, wherever their nodes are.
    let force = report["node_print"][0]["total_force"][0]
        .as_f64()
        .expect("a force");
    assert!((force - 1.0).abs() < 1e-9, "{force}");
    assert!(stderr.contains("has no volume at its node 2"), "{stderr}");
}

/// A bar of plane cells from x = 0 to 2 and y = 0 to 1, as a mesh of Gmsh: every cell in `clockwise` is mirrored.
fn bar(kind: &str, clockwise: [bool; 2]) -> String {
    let mut nodes = String::new();
    for k in 0..15 {
        let (x, y) = (0.5 * (k % 5) as f64, 0.5 * (k / 5) as f64);
        nodes += &format!("{} {x} {y} 0\n", k + 1);
    }
    let at = |i: usize, j: usize| 5 * j + i + 1;
    let mut cells = Vec::new();
    for (k, clockwise) in [(0, clockwise[0]), (2, clockwise[1])] {
        let corners = [at(k, 0), at(k + 2, 0), at(k + 2, 2), at(k, 2)];
        let middles = [at(k + 1, 0), at(k + 2, 1), at(k + 1, 2), at(k, 1)];
        let centre = at(k + 1, 1);
        let mut add = |number: u8, corners: &[usize], middles: &[usize], last: Option<usize>| {
            let mut corners = corners.to_vec();
            let mut middles = middles.to_vec();
            if clockwise {
                corners.reverse();
                // The first middle lies behind the first corner.
                middles.reverse();
                let behind = middles.len().min(1);
                middles.rotate_left(behind);
            }
            let all: Vec<String> = corners
                .iter()
                .chain(&middles)
                .chain(&last)
                .map(|n| n.to_string())
                .collect();
            cells.push(format!("{number} 2 3 1 {}", all.join(" ")));
        };
        match kind {
            "quad4" => add(3, &corners, &[], None),
            "quad8" => add(16, &corners, &middles, None),
            "quad9" => add(10, &corners, &middles, Some(centre)),
            "tri3" => {
                add(2, &corners[..3], &[], None);
                add(2, &[corners[2], corners[3], corners[0]], &[], None);
            }
            _ => {
                let [a, b, c, d] = middles;
                add(9, &corners[..3], &[a, b, centre], None);
                add(
                    9,
                    &[corners[2], corners[3], corners[0]],
                    &[c, d, centre],
                    None,
                );
            }
        }
    }
    // Sides of the bar: 1 on the left, 2 on the right.
    let quadratic = !matches!(kind, "quad4" | "tri3");
    let side = |tag: usize, i: usize| {
        if quadratic {
            format!("8 2 {tag} {tag} {} {} {}", at(i, 0), at(i, 2), at(i, 1))
        } else {
            format!("1 2 {tag} {tag} {} {}", at(i, 0), at(i, 2))
        }
    };
    cells.insert(0, side(1, 0));
    cells.insert(1, side(2, 4));
    let numbered: Vec<String> = cells
        .iter()
        .enumerate()
        .map(|(k, c)| format!("{} {c}\n", k + 1))
        .collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n15\n{nodes}$EndNodes\n$Elements\n{}\n{}$EndElements\n",
        numbered.len(),
        numbered.concat()
    )
}

/// Plane cells of every kind may run clockwise, all of them or some.
#[test]
fn plane_cells_may_run_clockwise() {
    let (_, report) = solve(1, "../../tests/data/cases/08_clockwise.toml");
    let energy = report["energy"].as_f64().expect("a number");
    assert!((energy + 0.01).abs() < 1e-12, "{energy}");
    let scratch = Scratch::new("clockwise");
    let scene = "dimension = 2\nphysics = \"elasticity\"\n[mesh]\nfile = \"bar.msh\"\n[[body]]\nname = \"3\"\n\
                 young = 1\n\
                 poisson = 0\nsubdomains = 2\ndirichlet = { 1 = 0 }\npressure = { 2 = -0.1 }\n\
                 [[probe]]\nname = \"end\"\npoint = [2, 0.5]\n";
    let scene = scratch.file("bar.toml", scene);
    for kind in ["quad4", "quad8", "quad9", "tri3", "tri6"] {
        for clockwise in [[false, false], [true, true], [true, false], [false, true]] {
            scratch.file("bar.msh", &bar(kind, clockwise));
            let (_, report) = solve(1, &scene);
            let u = report["probes"][0]["u"][0].as_f64().expect("a number");
            assert!((u - 0.2).abs() < 1e-9, "{kind} {clockwise:?}: {u}");
            let stress = report["probes"][0]["stress"][0].as_f64().expect("a number");
            assert!(
                (stress - 0.1).abs() < 1e-9,
                "{kind} {clockwise:?}: {stress}"
            );
        }
    }
}

/// Faces of a deck's elements keep their numbers: the same face is pressed, given by *DLOAD or by *SURFACE.
#[test]
fn faces_of_clockwise_elements_keep_their_numbers() {
    let scratch = Scratch::new("clockwise-deck");
    let deck = |nodes: &str, kind: &str, load: &str, surface: &str| {
        format!(
            "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, .5, 0\n6, 1, .5\n7, .5, 1\n8, 0, .5\n\
             *ELEMENT, TYPE={kind}, ELSET=A\n1, {nodes}\n{surface}*NSET, NSET=L\n1, 4, 8\n*NSET, NSET=R\n2, 3\n\
             *MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=A, MATERIAL=M\n1.\n\
             *STEP\n*STATIC\n*BOUNDARY\nL, 1, 1\n1, 2, 2\n{load}*NODE PRINT, NSET=R\nU\n*END STEP\n"
        )
    };
    let linear = ["1, 2, 3, 4", "1, 4, 3, 2"];
    let quadratic = ["1, 2, 3, 4, 5, 6, 7, 8", "1, 4, 3, 2, 8, 7, 6, 5"];
    for (kind, nodes) in [
        ("CPE4", linear),
        ("CPS4", linear),
        ("CPE8", quadratic),
        ("CPE8R", quadratic),
    ] {
        // The face at x = 1 is the second of one order and the third of the other.
        for (nodes, face) in nodes.into_iter().zip([2, 3]) {
            let by_face = deck(nodes, kind, &format!("*DLOAD\nA, P{face}, -10.\n"), "");
            let surface = format!("*SURFACE, NAME=S\n1, S{face}\n");
            let by_surface = deck(nodes, kind, "*DSLOAD\nS, P, -10.\n", &surface);
            for text in [by_face, by_surface] {
                let (_, report) = solve(1, &scratch.file("cell.inp", &text));
                for row in report["node_print"][0]["nodes"]
                    .as_array()
                    .expect("a table")
                {
                    let u = row[1].as_f64().expect("a number");
                    assert!((u - 0.01).abs() < 1e-12, "{kind} {nodes}: {u}");
                }
                let said = report["notes"]
                    .to_string()
                    .contains("element 1 run clockwise");
                assert_eq!(said, face == 3, "{kind} {nodes}: {}", report["notes"]);
            }
        }
    }
}

/// Solid cells that are inside out are refused, as in CalculiX, by their number.
#[test]
fn solid_cells_inside_out_are_refused() {
    let scratch = Scratch::new("inside-out");
    let text =
        std::fs::read_to_string("../../tests/data/cases/03_energy_of_given_displacement.inp")
            .expect("a deck");
    let file = scratch.file(
        "mirrored.inp",
        &text.replace("1, 1,2,3,4,5,6,7,8", "1, 5,6,7,8,1,2,3,4"),
    );
    let run = run_fetifeti(1, &["solve", &file]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(
        run.stderr
            .contains("cell 1, a hexahedron of 8 nodes, is inside out"),
        "{}",
        run.stderr
    );
}
