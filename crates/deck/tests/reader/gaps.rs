//! Gap elements: *ELEMENT of TYPE=GAPUNI and *GAP.

use super::{bad, deck, good, CUBES};
use crate::{read, Friction, Gap, Overclosure};
use base::Error;

const ELEMENTS: &str = "*ELEMENT,TYPE=GAPUNI,ELSET=G\n7,2,11\n8,3,14\n";

#[test]
fn gap_elements_are_read_beside_cells() {
    let deck = good(
        &format!("{ELEMENTS}*GAP,ELSET=G\n.1,1.,0.,0.,2.\n*FRICTION\n.2,5.\n"),
        "*END STEP\n*STEP\n*STATIC\n*CHANGE FRICTION,ELSET=G\n*FRICTION\n.1,5.\n",
    );
    assert_eq!((deck.mesh.cells.len(), deck.elements.len()), (2, 2));
    let [gap] = &deck.gaps[..] else {
        panic!("one *GAP")
    };
    assert_eq!((gap.clearance, gap.area), (0.1, 2.0));
    assert_eq!(gap.direction, Some([1.0, 0.0, 0.0]));
    let ids: Vec<(u64, [u32; 2])> = gap.elements.iter().map(|e| (e.id, e.nodes)).collect();
    assert_eq!(ids, [(7, [1, 8]), (8, [2, 11])]);
    let known = |coefficient| {
        vec![Some(Friction {
            coefficient,
            stick_slope: Some(5.0),
            limit: None,
        })]
    };
    assert_eq!(deck.steps[0].friction, known(0.2));
    assert_eq!(deck.steps[1].friction, known(0.1));
    // The set has no cells, so it is no group of the mesh.
    assert!(deck.mesh.groups.iter().all(|g| g.name != "G"));
}

/// A set may have cells beside gap elements: sections and loads are of its cells. Of two *GAP the later one counts.
#[test]
fn gap_elements_stand_in_sets() {
    let more = "*SOLID SECTION,ELSET=G,MATERIAL=M\n*ELSET,ELSET=ALL\nE,G\n*GAP,ELSET=G\n0.,1.\n\
                *ELSET,ELSET=ONE\n8\n*GAP,ELSET=ONE\n.5,1.\n";
    let deck = good(&format!("{ELEMENTS}{more}"), "*DLOAD\nALL,P1,1.\n");
    assert_eq!(deck.steps[0].pressures.len(), 2);
    let of = |g: &Gap| (g.clearance, g.elements.iter().map(|e| e.id).collect());
    let all: Vec<(f64, Vec<u64>)> = deck.gaps.iter().map(of).collect();
    assert_eq!(all, [(0.0, vec![7]), (0.5, vec![8])]);
}

#[test]
fn laws_of_gaps_are_springs_or_slopes() {
    let law = |data: &str| {
        let deck = good(&format!("{ELEMENTS}*GAP,ELSET=G\n{data}"), "");
        (
            deck.interactions[0].overclosure.clone(),
            deck.replaced.len(),
        )
    };
    assert_eq!(law("0.,1.\n"), (Overclosure::Hard, 0));
    let soft = |slope| Overclosure::Linear { slope };
    assert_eq!(law("0.,1.,,,,8.\n"), (soft(8.0), 0));
    assert_eq!(law("0.,1.,,,2.,8.,1e-3\n"), (soft(4.0), 1));
    let along = "*ELEMENT,TYPE=GAPUNI,ELSET=G\n7,1,11\n*GAP,ELSET=G\n0.\n";
    let deck = good(along, "");
    assert_eq!((deck.gaps[0].direction, deck.replaced.len()), (None, 1));
    let slope = "0.,1.\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n3.\n";
    assert_eq!(law(slope), (soft(3.0), 0));
}

/// Each instance of a part has its gap elements, with their law.
#[test]
fn instances_have_gaps_of_their_own() {
    let text = format!(
        "*PART,NAME=P\n{CUBES}{ELEMENTS}*SOLID SECTION,ELSET=E,MATERIAL=M\n*GAP,ELSET=G\n0.,1.\n*FRICTION\n.2,5.\n\
         *END PART\n*ASSEMBLY,NAME=A\n*INSTANCE,NAME=I,PART=P\n*END INSTANCE\n*INSTANCE,NAME=J,PART=P\n0.,5.\n\
         *END INSTANCE\n*END ASSEMBLY\n*MATERIAL,NAME=M\n*ELASTIC\n1.,.3\n*STEP\n*STATIC\n*END STEP\n"
    );
    let read = read("a.inp", text.as_bytes(), &|_| Err(Error::input("no files")));
    let deck = read.expect("a deck");
    let names: Vec<&str> = deck.gaps.iter().map(|g| g.elset.as_str()).collect();
    assert_eq!(names, ["I.G", "J.G"]);
    assert!(deck.gaps.iter().all(|g| g.elements.len() == 2));
    assert!(deck.steps[0].friction.iter().all(|f| f.is_some()));
    assert_eq!(deck.steps[0].friction.len(), 2);
}

#[test]
fn wrong_gaps_are_refused_in_a_sentence() {
    let gap = |data: &str| bad(&format!("{ELEMENTS}*GAP,ELSET=G\n{data}"), "");
    assert_eq!(
        gap(""),
        "*GAP: one line with clearance and direction is expected, but 0 follow"
    );
    assert_eq!(
        gap("0.,1.,1.\n"),
        "*GAP: the direction has length 1.4142135623730951; it must be 1"
    );
    assert_eq!(
        gap("0.,1.,,,0.\n"),
        "*GAP: an area is 0; it must be positive"
    );
    assert_eq!(
        gap("0.,1.,,,,-1.\n"),
        "*GAP: a spring constant is -1; it must be positive"
    );
    assert_eq!(
        gap("0.,1.,,,,1.\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n3.\n"),
        "*SURFACE BEHAVIOR: the *GAP before it gives a spring constant already"
    );
    assert_eq!(
        gap("0.,1.\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TIED\n3.\n"),
        "*SURFACE BEHAVIOR: gap elements are HARD or LINEAR"
    );
    let model = |text: &str| bad(text, "");
    assert_eq!(model(ELEMENTS), "gap element 7 belongs to no *GAP");
    assert_eq!(
        model("*GAP,ELSET=E\n0.,1.\n"),
        "*GAP: element 1 of E is no gap element (GAPUNI)"
    );
    assert_eq!(
        model("*GAP,ELSET=X\n0.,1.\n"),
        "*GAP: there is no element set X"
    );
    assert_eq!(
        model("*ELEMENT,TYPE=GAPUNI,ELSET=G\n7,2,2\n*GAP,ELSET=G\n0.,1.\n"),
        "gap element 7 has the same node twice"
    );
    assert_eq!(
        model("*ELEMENT,TYPE=GAPUNI,ELSET=G\n7,2,11\n*GAP,ELSET=G\n0.\n"),
        "gap element 7 has no direction: its nodes coincide, and its *GAP gives none"
    );
    assert_eq!(
        bad(
            &format!("{ELEMENTS}*GAP,ELSET=G\n0.,1.\n"),
            "*DLOAD\nG,P1,1.\n"
        ),
        "gap elements have neither sides nor loads"
    );
    assert_eq!(
        bad("", "*CHANGE FRICTION,ELSET=G\n*FRICTION\n.1\n"),
        "*CHANGE FRICTION: there is no *GAP of G"
    );
    assert!(deck("*ELEMENT,TYPE=GAPCYL,ELSET=G\n7,2,11\n", "")
        .expect_err("another kind of gap")
        .to_string()
        .contains("elements of type GAPCYL (gaps) are not supported"));
}
