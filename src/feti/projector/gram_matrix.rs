//! GᵀG for a choice of rows, renewed by what changed when rows switch.
//!
//! Only the blocks between bodies that switched rows touch are computed again, each from all its rows in their order:
//! the same bits as those of a product that is computed at once, without the cancellation of sums that are added to and
//! subtracted from. Ranks send the entries that changed to the owners of the rows.

use mpi::topology::SimpleCommunicator;

use super::gram_pattern::GramPattern;
use super::pattern::BlockPattern;
use super::products::{OutgoingEntries, ReceivedEntry};
use super::rows::KernelRows;
use base::linalg::csr::Csr;
use base::linalg::sorted::distinct;
use cholesky::team::FactorTeam;
use parallel::clock::{self, Phase};
use parallel::exchange::sum_all;

/// GᵀG for the rows that hold.
#[derive(Debug, Default)]
pub struct GramMatrix {
    /// Whether each row is in it.
    chosen: Vec<bool>,
    /// This rank's share, entry by entry of the pattern.
    share: Vec<f64>,
    /// Where ranks share the factor: the sums, in the rows that this rank has.
    sum: Vec<f64>,
    /// Contributions of other ranks to entries of this rank's rows, by entry and rank.
    sent: Vec<ReceivedEntry>,
}

impl GramMatrix {
    /// GᵀG over the chosen rows, which has this shape. With a team that all ranks share, a rank gets the rows that it
    /// has in the factor, else it gets all. Collective.
    pub fn renewed(
        &mut self,
        comm: &SimpleCommunicator,
        shape: &GramPattern,
        rows: &KernelRows,
        chosen: &[bool],
    ) -> Csr {
        let (pattern, team) = (&shape.pattern, shape.team().map(|team| &**team));
        let mut out = clock::timed(Phase::NaturalOrder, || pattern.zeros());
        if self.share.is_empty() {
            self.chosen = vec![false; rows.n()];
            self.share = vec![0.0; out.val.len()];
        }
        let mut touched: Vec<u32> = Vec::new();
        for i in (0..rows.n()).filter(|&i| chosen[i] != self.chosen[i]) {
            for &column in rows.entries(i).0 {
                let body = pattern.bodies()[column as usize];
                // Columns of a body follow each other.
                if touched.last() != Some(&body) {
                    touched.push(body);
                }
            }
        }
        let touched = distinct(touched);
        self.chosen.copy_from_slice(chosen);
        let team = team.filter(|team| team.is_shared());
        let before = team.map(|team| self.of_others(pattern, team, &touched));
        for span in pattern.blocks_between(&touched).map(|b| b.1) {
            self.share[span].fill(0.0);
        }
        let on = |body: u32| touched.binary_search(&body).is_ok();
        pattern.add_product(&mut self.share, (rows, rows), |i| chosen[i], on);
        match (team, before) {
            (Some(team), Some(before)) => {
                self.exchange(shape, team, &before);
                self.sum_of_own(pattern, team, &touched);
                out.val.copy_from_slice(&self.sum);
            }
            _ => {
                out.val.copy_from_slice(&self.share);
                sum_all(comm, &mut out.val);
            }
        }
        out
    }

    /// The row, the place and the present value of each entry between these bodies in a row that another rank has.
    fn of_others(
        &self,
        pattern: &BlockPattern,
        team: &FactorTeam,
        touched: &[u32],
    ) -> Vec<(u32, usize, f64)> {
        let blocks = pattern.blocks_between(touched);
        let others = blocks.filter(|(row, _)| !team.has(*row));
        let entries = others.flat_map(|(row, span)| span.map(move |k| (row, k, self.share[k])));
        entries.collect()
    }

    /// Sends the entries that differ from what they were, and notes what others send.
    fn exchange(&mut self, shape: &GramPattern, team: &FactorTeam, before: &[(u32, usize, f64)]) {
        let pattern = &shape.pattern;
        let mut outgoing = OutgoingEntries::new(team, &shape.known);
        for &(row, k, old) in before {
            if self.share[k] != old {
                outgoing.add(row, pattern.column(k), self.share[k]);
            }
        }
        let known = self.sent.len();
        for new in outgoing.send(pattern) {
            let place = |s: &ReceivedEntry| (s.entry, s.rank);
            match self.sent[..known].binary_search_by_key(&(new.entry, new.rank), place) {
                Ok(at) => self.sent[at].value = new.value,
                Err(_) => self.sent.push(new),
            }
        }
        if self.sent.len() > known {
            self.sent.sort_unstable_by_key(|s| (s.entry, s.rank));
        }
    }

    /// Sums the shares of the rows that this rank has.
    fn sum_of_own(&mut self, pattern: &BlockPattern, team: &FactorTeam, touched: &[u32]) {
        self.sum.resize(self.share.len(), 0.0);
        let blocks = pattern.blocks_between(touched);
        for (_, span) in blocks.filter(|(row, _)| team.has(*row)) {
            self.sum[span.clone()].copy_from_slice(&self.share[span]);
        }
        // The sums begin anew where others have a share.
        for s in &self.sent {
            self.sum[s.entry] = self.share[s.entry];
        }
        for s in &self.sent {
            self.sum[s.entry] += s.value;
        }
    }
}
