use crate::error::Error;
use crate::mesh::deck::{
    read, read_mesh, Adjust, BodyLoadKind, ContactKind, Deck, ElementType, Overclosure, Printed,
    Totals,
};
use crate::mesh::Members;

/// Two cubes of edge 1 side by side, each with nodes of its own: 1 to 8 and 11 to 18.
const CUBES: &str = "*NODE,NSET=N\n1\n2,1\n3,1,1\n4,0,1\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
    11,1\n12,2\n13,2,1\n14,1,1\n15,1,0,1\n16,2,0,1\n17,2,1,1\n18,1,1,1\n\
    *ELEMENT,TYPE=C3D8,ELSET=E\n1,1,2,3,4,5,6,7,8\n2,11,12,13,14,15,16,17,18\n";
const REST: &str = "*MATERIAL,NAME=M\n*ELASTIC\n1.,.3\n*SOLID SECTION,ELSET=E,MATERIAL=M\n";
const STEP: &str = "*STEP\n*STATIC\n*END STEP\n";

fn deck(model: &str, step: &str) -> Result<Deck, Error> {
    let text = format!("{CUBES}{model}{REST}*STEP\n*STATIC\n{step}*END STEP\n");
    read("a.inp", text.as_bytes(), &|_| Err(Error::input("no files")))
}

fn good(model: &str, step: &str) -> Deck {
    deck(model, step).unwrap_or_else(|e| panic!("{e} in {model}{step}"))
}

/// The message without its place; model data begin in line 21.
fn bad(model: &str, step: &str) -> String {
    let read = deck(model, step).map(|_| ());
    let message = read.expect_err("a deck that is refused").to_string();
    assert!(message.starts_with("a.inp, line "), "{message}");
    assert!(!message.contains('\n') && message.len() < 250, "{message}");
    message.split_once(": ").expect("a place").1.to_string()
}

fn whole(text: &str) -> String {
    let read = read("a.inp", text.as_bytes(), &|_| Err(Error::input("no files"))).map(|_| ());
    read.expect_err("a deck that is refused").to_string()
}

fn group<'a>(deck: &'a Deck, name: &str) -> &'a Members {
    let found = deck.mesh.groups.iter().find(|g| g.name == name);
    &found.expect("a group").members
}

#[test]
fn sets_are_listed_generated_and_complemented() {
    let deck = good(
        "*NSET,NSET=A,GENERATE\n1,7,3\n*NSET,NSET=b b\n8, a ,3\n2\n*NSET,NSET=A\n2,A\n\
         *ELSET,ELSET=E2\n2\n*ELSET,ELSET=ALL,GENERATE\n1,1000000000\n*NSET,NSET=EMPTY\n",
        "*NODE PRINT,NSET=BB\nU\n",
    );
    assert_eq!(*group(&deck, "A"), Members::Nodes(vec![0, 1, 3, 6]));
    assert_eq!(*group(&deck, "BB"), Members::Nodes(vec![0, 1, 2, 3, 6, 7]));
    assert_eq!(deck.steps[0].prints[0].nodes, [7, 0, 3, 6, 2, 1]);
    assert_eq!(
        *group(&deck, "ALL"),
        Members::Cells {
            dim: 3,
            cells: vec![0, 1]
        }
    );
    assert_eq!(
        deck.mesh
            .groups
            .iter()
            .filter(|g| g.name == "EMPTY")
            .count(),
        0
    );
    assert!(deck.ignored.iter().any(|n| n.reason.contains("EMPTY")));
}

#[test]
fn sets_that_say_too_much_are_refused() {
    // Each set is twice the one before.
    let mut doubled = "*NSET,NSET=S0\nN,N\n".to_string();
    for k in 0..60 {
        doubled += &format!("*NSET,NSET=S{}\nS{k},S{k}\n", k + 1);
    }
    assert!(bad(&doubled, "").contains("too much in too few lines"));
    let one_line = format!("*NSET,NSET=S\n{}\n", "N,".repeat(1_000_000));
    assert!(bad(&one_line, "").contains("too much in too few lines"));
    // Steps keep what is there before.
    let print = "*STEP\n*STATIC\n*NODE PRINT,NSET=BIG\nU\n*END STEP\n";
    let steps = format!("{REST}{print}{}", STEP.repeat(10_000));
    let big = format!("*NSET,NSET=BIG\n{}\n", "N,".repeat(50));
    assert!(whole(&format!("{CUBES}{big}{steps}")).contains("too much in too few lines"));
}

#[test]
fn mistakes_in_sets_are_said() {
    assert_eq!(bad("*NSET,NSET=A\n9\n", ""), "there is no node 9");
    assert_eq!(
        bad("*NSET,NSET=A\nB\n*NSET,NSET=B\n1\n", ""),
        "there is no node set B"
    );
    assert_eq!(bad("*ELSET,ELSET=A\n9\n", ""), "there is no element 9");
    assert_eq!(
        bad("*NSET\n1\n", ""),
        "*NSET: the parameter NSET= is missing"
    );
    assert_eq!(bad("*NSET,NSET=\n1\n", ""), "*NSET: NSET= needs a name");
    assert_eq!(
        bad("*NSET,NSET=A,SORT\n1\n", ""),
        "*NSET: the parameter SORT is not supported"
    );
    let name = "A".repeat(81);
    assert!(bad(&format!("*NSET,NSET={name}\n1\n"), "").contains("is longer than 80 letters"));
    assert!(deck(&format!("*NSET,NSET={}\n1\n", &name[1..]), "").is_ok());
    let generate = |row: &str| bad(&format!("*NSET,NSET=A,GENERATE\n{row}\n"), "");
    assert_eq!(generate("5,3"), "nodes from 5 to 3 by steps of 1 are none");
    assert_eq!(
        generate("1,3,0"),
        "nodes from 1 to 3 by steps of 0 are none"
    );
    assert_eq!(
        generate("100,2000000000"),
        "there are no nodes from 100 to 2000000000 by steps of 1"
    );
    assert!(generate("1,-3")
        .contains("the last number is expected, a whole number, but field 2 is '-3'"));
    assert!(generate("1,99999999999999999999").contains("a whole number"));
}

#[test]
fn mistakes_in_nodes_and_elements_are_said() {
    let mesh = |text: &str| whole(&format!("*NODE\n1,0\n2,1\n3,0,1\n4,0,0,1\n{text}\n{STEP}"));
    assert!(mesh("5,1e999")
        .starts_with("a.inp, line 6: a coordinate is expected, a number, but field 2 is '1e999'"));
    assert!(mesh("5,nan").contains("field 2 is 'nan'"));
    assert!(mesh("0,1").ends_with("nodes are numbered from 1"));
    assert!(mesh("-5,1").contains("the number of a node is expected"));
    let element = |rows: &str| mesh(&format!("*ELEMENT,TYPE=C3D4\n{rows}"));
    assert!(element("1,1,2,3,5").ends_with("line 7: element 1 has node 5, which is not defined"));
    assert!(element("1,1,2,3").ends_with("element 1 has 3 nodes, but elements of type C3D4 have 4"));
    assert!(element("1,1,2\n3,4,1")
        .ends_with("element 1 has 5 nodes, but elements of type C3D4 have 4"));
    assert!(element("1,1,2,3,4\n1,4,3,2,1").ends_with("line 8: element 1 is defined before"));
    assert!(mesh("*ELEMENT,TYPE=C3D4H\n1,1,2,3,4").ends_with(
        "*ELEMENT: elements of type C3D4H (hybrid or modified solids) are not supported"
    ));
    assert!(mesh("*ELEMENT\n1,1,2,3,4").ends_with("*ELEMENT: the parameter TYPE= is missing"));
    assert!(
        mesh("*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n*ELEMENT,TYPE=CPS3\n2,1,2,3")
            .ends_with("elements of type CPS3 are plane, but those before are solid")
    );
    assert!(mesh("*ELEMENT,TYPE=CPS3\n1,1,2,4").contains("but z is 1 at node 4 of element 1"));
    assert!(mesh("5,-1\n*ELEMENT,TYPE=CAX3\n1,1,5,3")
        .contains("lie at positive x, but x is -1 at node 5"));
    assert!(whole("").ends_with("a.inp: the deck has no elements"));
    let none = format!("{CUBES}{REST}");
    assert!(whole(&none).ends_with("a.inp: the deck has no *STEP, so it asks for nothing"));
}

#[test]
fn elements_take_several_lines_and_nodes_twice() {
    let deck = good(
        "*NODE\n1,0,0,0\n2,1.5\n*ELEMENT,TYPE=C3D8I,ELSET=E\n3,1,2,3,\n4,\n5,6,7,8,\n",
        "",
    );
    assert_eq!(deck.elements[2], ElementType::C3D8I);
    assert_eq!(deck.mesh.cells.nodes(2), [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(
        (deck.mesh.points.len(), deck.mesh.points[1]),
        (16, [1.5, 0.0, 0.0])
    );
    assert_eq!(deck.replaced.len(), 1);
    assert_eq!(deck.files.at(deck.replaced[0].place), "a.inp, line 23");
    assert!(deck.replaced[0]
        .reason
        .starts_with("node 2 is defined before"));
}

#[test]
fn surfaces_are_sides_or_nodes() {
    let deck = good(
        "*SURFACE,NAME=S\nE,S3\n1,S4\n1,S3\n*SURFACE,NAME=S,TYPE=NODE\n3\n1\n",
        "",
    );
    let of = |m: &Members| {
        deck.mesh
            .groups
            .iter()
            .any(|g| g.name == "S" && g.members == *m)
    };
    assert!(of(&Members::Sides(vec![(0, 2), (0, 3), (1, 2)])));
    assert!(of(&Members::Nodes(vec![0, 2])));
    assert!(bad("*SURFACE,NAME=S\n1,S7\n", "").contains("S1 to S6, but it is 'S7'"));
    assert!(bad("*SURFACE,NAME=S\n1,SPOS\n", "").contains("but it is 'SPOS'"));
    assert_eq!(
        bad("*SURFACE,NAME=S\nX,S1\n", ""),
        "there is no element set X"
    );
    assert_eq!(
        bad("*SURFACE,NAME=S,TYPE=EDGE\n1,S1\n", ""),
        "*SURFACE: TYPE=EDGE is neither ELEMENT nor NODE"
    );
    let tet = "*ELEMENT,TYPE=C3D4,ELSET=E\n3,1,2,3,5\n*SURFACE,NAME=S\n3,S5\n";
    assert_eq!(
        bad(tet, ""),
        "element 3, a tetrahedron of 4 nodes, has no side 5"
    );
}

#[test]
fn contact_and_ties() {
    let surfaces =
        "*SURFACE,NAME=L\n1,S4\n*SURFACE,NAME=R\n2,S6\n*SURFACE,NAME=R,TYPE=NODE\n11\n14\n\
                    *SURFACE INTERACTION,NAME=I\n";
    let soft = "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n1.e7,3.\n";
    let pair = "*CONTACT PAIR,INTERACTION=I,TYPE=SURFACE TO SURFACE,ADJUST=.01\nR,L\n";
    let gap = "*CLEARANCE,SLAVE=R,MASTER=L,VALUE=-.1\n";
    let deck = good(&format!("{surfaces}{soft}{pair}{gap}"), "");
    let contact = &deck.contacts[0];
    assert_eq!(
        (contact.kind, contact.slave.nodes),
        (ContactKind::SurfaceToSurface, false)
    );
    assert_eq!(
        deck.mesh.groups[contact.slave.group as usize].members,
        Members::Sides(vec![(1, 5)])
    );
    assert_eq!(
        (&contact.adjust, contact.clearance),
        (&Adjust::Within(0.01), Some(-0.1))
    );
    assert_eq!(
        deck.interactions[0].overclosure,
        Overclosure::Linear { slope: Some(1e7) }
    );
    assert_eq!(deck.replaced.len(), 2);
    assert!(deck.replaced[0]
        .reason
        .contains("LINEAR pressure is replaced by hard contact"));

    let nodes =
        "*CONTACT PAIR,INTERACTION=I,TYPE=NODE TO SURFACE,SMALL SLIDING\nR,L\n*TIE,NAME=T\nR,L\n";
    let deck = good(&format!("{surfaces}{nodes}"), "");
    let contact = &deck.contacts[0];
    assert!(contact.slave.nodes && contact.small_sliding && contact.adjust == Adjust::No);
    assert_eq!(
        deck.mesh.groups[contact.slave.group as usize].members,
        Members::Nodes(vec![8, 11])
    );
    assert_eq!(deck.interactions[0].overclosure, Overclosure::Hard);
    assert!(deck.replaced.is_empty());
    let tie = &deck.ties[0];
    assert!(tie.slave.nodes && !tie.master.nodes && tie.adjust && tie.tolerance.is_none());

    let rough = "*FRICTION\n.2,1e4\n";
    let refused = |more: &str| bad(&format!("{surfaces}{more}"), "");
    assert!(refused(&format!("{rough}{pair}")).starts_with("*FRICTION: friction is not supported"));
    assert!(read(
        "a",
        format!("{CUBES}{surfaces}{rough}{REST}{STEP}").as_bytes(),
        &|_| Ok(vec![])
    )
    .is_ok());
    good(&format!("{surfaces}*FRICTION\n0.,1e4\n{pair}"), "");
    let tied = "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TIED\n1.e7\n";
    let deck = good(&format!("{surfaces}{tied}{rough}{pair}"), "");
    assert!(deck.replaced[0].reason.contains("replaced by a tie"));
    assert_eq!(
        refused("*CONTACT PAIR,INTERACTION=X\nR,L\n"),
        "*CONTACT PAIR: there is no surface interaction X"
    );
    assert_eq!(refused("*TIE\nR,X\n"), "there is no surface X");
    assert_eq!(refused("*TIE\nL\n"), "there is no surface ");
    assert_eq!(
        refused("*TIE\n"),
        "*TIE: the line that names slave and master is missing"
    );
    assert_eq!(
        refused("*TIE,CYCLIC SYMMETRY\nR,L\n"),
        "*TIE: CYCLICSYMMETRY: cyclic symmetry is not supported"
    );
    let only_nodes = "*SURFACE,NAME=P,TYPE=NODE\n1\n*TIE\nL,P\n";
    assert!(refused(only_nodes).starts_with("the surface P consists of nodes"));
    assert!(refused(gap).ends_with("there is no contact pair of slave R and master L"));
    assert!(
        refused("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n-1.\n")
            .ends_with("must be positive")
    );
}

#[test]
fn equations_and_the_constraints_that_are_equations() {
    let sets = "*NSET,NSET=A\n2,3\n*NSET,NSET=B\n11,14\n";
    let deck = good(
        &format!("{sets}*EQUATION\n5\n1,1,1.,2,2,-.5,3,3,2.,4,1,1.,\n5,1,1.\n2\nA,1,1.,B,1,-1.\n2\nA,2,1.,1,2,3.\n"),
        "",
    );
    let terms = |e: usize| -> Vec<(u32, u8, f64)> {
        deck.equations[e]
            .terms
            .iter()
            .map(|t| (t.node, t.dof, t.factor))
            .collect()
    };
    assert_eq!(deck.equations.len(), 5);
    assert_eq!(
        terms(0),
        [
            (0, 0, 1.0),
            (1, 1, -0.5),
            (2, 2, 2.0),
            (3, 0, 1.0),
            (4, 0, 1.0)
        ]
    );
    assert_eq!(terms(2), [(2, 0, 1.0), (11, 0, -1.0)]);
    assert_eq!(terms(4), [(2, 1, 1.0), (0, 1, 3.0)]);
    assert_eq!(deck.files.at(deck.equations[4].place), "a.inp, line 31");

    let deck = good(
        &format!("{sets}*MPC\nPIN,A,B\nTIE,1,4\nLINEAR,5,1,12\n"),
        "",
    );
    assert_eq!(deck.equations.len(), 12);
    // Node 5 lies above node 1; between nodes 1 and 12 its share is all of node 1's.
    let last: Vec<(u32, f64)> = deck.equations[11]
        .terms
        .iter()
        .map(|t| (t.node, t.factor))
        .collect();
    assert_eq!(last, [(4, 1.0), (0, -1.0), (9, -0.0)]);

    let equation = |rows: &str| bad(&format!("{sets}*EQUATION\n{rows}"), "");
    assert_eq!(
        equation("3\n1,1,1.,2,1,1.\n"),
        "the equation has 3 terms, but only 2 follow"
    );
    assert_eq!(
        equation("1000000000000\n1,1,1.\n"),
        "the equation has 1000000000000 terms, but only 1 follow"
    );
    assert_eq!(
        equation("1\n1,1,1.,2,1,1.\n"),
        "the equation has 1 terms, but more follow"
    );
    assert_eq!(equation("0\n"), "an equation needs terms");
    assert_eq!(
        equation("1\n1,4,1.\n"),
        "the direction of a term is 1 to 3, but it is 4"
    );
    assert_eq!(equation("1\n1,1,0.\n"), "the factor of the first term is 0");
    assert_eq!(
        equation("1\n1,1\n"),
        "a factor is expected, a number, but field 3 is empty"
    );
    assert_eq!(
        equation("2\nA,1,1.,N,1,1.\n"),
        "the node sets of an equation differ in size"
    );
    assert!(bad("*MPC\nPLANE,1,2,3,4\n", "")
        .starts_with("*MPC: constraints of type PLANE are no plain equations"));
    assert_eq!(
        bad("*MPC\nPIN,1\n", ""),
        "*MPC: constraints of type PIN have 2 nodes or node sets, but 1 stand here"
    );
    assert!(bad("", "*EQUATION,REMOVE\n1,1\n").contains("equations stay for all steps"));
    assert!(bad("", "*EQUATION\n1\n1,1,1.\n").ends_with("it must stand before the first *STEP"));
}

#[test]
fn systems_of_coordinates() {
    let deck = good(
        "*TRANSFORM,NSET=N,TYPE=C\n0,0,0,0,0,1\n*NSET,NSET=A\n2\n*TRANSFORM,NSET=A\n0,1,0,0,0,1\n",
        "",
    );
    assert_eq!(
        deck.frame(1),
        Some([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    );
    assert_eq!(
        deck.frame(3),
        Some([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    );
    let on_axis = deck.frame(0).expect("a system");
    assert_eq!(on_axis[2], [0.0, 0.0, 1.0]);
    assert_eq!(
        bad("*TRANSFORM,NSET=N,TYPE=C\n1,2,3,1,2,3\n", ""),
        "the two points define no axes"
    );
    assert_eq!(
        bad("*TRANSFORM,NSET=N\n1,2,3,2,4,6\n", ""),
        "the two points define no axes"
    );
    assert_eq!(
        bad("*TRANSFORM,NSET=N,TYPE=S\n1,2,3,2,4,6\n", ""),
        "*TRANSFORM: TYPE=S is neither R nor C"
    );
    assert_eq!(
        bad("*TRANSFORM,NSET=X\n1,0,0,0,1,0\n", ""),
        "*TRANSFORM: there is no node set X"
    );
}

#[test]
fn materials_and_sections() {
    let section = |rows: &str| whole(&format!("{CUBES}{rows}{STEP}"));
    let with = |material: &str| {
        section(&format!(
            "*MATERIAL,NAME=M\n{material}*SOLID SECTION,ELSET=E,MATERIAL=M\n"
        ))
    };
    assert!(with("*ELASTIC\n-1.,.3\n").ends_with("Young's modulus is -1; it must be positive"));
    assert!(with("*ELASTIC\n1.,.5\n")
        .ends_with("Poisson's ratio is 0.5; it must lie between -1 and 0.5"));
    assert!(with("*ELASTIC\n1.\n").contains("a constant of the material is expected"));
    assert!(with("*ELASTIC\n1.,.3,20.\n2.,.3,100.\n")
        .ends_with("depend on temperature are not supported"));
    assert!(with("*ELASTIC\n").ends_with("*ELASTIC: its line of data is missing"));
    assert!(with("*DENSITY\n1.\n").ends_with("*SOLID SECTION: the material M has no *ELASTIC"));
    assert!(with("*ELASTIC,TYPE=ORTHO\n1.,2.\n")
        .contains("line 22: *ELASTIC: TYPE=ORTHO: only isotropic"));
    assert!(with("*ELASTIC\n1.,.3\n*PLASTIC\n1.,0.\n").ends_with(
        "line 24: *PLASTIC: only isotropic linear elasticity is supported \
             (the elements of E have this material)"
    ));
    assert!(section("*ELASTIC\n1.,.3\n").ends_with("*ELASTIC: there is no *MATERIAL before it"));
    assert!(section("*SOLID SECTION,ELSET=E,MATERIAL=M\n").ends_with("there is no material M"));
    assert!(
        section("*MATERIAL,NAME=M\n*ELASTIC\n1.,.3\n*SOLID SECTION,ELSET=X,MATERIAL=M\n")
            .ends_with("there is no element set X")
    );
    let one = "*ELSET,ELSET=E1\n1\n*MATERIAL,NAME=M\n*ELASTIC\n1.,.3\n*SOLID SECTION,ELSET=E1,MATERIAL=M\n";
    assert!(section(one).ends_with("a.inp: element 2 belongs to no *SOLID SECTION"));
    // Materials that no element has may be anything, and later sections win.
    let text = "*MATERIAL,NAME=P\n*PLASTIC\n1.,0.\n*MATERIAL,NAME=Q\n*ELASTIC\n2.,0.,20.\n2.,0.,30.\n*DENSITY\n3.\n\
                *ELSET,ELSET=E1\n1\n";
    let more = "*SOLID SECTION,ELSET=E1,MATERIAL=Q\n*STEP\n*STATIC\n*DLOAD\nE1,GRAV,2.,0.,-3.,0.\n*END STEP\n";
    let text = format!("{CUBES}{text}{REST}{more}");
    let deck = read("a.inp", text.as_bytes(), &|_| unreachable!()).expect("a deck");
    assert_eq!(deck.cell_section, [1, 0]);
    assert_eq!(
        deck.materials[deck.sections[1].material as usize].density,
        Some(3.0)
    );
    assert_eq!(
        deck.steps[0].body_loads[0].kind,
        BodyLoadKind::Gravity([0.0, -2.0, 0.0])
    );
    assert!(bad("", "*DLOAD\nE,GRAV,2.,0.,-3.,0.\n").contains("its material M has no *DENSITY"));
}

#[test]
fn boundary_conditions() {
    let deck = good(
        "*BOUNDARY\n1,1,3\n5,ENCASTRE\n2,2\n3,3,3,.5\n3,3,3,.25\n4,4,6\n",
        "*BOUNDARY\n2,2,2,1.\n",
    );
    let all: Vec<(u32, u8, f64)> = deck.steps[0]
        .supports
        .iter()
        .map(|s| (s.node, s.dof, s.value))
        .collect();
    let held = |n: u32| [(n, 0, 0.0), (n, 1, 0.0), (n, 2, 0.0)];
    assert_eq!(
        all,
        [&held(0)[..], &[(1, 1, 1.0), (2, 2, 0.25)], &held(4)].concat()
    );
    let line = |row: &str| bad(&format!("*BOUNDARY\n{row}\n"), "");
    assert_eq!(line("X,1"), "there is no node set X");
    assert_eq!(line("9,1"), "there is no node 9");
    assert_eq!(
        line("1"),
        "a direction is expected, a whole number, but field 2 is empty"
    );
    assert_eq!(
        line("1,11,11,20."),
        "directions are 1 to 6, but they are 11 to 11"
    );
    assert_eq!(
        line("1,1,1000000000"),
        "directions are 1 to 6, but they are 1 to 1000000000"
    );
    assert_eq!(
        line("1,3,1"),
        "the last direction, 1, comes before the first, 3"
    );
    assert!(line("1,1,6,.1").starts_with("direction 6 cannot be given here"));
    assert_eq!(
        line("1,1,1,inf"),
        "a displacement is expected, a number, but field 4 is 'inf'"
    );
    assert!(bad("*BOUNDARY,MASS FLOW\n1,1\n", "").contains("fluids are not supported"));
    assert!(bad("*BOUNDARY,AMPLITUDE=A\n1,1\n", "").ends_with("there is no amplitude A"));
}

#[test]
fn loads() {
    let deck = good(
        "*SURFACE,NAME=S\n1,S1\n2,S2\n",
        "*CLOAD\nN,2,.5\n1,2,.5\n1,1,1.\n1,1,-1.\n*DLOAD\nE,P2,1.\n*DSLOAD\nS,P,2.\n",
    );
    let step = &deck.steps[0];
    assert_eq!(step.forces.len(), 16);
    assert_eq!((step.forces[0].dof, step.forces[0].value), (1, 1.0));
    let all: Vec<(u32, u8, f64)> = step
        .pressures
        .iter()
        .map(|p| (p.cell, p.side, p.value))
        .collect();
    assert_eq!(all, [(0, 0, 2.0), (0, 1, 1.0), (1, 1, 3.0)]);
    let load = |row: &str| bad("", &format!("*DLOAD\n{row}\n"));
    assert!(load("E,P2NU,1.").starts_with("loads of type 'P2NU' are not supported"));
    assert!(load("E,P7,1.").contains("P1 to P6, but it is 'P7'"));
    assert_eq!(
        load("E,P2"),
        "a pressure is expected, a number, but field 3 is empty"
    );
    assert_eq!(load("S,P,1."), "there is no surface of sides of elements S");
    assert_eq!(load("E,GRAV,1.,0.,0.,0."), "the direction of gravity is 0");
    assert!(
        load("E,CENTRIF,1.,0.,0.,0.,0.,0.,1.\nE,CENTRIF,1.,1.,0.,0.,0.,0.,1.")
            .starts_with("a set cannot turn about two axes")
    );
    assert_eq!(
        bad("*CLOAD\n1,1,1.\n", ""),
        "*CLOAD: it must stand between *STEP and *END STEP"
    );
    assert_eq!(
        bad("", "*CLOAD\n1,4,1.\n"),
        "the direction of a force is 1 to 3 here, but it is 4"
    );
    let twice = "*NSET,NSET=A\n1,2,1\n*SURFACE,NAME=S\n1,S1\nE,S1\n*ELSET,ELSET=B\n1,1\n";
    assert!(bad(twice, "*CLOAD\nA,1,1.\n").starts_with("A has members twice"));
    assert!(bad(twice, "*DSLOAD\nS,P,1.\n").starts_with("S has members twice"));
    assert!(bad(twice, "*DLOAD\nB,P1,1.\n").starts_with("B has members twice"));
    let two = "*CLOAD,AMPLITUDE=A\n1,1,1.\n*CLOAD,AMPLITUDE=B\n1,1,1.\n";
    let amplitudes = "*AMPLITUDE,NAME=A\n0,1\n*AMPLITUDE,NAME=B\n0,2\n";
    assert!(bad(amplitudes, two).contains("another amplitude"));
}

#[test]
fn amplitudes_are_taken_at_the_end_of_steps() {
    let amplitudes = "*AMPLITUDE,NAME=A\n0.,0.,1.,2.,\n3.,4.\n*AMPLITUDE,NAME=T,TIME=TOTAL TIME\n0.,0.,10.,10.\n";
    let steps = "*STEP\n*STATIC\n.1,2.\n*CLOAD,AMPLITUDE=A\n1,1,10.\n*CLOAD,AMPLITUDE=T\n2,1,10.\n\
                 *CLOAD,AMPLITUDE=A,TIME DELAY=1.5\n3,1,10.\n*END STEP\n\
                 *STEP\n*STATIC\n.1,2.5\n*END STEP\n";
    let text = format!("{CUBES}{amplitudes}{REST}{steps}");
    let deck = read("a.inp", text.as_bytes(), &|_| unreachable!()).expect("a deck");
    let values = |k: usize| -> Vec<f64> { deck.steps[k].forces.iter().map(|f| f.value).collect() };
    assert_eq!((deck.steps[0].time, deck.steps[1].time), (2.0, 4.5));
    assert_eq!(values(0), [30.0, 20.0, 10.0]);
    assert_eq!(values(1), [30.0, 45.0, 10.0]);
    assert!(
        bad("*AMPLITUDE,NAME=A\n1.,0.,0.,1.\n", "").ends_with("the times of an amplitude decrease")
    );
    assert!(bad("*AMPLITUDE,NAME=A,USER\n", "").contains("amplitudes of users"));
    assert!(bad("*AMPLITUDE,NAME=A\n", "").ends_with("its table is missing"));
}

#[test]
fn steps() {
    let text = |steps: &str| whole(&format!("{CUBES}{REST}{steps}"));
    assert!(text("*STEP\n*STATIC\n*CLOAD\n1,1,1.\n")
        .ends_with("line 25: *STEP: the step has no *END STEP; the file may be cut off"));
    assert!(text("*STEP\n*STEP\n").contains("the *STEP of a.inp, line 25 has no *END STEP"));
    assert!(text("*STEP\n*END STEP\n").ends_with("line 25: *STEP: the step has no *STATIC"));
    assert!(text("*END STEP\n").ends_with("there is no *STEP before it"));
    assert!(text("*STATIC\n").ends_with("it must stand between *STEP and *END STEP"));
    assert!(text("*STEP,NLGEOM\n*STATIC\n*END STEP\n")
        .contains("NLGEOM: large displacements are not supported"));
    assert!(text("*STEP\n*FREQUENCY\n5\n*END STEP\n")
        .contains("line 26: *FREQUENCY: it depends on time"));
    assert!(text("*STEP\n*SHAKE\n").ends_with("line 26: *SHAKE: this keyword is unknown"));
    assert!(text(&format!("{STEP}*STEP,PERTURBATION\n")).contains("in the first step only"));
    let step =
        "*STEP,NLGEOM=NO,PERTURBATION,INC=10\nloads\n*STATIC,DIRECT\n*RESTART,WRITE\n*END STEP\n";
    let good = format!("{CUBES}{REST}{step}");
    let deck = read("a.inp", good.as_bytes(), &|_| unreachable!()).expect("a deck");
    assert_eq!(deck.ignored[0].keyword, "*RESTART");
    assert_eq!(deck.files.at(deck.ignored[0].place), "a.inp, line 28");
}

#[test]
fn what_is_printed() {
    let deck = good("", "*NODE PRINT,NSET=N,TOTALS=YES,FREQUENCY=100\nRF,NT,\nU\n*NODE PRINT,NSET=N,FREQUENCY=0\nU\n\
                         *NODE PRINT\nU\n*NODE FILE\nU,RF\n*EL FILE\nS\n*EL PRINT,ELSET=E\nS\n");
    let step = &deck.steps[0];
    assert_eq!(step.prints.len(), 1);
    assert_eq!(
        step.prints[0].printed,
        [Printed::Force, Printed::Displacement]
    );
    assert_eq!(
        (step.prints[0].totals, step.prints[0].global),
        (Totals::Yes, false)
    );
    assert_eq!(
        (step.fields[0].keyword, step.fields[1].keyword),
        ("*NODE FILE", "*EL FILE")
    );
    assert_eq!(step.fields[0].fields, ["U", "RF"]);
    let ignored: Vec<&str> = deck.ignored.iter().map(|n| n.keyword.as_str()).collect();
    assert_eq!(ignored, ["*EL PRINT", "*NODE PRINT", "*NODE PRINT"]);
    assert_eq!(
        bad("", "*NODE PRINT,NSET=X\nU\n"),
        "*NODE PRINT: there is no node set X"
    );
}

#[test]
fn plane_bodies() {
    let text = |more: &str| {
        format!(
            "*NODE,NSET=N\n1\n2,1\n3,1,1\n4,0,1\n*ELEMENT,TYPE=CPS4,ELSET=E\n1,1,2,3,4\n\
             *MATERIAL,NAME=M\n*ELASTIC\n1.,.3\n*DENSITY\n1.\n*SOLID SECTION,ELSET=E,MATERIAL=M\n.25\n{more}"
        )
    };
    let step =
        "*BOUNDARY\nN,1,3\n*STEP\n*STATIC\n*DLOAD\n1,P4,1.\nE,CENTRIF,2.,0,0,0,0,0,2\n*END STEP\n";
    let deck = read("a.inp", text(step).as_bytes(), &|_| unreachable!()).expect("a deck");
    assert_eq!((deck.dim(), deck.sections[0].thickness), (2, 0.25));
    assert_eq!(deck.steps[0].supports.len(), 8);
    assert_eq!(
        (
            deck.steps[0].pressures[0].side,
            deck.steps[0].pressures[0].value
        ),
        (3, 1.0)
    );
    let refused = |load: &str| whole(&text(&format!("*STEP\n*STATIC\n{load}\n*END STEP\n")));
    assert!(refused("*DLOAD\n1,P5,1.").ends_with("a quadrilateral of 4 nodes, has no side 5"));
    assert!(refused("*DLOAD\n1,GRAV,1.,0.,0.,1.")
        .ends_with("gravity across a plane body is not supported"));
    assert!(refused("*DLOAD\n1,CENTRIF,1.,0.,0.,0.,0.,1.,0.").ends_with("about axes along z only"));
    assert!(
        refused("*CLOAD\n1,3,1.").ends_with("the direction of a force is 1 to 2 here, but it is 3")
    );
    assert!(refused("*BOUNDARY\n1,3,3,1.").contains("direction 3 cannot be given here"));
    assert!(whole(&text("*TRANSFORM,NSET=N\n0,0,1,1,0,0\n"))
        .contains("the third axis must be that of z"));
    assert!(whole(&text(step).replace(".25", "0."))
        .ends_with("the thickness is 0; it must be positive"));
}

/// Wherever a deck ends or a character is wrong, there is one sentence.
#[test]
fn decks_that_are_cut_off_or_damaged_are_refused_or_read() {
    let block = include_str!("block.inp");
    let none = |_: &str| Err(Error::input("no files"));
    for end in 0..block.len() {
        let cut = &block[..end];
        if let Err(error) = read("a.inp", cut.as_bytes(), &none) {
            assert!(error.to_string().starts_with("a.inp"), "{error}");
        }
        let mut damaged = block.as_bytes().to_vec();
        for byte in [b'*', b',', b'9', b'\n', 0xff] {
            damaged[end] = byte;
            let read = read("a.inp", &damaged, &none);
            assert!(
                read.is_ok()
                    || !read
                        .map(|_| ())
                        .expect_err("an error")
                        .to_string()
                        .contains('\n')
            );
            let _ = read_mesh("a.inp", &damaged, &none);
        }
    }
    assert!(read("a.inp", &block.as_bytes()[..block.len() - 10], &none).is_err());
}
