//! Unit tests of `crates/lab/src/assembled/exerted.rs`.

use super::*;
use crate::assembled::rows::GapInequality;

/// Rows 0 and 1 between unknowns 0 and 1, 2 and 3; row 2 between unknown 4 and ground.
fn rows() -> Inequalities {
    let row = |(plus, minus, gap)| GapInequality { plus, minus, gap };
    Inequalities {
        unknowns: (0..5).collect(),
        rows: [(0, 1, 0.1), (3, 2, -0.2), (4, 5, 0.3)].map(row).to_vec(),
        ..Inequalities::default()
    }
}

fn exerted() -> ExertedForces {
    ExertedForces {
        springs: vec![
            RowSpring {
                rows: vec![(0, -0.6), (1, 0.8)],
                stiffness: 7.0,
                rest: 0.25,
            },
            RowSpring {
                rows: vec![(2, 1.0)],
                stiffness: 3.0,
                rest: 0.0,
            },
        ],
        given: vec![0.5, -1.0],
    }
}

/// The energy whose derivative the forces are, written out.
fn energy(w: &[f64]) -> f64 {
    let j = [w[0] - w[1] - 0.1, w[3] - w[2] + 0.2, w[4] - 0.3];
    let spring = -0.6 * j[0] + 0.8 * j[1] - 0.25;
    0.5 * j[0] - j[1] + 3.5 * spring * spring + 1.5 * j[2] * j[2]
}

const W: [f64; 5] = [0.3, -0.4, 0.9, 1.7, -0.6];

#[test]
fn forces_are_the_derivative_of_an_energy() {
    let forces = exerted().forces(&rows(), &W);
    for k in 0..5 {
        let at = |by: f64| {
            let mut w = W;
            w[k] += by;
            energy(&w)
        };
        // Exact for a quadratic function, but for rounding.
        let slope = (at(0.5) - at(-0.5)) / 1.0;
        assert!(
            (forces[k] - slope).abs() < 1e-12,
            "{k}: {} and {slope}",
            forces[k]
        );
    }
}

/// With row 0 as an equation, entries and forces at its offset belong to the same energy.
#[test]
fn entries_are_its_second_derivative_on_the_unknowns_of_a_set() {
    let (rows, exerted) = (rows(), exerted());
    let groups = ActiveGroups::new(&rows, &mut [true, false, false], &[0]);
    let entries = exerted.entries(&rows, &groups);
    let leads: Vec<usize> = (0..5).filter(|&k| groups.is_free(k)).collect();
    assert_eq!(leads, [0, 2, 3, 4]);
    let spread = |list: &[f64; 4]| {
        let mut v = [0.0; 5];
        leads.iter().zip(list).for_each(|(&k, x)| v[k] = *x);
        groups.spread(&v)
    };
    for k in 0..4 {
        for l in 0..4 {
            let at = |a: f64, b: f64| {
                let mut v = [0.0; 4];
                v[k] += a;
                v[l] += b;
                energy(&spread(&v))
            };
            let bend = at(0.5, 0.5) - at(0.5, -0.5) - at(-0.5, 0.5) + at(-0.5, -0.5);
            let of = |e: &&(usize, usize, f64)| (e.0, e.1) == (leads[k], leads[l]);
            let sum: f64 = entries.iter().filter(of).map(|e| e.2).sum();
            assert!((sum - bend).abs() < 1e-12, "{k}, {l}: {sum} and {bend}");
        }
    }
}

#[test]
fn springs_are_alike_within_a_factor() {
    let built = exerted();
    let with = |change: &dyn Fn(&mut RowSpring)| {
        let mut out = exerted();
        change(&mut out.springs[0]);
        out
    };
    let stiffer = with(&|s| s.stiffness *= 1.5);
    assert_eq!(
        (
            stiffer.rows_changed(&built, 2.0),
            stiffer.rows_changed(&built, 1.2)
        ),
        (0, 1)
    );
    let softer = with(&|s| s.stiffness /= 3.0);
    assert_eq!(softer.rows_changed(&built, 2.0), 1);
    let turned = with(&|s| s.rows = vec![(0, -0.7), (1, 0.71)]);
    assert_eq!(turned.rows_changed(&built, 2.0), 0);
    let far = with(&|s| s.rows = vec![(0, 0.6), (1, 0.8)]);
    assert_eq!(far.rows_changed(&built, 2.0), 1);
    let moved = with(&|s| s.rest = 9.0);
    assert!(
        moved.is_as_stiff(&built) && !stiffer.is_as_stiff(&built) && !turned.is_as_stiff(&built)
    );
    assert_eq!(ExertedForces::default().rows_changed(&built, 2.0), 2);
}
