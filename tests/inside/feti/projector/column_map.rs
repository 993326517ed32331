//! Unit tests of `src/feti/projector/column_map.rs`: on several ranks, of which each knows some columns, factors and
//! vectors of columns are those of a rank that knows all.

use std::rc::Rc;

use super::*;
use crate::feti::projector::blocks::ColumnBlocks;
use crate::feti::projector::coarse_solver::InverseSide;
use crate::feti::projector::gram::Gram;
use crate::feti::projector::gram_matrix::GramMatrix;
use crate::feti::projector::gram_pattern::{FactorSharing, GramPattern};
use crate::feti::projector::pattern::meeting;
use crate::feti::projector::refined::RefinedFactor;
use crate::feti::projector::rows::KernelRows;
use crate::mpirun::as_rank;

/// Bodies in a row, with two motions each: more motions than dense algebra is for.
const BODIES: u32 = 120;

type Entry = (u32, u32, f64);

/// Three rows between neighbours, whose normals differ, and two that hold each tenth body. With a `floor` they also
/// meet the last body.
fn entries(floor: bool) -> Vec<Entry> {
    let (mut entries, mut row) = (Vec::new(), 0);
    let mut meet = |a: u32, b: Option<u32>, by: f64| {
        for k in 0..3 {
            let angle = by * f64::from(k + 1) + 0.01 * f64::from(a);
            for (d, v) in [angle.cos(), angle.sin()].into_iter().enumerate() {
                entries.push((row, 2 * a + d as u32, v));
                if let Some(b) = b {
                    entries.push((row, 2 * b + d as u32, -v));
                }
            }
            row += 1;
        }
    };
    for a in 0..BODIES - 1 {
        meet(a, Some(a + 1), 0.3);
        if a % 10 == 3 {
            meet(a, None, 0.5);
        }
        // Bodies that are let loose are not held by the floor.
        let loose = a == 41 || (61..67).contains(&a);
        if floor && a + 2 < BODIES && !loose {
            meet(a, Some(BODIES - 1), 0.7);
        }
    }
    entries
}

/// The bodies that rows of number `row` are between, and whether that row holds: two bodies in the middle are loose on
/// one side each, so that some motions are free, of one body and of several.
fn chosen(entries: &[Entry], row: u32) -> bool {
    let has = |b: u32| entries.iter().any(|e| e.0 == row && e.1 / 2 == b);
    let loose = [(40, 41), (41, 42), (60, 61), (66, 67)];
    let cut = loose.iter().any(|&(a, b)| has(a) && has(b));
    // The held bodies between the cuts are let loose, too.
    let alone = |b: u32| entries.iter().all(|e| e.0 != row || e.1 / 2 == b);
    !cut && !(61..67).any(alone)
}

/// What is compared: columns that are left out, motions that are free, and solutions of many kinds.
struct Found {
    dropped: Vec<u32>,
    unheld: Vec<KernelMotion>,
    vectors: Vec<Vec<f64>>,
}

/// For the rows `first..end`, of which `of` has the entries. Each rank has some of all rows.
fn found(
    comm: &SimpleCommunicator,
    all: &[Entry],
    of: std::ops::Range<u32>,
    known: Option<Vec<u32>>,
    weight: f64,
) -> (Found, usize) {
    let mine = all.iter().filter(|e| of.contains(&e.0));
    let mine: Vec<Entry> = mine.map(|e| (e.0 - of.start, e.1, e.2)).collect();
    let named = KernelRows::from_triplets(of.len(), mine);
    let start: Vec<usize> = (0..=BODIES as usize).map(|b| 2 * b).collect();
    let lists = meeting(comm, &named, &named, &start);
    // Fronts go to the ranks of the rows.
    let ranks = comm.size() as u32;
    let home: Vec<u32> = (0..BODIES).map(|b| b * ranks / BODIES).collect();
    let sharing = FactorSharing {
        home: &home,
        rows: Some(&named),
        known,
    };
    let order = || (ColumnBlocks::of_bodies(&lists, &start), None);
    let shape = GramPattern::ordered(comm, &lists, &start, order, &sharing);
    let known = &*shape.known;
    let g = named.numbered(known);
    let row = |i: usize| i as u32 + of.start;
    let some: Vec<bool> = (0..g.n()).map(|i| chosen(all, row(i))).collect();
    // From no rows to these, in two rounds, as the contact loop does.
    let mut numbers = GramMatrix::default();
    let half: Vec<bool> = some
        .iter()
        .enumerate()
        .map(|(i, on)| *on && row(i) % 2 == 0)
        .collect();
    numbers.renewed(comm, &shape, &g, &half);
    let product = numbers.renewed(comm, &shape, &g, &some);
    let gram = Rc::new(Gram::new(&shape, product));
    assert!(gram.weakest().is_none());

    // G⁺ of a vector that each rank has a share of, and of one that is known.
    let held = |on: &[bool]| {
        let mut held = g.clone();
        held.scale_rows(
            &on.iter()
                .map(|&on| f64::from(u8::from(on)))
                .collect::<Vec<_>>(),
        );
        held
    };
    let load = |rows: &KernelRows| {
        let x: Vec<f64> = (0..g.n())
            .map(|i| f64::from((row(i) * 37) % 23) - 11.0)
            .collect();
        let mut c = vec![0.0; known.n()];
        rows.add_transpose(&x, &mut c);
        known.sum(comm, &mut c);
        c
    };
    let mut vectors = Vec::new();
    let mut c = load(&held(&some));
    vectors.push(known.whole(comm, &c));
    let [square, first] = known.total(comm, |k| [c[k] * c[k], c[k]]);
    vectors.push(vec![square, first, known.largest(comm, &c)]);
    gram.solve(&mut c);
    vectors.push(known.whole(comm, &c));

    // A row of each cut more holds, without another factorisation.
    let more = |i: usize| all.iter().filter(move |e| e.0 as usize == i);
    let cut = |b: u32| {
        let rows = 0..all.last().expect("there are rows").0;
        let of = |i: &u32| {
            [b, b + 1]
                .iter()
                .all(|b| more(*i as usize).any(|e| e.1 / 2 == *b))
        };
        rows.clone().find(of).expect("a row of the cut")
    };
    let back = [cut(40), cut(60)];
    let added: Vec<(Vec<u32>, Vec<f64>)> = back
        .iter()
        .map(|&i| more(i as usize).map(|e| (e.1, e.2)).unzip())
        .collect();
    let raised = gram.raised(&added).expect("each takes a motion");
    let now: Vec<bool> = (0..g.n())
        .map(|i| some[i] || back.contains(&row(i)))
        .collect();
    let mut c = load(&held(&now));
    raised.solve(&mut c);
    // What is free is not determined: the forces are.
    let forces = |c: &[f64], on: &[bool]| {
        let mut forces = vec![0.0; g.n()];
        held(on).add(1.0, c, &mut forces);
        let mut back = vec![0.0; known.n()];
        held(on).add_transpose(&forces, &mut back);
        known.sum(comm, &mut back);
        known.whole(comm, &back)
    };
    vectors.push(forces(&c, &now));
    vectors.push(vec![raised.unheld.len() as f64]);

    // A column that is left out beforehand, and its motion.
    let all_rows = vec![true; g.n()];
    let product = shape.product(comm, &g, &g, |_| true);
    let without = Gram::without(&shape, product, (&[2 * (BODIES / 2)], &[]));
    let [motion] = &without.unheld[..] else {
        panic!("{} motions", without.unheld.len());
    };
    let mut of_motion = vec![0.0; known.n()];
    known.add(1.0 / motion.largest(), motion, &mut of_motion);
    vectors.push(known.whole(comm, &of_motion));

    // Weights, and refinement.
    let plain = Gram::new(&shape, shape.product(comm, &g, &g, |_| true));
    let mut qg = g.clone();
    let weights: Vec<f64> = (0..g.n())
        .map(|i| weight.powi(row(i) as i32 % 5 - 2))
        .collect();
    qg.scale_rows(&weights);
    let both = shape.product_and_transpose(comm, &g, &qg);
    let Ok(refined) = RefinedFactor::weighted(&shape, both, &plain) else {
        panic!("the factor is good enough");
    };
    let mut c = load(&held(&all_rows));
    refined.solve(&mut c, InverseSide::Plain);
    vectors.push(known.whole(comm, &c));
    vectors.push(vec![refined.rank() as f64]);
    let found = Found {
        dropped: gram.dropped.clone(),
        unheld: gram.unheld.clone(),
        vectors,
    };
    (found, known.n())
}

#[test]
fn ranks_that_know_some_columns_find_what_one_finds_that_knows_all() {
    let ranks = as_rank(|session, _| {
        let comm = session.comm();
        let (size, rank) = (session.size() as u32, session.rank() as u32);
        for floor in [false, true] {
            let all = entries(floor);
            let n = all.last().expect("there are rows").0 + 1;
            let (one, r) = found(&SimpleCommunicator::self_comm(), &all, 0..n, None, 3.0);
            assert_eq!(r, 2 * BODIES as usize);
            let own = n * rank / size..n * (rank + 1) / size;
            let (many, here) = found(comm, &all, own, Some(Vec::new()), 3.0);
            if size > 1 {
                // Those of the bodies in a row, and with a floor its own; the rank of the floor knows all.
                let few = here < 4 * r / 5;
                let on = parallel::exchange::total(comm, f64::from(u8::from(few)));
                assert!(
                    on >= f64::from(size - u32::from(floor)),
                    "rank {rank}: {here} of {r}"
                );
            }
            assert_eq!(one.dropped.len(), 4, "{:?}", one.dropped);
            assert_eq!(many.dropped, one.dropped);
            let largest = |v: &[f64]| v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            for (k, (a, b)) in many.vectors.iter().zip(&one.vectors).enumerate() {
                assert_eq!(a.len(), b.len());
                let apart: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
                let (apart, size) = (largest(&apart), largest(b));
                assert!(
                    apart <= 1e-9 * size,
                    "floor: {floor}, {k}: {apart:e} of {size:e}"
                );
            }
            assert_eq!(many.unheld.len(), one.unheld.len());
            for (a, b) in many.unheld.iter().zip(&one.unheld) {
                let apart = a.plus(-1.0, b);
                assert!(apart.0.is_empty() || apart.largest() < 1e-9 * b.largest());
            }
        }
        Ok(())
    });
    for n in [1, 2, 4] {
        let out = ranks.run(n, "known");
        assert_eq!(out.code, 0, "{n} ranks: {}", out.all());
    }
}
