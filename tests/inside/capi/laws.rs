//! Unit tests of `src/capi/laws.rs`.

use super::*;

fn law(given: GivenLaw) -> std::result::Result<ContactLaw, String> {
    let made = ContactLaw::new(&given, &|| "row 0".into());
    made.map_err(|e| e.to_string())
}

#[test]
fn numbers_that_say_nothing_make_hard_contact_without_friction() {
    let nothing = GivenLaw {
        friction: Some(0.0),
        limit: Some(INFINITY),
        tresca: Some(0.0),
        stiffness: Some(f64::INFINITY),
        stick_stiffness: Some(INFINITY),
    };
    for given in [nothing, GivenLaw::default()] {
        let law = law(given).expect("a law");
        assert_eq!(law, ContactLaw::default());
        assert!(!law.has_friction() && law.bound(2.0).is_none());
        assert_eq!((law.compliance(2.0), law.stick_compliance(2.0)), (0.0, 0.0));
    }
}

#[test]
fn areas_make_forces_of_stresses() {
    let coulomb = law(GivenLaw {
        friction: Some(0.3),
        limit: Some(4.0),
        stiffness: Some(5.0),
        stick_stiffness: Some(10.0),
        ..GivenLaw::default()
    });
    let coulomb = coulomb.expect("a law");
    let bound = coulomb.bound(0.5).expect("it has friction");
    assert_eq!((bound.at(2.0), bound.at(100.0)), (0.6, 2.0));
    assert_eq!(
        (coulomb.compliance(0.5), coulomb.stick_compliance(0.5)),
        (0.4, 0.2)
    );
    let tresca = law(GivenLaw {
        tresca: Some(3.0),
        ..GivenLaw::default()
    });
    let bound = tresca.expect("a law").bound(0.5).expect("it has friction");
    assert_eq!(bound.at(0.0), 1.5);
}

#[test]
fn an_equation_has_no_law() {
    let some = GivenLaw {
        stiffness: Some(1.0),
        ..GivenLaw::default()
    };
    let soft = law(some).expect("a law");
    let whose = || "row 0".to_string();
    assert!(soft.suits(Law::Unilateral, &whose).is_ok());
    assert!(ContactLaw::default().suits(Law::Tie, &whose).is_ok());
    let text = soft.suits(Law::Tie, &whose).expect_err("a tie").to_string();
    assert!(
        text.contains("row 0 has a contact stiffness and is an equation"),
        "{text}"
    );
}

#[test]
fn numbers_that_are_none_are_refused() {
    for (given, sentence) in [
        (
            GivenLaw {
                friction: Some(f64::NAN),
                ..GivenLaw::default()
            },
            "row 0 has a coefficient of friction of NaN, expected a number that is not negative",
        ),
        (
            GivenLaw {
                stick_stiffness: Some(f64::NAN),
                friction: Some(1.0),
                ..GivenLaw::default()
            },
            "row 0 has a stick stiffness of NaN, expected a positive number",
        ),
    ] {
        let text = law(given).expect_err("it is no law");
        assert!(text.contains(sentence), "{text}");
    }
}
