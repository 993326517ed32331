//! Sets and surfaces.

use super::{bad, deck, good, group, whole, CUBES, REST, STEP};
use mesh::Members;

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
