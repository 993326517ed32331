//! E = Wᵀ F W of many columns as a sparse matrix: two bodies have common entries if F leads from the columns of one to
//! the rows of the other.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use super::panels::Panels;
use crate::feti::projector::blocks::ColumnBlocks;
use crate::feti::projector::coarse_solver::InverseSide;
use crate::feti::projector::gram::Gram;
use crate::feti::projector::gram_pattern::{FactorSharing, GramPattern};
use crate::feti::projector::refined::RefinedFactor;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;
use parallel::exchange::{gather_all, sum_all};

/// E as a sparse matrix, factored.
pub struct Sparse {
    /// Its pattern, which is kept while it suffices.
    pub shape: Rc<GramPattern>,
    inverse: RefinedFactor,
}

impl Sparse {
    /// Factors `e`. Collective.
    pub fn new(shape: Rc<GramPattern>, e: Csr) -> Sparse {
        let factor = Gram::new(&shape, e.clone());
        let inverse = RefinedFactor::symmetric(&shape, factor, e);
        Sparse { shape, inverse }
    }

    /// Number of independent columns.
    pub fn rank(&self) -> usize {
        self.inverse.rank()
    }

    /// c ← E⁺ c, the same on every rank. Collective.
    pub fn solve(&self, c: &mut [f64]) {
        self.inverse.solve(c, InverseSide::Plain);
    }
}

/// The symmetric part of WᵀFW, block by block, and its shape: `known` if that suffices. `at` has the position of each
/// panel, if they are known. Collective.
pub fn product(
    comm: &SimpleCommunicator,
    [w, fw]: [&Panels; 2],
    at: Option<&[[f64; 3]]>,
    known: Option<Rc<GramPattern>>,
) -> (Rc<GramPattern>, Csr) {
    let starts = w.starts();
    let n = starts.len() - 1;
    let mut blocks: Vec<(usize, usize, Dense)> = Vec::new();
    w.products(fw, |a, b, part| blocks.push((a, b, part.clone())));
    let pair = |a: usize, b: usize| [a as u32, b as u32];
    let both = blocks
        .iter()
        .flat_map(|&(a, b, _)| [pair(a, b), pair(b, a)]);
    let mut lists: Vec<Vec<u32>> = (0..n as u32).map(|k| vec![k]).collect();
    for [a, b] in gather_all(comm, &distinct(both)).concat() {
        lists[a as usize].push(b);
    }
    let mut lists: Vec<Vec<u32>> = lists.into_iter().map(distinct).collect();
    let new = |lists: &[Vec<u32>]| {
        let order = || {
            (
                ColumnBlocks::of_bodies(lists, &starts),
                at.map(<[_]>::to_vec),
            )
        };
        GramPattern::ordered(comm, lists, &starts, order, &FactorSharing::any()).into()
    };
    let shape = match known {
        Some(shape) if shape.pattern.contains(&lists) => shape,
        Some(shape) if shape.pattern.n_bodies() == n => {
            for (k, list) in lists.iter_mut().enumerate() {
                list.extend(shape.pattern.near(k));
                *list = distinct(list.iter().copied());
            }
            new(&lists)
        }
        _ => new(&lists),
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
