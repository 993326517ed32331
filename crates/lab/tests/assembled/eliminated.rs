//! Unit tests of `crates/lab/src/assembled/eliminated.rs`.

use super::*;

fn free(_: u64) -> f64 {
    1.0
}

/// All but one unknown may be given up.
fn but(kept: u64) -> impl Fn(u64) -> f64 {
    move |place| f64::from(place != kept)
}

/// The value of every unknown below `n`: dependent ones from the values `v` of the others.
fn spread(eliminated: &EliminatedUnknowns, v: &dyn Fn(u64) -> f64, n: u64) -> Vec<f64> {
    let value = |place: u64| match eliminated.get(place) {
        None => v(place),
        Some((terms, offset)) => {
            assert!(terms.keys().all(|p| eliminated.get(*p).is_none()));
            terms.iter().map(|(p, t)| t * v(*p)).sum::<f64>() + offset
        }
    };
    (0..n).map(value).collect()
}

#[test]
fn whatever_the_others_are_the_equations_hold() {
    // A chain that comes back to its beginning, a mean, two that share unknowns, and a sum of two of them.
    let equations = vec![
        (vec![(0, 1.0), (1, -1.0)], 0.0),
        (vec![(2, 1.0), (1, -1.0)], 0.5),
        (vec![(3, 1.0), (4, 1.0), (5, 1.0), (2, -3.0)], 0.0),
        (vec![(1, 0.3), (6, 0.1), (6, 0.2)], -2.0),
        (vec![(4, 1.0), (7, 5.0), (0, 2.0)], 1.0),
        (vec![(0, 1.0), (2, -1.0)], -0.5),
        (vec![(8, 1.0)], 4.0),
    ];
    let out = EliminatedUnknowns::new(equations.clone(), &free).expect("solved");
    assert_eq!(out.places().count(), 6, "the sixth follows from two others");
    for slope in [0.0, 1.7, -3.1] {
        let u = spread(&out, &|p| slope * p as f64 + 0.1 * slope * slope, 9);
        for (terms, rhs) in &equations {
            let sum: f64 = terms.iter().map(|&(p, b)| b * u[p as usize]).sum();
            assert!((sum - rhs).abs() < 1e-12, "{sum}, not {rhs}");
        }
        assert_eq!(u[8], 4.0);
    }
}

#[test]
fn what_is_kept_is_not_given_up() {
    let equations = vec![(vec![(0, 1.0), (1, 0.5)], 0.0)];
    let out = EliminatedUnknowns::new(equations.clone(), &but(0)).expect("solved");
    assert_eq!(out.places().collect::<Vec<_>>(), [1]);
    let out = EliminatedUnknowns::new(equations.clone(), &free).expect("solved");
    assert_eq!(out.places().collect::<Vec<_>>(), [0]);
    let rather = |p: u64| if p == 1 { 1.0 } else { 0.1 };
    let out = EliminatedUnknowns::new(equations.clone(), &rather).expect("solved");
    assert_eq!(out.places().collect::<Vec<_>>(), [1]);
    let kept = EliminatedUnknowns::new(equations, &|_| 0.0);
    assert_eq!(kept.err(), Some(Trouble::Kept(0)));
    // A coefficient beside which the others would become huge is none to divide by.
    let small = EliminatedUnknowns::new(vec![(vec![(0, 1.0), (1, 1e-3)], 0.0)], &but(0));
    assert_eq!(small.err(), Some(Trouble::Kept(0)));
}

#[test]
fn a_contradiction_is_one() {
    let twice = |rhs: f64| {
        let first = (vec![(3, 1.0), (7, -2.0)], 1.0);
        EliminatedUnknowns::new(vec![first, (vec![(7, 4.0), (3, -2.0)], rhs)], &free)
    };
    assert_eq!(twice(-2.0).map(|e| e.places().count()).ok(), Some(1));
    assert_eq!(twice(-2.1).err(), Some(Trouble::Contradicts(7)));
    // Without terms.
    let empty = |rhs: f64| EliminatedUnknowns::new(vec![(vec![(1, 0.0)], rhs)], &free);
    assert!(empty(0.0).is_ok_and(|e| e.is_empty()));
    assert_eq!(empty(1.0).err(), Some(Trouble::Contradicts(1)));
}
