//! *TIE and [[tie]] hold the nodes that are within a tolerance, and say which they leave out.
//!
//! Values are those of CalculiX 2.20 on the same decks, where nothing else is said.

use super::blocks::{deck, solve, Block, Ran};
use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use serde_json::Value;

const CASE: &str = "../../tests/data/cases/02_tie_position_tolerance.inp";

/// The case with other parameters of its *TIE.
fn case(parameters: &str, ranks: usize) -> Ran {
    let text = std::fs::read_to_string(CASE).unwrap();
    let own = "POSITION TOLERANCE=0.1, ADJUST=NO";
    assert!(text.contains(own));
    let name = format!("tie_{}", parameters.replace([' ', '=', ',', '.'], ""));
    solve(&name, &text.replace(own, parameters), ranks)
}

/// Sides that do not match and part like a wedge: the tolerance says how far the tie reaches, and ADJUST whether nodes
/// move onto the master.
#[test]
fn the_tolerance_of_a_tie_selects_its_nodes() {
    for (parameters, ranks, value, left) in [
        ("POSITION TOLERANCE=0.1, ADJUST=NO", 1, -4.438643, 20),
        ("POSITION TOLERANCE=0.1, ADJUST=NO", 2, -4.438643, 20),
        ("POSITION TOLERANCE=0.2, ADJUST=NO", 1, -1.585205, 16),
        ("POSITION TOLERANCE=0.1", 1, -4.316426, 20),
        ("POSITION TOLERANCE=0.1, ADJUST=YES", 2, -4.316426, 20),
        ("POSITION TOLERANCE=0.6, ADJUST=NO", 1, -2.680231e-2, 0),
        ("POSITION TOLERANCE=0.6", 1, -2.125118e-2, 0),
    ] {
        let ran = case(parameters, ranks);
        ran.expect(88, 2, value);
        match left {
            0 => assert!(!ran.said.contains("leaves out"), "{}", ran.said),
            _ => ran.says(&format!(
                "line 461: the tie of `UP_Z0` and `LOW_Z1` leaves out {left} of 28 nodes of `UP_Z0`"
            )),
        }
        let moves = !parameters.contains("ADJUST=NO");
        assert_eq!(ran.said.contains("*TIE moves"), moves, "{}", ran.said);
    }
    // What was said before everything was solved as if all nodes were tied.
    case("POSITION TOLERANCE=0.1", 1)
        .says("*TIE moves 4 nodes of the slave UP_Z0 onto the master LOW_Z1, by 8.333e-2");
}

/// A tolerance that leaves a row of nodes: the body turns about it. So does the tolerance that CalculiX takes where the
/// deck gives none, 2.5 % of the size of a face.
#[test]
fn a_body_that_its_tie_does_not_hold_is_named() {
    for parameters in ["POSITION TOLERANCE=0.01, ADJUST=NO", "ADJUST=NO"] {
        for ranks in [1, 2] {
            let ran = case(parameters, ranks);
            assert_eq!(ran.code, 2, "{}", ran.said);
            ran.says("leaves out 24 of 28 nodes");
            ran.says("body \"UP\"");
        }
    }
}

const STEP: &str = "*STEP\n*STATIC\n*BOUNDARY\nNLOZ0,1,3\n*CLOAD\nNUPX1,3,-1.\n*NODE PRINT,NSET=NUPX1\nU\n*END STEP\n";

/// A long block, and what stands on it.
fn low() -> Block {
    Block::new("LO", 1, [4, 2, 2], [0.0; 3], [2.0, 1.0, 1.0])
}

/// Sides whose nodes lie opposite each other.
#[test]
fn sides_that_match_have_a_tolerance_too() {
    let up = || Block::new("UP", 101, [4, 2, 2], [0.0, 0.0, 1.0], [2.0, 1.0, 0.5]).sloping(0.1);
    let tie = |parameters: &str| {
        let tie = format!("*TIE,NAME=T,{parameters}\nSUPZ0,SLOZ1\n{STEP}");
        deck(&[low(), up()], &tie)
    };
    for (parameters, value, left) in [
        ("POSITION TOLERANCE=0.06,ADJUST=NO", -1.700760, 9),
        ("POSITION TOLERANCE=0.11,ADJUST=NO", -5.063002e-1, 6),
        ("POSITION TOLERANCE=0.3,ADJUST=NO", -2.631600e-2, 0),
        ("POSITION TOLERANCE=0.06", -1.590784, 9),
    ] {
        for ranks in [1, 2] {
            let ran = solve("tie_match", &tie(parameters), ranks);
            ran.expect(105, 2, value);
            let said = format!("leaves out {left} of 15 nodes of `SUPZ0`");
            assert_eq!(ran.said.contains(&said), left > 0, "{}", ran.said);
        }
    }
}

/// Faces of eight nodes: nodes in the middle of edges are tied as those at corners are.
#[test]
fn faces_of_second_order_have_a_tolerance() {
    let up = Block::new("UP", 101, [3, 2, 1], [0.0, 0.0, 1.0], [2.0, 1.0, 0.5]);
    let blocks = [low().quadratic(), up.sloping(0.1).quadratic()];
    for (adjust, value) in [(",ADJUST=NO", -9.591864e-1), ("", -8.811763e-1)] {
        let tie = format!("*TIE,NAME=T,POSITION TOLERANCE=0.08{adjust}\nSUPZ0,SLOZ1\n{STEP}");
        let ran = solve("tie_quadratic", &deck(&blocks, &tie), 1);
        ran.expect(104, 2, value);
        ran.says("farther than the position tolerance 0.08");
    }
}

/// A slave surface that two bodies share.
#[test]
fn a_tie_of_several_bodies_has_a_tolerance() {
    let small = |name, first, y| {
        Block::new(name, first, [2, 2, 1], [0.0, y, 1.0], [1.0, 0.5, 0.5]).sloping(0.1)
    };
    let faces: String = (101..105)
        .chain(201..205)
        .map(|e| format!("{e},S1\n"))
        .collect();
    let step = "*STEP\n*STATIC\n*BOUNDARY\nNLOZ0,1,3\n*CLOAD\nNUPX1,3,-1.\nNVPX1,3,-2.\n\
                *NODE PRINT,NSET=NVPX1\nU\n*END STEP\n";
    let tie = "*TIE,NAME=T,POSITION TOLERANCE=0.06,ADJUST=NO\nBOTH,SLOZ1\n";
    let rest = format!("*SURFACE,NAME=BOTH\n{faces}{tie}{step}");
    let text = deck(
        &[low(), small("UP", 101, 0.0), small("VP", 201, 0.5)],
        &rest,
    );
    for ranks in [1, 2] {
        let ran = solve("tie_many", &text, ranks);
        ran.expect(203, 2, -4.523048e-1);
        ran.says(
            "leaves out 6 of 18 nodes of `BOTH`: 6 are farther than the position tolerance 0.06",
        );
    }
}

/// In the plane; CalculiX has the same as *EQUATION at the two nodes within the tolerance.
#[test]
fn plane_ties_have_a_tolerance() {
    let text = "*NODE,NSET=N\n1,0,0\n2,1,0\n3,2,0\n4,0,1\n5,1,1\n6,2,1\n11,0,1\n12,.7,1.07\n13,1.4,1.14\n14,2,1.2\n\
                15,0,2\n16,.7,2.07\n17,1.4,2.14\n18,2,2.2\n*ELEMENT,TYPE=CPE4,ELSET=E\n1,1,2,5,4\n2,2,3,6,5\n\
                11,11,12,16,15\n12,12,13,17,16\n13,13,14,18,17\n*NSET,NSET=TOP\n15,16,17,18\n*SURFACE,NAME=M\n1,S3\n\
                2,S3\n*SURFACE,NAME=S\n11,S1\n12,S1\n13,S1\n*MATERIAL,NAME=M\n*ELASTIC\n1000.,0.3\n\
                *SOLID SECTION,ELSET=E,MATERIAL=M\n1.\n*TIE,NAME=T,POSITION TOLERANCE=0.08,ADJUST=NO\nS,M\n*BOUNDARY\n\
                1,1,2\n2,1,2\n3,1,2\n*STEP\n*STATIC\n*CLOAD\n18,2,-1.\n*NODE PRINT,NSET=TOP\nU\n*END STEP\n";
    let ran = solve("tie_plane", text, 1);
    ran.expect(15, 0, 1.367645e-2);
    ran.expect(16, 1, -3.266886e-3);
    ran.says("leaves out 2 of 4 nodes of `S`");
}

const LIFT: &str = "*STEP\n*STATIC\n*BOUNDARY\nNLOZ0,1,3\n*CLOAD\nNUPZ1,1,1.\n*NODE PRINT,NSET=NUPZ1\nU\n*END STEP\n";

/// A slave of nodes: those count that form no face of an element, too.
#[test]
fn a_slave_of_nodes_is_tied_at_each_of_them() {
    let low = || Block::new("LO", 1, [2, 2, 2], [0.0; 3], [1.0; 3]);
    let up = |n| Block::new("UP", 101, [n, n, 2], [0.0, 0.0, 1.0], [1.0; 3]);
    for (n, nodes, node, value) in [
        (2, "101\n102\n104\n105\n107\n", 119, 5.350247e-1),
        (2, "101\n103\n107\n", 119, 6.830959e-1),
        (3, "101\n102\n103\n105\n106\n107\n109\n", 133, 7.481407e-1),
    ] {
        let rest = format!("*SURFACE,NAME=PS,TYPE=NODE\n{nodes}*TIE,NAME=T\nPS,SLOZ1\n{LIFT}");
        let text = deck(&[low(), up(n)], &rest);
        for ranks in [1, 2] {
            let ran = solve(&format!("tie_nodes_{}", nodes.len()), &text, ranks);
            ran.expect(node, 0, value);
        }
    }
    // Without nodes within the tolerance there is nothing to solve.
    let far = Block::new("UP", 101, [2, 2, 2], [0.0, 0.0, 1.02], [1.0; 3]);
    let tie = format!("*TIE,NAME=T\nSUPZ0,SLOZ1\n{LIFT}");
    let ran = solve("tie_far", &deck(&[low(), far], &tie), 1);
    assert_eq!(ran.code, 2);
    ran.says("no node of side `SUPZ0` of `UP` lies within");
    // A small gap is closed before.
    let near = Block::new("UP", 101, [2, 2, 2], [0.0, 0.0, 1.003], [1.0; 3]);
    let ran = solve("tie_near", &deck(&[low(), near], &tie), 1);
    ran.expect(119, 0, 2.873371e-1);
    ran.says("*TIE moves 9 nodes of the slave SUPZ0");
}

/// A node set may have the name of a surface: ties mean the surface.
#[test]
fn a_tie_means_the_surface_of_that_name() {
    let low = Block::new("LO", 1, [2, 2, 2], [0.0; 3], [1.0; 3]);
    let up = Block::new("UP", 101, [2, 2, 2], [0.0, 0.0, 1.0], [1.0; 3]);
    let both = "*NSET,NSET=S\n101,102,104,105\n*SURFACE,NAME=S\n101,S1\n102,S1\n103,S1\n104,S1\n";
    let text = deck(&[low, up], &format!("{both}*TIE,NAME=T\nS,SLOZ1\n{LIFT}"));
    let ran = solve("tie_names", &text, 1);
    ran.expect(119, 0, 2.862202e-1);
    assert!(!ran.said.contains("leaves out"), "{}", ran.said);
}

/// Sides that lie on each other, with different meshes: a tie of a deck holds every slave node at its place on the
/// master, as in CalculiX.
#[test]
fn nodes_that_do_not_match_are_tied_where_they_are() {
    let low = Block::new("LO", 1, [2, 2, 2], [0.0; 3], [1.0; 3]);
    let up = Block::new("UP", 101, [3, 3, 2], [0.0, 0.0, 1.0], [1.0; 3]);
    let text = deck(&[low, up], &format!("*TIE,NAME=T\nSUPZ0,SLOZ1\n{LIFT}"));
    let ran = solve("tie_meshes", &text, 2);
    ran.expect(133, 0, 5.135227e-1);
    assert!(!ran.said.contains("leaves out"), "{}", ran.said);
}

/// The key of scenes: the deck of the case as a mesh gives what the deck gives; without the key all nodes are tied.
#[test]
fn scenes_have_the_tolerance_too() {
    let scratch = Scratch::new("cases_scene_tolerance");
    let mesh = scratch.file("mesh.inp", &std::fs::read_to_string(CASE).unwrap());
    assert!(mesh.ends_with("mesh.inp"));
    let scene = |key: &str| {
        format!(
            "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"mesh.inp\"\n\
             [[body]]\nname = \"LOW\"\nyoung = 1000\npoisson = 0.3\ndirichlet = [\"LOW_Z0\"]\n\
             [[body]]\nname = \"UP\"\nyoung = 1000\npoisson = 0.3\npressure = {{ UP_Z1 = 1 }}\n\
             [[tie]]\nsurfaces = [\"UP_Z0\", \"LOW_Z1\"]\n{key}\n[[probe]]\nname = \"tip\"\nbody = \"UP\"\n\
             point = [4, 0, 1.5]\n"
        )
    };
    let tip = |key: &str, ranks: usize| -> (f64, String) {
        let file = scratch.file("scene.toml", &scene(key));
        let json = scratch.path("report.json");
        let run = run_fetifeti(
            ranks,
            &[
                "solve",
                &file,
                "--json",
                &json,
                "-fetifeti_ksp_rtol",
                "1e-10",
            ],
        );
        assert_eq!(run.code, 0, "{}", run.all());
        let report: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
        let u = report["probes"][0]["u"][2]
            .as_f64()
            .expect("a displacement");
        (u, report["notes"].to_string())
    };
    let (whole, notes) = tip("", 1);
    assert!(!notes.contains("the tie"), "{notes}");
    let (all, _) = tip("position_tolerance = 0.6", 1);
    assert!(
        (all - whole).abs() < 1e-9 * whole.abs(),
        "{all}, not {whole}"
    );
    for ranks in [1, 2] {
        let (some, notes) = tip("position_tolerance = 0.1", ranks);
        // What CalculiX has for the deck with this pressure in the place of its forces.
        assert!((some + 6.291068e-1).abs() < 5e-6, "{some}");
        assert!(
            notes.contains("leaves out 20 of 28 nodes of `UP_Z0`"),
            "{notes}"
        );
    }
    for (key, message) in [
        ("position_tolerance = 0.01", "body \"UP\""),
        (
            "position_tolerance = 0.1\nrange = [0, 0.5]",
            "`position_tolerance` together with",
        ),
    ] {
        let run = run_fetifeti(1, &["solve", &scratch.file("scene.toml", &scene(key))]);
        assert_eq!(run.code, 2, "{}", run.all());
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
}

/// Sides of boxes: a tolerance below their gap joins nothing, one above it all.
#[test]
fn sides_of_boxes_have_the_tolerance() {
    let scratch = Scratch::new("cases_box_tolerance");
    let scene = |n: usize, key: &str| {
        format!(
            "dimension = 2\nphysics = \"elasticity\"\n\
             [[body]]\nname = \"a\"\nsize = [1, 1]\nelements = [4, 4]\ndirichlet = [\"bottom\"]\n\
             [[body]]\nname = \"b\"\norigin = [0, 1.01]\nsize = [1, 1]\nelements = [{n}, 4]\nload = [1, 0]\n\
             [[tie]]\nbodies = [\"b\", \"a\"]\nsides = [\"bottom\", \"top\"]\n{key}\n"
        )
    };
    for n in [4, 3] {
        let run =
            |key: &str| run_fetifeti(1, &["solve", &scratch.file("scene.toml", &scene(n, key))]);
        let [with, without] = ["position_tolerance = 0.011", ""].map(run);
        let energy = |text: &str| {
            text.lines()
                .find(|line| line.starts_with("energy"))
                .map(String::from)
        };
        assert!(
            with.code == 0 && energy(&with.stdout).is_some(),
            "{}",
            with.all()
        );
        assert_eq!(energy(&with.stdout), energy(&without.stdout));
        let none = run("position_tolerance = 0.009");
        assert_eq!(none.code, 2, "{}", none.all());
        assert!(
            none.stderr
                .contains("no node of side `bottom` of `b` lies within 0.009"),
            "{}",
            none.stderr
        );
    }
    // Where bodies touch there is nothing to select.
    let touching = "position_tolerance = 1";
    let text = scene(4, touching).replace("sides = [\"bottom\", \"top\"]\n", "");
    let run = run_fetifeti(1, &["solve", &scratch.file("scene.toml", &text)]);
    assert!(
        run.code == 2 && run.stderr.contains("`position_tolerance` without"),
        "{}",
        run.all()
    );
}
