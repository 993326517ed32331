//! Unit tests of `src/substructures/rows.rs`.

use super::*;

#[test]
fn rows_travel_unchanged() {
    let members = [Some(BodyNode { body: 3, node: 70 }), None];
    let label = RowLabel {
        point: [0.5, -1.0, 2.0],
        t: [0.25, 1.0],
        normal: [0.0, 0.6, -0.8],
        area: 0.125,
        ..RowLabel::new(RowSource::Obstacle(7), members)
    };
    let given = Row {
        terms: vec![(9, 1.0)],
        gap: 0.0,
        law: Law::Unilateral,
        holds: true,
        block: 9,
        compliance: 0.0,
        rounding: 0.0,
        label,
    };
    for (law, holds, state) in [
        (Law::Unilateral, true, RowState::Holds),
        (Law::Unilateral, false, RowState::Open),
        (Law::Tie, true, RowState::Tied),
        (Law::Tie, false, RowState::Open),
        (Law::Friction, true, RowState::Sticks),
        (Law::Friction, false, RowState::Slips),
    ] {
        let given = Row {
            law,
            ..given.clone()
        };
        let row = SolvedRow::new(&given, 2.0, -0.75, holds);
        assert_eq!(SentRow::new(&row).row(), row);
        assert_eq!((row.state, row.holds()), (state, holds));
        assert_eq!((row.gap, row.pressure()), (0.75, Some(16.0)));
        assert_eq!((row.body(), row.node()), (Some(3), Some(70)));
    }
}
