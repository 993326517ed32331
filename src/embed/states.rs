//! Known and unknown dofs. A dof is known if its row of the assembled operator has only a diagonal entry.
//!
//! MatZeroRowsColumns and MatZeroRows leave such rows for boundary conditions, u = b / diagonal. The dofs that the host
//! holds are known too.

use super::torn::Torn;
use bytemuck::{Pod, Zeroable};
use mpi::traits::Communicator;
use parallel::exchange::{exchange, exchange_by_rank};
use petsc::Session;
use rustc_hash::FxHashMap;

/// The state of a global dof.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GlobalDofState {
    /// An unknown, with the sum of the diagonal entries of its copies.
    Free(f64),
    /// Known from its own row, with the sum of the diagonal entries; 0 for an empty row.
    Fixed(f64),
}

impl GlobalDofState {
    /// The sum of the diagonal entries.
    pub fn diagonal(self) -> f64 {
        match self {
            GlobalDofState::Free(d) | GlobalDofState::Fixed(d) => d,
        }
    }

    /// Whether the dof is unknown.
    pub fn is_free(self) -> bool {
        matches!(self, GlobalDofState::Free(_))
    }
}

/// A dof: whether a row of its own couples it to others, and the diagonal entry.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct DofState {
    dof: u32,
    full: u32,
    diagonal: f64,
}

/// The states of global dofs.
pub type States = FxHashMap<u32, GlobalDofState>;

/// The state of every dof that this rank's pieces touch. Collective.
pub fn states(session: &Session, torn: &Torn) -> States {
    let comm = session.comm();
    let size = comm.size() as usize;
    let mut reports: Vec<Vec<DofState>> = vec![Vec::new(); size];
    for piece in &torn.pieces {
        for (i, &dof) in piece.dofs.iter().enumerate() {
            reports[dof as usize % size].push(DofState {
                dof,
                full: (piece.couples(i) && !torn.held.contains(&dof)).into(),
                diagonal: piece.k.get(i, i),
            });
        }
    }
    let received = exchange_by_rank(comm, reports);
    let mut known: FxHashMap<u32, DofState> = FxHashMap::default();
    for part in received.iter().flatten() {
        let sum = known.entry(part.dof).or_insert(DofState {
            dof: part.dof,
            ..DofState::zeroed()
        });
        sum.full |= part.full;
        sum.diagonal += part.diagonal;
    }
    let answer = |part: &DofState| known[&part.dof];
    let replies = received
        .iter()
        .map(|list| list.iter().map(answer).collect());
    let state = |of: DofState| match of.full {
        0 => GlobalDofState::Fixed(of.diagonal),
        _ => GlobalDofState::Free(of.diagonal),
    };
    let answers = exchange(comm, replies.collect()).into_iter();
    answers.map(|of| (of.dof, state(of))).collect()
}
