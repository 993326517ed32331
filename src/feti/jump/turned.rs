//! The jump operator with turned rows.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::blocks::JumpBlockEntry;
use super::operator::Jump;
use super::turn::Turn;
use parallel::exchange::exchange;

impl Jump {
    /// Number of rows in the block of an owned row of B_gl.
    pub fn rows_beside(&self, row: usize) -> usize {
        let block = self.block_of[row - self.n_owned_local];
        self.blocks[block as usize].rows.len()
    }

    /// Turns rows of this rank, with their right-hand sides and B_D. Collective.
    pub fn turn(&mut self, comm: &SimpleCommunicator, turns: &[Turn]) {
        let mut outgoing: Vec<Vec<JumpBlockEntry>> = (0..comm.size()).map(|_| Vec::new()).collect();
        let mut blocks: Vec<u32> = Vec::new();
        for turn in turns {
            let k = self.block_of[turn.rows[0] - self.n_owned_local];
            self.blocks[k as usize].turn(turn);
            blocks.push(k);
            for values in [&mut self.gap, &mut self.held] {
                let [a, b] = turn.rows;
                [values[a], values[b]] = turn.of([values[a], values[b]]);
            }
        }
        blocks.sort_unstable();
        blocks.dedup();
        let mut rows: Vec<usize> = turns.iter().flat_map(|t| t.rows).collect();
        rows.sort_unstable();
        for &k in &blocks {
            let block = &mut self.blocks[k as usize];
            let active = &self.active[block.rows.clone()];
            let mut send = |entry: JumpBlockEntry| {
                outgoing[self.locations.rank(entry.subdomain)].push(entry);
            };
            let start = block.rows.start;
            let turned = |r| rows.binary_search(&(start + r)).is_ok();
            block.hold(self.first, turned, active, &mut self.known, &mut send);
        }
        self.change(exchange(comm, outgoing));
    }

    /// Replaces entries of B_gl and B_D that other ranks have sent. Those of a row follow each other.
    pub(super) fn change(&mut self, entries: Vec<JumpBlockEntry>) {
        let mut ghost = 0;
        for entry in entries {
            let j = self.local_index(entry.subdomain);
            if self.ghosts.get(ghost) != Some(&entry.row) {
                let found = self.ghosts.binary_search(&entry.row);
                ghost = found.expect("rows of a block are ghosts of its subdomains");
            }
            let k = self.places.entry(ghost, j as u32, entry.local);
            self.columns.set_b(j, k, entry.b);
            self.columns.set_bd(j, k, entry.bd);
            self.columns.set_full(j, k, entry.full);
        }
    }
}
