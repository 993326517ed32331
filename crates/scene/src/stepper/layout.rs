//! The state of the contact loop without the ranks: gathered in a canonical order that depends on the problem only, and
//! distributed again to any number of ranks.
//!
//! Rows of B_loc belong to the lowest subdomain of their dof and follow its local dofs. Rows of B_gl belong to a block
//! and keep the order in which the scene provides them. Neither depends on the owners, so that (subdomain, position)
//! and (block, position) identify a row in every run of the problem:
//!
//! ```text
//!     λ = [ rows of subdomain 0 | rows of subdomain 1 | … | rows of the lowest block | of the next | … ]
//! ```

use std::ops::Range;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use base::{Error, Result};
use bytemuck::{cast_slice, pod_collect_to_vec};
use fetifeti::inside::LinearMethod;
use fetifeti::problem::Law;
use fetifeti::solution::State;
use parallel::exchange::exchange_by_rank;
use petsc::Session;

/// A [`State`] with the rows of all ranks in canonical order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GlobalState {
    /// Number of rows of B_loc that belong to each subdomain.
    pub local: Vec<u64>,
    /// Blocks of B_gl, increasing, and their numbers of rows.
    pub blocks: Vec<(u64, u64)>,
    /// The state of all ranks: λ on rows of B_loc, then of B_gl; the sets on rows of B_gl.
    pub all: State,
}

impl GlobalState {
    /// Whether the lengths of the lists agree with the numbers of rows.
    pub fn is_consistent(&self) -> bool {
        let contact = checked_sum(self.blocks.iter().map(|b| b.1));
        let all = checked_sum(self.local.iter().copied().chain(contact));
        contact == Some(self.all.active.len() as u64)
            && contact == Some(self.all.before.len() as u64)
            && (self.all.slid.is_empty() || contact == Some(self.all.slid.len() as u64))
            && all == Some(self.all.lambda.len() as u64)
    }
}

fn checked_sum(mut numbers: impl Iterator<Item = u64>) -> Option<u64> {
    numbers.try_fold(0u64, |sum, n| sum.checked_add(n))
}

/// Consecutive rows on one rank that are moved together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Chunk {
    /// Subdomain or block.
    key: u64,
    rank: usize,
    /// First of these rows among those that the rank owns.
    first: usize,
    n: usize,
}

impl Chunk {
    /// These rows as indices among those that the rank owns.
    fn rows(&self) -> Range<usize> {
        self.first..self.first + self.n
    }
}

/// The owners of the rows, known to rank 0.
#[derive(Debug)]
pub(super) struct RowLayout {
    /// On the owned rows: Z⁰, and what says whether it may change.
    initial: Vec<bool>,
    law: Vec<Law>,
    /// Length of μ.
    r: usize,
    /// Rows of B_loc by subdomain, of B_gl by block; on rank 0.
    local: Vec<Chunk>,
    blocks: Vec<Chunk>,
    /// Number of rows that each rank owns; on rank 0.
    owned: Vec<usize>,
}

impl RowLayout {
    /// The owners in this run. Collective.
    pub fn new(solver: &LinearMethod) -> RowLayout {
        let (session, problem) = (solver.session(), solver.problem());
        let dual = solver.dual();
        let jump = &dual.stiffness.jump;
        let subdomains = problem.local.iter().zip(jump.local_start.windows(2));
        let mine: [Vec<(u64, usize)>; 2] = [
            subdomains
                .map(|(sub, ends)| (sub.index as u64, ends[1] - ends[0]))
                .collect(),
            jump.numbered_blocks(problem)
                .map(|(block, rows)| (block, rows.len()))
                .collect(),
        ];
        let mut chunks = [Vec::new(), Vec::new()];
        let mut owned = Vec::new();
        for (rank, lists) in to_first(session, &mine).into_iter().enumerate() {
            let mut first = 0;
            for (list, chunks) in lists.into_iter().zip(&mut chunks) {
                for (key, n) in list {
                    chunks.push(Chunk {
                        key,
                        rank,
                        first,
                        n,
                    });
                    first += n;
                }
            }
            owned.push(first);
        }
        chunks.iter_mut().for_each(|c| c.sort_unstable());
        let [local, blocks] = chunks;
        RowLayout {
            initial: jump.initial.clone(),
            law: jump.law.clone(),
            r: dual.natural.r,
            local,
            blocks,
            owned,
        }
    }

    /// The state of all ranks, on rank 0; `None` on the others. Collective.
    pub fn gather(&self, session: &Session, state: &State) -> Option<GlobalState> {
        let parts = to_first(session, state);
        let first = parts.first()?;
        let all = self.local.iter().chain(&self.blocks);
        let lambda = all.flat_map(|c| &parts[c.rank].lambda[c.rows()]);
        let lambda = lambda.copied().collect();
        let set = |of: fn(&State) -> &[bool]| -> Vec<bool> {
            let rows = self.blocks.iter();
            rows.flat_map(|c| &of(&parts[c.rank])[c.rows()])
                .copied()
                .collect()
        };
        let some = parts.iter().any(|part| !part.slid.is_empty());
        let rows = self.blocks.iter().filter(|_| some);
        let slid = rows.flat_map(|c| &parts[c.rank].slid[c.rows()]);
        let slid = slid.copied().collect();
        Some(GlobalState {
            local: self.local.iter().map(|c| c.n as u64).collect(),
            blocks: self.blocks.iter().map(|c| (c.key, c.n as u64)).collect(),
            all: first.on_rows(lambda, [set(|s| &s.active), set(|s| &s.before)], slid),
        })
    }

    /// This rank's part of the state that rank 0 has. Collective.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) if its rows are not those of this run.
    pub fn scatter(&self, session: &Session, global: Option<&GlobalState>) -> Result<State> {
        session.agree(global.map_or(Ok(()), |global| self.fits(global)))?;
        let mut state: State = from_first(session, global.map(|global| self.deal(global)));
        // Equations are always active.
        for set in [&mut state.active, &mut state.before] {
            for (r, on) in set.iter_mut().enumerate() {
                if !self.law[r].is_decided() {
                    *on = self.initial[r];
                }
            }
        }
        Ok(state)
    }

    /// The states of all ranks.
    fn deal(&self, global: &GlobalState) -> Vec<State> {
        let all = &global.all;
        let some = !all.slid.is_empty();
        let part = |&n: &usize| {
            let slid = vec![0.0; if some { n } else { 0 }];
            all.on_rows(vec![0.0; n], [vec![true; n], vec![true; n]], slid)
        };
        let mut out: Vec<State> = self.owned.iter().map(part).collect();
        let mut next = 0;
        for c in self.local.iter().chain(&self.blocks) {
            out[c.rank].lambda[c.rows()].copy_from_slice(&all.lambda[next..next + c.n]);
            next += c.n;
        }
        let mut next = 0;
        for c in &self.blocks {
            out[c.rank].active[c.rows()].copy_from_slice(&all.active[next..next + c.n]);
            out[c.rank].before[c.rows()].copy_from_slice(&all.before[next..next + c.n]);
            if some {
                out[c.rank].slid[c.rows()].copy_from_slice(&all.slid[next..next + c.n]);
            }
            next += c.n;
        }
        out
    }

    fn fits(&self, global: &GlobalState) -> Result<()> {
        let local = self.local.iter().map(|c| c.n as u64);
        let blocks = self.blocks.iter().map(|c| (c.key, c.n as u64));
        let here = [&self.local, &self.blocks].map(|c| c.iter().map(|c| c.n).sum::<usize>());
        let same =
            local.eq(global.local.iter().copied()) && blocks.eq(global.blocks.iter().copied());
        if !same {
            let n = global.all.active.len();
            return Err(Error::input(format!(
                "the checkpoint is for {} subdomains with {} local and {n} global multipliers, \
                 expected {} with {} and {} numbered alike",
                global.local.len(),
                global.all.lambda.len() - n,
                self.local.len(),
                here[0],
                here[1],
            )));
        }
        if !global.all.mu.is_empty() && global.all.mu.len() != self.r {
            return Err(Error::input(format!(
                "the checkpoint is for bodies with {} rigid motions, expected {}",
                global.all.mu.len(),
                self.r
            )));
        }
        Ok(())
    }
}

/// The values of all ranks on rank 0; empty on the others. Collective.
fn to_first<T: Serialize + DeserializeOwned>(session: &Session, mine: &T) -> Vec<T> {
    let mut outgoing = vec![Vec::new(); session.size()];
    outgoing[0] = to_words(mine);
    let received = exchange_by_rank(session.comm(), outgoing);
    match session.rank() {
        0 => received.iter().map(|words| from_words(words)).collect(),
        _ => Vec::new(),
    }
}

/// Sends each rank its value from rank 0, which has one for every rank. Collective.
pub(super) fn from_first<T: Serialize + DeserializeOwned>(
    session: &Session,
    values: Option<Vec<T>>,
) -> T {
    let outgoing = match values {
        Some(values) => values.iter().map(to_words).collect(),
        None => vec![Vec::new(); session.size()],
    };
    from_words(&exchange_by_rank(session.comm(), outgoing)[0])
}

/// A value as bytes, with zeros at the end.
fn to_words(value: &impl Serialize) -> Vec<u32> {
    let bytes = postcard::to_allocvec(value).expect("numbers, texts and lists have a form");
    pod_collect_to_vec(&bytes)
}

fn from_words<T: DeserializeOwned>(words: &[u32]) -> T {
    postcard::from_bytes(cast_slice(words)).expect("a rank of the same program has sent it")
}
