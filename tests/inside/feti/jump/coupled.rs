//! Unit tests of `src/feti/jump/coupled/mod.rs`: against the dense blocks of `src/feti/jump/scaling.rs`.

use super::*;
use crate::feti::jump::scaling;
use crate::matrices::random;

type Rows = Vec<Vec<(u32, f64)>>;

/// Rows between n nodes of one side, each with its own node, and m nodes of the other side, four of them near it; the
/// weights of the two sides. Dofs of the first side come first.
fn between_sides(n: usize, m: usize, weights: [f64; 2]) -> (Rows, Vec<f64>) {
    let noise = random(4 * n, 7);
    let row = |p: usize| {
        let first = p * (m - 4) / n;
        let other = (0..4).map(|k| ((n + first + k) as u32, -0.25 - 0.2 * noise[4 * p + k]));
        std::iter::once((p as u32, 1.0)).chain(other).collect()
    };
    let rows = (0..n).map(row).collect();
    let noise = random(n + m, 3);
    let weight = |j: usize| weights[usize::from(j >= n)] * (1.5 + noise[j]);
    (rows, (0..n + m).map(weight).collect())
}

fn dense(rows: &Rows, n_dofs: usize) -> Dense {
    let mut b = Dense::zeros(rows.len(), n_dofs);
    for (r, row) in rows.iter().enumerate() {
        row.iter()
            .for_each(|&(j, v)| b.set(r, j as usize, b.get(r, j as usize) + v));
    }
    b
}

fn product(b: &Dense, v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; b.rows];
    b.add_mul(v, &mut out);
    out
}

fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0f64, |a, v| a.max(v.abs()))
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let wrong: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    size(&wrong) / size(b)
}

/// λ that is zero on rows that do not hold.
fn multipliers(active: &[bool]) -> Vec<f64> {
    let all = random(active.len(), 11);
    let on = |(l, on): (f64, &bool)| if *on { l } else { 0.0 };
    all.into_iter().zip(active).map(on).collect()
}

/// aᵀ b.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// B_Dᵀ λ and B_D y of a coupled block are those of a dense one.
fn compare(rows: &Rows, weights: &[f64], active: &[bool], away: f64) {
    let mut coupled = Coupled::new(rows, weights);
    // B_D may come after that of another set.
    coupled.hold(&vec![true; rows.len()]);
    coupled.hold(active);
    let bd = scaling::block(&dense(rows, weights.len()), weights, active);
    let lambda = multipliers(active);
    let mut v = vec![0.0; weights.len()];
    coupled.lift(&lambda, &mut v);
    let mut expected = vec![0.0; weights.len()];
    bd.add_mul_transpose(&lambda, &mut expected);
    let found = distance(&v, &expected);
    assert!(found < away, "{} rows: {found:.1e}", rows.len());
    let y = random(weights.len(), 5);
    let mut out = vec![f64::NAN; rows.len()];
    coupled.collect(&y, &mut out);
    let found = distance(&out, &product(&bd, &y));
    assert!(found < away, "{} rows: {found:.1e}", rows.len());
    let mut off = out.iter().zip(active).filter(|r| !r.1);
    assert!(off.all(|r| *r.0 == 0.0));
}

#[test]
fn sparse_and_dense_blocks_scale_alike() {
    for (n, m) in [(60, 40), (40, 60)] {
        // Six of the digits are lost in the dense block where rows do not hold, and in values on the soft side that no
        // row feels.
        for (weights, away) in [
            ([1.0, 1.0], 1e-12),
            ([1e3, 1.0], 1e-12),
            ([1.0, 1e6], 1e-9),
            ([1e6, 1.0], 1e-9),
        ] {
            let (rows, weights) = between_sides(n, m, weights);
            for kind in 0..3 {
                let active: Vec<bool> = (0..n).map(|r| kind == 0 || (r * kind) % 3 != 0).collect();
                compare(&rows, &weights, &active, away);
            }
        }
    }
}

/// Rows that use nodes of the first side again, so that these and others have no dof of their own; every third of the
/// dofs that they have and the first side has not is heavy.
fn with_cross_points(weights: [f64; 2]) -> (Rows, Vec<f64>) {
    let (mut rows, mut d) = between_sides(60, 40, weights);
    let n = d.len() as u32;
    for (k, p) in [0, 1, 17, 30, 31, 32, 59].into_iter().enumerate() {
        rows.push(vec![
            (p, 0.75),
            (n + k as u32 % 3, -0.5),
            (61 + p / 2, -0.3),
        ]);
    }
    d.extend([weights[0], weights[1], weights[0]]);
    (rows, d)
}

/// The distances of B B_Dᵀ λ from λ and of (B_Dᵀ λ)ᵀ y from λᵀ B_D y.
fn defects(rows: &Rows, weights: &[f64]) -> [f64; 2] {
    let b = dense(rows, weights.len());
    let mut coupled = Coupled::new(rows, weights);
    let active = vec![true; rows.len()];
    coupled.hold(&active);
    assert!(coupled.by_dofs.is_some() == coupled.steep);
    let lambda = multipliers(&active);
    let mut v = vec![0.0; weights.len()];
    coupled.lift(&lambda, &mut v);
    let y = random(weights.len(), 5);
    let mut out = vec![0.0; rows.len()];
    coupled.collect(&y, &mut out);
    let terms: f64 = v.iter().zip(&y).map(|(v, y)| (v * y).abs()).sum();
    let away = (dot(&v, &y) - dot(&lambda, &out)).abs() / terms;
    [distance(&product(&b, &v), &lambda), away]
}

#[test]
fn extreme_weights_cost_no_digits() {
    for jump in [1e-18, 1e-12, 1e-6, 1.0, 1e6, 1e12, 1e18] {
        let each = [
            between_sides(60, 40, [jump, 1.0]),
            between_sides(40, 60, [jump, 1.0]),
            with_cross_points([jump, 1.0]),
        ];
        for (k, (rows, weights)) in each.iter().enumerate() {
            let [right, symmetric] = defects(rows, weights);
            assert!(right < 1e-12, "{jump:e}, {k}: {right:.1e}");
            assert!(symmetric < 1e-6, "{jump:e}, {k}: {symmetric:.1e}");
        }
    }
}

#[test]
fn rows_without_own_dofs_scale_as_in_dense_blocks() {
    for (jump, away) in [(1.0, 1e-12), (1e6, 1e-8), (1e-6, 1e-8)] {
        let (rows, weights) = with_cross_points([jump, 1.0]);
        let active: Vec<bool> = (0..rows.len()).map(|r| r % 11 != 4).collect();
        compare(&rows, &weights, &active, away);
    }
}

/// The rows of [`between_sides`], and combinations of some of them; (dependent ones, all).
fn with_combinations() -> (Vec<usize>, Rows, Vec<f64>) {
    let (mut rows, weights) = between_sides(60, 40, [1.0, 10.0]);
    let sum = |list: &[(usize, f64)]| -> Vec<(u32, f64)> {
        let of = |&(r, a): &(usize, f64)| {
            let row: &Vec<(u32, f64)> = &rows[r];
            row.iter().map(|&(j, v)| (j, a * v)).collect::<Vec<_>>()
        };
        list.iter().flat_map(of).collect()
    };
    let more = [
        sum(&[(3, 1.0)]),
        sum(&[(20, 2.0), (21, -1.0)]),
        sum(&[(40, 1.0), (41, 1.0), (42, 0.5)]),
    ];
    rows.extend(more);
    (vec![3, 20, 21, 40, 41, 42, 60, 61, 62], rows, weights)
}

#[test]
fn rows_that_follow_from_others_are_found_and_do_no_harm() {
    let (members, rows, weights) = with_combinations();
    let b = dense(&rows, weights.len());
    let mut coupled = Coupled::new(&rows, &weights);
    let all = vec![true; rows.len()];
    assert_eq!(coupled.dependent(&all), members);
    let mut fewer = all.clone();
    fewer[3] = false;
    fewer[41] = false;
    assert_eq!(coupled.dependent(&fewer), [20, 21, 61]);
    fewer[61] = false;
    assert!(coupled.dependent(&fewer).is_empty());
    compare(&rows, &weights, &all, 1e-11);
    compare(&rows, &weights, &fewer, 1e-11);
    // B B_Dᵀ B = B
    coupled.hold(&all);
    let jump = product(&b, &random(weights.len(), 9));
    let mut v = vec![0.0; weights.len()];
    coupled.lift(&jump, &mut v);
    assert!(distance(&product(&b, &v), &jump) < 1e-12);
    let part = coupled.part(&members);
    assert_eq!(part.rows, members.len());
    let ranks = [part, b].map(|b| {
        let b = faer::Mat::from_fn(b.rows, b.cols, |i, j| b.get(i, j));
        scaling::range(&b).ncols()
    });
    assert_eq!(ranks, [6, 60]);
}

/// Every row twice, with right-hand sides that differ: both get the mean, however many there are.
#[test]
fn right_hand_sides_of_many_rows_are_reconciled() {
    let (mut rows, weights) = between_sides(150, 100, [1.0, 10.0]);
    let n = rows.len();
    rows.extend_from_within(..);
    let mut active = vec![true; 2 * n];
    active[7] = false;
    let mut coupled = Coupled::new(&rows, &weights);
    coupled.hold(&active);
    let c = random(2 * n, 4);
    let mut near = c.clone();
    assert!(coupled.reconcile(&active, &mut near));
    for r in 0..n {
        let mean = (c[r] + c[n + r]) / 2.0;
        let wanted = if r == 7 { [c[r], c[n + r]] } else { [mean; 2] };
        assert!(distance(&[near[r], near[n + r]], &wanted) < 1e-12, "{r}");
    }
    // The same for other rows than those that hold.
    active[7] = true;
    let mut other = c.clone();
    assert!(coupled.reconcile(&active, &mut other));
    assert!((other[7] - (c[7] + c[n + 7]) / 2.0).abs() < 1e-12);
    active[..n].fill(false);
    assert!(!coupled.reconcile(&active, &mut other));
    // As a whole they are too many to look into; every pair by itself is not.
    let all = vec![true; 2 * n];
    assert!(coupled.dependent(&all).is_empty());
    let sets = coupled.dependent_sets(&all);
    assert_eq!(sets.len(), n);
    assert!(sets
        .iter()
        .all(|rows| rows.len() == 2 && rows[1] == rows[0] + n));
}

#[test]
fn a_row_without_a_dof_of_its_own_may_be_independent() {
    // Differences along a chain: the last row closes it and has no dof of its own, but a coefficient of its own.
    let n = 50;
    let mut rows: Rows = (0..n - 1)
        .map(|p| vec![(p as u32, 1.0), (p as u32 + 1, -1.0)])
        .collect();
    rows.push(vec![(0, 1.0), (n as u32 - 1, -1.1)]);
    let mut coupled = Coupled::new(&rows, &vec![1.0; n]);
    assert!(coupled.dependent(&vec![true; n]).is_empty());
    coupled.hold(&vec![true; n]);
    let lambda = random(n, 1);
    let mut v = vec![0.0; n];
    coupled.lift(&lambda, &mut v);
    assert!(distance(&product(&dense(&rows, n), &v), &lambda) < 1e-8);
    rows[n - 1][1].1 = -1.0;
    let coupled = Coupled::new(&rows, &vec![1.0; n]);
    assert_eq!(coupled.dependent(&vec![true; n]).len(), n);
}

#[test]
fn the_diagonal_is_that_of_dense_products() {
    let (rows, weights) = between_sides(12, 10, [1.0, 100.0]);
    let mut coupled = Coupled::new(&rows, &weights);
    let active: Vec<bool> = (0..12).map(|r| r != 5).collect();
    coupled.hold(&active);
    let x = random(weights.len(), 2)
        .iter()
        .map(|x| 2.0 + x)
        .collect::<Vec<_>>();
    let mut q = vec![f64::NAN; 12];
    coupled.diagonal(&x, &mut q);
    for (r, row) in rows.iter().enumerate() {
        let sum = |of: &dyn Fn(f64, usize) -> f64| -> f64 {
            row.iter().map(|&(j, v)| of(v, j as usize)).sum()
        };
        let g = sum(&|v, j| v * v / weights[j]);
        let wanted = sum(&|v, j| v * v / weights[j].powi(2) * x[j]) / (g * g);
        let wanted = if r == 5 { 0.0 } else { wanted };
        assert!((q[r] - wanted).abs() <= 1e-14 * wanted, "{r}");
    }
}

/// The nodes of a fine side, each held by an obstacle and tied to the hat functions of a coarse side: 74 rows on 54
/// dofs. The rows of few neighbours are nearly dependent without the others, so that pivots in a fixed order are lost.
#[test]
fn rows_of_a_fine_side_depend_on_each_other_to_rounding() {
    let (fine, coarse) = (37, 17);
    let mut rows: Rows = (0..fine).map(|p| vec![(p as u32, 1.0)]).collect();
    for p in 0..fine {
        let at = 1.3 + 14.4 * p as f64 / (fine - 1) as f64;
        let (left, part) = (at.floor() as usize, at.fract());
        let hat = |k: usize| (fine + left + k) as u32;
        rows.push(vec![(p as u32, 1.0), (hat(0), part - 1.0), (hat(1), -part)]);
    }
    let b = dense(&rows, fine + coarse);
    let mut coupled = Coupled::new(&rows, &vec![1.0; fine + coarse]);
    let all = vec![true; 2 * fine];
    coupled.hold(&all);
    let dependencies = coupled.dependencies.as_ref().expect("they depend");
    let free =
        2 * fine - scaling::range(&faer::Mat::from_fn(b.rows, b.cols, |i, j| b.get(i, j))).ncols();
    assert_eq!(dependencies.parts().count(), free);
    // Π c is a right-hand side that the rows can satisfy: B B_Dᵀ Π c = Π c.
    let mut wanted = random(2 * fine, 5);
    dependencies.project(&mut wanted);
    let mut v = vec![0.0; fine + coarse];
    coupled.lift(&wanted, &mut v);
    let missed = distance(&product(&b, &v), &wanted);
    assert!(missed < 1e-12, "{missed:e}");
}

/// Two rows that are turned together have the B_D of turned rows, and turning them back gives the old one.
#[test]
fn turned_rows_scale_as_in_dense_blocks() {
    let (n, m) = (60, 30);
    let (first, of_first) = between_sides(n, m, [1.0, 2.0]);
    // The second row of each pair is along another component: its dofs come after those of the first ones.
    let shift = (n + m) as u32;
    let mut rows: Rows = Vec::new();
    for row in &first {
        let second: Vec<(u32, f64)> = row.iter().map(|&(j, v)| (j + shift, v)).collect();
        let zeros = |of: &[(u32, f64)]| of.iter().map(|e| (e.0, 0.0)).collect::<Vec<_>>();
        rows.push([row.clone(), zeros(&second)].concat());
        rows.push([second.clone(), zeros(row)].concat());
    }
    let weights = [of_first.clone(), of_first].concat();
    let turn = Turn {
        rows: [8, 9],
        by: [0.6, 0.8],
    };
    let mut turned = rows.clone();
    for k in 0..rows[8].len() {
        let j = rows[8][k].0;
        let b = rows[9].iter().find(|e| e.0 == j).expect("a dof of both").1;
        let [along, across] = turn.of([rows[8][k].1, b]);
        turned[8][k].1 = along;
        turned[9]
            .iter_mut()
            .find(|e| e.0 == j)
            .expect("a dof of both")
            .1 = across;
    }
    let mut active = vec![true; rows.len()];
    active[8] = false;
    let mut coupled = Coupled::new(&rows, &weights);
    coupled.hold(&vec![true; rows.len()]);
    coupled.turn(&turn);
    coupled.hold(&active);
    let bd = scaling::block(&dense(&turned, weights.len()), &weights, &active);
    let lambda = multipliers(&active);
    let (mut v, mut expected) = (vec![0.0; weights.len()], vec![0.0; weights.len()]);
    coupled.lift(&lambda, &mut v);
    bd.add_mul_transpose(&lambda, &mut expected);
    assert!(
        distance(&v, &expected) < 1e-12,
        "{:.1e}",
        distance(&v, &expected)
    );
    // Rows with zeros for the dofs of their partners depend on each other no more than without.
    assert!(coupled.dependent(&vec![true; rows.len()]).is_empty());
}
