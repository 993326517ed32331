//! What of a model is left out is said in numbers: cells of no body, groups that nothing names, faces without a
//! partner, nodes that a contact takes as touching, keys of decks that do nothing.

use super::blocks::{deck, solve, Block};
use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;

/// What `plan` and `solve` say of a scene with the mesh `mesh.msh`.
fn said(name: &str, mesh: &str, scene: &str) -> [String; 2] {
    let scratch = Scratch::new(&format!("cases_{name}"));
    scratch.file("mesh.msh", mesh);
    let file = scratch.file("scene.toml", scene);
    ["plan", "solve"].map(|command| {
        let run = run_fetifeti(1, &[command, &file]);
        assert_eq!(run.code, 0, "{command}: {}", run.all());
        run.stdout
    })
}

#[track_caller]
fn both_say(said: &[String; 2], sentence: &str) {
    for text in said {
        assert!(text.contains(sentence), "{sentence}\n{text}");
    }
}

/// Half of the model belongs to no body.
#[test]
fn cells_of_no_body_are_counted() {
    let run = |command| {
        run_fetifeti(
            1,
            &[command, "../../tests/data/cases/09_untagged_volume.toml"],
        )
    };
    for command in ["plan", "solve"] {
        let run = run(command);
        assert_eq!(run.code, 0, "{}", run.all());
        let sentence =
            "1 of 2 cells of dimension 3 belongs to no [[body]] and is left out, the first is cell";
        assert!(run.stdout.contains(sentence), "{}", run.all());
    }
}

/// Two squares beside each other, with the groups `left` and `right` of cells and the edges `foot`, `top` and `cut`.
const SQUARES: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n2 1 \"left\"\n2 2 \"right\"\n\
    1 3 \"foot\"\n1 4 \"top\"\n1 5 \"cut\"\n0 6 \"corner\"\n$EndPhysicalNames\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n\
    3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes\n$Elements\n7\n1 15 2 6 6 4\n2 1 2 3 3 1 2\n3 1 2 3 3 2 3\n\
    4 1 2 4 4 5 4\n5 1 2 5 5 2 5\n6 3 2 1 1 1 2 5 4\n7 3 2 2 2 2 3 6 5\n$EndElements\n";

fn squares(body: &str) -> String {
    format!("dimension = 2\nphysics = \"elasticity\"\n[mesh]\nfile = \"mesh.msh\"\n{body}")
}

fn body(name: &str, more: &str) -> String {
    format!("[[body]]\nname = \"{name}\"\nyoung = 1000\nload = [0, -1]\ndirichlet = [\"foot\"]\n{more}\n")
}

/// Groups of cells and of faces that no entry names.
#[test]
fn groups_that_nothing_names_are_listed() {
    let all = said(
        "groups",
        SQUARES,
        &squares(&body("left", "pressure = { top = 1 }")),
    );
    both_say(&all, "1 of 2 cells of dimension 2 belongs to no [[body]]");
    both_say(
        &all,
        "no entry of the scene names the group `right` (1 face)",
    );
    both_say(
        &all,
        "no entry of the scene names the groups `cut` (1 edge), `corner` (1 point)",
    );
    let both =
        body("left", "pressure = { top = 1 }") + &body("right", "traction = { cut = [1, 0] }");
    let all = said("groups_both", SQUARES, &squares(&both));
    both_say(
        &all,
        "no entry of the scene names the group `corner` (1 point)",
    );
    for text in &all {
        assert!(!text.contains("belongs to no"), "{text}");
    }
    // Who names the whole boundary names them all.
    let all = body("left", "pressure = { top = 1 }") + &body("right", "spring = { all = 1 }");
    for text in said("groups_all", SQUARES, &squares(&all)) {
        assert!(!text.contains("no entry of the scene names"), "{text}");
    }
}

/// A load where the body has no boundary did nothing, and nothing was said.
#[test]
fn loads_on_no_boundary_are_refused() {
    let one = SQUARES.replace("7 3 2 2 2 2 3 6 5", "7 3 2 1 1 2 3 6 5");
    let scratch = Scratch::new("cases_inside");
    scratch.file("mesh.msh", &one);
    for (key, group) in [
        ("pressure", "cut = 1"),
        ("traction", "corner = [1, 0]"),
        ("spring", "corner = 1"),
    ] {
        let scene = squares(&body("left", &format!("{key} = {{ {group} }}")));
        let run = run_fetifeti(1, &["solve", &scratch.file("scene.toml", &scene)]);
        assert_eq!(run.code, 2, "{}", run.all());
        assert!(
            run.stderr
                .contains("of which no face is on the boundary of the body"),
            "{}",
            run.stderr
        );
    }
    // Where some of its faces are on the boundary, the others are counted.
    let more = one.replace("4 1 2 4 4 5 4", "4 1 2 5 5 5 4");
    let all = said(
        "inside_some",
        &more,
        &squares(&body("left", "pressure = { cut = 1 }")),
    );
    both_say(
        &all,
        "1 of 2 faces of the group `cut` are on no boundary of a body and are left out",
    );
}

/// Faces of a contact that lie opposite nothing.
#[test]
fn faces_without_a_partner_are_counted() {
    // Above the two squares stands one that is half as wide; all three are bodies.
    let mesh = SQUARES
        .replace("$PhysicalNames\n6", "$PhysicalNames\n8")
        .replace(
            "0 6 \"corner\"",
            "0 6 \"corner\"\n2 7 \"upper\"\n1 8 \"under\"",
        )
        .replace("$Nodes\n6", "$Nodes\n10")
        .replace(
            "6 2 1 0\n$EndNodes",
            "6 2 1 0\n7 0 1 0\n8 1 1 0\n9 0 2 0\n10 1 2 0\n$EndNodes",
        )
        .replace("$Elements\n7", "$Elements\n10")
        .replace(
            "7 3 2 2 2 2 3 6 5",
            "7 3 2 1 1 2 3 6 5\n8 3 2 7 7 7 8 10 9\n9 1 2 8 8 7 8\n10 1 2 4 4 6 5",
        );
    let upper =
        "[[body]]\nname = \"upper\"\nyoung = 1000\nload = [0, -1]\nspring = { under = 1e-3 }\n";
    for (entry, what) in [
        ("[[contact]]\nsurfaces = [\"under\", \"top\"]\n", "contact"),
        ("[[tie]]\nsurfaces = [\"under\", \"top\"]\n", "tie"),
    ] {
        let scene = squares(&(body("left", "") + upper + entry));
        let all = said(&format!("partner_{what}"), &mesh, &scene);
        both_say(
            &all,
            &format!(
                "the {what} of `under` and `top` leaves out 1 of 2 faces of `top`: they lie opposite nothing of the \
                 other side"
            ),
        );
    }
}

const PRESS: &str =
    "*STEP\n*STATIC\n*BOUNDARY\nNLOZ0,1,3\nNUPX0,1,1\nNUPY0,2,2\n*CLOAD\nNUPZ1,3,-1.\n\
    *NODE PRINT,NSET=NUPZ1\nU\n*END STEP\n";

fn pair(kind: &str, slave: &str) -> String {
    format!(
        "*SURFACE INTERACTION,NAME=I\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=HARD\n\
         *CONTACT PAIR,INTERACTION=I,SMALL SLIDING,{kind}\n{slave},SLOZ1\n"
    )
}

fn low() -> Block {
    Block::new("LO", 1, [2, 2, 2], [0.0; 3], [1.0; 3])
}

fn up(cells: usize, gap: f64) -> Block {
    Block::new(
        "UP",
        101,
        [cells, cells, 2],
        [0.0, 0.0, 1.0 + gap],
        [1.0; 3],
    )
}

/// *CLEARANCE acts on pairs of surfaces alone in CalculiX: a pair of nodes keeps its gaps.
#[test]
fn clearance_does_nothing_to_nodes() {
    let clearance = "*CLEARANCE,MASTER=SLOZ1,SLAVE=SUPZ0,VALUE=-0.01\n";
    let deck =
        |kind: &str, more: &str| deck(&[low(), up(2, 0.0)], &(pair(kind, "SUPZ0") + more + PRESS));
    let nodes = solve(
        "clearance_nodes",
        &deck("TYPE=NODE TO SURFACE", clearance),
        1,
    );
    nodes.says(
        "*CLEARANCE is ignored: in CalculiX it has no effect on pairs of TYPE=NODE TO SURFACE",
    );
    let without = solve("clearance_none", &deck("TYPE=NODE TO SURFACE", ""), 1);
    nodes.expect(119, 2, without.u[&119][2]);
    // Of surfaces CalculiX has −0.0112402 with stiff springs.
    let surfaces = solve(
        "clearance_surfaces",
        &deck("TYPE=SURFACE TO SURFACE", clearance),
        1,
    );
    surfaces.expect(119, 2, without.u[&119][2] + 0.01);
    assert!((surfaces.u[&119][2] + 0.0112402).abs() < 1e-6);
}

/// A slave of nodes: those that form no face touch, too. All press, so that the contact is as equations are that tie
/// the nodes along z.
#[test]
fn a_slave_of_nodes_touches_with_each_of_them() {
    let nodes = [101, 102, 103, 105, 106, 107, 109, 113, 116];
    let surface: String = nodes.iter().map(|n| format!("{n}\n")).collect();
    let contact = format!("*SURFACE,NAME=PS,TYPE=NODE\n{surface}")
        + &pair("TYPE=NODE TO SURFACE", "PS")
        + PRESS;
    let found = solve("contact_nodes", &deck(&[low(), up(3, 0.0)], &contact), 2);
    assert_eq!(found.code, 0, "{}", found.said);
    // Shape functions of the master at each node.
    let mut equations = String::new();
    for node in nodes {
        let at = |k: usize| 2.0 * (k as f64) / 3.0;
        let (x, y) = (at((node - 101) % 4), at((node - 101) / 4));
        let (i, j) = ((x as usize).min(1), (y as usize).min(1));
        let (s, t) = (x - i as f64, y - j as f64);
        let corners = [
            (0, 0, (1.0 - s) * (1.0 - t)),
            (1, 0, s * (1.0 - t)),
            (1, 1, s * t),
            (0, 1, (1.0 - s) * t),
        ];
        let terms: Vec<String> = corners
            .into_iter()
            .filter(|c| c.2 > 1e-12)
            .map(|(a, b, v)| format!("{},3,{:.14}\n", 19 + i + a + 3 * (j + b), -v))
            .collect();
        equations += &format!(
            "*EQUATION\n{}\n{node},3,1.\n{}",
            1 + terms.len(),
            terms.concat()
        );
    }
    let tied = solve(
        "contact_equations",
        &deck(&[low(), up(3, 0.0)], &(equations + PRESS)),
        1,
    );
    for node in [133, 136, 148] {
        found.expect(node, 2, tied.u[&node][2]);
    }
}

/// What ADJUST takes as touching is counted; a tied contact with ADJUST moves its nodes, and without it says that it
/// keeps a gap that the springs of CalculiX close.
#[test]
fn what_is_adjusted_is_said() {
    let contact = pair("TYPE=SURFACE TO SURFACE,ADJUST=0.03", "SUPZ0") + PRESS;
    let ran = solve("adjust", &deck(&[low(), up(2, 0.02)], &contact), 1);
    ran.says("takes 9 nodes as touching that are up to 2.000e-2 apart or overlap as much;");
    let tied = |adjust: &str| {
        let kind = format!("TYPE=SURFACE TO SURFACE{adjust}");
        let law = pair(&kind, "SUPZ0").replace("=HARD", "=TIED\n1.e7");
        let press = PRESS
            .replace("NUPX0,1,1\nNUPY0,2,2\n", "")
            .replace("NUPZ1,3,-1.", "NUPZ1,1,1.");
        solve("tied_gap", &deck(&[low(), up(2, 0.2)], &(law + &press)), 1)
    };
    let gap = tied("");
    gap.says("9 nodes of the slave SUPZ0 are up to 2.000e-1 from the master SLOZ1: the springs of CalculiX close such");
    let moved = tied(",ADJUST=0.3");
    moved.says(
        "*CONTACT PAIR moves 9 nodes of the slave SUPZ0 onto the master SLOZ1, by 2.000e-1 at most",
    );
    assert!(
        !moved.said.contains("springs of CalculiX"),
        "{}",
        moved.said
    );
    // The block that is pushed is longer by 0.2.
    assert!(
        moved.u[&119][0] > 1.2 * gap.u[&119][0],
        "{:?} {:?}",
        moved.u[&119],
        gap.u[&119]
    );
}

/// Notes that belong to the scene of a deck are printed by `solve`, as by `plan`.
#[test]
fn notes_of_a_deck_are_printed() {
    let contact = pair("TYPE=SURFACE TO SURFACE", "SUPX0") + PRESS;
    let ran = solve(
        "deck_notes",
        &deck(
            &[low(), up(2, 0.0)],
            &contact
                .replace("SUPX0", "SUPZ0")
                .replace("SLOZ1", "WIDE")
                .replacen(
                    "*SURFACE INTERACTION",
                    "*SURFACE,NAME=WIDE\n5,S2\n6,S2\n7,S2\n8,S2\n5,S3\n*SURFACE INTERACTION",
                    1,
                ),
        ),
        2,
    );
    assert_eq!(ran.code, 0, "{}", ran.said);
    ran.says("the contact of `SUPZ0` and `WIDE` leaves out 1 of 5 faces of `WIDE`");
}
