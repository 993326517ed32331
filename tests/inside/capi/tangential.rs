//! Unit tests of `src/capi/tangential.rs`.

use super::super::laws::GivenLaw;
use super::*;

fn whose() -> String {
    "row 0".into()
}

/// Nodes 1 and 4 with weights 2 and -2 along (0.6, 0, -0.8).
#[test]
fn tangents_have_the_nodes_and_weights_of_the_normal_row() {
    let normal = [(3, 1.2), (5, -1.6), (12, -1.2), (14, 1.6)];
    let found = beside(&normal, 3, &whose).expect("a normal");
    assert_eq!(found.len(), 2);
    for tangent in found {
        let t = tangent.direction;
        assert!(dot(t, [0.6, 0.0, -0.8]).abs() < 1e-15 && (dot(t, t) - 1.0).abs() < 1e-15);
        for (dof, value) in tangent.terms {
            let weight = if dof < 9 { 2.0 } else { -2.0 };
            assert!((value - weight * t[dof as usize % 3]).abs() < 1e-15);
        }
    }
    let error = |terms: &[(u32, f64)], n| {
        let found = beside(terms, n, &whose);
        found.map(|_| ()).expect_err("no normal").to_string()
    };
    let text = error(&[(0, 1.0), (3, -1.0)], 2);
    assert!(
        text.contains("coefficients of different directions"),
        "{text}"
    );
    let text = error(&[(0, 1.0)], 1);
    assert!(
        text.contains("friction at nodes of 1 unknowns, expected 2 or 3"),
        "{text}"
    );
}

/// Two rows, of which the second has friction: what comes back is a vector, without the elastic slip.
#[test]
fn results_are_vectors_at_the_normal_row() {
    let law = ContactLaw::new(
        &GivenLaw {
            friction: Some(0.5),
            stick_stiffness: Some(4.0),
            ..GivenLaw::default()
        },
        &whose,
    );
    let row = |dof: u32| GivenRow {
        terms: vec![(dof, 1.0)],
        gap: 0.0,
        law: Law::Unilateral,
        compliance: 0.0,
    };
    let node = NodeFriction {
        normal: 1,
        tangents: beside(&[(3, 1.0)], 2, &whose).expect("a normal"),
        slipped: [7.0, 9.0, 0.0],
        law: law.expect("a law"),
        area: 1.0,
    };
    let (rows, made) = appended(vec![row(1), row(3)], vec![node]);
    assert_eq!((rows.rows.len(), made.len()), (3, 1));
    // The direction along the plane is -x.
    assert_eq!((rows.rows[2].gap, rows.rows[2].compliance), (-7.0, 0.25));
    assert_eq!(rows.friction[0].tangential, [2]);
    let new = gaps(&made, |normal| [normal as f64 + 1.0, 0.0, 0.0]);
    assert_eq!(new.collect::<Vec<_>>(), [-2.0]);
    let mut given = GivenResults {
        multipliers: vec![0.0, 2.0, 1.0],
        gaps: vec![0.1, 0.0, -0.75],
        holds: vec![false, true, false],
    };
    let [open, at] = results(&made, &given).try_into().expect("two");
    assert_eq!((open.state, open.force), (OPEN, [0.0; 3]));
    assert_eq!(
        (at.state, at.force, at.slip),
        (SLIPS, [-1.0, 0.0, 0.0], [-0.5, 0.0, 0.0])
    );
    given.holds[2] = true;
    assert_eq!(results(&made, &given)[1].state, STICKS);
    (given.holds[2], given.multipliers[2]) = (false, 0.0);
    assert_eq!(results(&made, &given)[1].state, HOLDS);
}
