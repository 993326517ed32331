//! Contact, ties and equations.

use super::{bad, good};
use crate::{Adjust, ContactKind, Overclosure};
use mesh::Members;

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
    // Its nodes may slide from face to face in CalculiX.
    assert_eq!(deck.replaced.len(), 1);

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

    let refused = |more: &str| bad(&format!("{surfaces}{more}"), "");
    let tied = "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TIED\n1.e7\n";
    let deck = good(&format!("{surfaces}{tied}*FRICTION\n.2,1e4\n{pair}"), "");
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
    assert_eq!(
        refused("*TIE,ADJUST=MAYBE\nR,L\n"),
        "*TIE: ADJUST=MAYBE is neither YES nor NO"
    );
    let by_nodes = "*CONTACT PAIR,INTERACTION=I,TYPE=NODE TO SURFACE\nR,L\n";
    let deck = good(&format!("{surfaces}{by_nodes}{gap}"), "");
    assert_eq!(deck.contacts[0].clearance, None);
    assert!(deck.ignored[0]
        .reason
        .contains("in CalculiX it has no effect"));
    let only_nodes = "*SURFACE,NAME=P,TYPE=NODE\n1\n*TIE\nL,P\n";
    assert!(refused(only_nodes).starts_with("the surface P consists of nodes"));
    assert!(refused(gap).ends_with("there is no contact pair of slave R and master L"));
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
