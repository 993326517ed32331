use crate::{read, read_mesh, Deck};
use base::Error;
use base::Result;
use mesh::{Members, MeshFile, MeshGroup};

fn deck(text: &str) -> Result<Deck> {
    read("a.inp", text.as_bytes(), &|_| Err(Error::input("no files")))
}

fn mesh(text: &str) -> MeshFile {
    read_mesh("a.inp", text.as_bytes(), &|_| Err(Error::input("no files"))).expect("a mesh")
}

/// A square of side 1 whose element takes two lines, with what else a part may have.
const PART: &str = "*PART, NAME=P
*NODE, NSET=\"every node\"
1, 0, 0
2, 1, 0
5, 1, 1
7, 0, 1
*ELEMENT, TYPE=CPE4, ELSET=E
3, 1, 2,
5, 7
*NSET, NSET=S, GENERATE
1, 5, 2
*NSET, NSET=T
S, 2
*SURFACE, NAME=LOW
E, S1
*SOLID SECTION, ELSET=E, MATERIAL=M
*TRANSFORM, NSET=S, TYPE=R
0, 1, 0, -1, 0, 0
*EQUATION
2
7, 1, 1.0, S, 1, -2.0
*END PART
";

const REST: &str = "*MATERIAL, NAME=M\n*ELASTIC\n1, 0.3\n*STEP\n*STATIC\n*END STEP\n";

/// Two of them: one at its place, the other moved by (2, 0) and turned by 90 degrees about (2, 0).
const ASSEMBLY: &str = "*ASSEMBLY, NAME=A
*INSTANCE, NAME=I-1, PART=P
*END INSTANCE
*INSTANCE, NAME=I-2, PART=P
2., 0., 0.
2., 0., 0., 2., 0., 1., 90.
*END INSTANCE
*NODE
1, 9, 9
*NSET, NSET=RP
1
*NSET, NSET=BOTH, INSTANCE=I-1
S
*NSET, NSET=BOTH, INSTANCE=I-2
2, 5
*NSET, NSET=NAMED
A.I-2.S, I-1.7
*EQUATION
2
I-1.2, 1, 1., A.I-2.S, 1, -1.
*END ASSEMBLY
";

fn members<'a>(mesh: &'a MeshFile, name: &str) -> &'a Members {
    let named = |g: &&MeshGroup| g.name == name;
    &mesh.groups.iter().find(named).expect(name).members
}

#[test]
fn instances_have_their_own_nodes_and_names() {
    let mesh = mesh(&format!("{PART}{ASSEMBLY}{REST}"));
    assert_eq!(mesh.node_ids, [1, 2, 5, 7, 8, 9, 12, 14, 15]);
    assert_eq!(mesh.cell_ids, [3, 6]);
    assert_eq!(mesh.cells.nodes(1), [4, 5, 6, 7]);
    let placed = [
        [2.0, 0.0, 0.0],
        [2.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
    ];
    assert_eq!(mesh.points[4..8], placed);
    let nodes = |name: &str| match members(&mesh, name) {
        Members::Nodes(nodes) => nodes.clone(),
        other => panic!("{name}: {other:?}"),
    };
    assert_eq!(nodes("I-1.EVERYNODE"), [0, 1, 2, 3]);
    assert_eq!(nodes("I-2.T"), [4, 5, 6]);
    assert_eq!(nodes("RP"), [8]);
    assert_eq!(nodes("BOTH"), [0, 2, 5, 6]);
    assert_eq!(nodes("NAMED"), [3, 4, 6]);
    assert_eq!(*members(&mesh, "I-2.LOW"), Members::Sides(vec![(1, 0)]));
    let second = Members::Cells {
        dim: 2,
        cells: vec![1],
    };
    assert_eq!(
        (members(&mesh, "I-2"), members(&mesh, "I-2.E")),
        (&second, &second)
    );
    // Both instances have the others: there is no short name.
    let short = |g: &MeshGroup| ["S", "T", "E", "LOW"].contains(&g.name.as_str());
    assert!(!mesh.groups.iter().any(short));
}

#[test]
fn a_single_instance_has_short_names() {
    let text = "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*NSET, NSET=T, INSTANCE=I\n7\n\
        *END ASSEMBLY\n";
    let mesh = mesh(&format!("{PART}{text}"));
    assert_eq!(mesh.node_ids, [1, 2, 5, 7]);
    assert_eq!(members(&mesh, "S"), members(&mesh, "I.S"));
    assert_eq!(*members(&mesh, "LOW"), Members::Sides(vec![(0, 0)]));
    // The assembly has a set of this name.
    assert_eq!(*members(&mesh, "T"), Members::Nodes(vec![3]));
}

#[test]
fn equations_and_systems_are_those_of_each_instance() {
    let deck = deck(&format!("{PART}{ASSEMBLY}{REST}")).expect("a deck");
    let nodes = |e: &crate::DeckEquation| e.terms.iter().map(|t| t.node).collect::<Vec<u32>>();
    let all: Vec<Vec<u32>> = deck.equations.iter().map(nodes).collect();
    // S has two nodes, so that each card makes two equations.
    assert_eq!(all, [[3, 0], [3, 2], [7, 4], [7, 6], [1, 4], [1, 6]]);
    assert_eq!(
        deck.frame(0),
        Some([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    );
    assert_eq!(
        deck.frame(4),
        Some([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]])
    );
    assert_eq!(deck.frame(1), None);
    let notes: Vec<&str> = deck.placed.iter().map(|n| n.reason.as_str()).collect();
    let second = "nodes of instance I-2 have their own numbers plus 7 in messages and tables, elements plus 3";
    assert_eq!(notes, [second]);
    assert_eq!(deck.cell_section, [0, 1]);
}

/// Axes of materials go with the instances of a part.
#[test]
fn orientations_are_those_of_each_instance() {
    let part = PART
        .replace("MATERIAL=M", "MATERIAL=M, ORIENTATION=O")
        .replace(
            "*EQUATION",
            "*ORIENTATION, NAME=O\n1, 0, 0, 0, 1, 0\n3, 0\n*EQUATION",
        );
    let deck = deck(&format!("{part}{ASSEMBLY}{REST}")).expect("a deck");
    let axes = |k: usize| {
        let place = deck.sections[k].orientation.expect("one");
        deck.orientations[place as usize].axes.frame([0.0; 3])[0]
    };
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(near(axes(0), [1.0, 0.0, 0.0]) && near(axes(1), [0.0, 1.0, 0.0]));
}

/// A part without an instance is said to be left out; what it has is not told twice of one with two.
#[test]
fn what_is_left_out_is_told() {
    let other = PART
        .replace("NAME=P", "NAME=Q")
        .replace("*EQUATION", "*NORMAL\n1, 1, 0, 0, 1\n*EQUATION");
    let text = ASSEMBLY.replace("PART=P", "PART=Q");
    let deck = deck(&format!("{PART}{other}{text}{REST}")).expect("a deck");
    assert!(deck
        .placed
        .iter()
        .any(|n| n.reason == "part P has no instance: it is left out"));
    let told = deck.ignored.iter().filter(|n| n.keyword == "*NORMAL");
    assert_eq!(told.count(), 1);
    // Every part is there once where nothing is assembled.
    let mesh = mesh(&format!("{PART}{other}"));
    assert_eq!(mesh.node_ids.len(), 8);
    assert_eq!(*members(&mesh, "Q.S"), Members::Nodes(vec![4, 6]));
}

/// *SYSTEM moves the nodes behind it: an origin, a point on the first axis, a point in the plane of the first two.
#[test]
fn a_system_places_nodes() {
    let mesh = mesh("*SYSTEM\n1, 2, 3, 1, 5, 3\n-4, 2, 3\n*NODE\n1, 1, 0, 0\n2, 0, 1, 0\n*SYSTEM\n1\n*NODE\n3, 1\n\
        *SYSTEM\n*NODE\n4, 1\n*SYSTEM\n0, 0, 0, 0, 1, 0\n*NODE\n5, 1, 2\n*ELEMENT, TYPE=T3D2, ELSET=E\n1, 1, 2\n");
    let expected = [
        [1.0, 3.0, 3.0],
        [0.0, 2.0, 3.0],
        [2.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [-2.0, 1.0, 0.0],
    ];
    assert_eq!(mesh.points, expected);
    let wrong = deck("*SYSTEM\n0, 0, 0, 1, 0, 0\n2, 0, 0\n*NODE\n1, 0\n")
        .unwrap_err()
        .to_string();
    assert_eq!(wrong, "a.inp, line 1: *SYSTEM: its points define no axes");
}
