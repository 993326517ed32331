//! The work of the set-ups so far, counted over all ranks: it shows how much was repeated.

use super::partition::partitions;
use crate::feti::subdomain::problem::{condensations, factorisations};
use crate::Result;
use cholesky::symbolic::analyses;
use parallel::exchange::sum_all;
use petsc::Session;

/// The kind of a set-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SetUp {
    /// Of everything.
    Whole,
    /// Other numbers in the same matrices.
    Numbers,
    /// Other rows.
    Rows,
}

/// Set-ups, and what they took over all ranks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SetUpWork {
    /// Set-ups of everything, of other numbers, of other rows alone.
    pub set_ups: [usize; 3],
    /// Patterns that were analysed, subdomains that were factored, partitions into bodies that were looked for,
    /// subdomains whose S and T became dense matrices.
    pub spent: [f64; 4],
}

impl SetUpWork {
    /// Does something of which some may be a set-up, and counts what it takes. `done` says what it was. Collective.
    ///
    /// # Errors
    /// Those of `work`.
    pub fn count<T>(
        &mut self,
        session: &Session,
        work: impl FnOnce() -> Result<T>,
        done: impl FnOnce(&T) -> Option<SetUp>,
    ) -> Result<T> {
        let before = now();
        let out = work()?;
        let mut spent = now();
        spent.iter_mut().zip(before).for_each(|(s, b)| *s -= b);
        sum_all(session.comm(), &mut spent);
        self.spent.iter_mut().zip(spent).for_each(|(s, n)| *s += n);
        if let Some(kind) = done(&out) {
            self.set_ups[kind as usize] += 1;
        }
        Ok(out)
    }

    /// The counts as two lines for -ksp_view and FetiFetiView.
    pub fn lines(&self) -> String {
        let [whole, numbers, rows] = self.set_ups;
        let [analysed, factored, partitions, dense] = self.spent;
        format!(
            "set-ups: {whole} whole, {numbers} of numbers, {rows} of rows; {analysed} patterns analysed, \
             {factored} subdomains factored, {partitions} partitions into bodies\
             \n  S and T as dense matrices: {dense} of {factored} subdomains factored"
        )
    }
}

/// Numbers of analyses, factorisations, partitions and dense condensations of this process so far.
fn now() -> [f64; 4] {
    [analyses(), factorisations(), partitions(), condensations()].map(|n| n as f64)
}
