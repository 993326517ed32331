//! Unit tests of `src/feti/projector/woodbury.rs`.

use super::*;
use crate::feti::projector::gram_matrix::GramMatrix;
use crate::feti::projector::gram_pattern::{FactorSharing, GramPattern};
use crate::feti::projector::pattern::meeting;
use crate::feti::projector::rows::KernelRows;
use crate::testing::with_session;

/// Bodies in a row, with two motions each: more motions than dense algebra is for.
const BODIES: u32 = 100;

/// Three rows between neighbours, whose normals differ, and two that hold each tenth body.
fn rows() -> KernelRows {
    let mut entries = Vec::new();
    let mut row = 0;
    for a in 0..BODIES {
        for k in 0..3 {
            let angle = 0.3 * f64::from(k) + 0.01 * f64::from(a);
            let normal = [angle.cos(), angle.sin()];
            for d in 0..2 {
                entries.push((row, 2 * a + d, normal[d as usize]));
                if a + 1 < BODIES {
                    entries.push((row, 2 * a + 2 + d, -normal[d as usize]));
                }
            }
            row += u32::from(a % 10 == 9 || a + 1 < BODIES);
        }
        if a % 10 == 0 {
            entries.push((row, 2 * a, 1.0));
            entries.push((row + 1, 2 * a + 1, 1.0));
            row += 2;
        }
    }
    KernelRows::from_triplets(row as usize, entries)
}

/// The shape of GᵀG, and what computes it.
fn shape(comm: &mpi::topology::SimpleCommunicator, g: &KernelRows) -> GramPattern {
    let start: Vec<usize> = (0..=BODIES as usize).map(|b| 2 * b).collect();
    GramPattern::new(
        comm,
        &meeting(comm, g, g, &start),
        &start,
        &FactorSharing::any(),
    )
}

/// Whether row `i` holds at first: not those of three bodies on one side, and of two single ones.
fn at_first(g: &KernelRows, i: usize) -> bool {
    let has = |b: u32| g.entries(i).0.iter().any(|c| c / 2 == b);
    let parts = [(13, 14), (16, 17), (44, 45), (45, 46), (72, 73), (73, 74)];
    !parts.iter().any(|&(a, b)| has(a) && has(b))
}

/// x − G A⁺ Gᵀ x.
fn projected(g: &KernelRows, chosen: &[bool], gram: &Gram, x: &[f64]) -> Vec<f64> {
    let mut held = g.clone();
    held.scale_rows(
        &chosen
            .iter()
            .map(|&on| f64::from(u8::from(on)))
            .collect::<Vec<_>>(),
    );
    let mut c = vec![0.0; gram.r()];
    held.add_transpose(x, &mut c);
    gram.solve(&mut c);
    let mut out = x.to_vec();
    held.add(-1.0, &c, &mut out);
    out
}

#[test]
fn rows_that_are_put_back_need_no_other_factor() {
    with_session(|session| {
        let comm = session.comm();
        let g = rows();
        let shape = shape(comm, &g);
        let gram = |chosen: &[bool]| {
            let product = shape.product(comm, &g, &g, |i| chosen[i]);
            Rc::new(Gram::new(&shape, product))
        };
        let mut chosen: Vec<bool> = (0..g.n()).map(|i| at_first(&g, i)).collect();
        let base = gram(&chosen);
        // Two motions of bodies 14 to 16, of 45, and of 73.
        assert_eq!(base.unheld.len(), 6);
        let row = |i: usize| (g.entries(i).0.to_vec(), g.entries(i).1.to_vec());
        let missing: Vec<usize> = (0..g.n()).filter(|&i| !chosen[i]).collect();
        // One row at a time, of different joints, until nothing is free.
        let order = [0, 9, 13, 4, 8, 12];
        for n in 1..=order.len() {
            let back: Vec<usize> = order[..n].iter().map(|&k| missing[k]).collect();
            back.iter().for_each(|&i| chosen[i] = true);
            let added: Vec<SparseRow> = back.iter().map(|&i| row(i)).collect();
            let raised = base.raised(&added).expect("each takes a motion");
            let direct = gram(&chosen);
            assert_eq!(raised.unheld.len(), 6 - n);
            assert_eq!(raised.dropped.len(), 6 - n);
            assert_eq!(direct.unheld.len(), 6 - n);
            for motion in &raised.unheld {
                for i in (0..g.n()).filter(|&i| chosen[i]) {
                    let (columns, values) = g.entries(i);
                    assert!(motion.work(columns, values).abs() < 1e-12 * motion.largest());
                }
            }
            let x: Vec<f64> = (0..g.n()).map(|i| ((i * 37) % 23) as f64 - 11.0).collect();
            let (ours, theirs) = (
                projected(&g, &chosen, &raised, &x),
                projected(&g, &chosen, &direct, &x),
            );
            let apart = ours
                .iter()
                .zip(&theirs)
                .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(apart < 1e-11, "{n} rows: {apart}");
            back.iter().for_each(|&i| chosen[i] = false);
        }
        // A vector that ranks share; here one rank has it all.
        let raised = base
            .raised(&[row(missing[0]), row(missing[9])])
            .expect("two motions");
        let GramFactor::Sparse { factor, .. } = &base.factor else {
            panic!("there are many motions")
        };
        let mut whole: Vec<f64> = (0..base.r())
            .map(|k| ((k * 29) % 17) as f64 - 8.0)
            .collect();
        let mut own: Vec<f64> = factor
            .team()
            .own_dofs()
            .map(|k| whole[k as usize])
            .collect();
        raised.solve(&mut whole);
        raised.solve_shares(&mut own);
        let largest = whole.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        for (k, x) in factor.team().own_dofs().zip(&own) {
            assert!((whole[k as usize] - x).abs() < 1e-13 * largest);
        }
        // Two rows that take the same motion.
        assert!(base.raised(&[row(missing[0]), row(missing[0])]).is_none());
    });
}

#[test]
fn numbers_that_are_renewed_are_those_computed_at_once() {
    with_session(|session| {
        let comm = session.comm();
        let g = rows();
        let shape = shape(comm, &g);
        let mut numbers = GramMatrix::default();
        for round in 0..20usize {
            // Few rows switch from one round to the next, and come back.
            let chosen: Vec<bool> = (0..g.n())
                .map(|i| (i * 31 + 7) % 41 != round && (i * 17) % 53 != round / 2)
                .collect();
            let renewed = numbers.renewed(comm, &shape, &g, &chosen);
            let once = shape.product(comm, &g, &g, |i| chosen[i]);
            assert_eq!(renewed.val, once.val, "round {round}");
        }
    });
}
