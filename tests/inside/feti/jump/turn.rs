//! Unit tests of `src/feti/jump/turn.rs`.

use super::*;

#[test]
fn a_turn_keeps_lengths_and_leads_back() {
    let turn = Turn {
        rows: [3, 4],
        by: [0.6, 0.8],
    };
    let back = Turn {
        by: [0.6, -0.8],
        ..turn
    };
    let turned = turn.of([0.6, 0.8]);
    assert!((turned[0] - 1.0).abs() < 1e-15 && turned[1].abs() < 1e-15);
    let none = back.after(turn.by);
    assert!((none[0] - 1.0).abs() < 1e-15 && none[1].abs() < 1e-15);
    let again = back.of(turn.of([-2.0, 5.0]));
    assert!((again[0] + 2.0).abs() < 1e-14 && (again[1] - 5.0).abs() < 1e-14);
}
