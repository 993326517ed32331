//! Known and unknown dofs. A dof is known if its row of the assembled operator has only a diagonal entry.
//!
//! MatZeroRowsColumns and MatZeroRows leave such rows for boundary conditions, u = b / diagonal. The dofs that the host
//! holds are known too.

use std::collections::HashMap;

use super::torn::Torn;
use mpi::traits::Communicator;
use parallel::exchange::exchange_words;
use petsc::Session;

/// The state of a global dof.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum State {
    /// An unknown, with the sum of the diagonal entries of its copies.
    Free(f64),
    /// Known from its own row, with the sum of the diagonal entries; 0 for an empty row.
    Fixed(f64),
}

impl State {
    /// The sum of the diagonal entries.
    pub fn diagonal(self) -> f64 {
        match self {
            State::Free(d) | State::Fixed(d) => d,
        }
    }

    /// Whether the dof is unknown.
    pub fn is_free(self) -> bool {
        matches!(self, State::Free(_))
    }
}

/// The state of every dof that this rank's pieces touch. Collective.
pub fn states(session: &Session, torn: &Torn) -> HashMap<u32, State> {
    let comm = session.comm();
    let size = comm.size() as usize;
    let mut reports: Vec<Vec<u64>> = vec![Vec::new(); size];
    for piece in &torn.pieces {
        for (i, &dof) in piece.dofs.iter().enumerate() {
            let full = piece.couples(i) && !torn.held.contains(&dof);
            let word = u64::from(dof) << 1 | u64::from(full);
            reports[dof as usize % size].extend([word, piece.k.get(i, i).to_bits()]);
        }
    }
    let received = exchange_words(comm, reports);
    let mut known: HashMap<u64, (bool, f64)> = HashMap::new();
    for pair in received.iter().flat_map(|w| w.chunks_exact(2)) {
        let entry = known.entry(pair[0] >> 1).or_default();
        entry.0 |= pair[0] & 1 == 1;
        entry.1 += f64::from_bits(pair[1]);
    }
    let replies = received
        .iter()
        .map(|words| {
            let answer = |pair: &[u64]| {
                let (full, diagonal) = known[&(pair[0] >> 1)];
                [pair[0] & !1 | u64::from(full), diagonal.to_bits()]
            };
            words.chunks_exact(2).flat_map(answer).collect()
        })
        .collect();
    let answers = exchange_words(comm, replies);
    answers
        .iter()
        .flat_map(|w| w.chunks_exact(2))
        .map(|pair| {
            let diagonal = f64::from_bits(pair[1]);
            let state = if pair[0] & 1 == 1 {
                State::Free(diagonal)
            } else {
                State::Fixed(diagonal)
            };
            ((pair[0] >> 1) as u32, state)
        })
        .collect()
}
