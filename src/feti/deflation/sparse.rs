//! E = Wᵀ F W of many columns as a sparse matrix: two bodies have common entries if F leads from the columns of one to
//! the rows of the other.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use super::panels::Panels;
use crate::feti::projector::gram::{Gram, Shape};
use crate::feti::projector::pattern::Pattern;
use crate::linalg::csr::Csr;
use crate::linalg::dense::Dense;
use crate::linalg::sorted::distinct;
use crate::parallel::exchange::{gather_all, sum_all};

/// E as a sparse matrix.
pub struct Sparse {
    /// Its pattern, which is kept while it suffices.
    pub shape: Rc<Shape>,
    factor: Gram,
    e: Csr,
    /// Number of steps of refinement in a solve.
    steps: usize,
}

/// Largest residual of a solution with E, relative to the right-hand side, each entry by the root of its diagonal
/// entry.
const EXACT: f64 = 1e-14;

/// Largest number of refinement steps.
const STEPS: usize = 2;

impl Sparse {
    /// Factors `e`. Columns are left out without a choice of pivots, which may leave small ones: a solution with a
    /// known vector tells how many steps of refinement make up for them. Collective.
    pub fn new(shape: Rc<Shape>, e: Csr) -> Sparse {
        let mut sparse = Sparse {
            factor: Gram::new(&shape, e.clone()),
            shape,
            e,
            steps: 0,
        };
        let n = sparse.e.n();
        let root: Vec<f64> = sparse.e.diagonal().iter().map(|d| d.sqrt()).collect();
        let x: Vec<f64> = (0..n)
            .map(|i| 1.0 + ((i * 7919) % 13) as f64 / 13.0)
            .zip(&root)
            .map(|(x, d)| if *d > 0.0 { x / d } else { 0.0 })
            .collect();
        let mut b = vec![0.0; n];
        sparse.e.mul(&x, &mut b);
        let scaled = |v: &[f64]| {
            let entries = v.iter().zip(&root).filter(|e| *e.1 > 0.0);
            entries.fold(0.0f64, |m, (v, d)| m.max((v / d).abs()))
        };
        for steps in 0..=STEPS {
            sparse.steps = steps;
            let mut c = b.clone();
            sparse.solve(&mut c);
            if scaled(&sparse.rest(&c, &b)) <= EXACT * scaled(&b) {
                break;
            }
        }
        sparse
    }

    /// Number of independent columns.
    pub fn rank(&self) -> usize {
        self.factor.n() - self.factor.dropped.len()
    }

    /// b − E c in the columns that are not left out.
    fn rest(&self, c: &[f64], b: &[f64]) -> Vec<f64> {
        let mut rest = vec![0.0; c.len()];
        self.e.mul(c, &mut rest);
        rest.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        let dropped = self.factor.dropped.iter();
        dropped.for_each(|&k| rest[k as usize] = 0.0);
        rest
    }

    /// c ← E⁺ c, the same on every rank. Collective.
    pub fn solve(&self, c: &mut [f64]) {
        let b = c.to_vec();
        self.factor.solve(c);
        for _ in 0..self.steps {
            let mut rest = self.rest(c, &b);
            self.factor.solve(&mut rest);
            c.iter_mut().zip(&rest).for_each(|(c, r)| *c += r);
        }
    }
}

/// The symmetric part of WᵀFW, block by block, and its shape: `known` if that suffices. Collective.
pub fn product(
    comm: &SimpleCommunicator,
    w: &Panels,
    fw: &Panels,
    known: Option<Rc<Shape>>,
) -> (Rc<Shape>, Csr) {
    let starts = w.starts();
    let n = starts.len() - 1;
    let mut blocks: Vec<(usize, usize, Dense)> = Vec::new();
    w.products(fw, |a, b, part| blocks.push((a, b, part.clone())));
    let pair = |a: usize, b: usize| (a as u64) << 32 | b as u64;
    let both = blocks
        .iter()
        .flat_map(|&(a, b, _)| [pair(a, b), pair(b, a)]);
    let mut lists: Vec<Vec<u32>> = (0..n as u32).map(|k| vec![k]).collect();
    for pair in gather_all(comm, &distinct(both)).concat() {
        lists[(pair >> 32) as usize].push(pair as u32);
    }
    let mut lists: Vec<Vec<u32>> = lists.into_iter().map(distinct).collect();
    let shape = match known {
        Some(shape) if shape.pattern.contains(&lists) => shape,
        Some(shape) if shape.pattern.n_bodies() == n => {
            let before = shape.pattern.graph();
            for (k, list) in lists.iter_mut().enumerate() {
                list.extend(before.row(k).0);
                *list = distinct(list.iter().copied());
            }
            Shape::of(comm, Pattern::of_bodies(lists, &starts), 1, &[]).into()
        }
        _ => Shape::of(comm, Pattern::of_bodies(lists, &starts), 1, &[]).into(),
    };
    let pattern = &shape.pattern;
    let mut e = pattern.zeros();
    for (a, b, mut part) in blocks {
        part.data.iter_mut().for_each(|v| *v *= 0.5);
        pattern.add_block(&mut e, (a, b), part.view());
        pattern.add_block(&mut e, (b, a), part.view().transpose());
    }
    sum_all(comm, &mut e.val);
    (shape, e)
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/deflation/sparse.rs"]
mod tests;
