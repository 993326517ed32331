//! Which rows hold: a change of Z^k, block by block, and what follows from it.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::blocks::JumpBlockEntry;
use super::operator::Jump;
use parallel::exchange::exchange;

impl Jump {
    /// Z^k, with the inequality rows that hold because they follow from others. Around a cross point several sets of
    /// rows are equivalent.
    pub fn implied(&self) -> Vec<bool> {
        let mut out = self.active.clone();
        for block in self.blocks.iter().filter(|b| b.rows.len() > 1) {
            if !block
                .rows
                .clone()
                .any(|r| self.law[r].is_inequality() && !out[r])
            {
                continue;
            }
            let (active, c) = (
                &self.active[block.rows.clone()],
                &self.gap[block.rows.clone()],
            );
            for r in block.implied(active, c) {
                let r = block.rows.start + r;
                out[r] |= self.law[r].is_inequality();
            }
        }
        out
    }

    /// Gives the owned rows that do not hold in `active` the multiplier of a released row.
    pub fn release(&self, active: &[bool], lambda: &mut [f64]) {
        for i in (0..lambda.len()).filter(|&i| !active[i]) {
            let given = self.given_multipliers.get(i).copied();
            lambda[i] = self.law[i].released(given.unwrap_or(0.0));
        }
    }

    /// Computes right-hand sides that the rows that hold can satisfy together, from c and Z^k, for all blocks.
    pub(super) fn reconcile_all(&mut self) {
        self.reconcile(0..self.blocks.len());
    }

    /// Computes right-hand sides that the rows that hold can satisfy together, from c and Z^k, for these blocks.
    fn reconcile(&mut self, which: impl Iterator<Item = usize>) {
        for block in which.map(|k| &self.blocks[k]) {
            let (active, c) = (
                &self.active[block.rows.clone()],
                &self.gap[block.rows.clone()],
            );
            self.held[block.rows.clone()].copy_from_slice(&block.consistent(active, c));
        }
    }

    /// Changes Z^k. `active` says for each owned row whether it holds (rows of B_loc always do). Only blocks with a
    /// changed row get a new B_D. Returns the number of rows that changed on this rank. Collective.
    pub fn set_active(&mut self, comm: &SimpleCommunicator, active: &[bool]) -> usize {
        debug_assert!(active[..self.n_owned_local].iter().all(|&on| on));
        let mut outgoing: Vec<Vec<JumpBlockEntry>> = (0..comm.size()).map(|_| Vec::new()).collect();
        let pairs = self.active.iter().zip(active);
        let rows = (0..).zip(pairs).filter(|(_, (old, new))| old != new);
        let rows: Vec<usize> = rows.map(|(i, _)| i).collect();
        let mut blocks: Vec<u32> = (rows.iter())
            .map(|&i| self.block_of[i - self.n_owned_local])
            .collect();
        blocks.dedup();
        for &k in &blocks {
            let block = &mut self.blocks[k as usize];
            let (old, new) = (
                &self.active[block.rows.clone()],
                &active[block.rows.clone()],
            );
            block.hold(
                self.first,
                |r| old[r] != new[r],
                new,
                &mut self.known,
                &mut |entry: JumpBlockEntry| {
                    outgoing[self.locations.rank(entry.subdomain)].push(entry);
                },
            );
        }
        self.active.copy_from_slice(active);
        self.reconcile(blocks.iter().map(|&k| k as usize));
        self.change(exchange(comm, outgoing));
        rows.len()
    }
}
