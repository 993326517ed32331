//! Nodes, elements, systems of coordinates, materials and sections.

use super::{bad, good, whole, CUBES, REST, STEP};
use crate::{read, BodyLoadKind, ElementType};
use elements::law::{Law, Tangent};

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
    assert!(with("*ELASTIC,TYPE=SHORT FIBER\n1.,2.\n").contains("line 22: *ELASTIC: TYPE="));
    assert!(with("*ELASTIC\n1.,.3\n*PLASTIC\n1.,0.\n").ends_with(
        "line 24: *PLASTIC: only linear elasticity is supported \
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

/// Laws that are not isotropic: eight constants in a line, a temperature behind the last.
#[test]
fn laws_of_many_constants_and_their_axes() {
    let read = |material: &str, section: &str| {
        let text = format!(
            "{CUBES}*MATERIAL,NAME=M\n{material}*SOLID SECTION,ELSET=E,MATERIAL=M{section}\n{STEP}"
        );
        read("a.inp", text.as_bytes(), &|_| unreachable!())
    };
    let elastic = |material: &str| match read(material, "").expect("a deck").materials[0].elastic {
        Some(Law::General(tangent)) => tangent.0,
        other => panic!("{other:?}"),
    };
    let ortho = elastic("*ELASTIC,TYPE=ORTHO\n10.,3.,11.,4.,5.,12.,6.,7.\n8.,20.\n");
    assert_eq!([ortho[0][0], ortho[0][1], ortho[1][1]], [10.0, 3.0, 11.0]);
    assert_eq!([ortho[0][2], ortho[1][2], ortho[2][2]], [4.0, 5.0, 12.0]);
    // 12, 13, 23 are our xy, xz, yz.
    assert_eq!([ortho[3][3], ortho[5][5], ortho[4][4]], [6.0, 7.0, 8.0]);
    let constants =
        elastic("*ELASTIC,TYPE=ENGINEERING CONSTANTS\n2.,2.,2.,.25,.25,.25,.8,.8\n.8\n");
    for (a, b) in constants
        .iter()
        .flatten()
        .zip(Tangent::isotropic(2.0, 0.25).0.iter().flatten())
    {
        assert!((a - b).abs() < 1e-14);
    }
    let aniso = elastic(
        "*ELASTIC,TYPE=ANISO\n10.,3.,11.,4.,5.,12.,0.,0.\n0.,6.,0.,0.,0.,.5,7.,0.\n0.,0.,0.,0.,8.,20.\n",
    );
    assert_eq!(
        [aniso[3][3], aniso[3][5], aniso[5][5], aniso[4][4]],
        [6.0, 0.5, 7.0, 8.0]
    );
    let said =
        |material: &str, section: &str| read(material, section).expect_err("refused").to_string();
    assert!(
        said("*ELASTIC,TYPE=ORTHO\n1.,2.\n", "").contains("a constant of the material is expected")
    );
    assert!(
        said("*ELASTIC,TYPE=ORTHO\n1.,2.,1.,2.,2.,1.,1.,1.\n1.\n", "")
            .contains("no positive energy")
    );
    assert!(said("*ELASTIC,TYPE=ORTHO\n9.,2.,9.,2.,2.,9.,1.,1.\n", "")
        .ends_with("9 constants were expected, eight in a line"));

    let axes = "*ORIENTATION,NAME=O,SYSTEM=CYLINDRICAL\n1.,0.,0.,1.,0.,5.\n3,30.\n";
    let steel = "*ELASTIC\n1.,.3\n";
    let deck = read(&format!("{steel}{axes}"), ",ORIENTATION=O");
    let deck = deck.expect("a deck");
    let found = &deck.orientations[deck.sections[0].orientation.expect("one") as usize];
    assert!(found.axes.cylindrical && found.turn == Some((2, 30.0)));
    assert!(said(steel, ",ORIENTATION=O").ends_with("there is no orientation O"));
    let wrong = "*ORIENTATION,NAME=O\n1.,0.,0.,0.,1.,0.\n4,30.\n";
    assert!(said(&format!("{steel}{wrong}"), "").ends_with("the axis is 4; it must be 1, 2 or 3"));
}

/// Temperatures hold until they are replaced or removed.
#[test]
fn temperatures_over_steps() {
    let step = |more: &str| format!("*STEP\n*STATIC\n{more}*END STEP\n");
    let text = format!(
        "{CUBES}*MATERIAL,NAME=M\n*ELASTIC\n1.,.3\n*EXPANSION,ZERO=20.\n1.E-5\n*SOLID SECTION,ELSET=E,MATERIAL=M\n\
         *AMPLITUDE,NAME=A\n0.,0.,1.,.5\n*INITIAL CONDITIONS,TYPE=TEMPERATURE\nN,20.\n1,30.\n{}{}{}{}",
        step("*TEMPERATURE\nN,100.\n"),
        step("*TEMPERATURE,AMPLITUDE=A\n2,60.\n"),
        step("*TEMPERATURE,OP=NEW\n3,7.\n"),
        step("")
    );
    let deck = read("a.inp", text.as_bytes(), &|_| unreachable!()).expect("a deck");
    assert_eq!(deck.materials[0].expansion, Some([1e-5; 3]));
    assert_eq!(deck.initial_temperatures[..2], [(0, 30.0), (1, 20.0)]);
    let all = deck.initial_temperatures.len();
    let of = |k: usize| &deck.steps[k].temperatures;
    assert_eq!((of(0).len(), of(0)[1]), (all, (1, 100.0)));
    assert_eq!((of(1)[0], of(1)[1]), ((0, 100.0), (1, 30.0)));
    assert_eq!((of(2), of(3)), (&vec![(2, 7.0)], &vec![(2, 7.0)]));
    assert!(bad("", "*TEMPERATURE,FILE=old\nN,1.\n").contains("results of other computations"));
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
