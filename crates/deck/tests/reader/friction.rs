//! Laws of contact: *SURFACE BEHAVIOR, *FRICTION and *CHANGE FRICTION.

use super::{bad, deck, good};
use crate::{Friction, Overclosure};

const SURFACES: &str =
    "*SURFACE,NAME=L\n1,S4\n*SURFACE,NAME=R\n2,S6\n*SURFACE INTERACTION,NAME=I\n";
const PAIR: &str = "*CONTACT PAIR,INTERACTION=I,TYPE=SURFACE TO SURFACE,SMALL SLIDING\nR,L\n";

fn friction(coefficient: f64, stick_slope: Option<f64>, limit: Option<f64>) -> Option<Friction> {
    Some(Friction {
        coefficient,
        stick_slope,
        limit,
    })
}

#[test]
fn friction_and_softness_are_read() {
    let read = |law: &str| good(&format!("{SURFACES}{law}{PAIR}"), "");
    let deck = read("*FRICTION\n.2,1e4\n");
    assert_eq!(deck.steps[0].friction, [friction(0.2, Some(1e4), None)]);
    assert_eq!(deck.interactions[0].overclosure, Overclosure::Hard);
    assert!(deck.replaced.is_empty() && deck.ignored.is_empty());

    let deck = read("*FRICTION,TAUMAX=3.,LAGRANGE\n.2\n");
    assert_eq!(deck.steps[0].friction, [friction(0.2, None, Some(3.0))]);
    assert!(deck.replaced[0].reason.starts_with("without a stick slope"));
    assert_eq!(read("*FRICTION\n0.,1e4\n").steps[0].friction, [None]);

    // Young's modulus of the material is 1.
    let soft = |data: &str| {
        let deck = read(&format!(
            "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n{data}"
        ));
        assert!(deck.replaced.is_empty());
        deck.interactions[0].overclosure.clone()
    };
    assert_eq!(soft("1.e7,3.\n"), Overclosure::Linear { slope: 1e7 });
    assert_eq!(soft(""), Overclosure::Linear { slope: 50.0 });

    // With nodes CalculiX has a tension at gaps, too.
    let nodes = "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n1.e7,3.\n\
                 *CONTACT PAIR,INTERACTION=I,TYPE=NODE TO SURFACE,SMALL SLIDING\nR,L\n";
    let deck = good(&format!("{SURFACES}{nodes}"), "");
    assert!(deck.replaced[0].reason.contains("has no tension"));
}

/// The way to the end of a step counts where there is friction.
#[test]
fn increments_are_said_to_be_one() {
    let notes = |law: &str, times: &str| {
        let steps = format!("*END STEP\n*STEP\n*STATIC\n{times}\n");
        good(&format!("{SURFACES}{law}{PAIR}"), &steps).replaced
    };
    let law = "*FRICTION\n.2,1e4\n";
    let found = notes(law, ".1,1.");
    assert_eq!(found[0].keyword, "*STATIC");
    assert!(found[0].reason.ends_with("in one increment"));
    assert!(notes(law, "1.,1.").is_empty() && notes(law, "0.,1.").is_empty());
    assert!(notes("", ".1,1.").is_empty());
}

/// A *CHANGE FRICTION holds from its step on, for its interaction.
#[test]
fn friction_changes_between_steps() {
    let other = "*SURFACE INTERACTION,NAME=J\n*FRICTION\n.5,9.\n";
    let steps = "*STEP\n*STATIC\n*CHANGE FRICTION,INTERACTION=I\n*FRICTION\n.1,5.\n*END STEP\n\
                 *STEP\n*STATIC\n*END STEP\n*STEP\n*STATIC\n*CHANGE FRICTION,INTERACTION=J\n*FRICTION\n0\n";
    let model = format!("{SURFACES}*FRICTION\n.2,5.\n{other}{PAIR}");
    let deck = good(&model, &format!("*END STEP\n{steps}"));
    let known = friction(0.5, Some(9.0), None);
    let [before, after] = [0.2, 0.1].map(|c| friction(c, Some(5.0), None));
    let expected = [
        [before, known],
        [after, known],
        [after, known],
        [after, None],
    ];
    assert_eq!(deck.steps.len(), expected.len());
    for (step, expected) in deck.steps.iter().zip(expected) {
        assert_eq!(step.friction, expected);
    }
}

#[test]
fn wrong_laws_are_refused_in_a_sentence() {
    let law = |law: &str| bad(&format!("{SURFACES}{law}{PAIR}"), "");
    assert_eq!(
        law("*FRICTION\n-.2,1e4\n"),
        "*FRICTION: the coefficient of friction is -0.2; it must not be negative"
    );
    assert_eq!(
        law("*FRICTION\n.2,0.\n"),
        "*FRICTION: the stick slope is 0; it must be positive (without the number, surfaces that stick do not slip)"
    );
    assert_eq!(
        law("*FRICTION,TAUMAX=-1.\n.2,1.\n"),
        "*FRICTION: the largest shear stress TAUMAX is -1; it must be positive"
    );
    assert_eq!(
        law("*FRICTION\n"),
        "*FRICTION: one line with coefficient and stick slope is expected, but 0 follow"
    );
    assert_eq!(
        law("*FRICTION\n.2,1.\n.3,1.\n"),
        "*FRICTION: one line with coefficient and stick slope is expected, but 2 follow"
    );
    assert!(law("*FRICTION\nsmooth,1.\n").contains("a coefficient of friction is expected"));
    assert!(law("*FRICTION,ROUGH\n.2\n").starts_with("*FRICTION: ROUGH: what never slips"));
    assert_eq!(
        law("*FRICTION,DEPENDENCIES=1\n.2\n"),
        "*FRICTION: the parameter DEPENDENCIES is not supported"
    );
    assert_eq!(
        bad("*FRICTION\n.2,1.\n", ""),
        "*FRICTION: there is no *SURFACE INTERACTION or *GAP before it"
    );
    assert!(law("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n0.\n")
        .ends_with("its numbers must be positive"));

    let step = |cards: &str| bad(&format!("{SURFACES}*FRICTION\n.2,1.\n{PAIR}"), cards);
    assert_eq!(
        step("*FRICTION\n.1,1.\n"),
        "*FRICTION: in a step it must follow a *CHANGE FRICTION, which names the interaction"
    );
    assert_eq!(
        step("*CHANGE FRICTION\n*FRICTION\n.1,1.\n"),
        "*CHANGE FRICTION: the parameter INTERACTION= is missing"
    );
    assert_eq!(
        step("*CHANGE FRICTION,INTERACTION=X\n*FRICTION\n.1,1.\n"),
        "*CHANGE FRICTION: there is no surface interaction X"
    );
    assert_eq!(
        step("*CHANGE FRICTION,INTERACTION=I\n"),
        "*CHANGE FRICTION: no *FRICTION with the new numbers follows it"
    );
    assert_eq!(
        step("*CHANGE FRICTION,INTERACTION=I\n*CHANGE FRICTION,INTERACTION=I\n*FRICTION\n.1,1.\n"),
        "*CHANGE FRICTION: no *FRICTION with the new numbers follows it"
    );
    assert_eq!(
        step("*CHANGE FRICTION,INTERACTION=I\n*FRICTION\n-1.\n"),
        "*FRICTION: the coefficient of friction is -1; it must not be negative"
    );
    assert_eq!(
        step("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n1.\n"),
        "*SURFACE BEHAVIOR: it must stand before the first *STEP"
    );
    let early = format!("{SURFACES}*CHANGE FRICTION,INTERACTION=I\n*FRICTION\n.1,1.\n");
    assert_eq!(
        bad(&early, ""),
        "*CHANGE FRICTION: it must stand between *STEP and *END STEP"
    );
    // CalculiX takes the slope from the first material, which has none here.
    let none = "*MATERIAL,NAME=NONE\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n";
    let message = deck(&format!("{SURFACES}{none}{PAIR}"), "").expect_err("no slope");
    assert!(
        message.to_string().contains("its slope is missing"),
        "{message}"
    );
}
