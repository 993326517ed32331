//! GᵀG for a choice of rows: the last one, the last one with a few rows more, or another factorisation.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use super::by_column::ByColumn;
use super::gram::Gram;
use super::gram_pattern::GramPattern;
use super::kernel_motion::{Coefficient, KernelMotion};
use super::natural::NaturalCoarse;
use super::woodbury::{SparseRow, MOST};
use parallel::clock::{self, Phase};
use parallel::exchange::{highest, sum_all};
use parallel::parcels::Parcels;

/// Motions on which the rows do more work than this, relative to the largest that they could do, are not known well
/// enough: P would lose digits. As a rule it is some times rounding.
const FREE: f64 = 1e-13;

/// Largest work of the rows, in the same measure, on a motion that they do not hold but no pivot shows: the root of
/// what a regular matrix has there, and more than what is left of a motion after the solves that find it.
const NO_WORK: f64 = 1e-8;

/// Largest number of such motions that are looked for.
const MOST_HIDDEN: usize = 8;

impl NaturalCoarse {
    /// GᵀG of these rows, factored. Collective.
    ///
    /// # Panics
    /// If no body floats.
    pub fn gram(&self, comm: &SimpleCommunicator, chosen: &[bool]) -> Rc<Gram> {
        let shape = self.shape.as_ref().expect("a body floats");
        let mut last = self.last.borrow_mut();
        // Rows that have left, and rows that have come, over all ranks.
        let mut changes = match &*last {
            Some((rows, _)) => {
                let pairs = || rows.iter().zip(chosen);
                let left = pairs().filter(|(was, is)| **was && !**is).count();
                let more = pairs().filter(|(was, is)| !**was && **is).count();
                [left as f64, more as f64]
            }
            None => [1.0, 0.0],
        };
        sum_all(comm, &mut changes);
        if changes != [0.0; 2] {
            let raised = match &*last {
                Some((rows, gram)) if changes[0] == 0.0 && changes[1] <= MOST as f64 => gram
                    .raised(&self.more_rows(comm, rows, chosen))
                    .filter(|raised| self.work(comm, rows, raised.taken()) <= FREE),
                _ => None,
            };
            let gram = raised.unwrap_or_else(|| self.factored(comm, shape, chosen));
            *last = Some((chosen.to_vec(), Rc::new(gram)));
        }
        last.as_ref().expect("it was set").1.clone()
    }

    /// GᵀG of these rows, factored anew; motions that no pivot shows are left out, too. Collective.
    fn factored(&self, comm: &SimpleCommunicator, shape: &GramPattern, chosen: &[bool]) -> Gram {
        let mut hidden: Vec<u32> = Vec::new();
        loop {
            let mut numbers = self.numbers.borrow_mut();
            let product = numbers.renewed(comm, shape, &self.all, chosen);
            let gram = clock::timed(Phase::NaturalFactor, || {
                Gram::without(shape, product, (&hidden, &self.noise))
            });
            let Some((column, motion)) = gram.weakest().filter(|_| hidden.len() < MOST_HIDDEN)
            else {
                return gram;
            };
            if self.work(comm, chosen, &[motion]) > NO_WORK {
                return gram;
            }
            hidden.push(column);
        }
    }

    /// The largest work of these rows on one of these motions, relative to the largest that it could be. Collective.
    fn work(&self, comm: &SimpleCommunicator, chosen: &[bool], motions: &[KernelMotion]) -> f64 {
        let largest: Vec<f64> = motions.iter().map(KernelMotion::largest).collect();
        let by_column = ByColumn::new(self.known(), motions.iter());
        let mut most = 0.0f64;
        for i in (0..chosen.len()).filter(|&i| chosen[i]) {
            let (columns, values) = self.all.entries(i);
            let size: f64 = values.iter().map(|v| v.abs()).sum();
            for (m, work) in by_column.works(columns, values) {
                most = most.max(work.abs() / (size * largest[m]));
            }
        }
        highest(comm, most)
    }

    /// The rows that are chosen now and were not, by the names of columns, on every rank. Collective.
    fn more_rows(&self, comm: &SimpleCommunicator, was: &[bool], is: &[bool]) -> Vec<SparseRow> {
        let mut mine = Parcels::default();
        for i in (0..is.len()).filter(|&i| is[i] && !was[i]) {
            let (columns, values) = self.all.entries(i);
            let names = columns.iter().map(|&c| self.known().name(c));
            let entries = names.zip(values).map(|(c, &v)| Coefficient::new(c, v));
            mine.push((), entries);
        }
        let all = mine.gather_all(comm);
        let rows = all.iter().flat_map(Parcels::iter);
        rows.map(|((), row)| row.iter().map(Coefficient::pair).unzip())
            .collect()
    }
}
