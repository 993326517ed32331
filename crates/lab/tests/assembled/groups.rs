//! Unit tests of `crates/lab/src/assembled/groups.rs`.

use super::super::rows::GapInequality;
use super::*;

fn rows(n: usize, list: &[(usize, usize, f64)]) -> Inequalities {
    let row = |&(plus, minus, gap): &(usize, usize, f64)| GapInequality { plus, minus, gap };
    Inequalities {
        unknowns: (0..n as u64).collect(),
        rows: list.iter().map(row).collect(),
        initial: vec![true; list.len()],
        ..Inequalities::default()
    }
}

fn groups(rows: &Inequalities, active: &mut [bool]) -> ActiveGroups {
    ActiveGroups::new(rows, active, &(0..rows.len()).collect::<Vec<_>>())
}

#[test]
fn groups_carry_offsets_and_hang_on_ground() {
    // u0 − u2 = 1, u2 − u1 = 0.5; u3 = 2; −u4 = 3 is off.
    let rows = rows(5, &[(0, 2, 1.0), (2, 1, 0.5), (3, 5, 2.0), (5, 4, 3.0)]);
    let mut active = [true, true, true, false];
    let g = groups(&rows, &mut active);
    assert_eq!(g.lead, [Some(0), Some(0), Some(0), None, Some(4)]);
    let u = g.spread(&[10.0, 0.0, 0.0, 0.0, 7.0]);
    assert_eq!(u, [10.0, 8.5, 9.0, 2.0, 7.0]);
    assert_eq!(rows.gaps(&u), [0.0, 0.0, 0.0, -10.0]);
    assert_eq!(
        g.fold(&[1.0, 2.0, 4.0, 8.0, 16.0]),
        [7.0, 0.0, 0.0, 0.0, 16.0]
    );
    let v = g.nearest(&u, &[1.0, 2.0, 3.0, 4.0, 5.0]);
    assert!((v[0] - 10.0).abs() < 1e-14 && v[4] == 7.0, "{v:?}");
    assert!(g.is_free(0) && !g.is_free(1) && !g.is_free(3));
}

#[test]
fn rows_that_follow_hold_and_rows_that_contradict_go() {
    let cycle = |last: f64| rows(3, &[(0, 1, 1.0), (1, 2, 1.0), (0, 2, last)]);
    let mut active = [true, true, false];
    assert_eq!(groups(&cycle(2.0), &mut active).holds, [true; 3]);
    let mut active = [true; 3];
    let g = groups(&cycle(3.0), &mut active);
    assert_eq!(active, [true, true, false]);
    assert_eq!(g.holds, [true, true, false]);
    let mut active = [true; 3];
    ActiveGroups::new(&cycle(3.0), &mut active, &[2, 1, 0]);
    assert_eq!(active, [false, true, true]);
}

#[test]
fn multipliers_are_the_shortest_that_carry_the_forces() {
    // A ring of four, fully redundant by one, and a node on ground beside it.
    let rows = rows(
        5,
        &[
            (0, 1, 0.0),
            (0, 2, 0.0),
            (1, 3, 0.0),
            (2, 3, 0.0),
            (5, 4, 0.0),
        ],
    );
    let force = [3.0, -1.0, 0.0, -2.0, -4.0];
    let lambda = multipliers(&rows, &[true; 5], &force, MultiplierSigns::Any);
    let mut carried = [0.0; 6];
    for (row, l) in rows.rows.iter().zip(&lambda) {
        carried[row.plus] += l;
        carried[row.minus] -= l;
    }
    for (c, f) in carried.iter().zip(&force) {
        assert!((c - f).abs() < 1e-14, "{carried:?}");
    }
    // The multipliers of smallest norm have no component along the ring.
    let along = lambda[0] + lambda[2] - lambda[1] - lambda[3];
    assert!(along.abs() < 1e-14, "{lambda:?}");
    assert_eq!(lambda[4], 4.0);
    let open = multipliers(
        &rows,
        &[true, false, false, false, false],
        &[1.0, -0.5, 0.0, 0.0, 0.0],
        MultiplierSigns::Any,
    );
    assert_eq!(open[1..], [0.0; 4]);
    assert!((open[0] - 0.75).abs() < 1e-15);
}

#[test]
fn multipliers_around_a_ring_push_where_they_can() {
    // The forces of λ = (0, 4, 0, 0) on the ring 0-1-3-2.
    let rows = rows(4, &[(0, 1, 0.0), (0, 2, 0.0), (1, 3, 0.0), (2, 3, 0.0)]);
    let force = [4.0, 0.0, -4.0, 0.0];
    let shortest = multipliers(&rows, &[true; 4], &force, MultiplierSigns::Any);
    assert!((shortest[0] - 1.0).abs() < 1e-14, "{shortest:?}");
    assert!((shortest[3] + 1.0).abs() < 1e-14, "{shortest:?}");
    let pushing = multipliers(&rows, &[true; 4], &force, MultiplierSigns::Pushing);
    for (l, exact) in pushing.iter().zip([0.0, 4.0, 0.0, 0.0]) {
        assert!((l - exact).abs() < 1e-12, "{pushing:?}");
    }
    // No λ ≥ 0 has these forces: the shortest are given.
    let pulled = force.map(|f| -f);
    let any = multipliers(&rows, &[true; 4], &pulled, MultiplierSigns::Any);
    assert_eq!(
        multipliers(&rows, &[true; 4], &pulled, MultiplierSigns::Pushing),
        any
    );
}
