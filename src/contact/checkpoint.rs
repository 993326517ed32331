//! The state of the outer loop without the ranks: gathered in an order that only the problem decides, and dealt out again to any
//! number of ranks.
//!
//! Rows of B_loc belong to the lowest subdomain of their dof and follow its local dofs; rows of B_gl belong to a block and stand
//! in it as the scene provides them. Neither depends on who owns what, so that (subdomain, position) and (block, position)
//! name a row in every run of the problem:
//!
//! ```text
//!     λ = [ rows of subdomain 0 | rows of subdomain 1 | … | rows of the lowest block | of the next | … ]
//! ```

use std::ops::Range;
use std::path::Path;

use super::state::{Caution, State};
use crate::feti::jump::operator::Jump;
use crate::feti::LinearMethod;
use crate::parallel::exchange::exchange_words;
use crate::petsc::Session;
use crate::substructures::Substructures;
use crate::{Error, Result};

/// A [`State`] with the rows of all ranks in canonical order.
#[derive(Debug, Clone, PartialEq)]
pub struct GlobalState {
    /// Number of rows of B_loc that belong to each subdomain.
    pub local: Vec<u64>,
    /// Blocks of B_gl, increasing, and their numbers of rows.
    pub blocks: Vec<(u64, u64)>,
    /// Multipliers: rows of B_loc, then of B_gl.
    pub lambda: Vec<f64>,
    /// Which rows of B_gl are to hold in the next step.
    pub active: Vec<bool>,
    /// Which of them held in the step before.
    pub before: Vec<bool>,
    /// As [`State::reference`].
    pub reference: f64,
    /// As [`State::steps`].
    pub steps: u64,
    /// As [`State::visited`].
    pub visited: Vec<u64>,
    /// As [`State::caution`].
    pub caution: Caution,
    /// As [`State::mu`].
    pub mu: Vec<f64>,
}

/// Everything that a run needs to go on.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Title of the scene, for messages.
    pub title: String,
    /// Fingerprint of the scene.
    pub scene: u64,
    /// The load step that is under way.
    pub load_step: usize,
    /// What the caller wants to know about the time before this state.
    pub records: String,
    /// Where the load step stands.
    pub state: GlobalState,
}

/// The blocks of the rows that this rank owns: their numbers, and their rows among the owned ones.
pub(super) fn blocks<'a>(
    problem: &'a Substructures,
    jump: &'a Jump,
) -> impl Iterator<Item = (u64, Range<usize>)> + 'a {
    jump.blocks.iter().map(|block| {
        let first = jump.given(block.rows.start);
        (problem.rows[first].block, block.rows.clone())
    })
}

/// Consecutive rows on one rank that stay together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Chunk {
    /// Subdomain or block.
    key: u64,
    rank: usize,
    /// First row among those that the rank owns.
    first: usize,
    rows: usize,
}

/// Who owns which rows: known to rank 0.
#[derive(Debug)]
pub struct Layout {
    /// The owned rows of B_gl.
    contact: Range<usize>,
    /// Z⁰ and whether it may change, on the owned rows.
    initial: Vec<bool>,
    inequality: Vec<bool>,
    /// Length of μ.
    r: usize,
    /// Rows of B_loc by subdomain, of B_gl by block; on rank 0.
    local: Vec<Chunk>,
    blocks: Vec<Chunk>,
    /// (rows, rows of B_loc) that each rank owns; on rank 0.
    owned: Vec<(usize, usize)>,
}

impl Layout {
    /// The layout of this run. Collective.
    pub fn new(solver: &LinearMethod) -> Layout {
        let (session, problem) = (solver.session(), solver.problem());
        let dual = solver.dual();
        let jump = &dual.stiffness.jump;
        // [number of subdomains, (subdomain, rows) …, (block, rows) …]
        let mut mine = vec![problem.local.len() as u64];
        for (sub, ends) in problem.local.iter().zip(jump.local_start.windows(2)) {
            mine.extend([sub.index as u64, (ends[1] - ends[0]) as u64]);
        }
        for (block, rows) in blocks(problem, jump) {
            mine.extend([block, rows.len() as u64]);
        }
        let (mut local, mut contact) = (Vec::new(), Vec::new());
        let mut owned = Vec::new();
        for (rank, words) in to_first(session, mine).into_iter().enumerate() {
            let Some((&subdomains, pairs)) = words.split_first() else {
                continue; // not rank 0
            };
            let (mut first, mut n_local) = (0, 0);
            for (k, pair) in pairs.chunks_exact(2).enumerate() {
                let rows = pair[1] as usize;
                let chunk = Chunk {
                    key: pair[0],
                    rank,
                    first,
                    rows,
                };
                if k < subdomains as usize {
                    local.push(chunk);
                    n_local += rows;
                } else {
                    contact.push(chunk);
                }
                first += rows;
            }
            owned.push((first, n_local));
        }
        local.sort_unstable();
        contact.sort_unstable();
        Layout {
            contact: jump.rows_between_bodies(),
            initial: jump.initial.clone(),
            inequality: jump.inequality.clone(),
            r: dual.natural.r,
            local,
            blocks: contact,
            owned,
        }
    }

    /// The state of all ranks, on rank 0; `None` on the others. Collective.
    pub fn gather(&self, session: &Session, state: &State) -> Option<GlobalState> {
        // One word for each row's λ, one for each contact row's place in the two sets.
        let mut mine: Vec<u64> = state.lambda.iter().map(|l| l.to_bits()).collect();
        let sets = state.active.iter().zip(&state.before);
        let sets = sets.skip(self.contact.start);
        mine.extend(sets.map(|(&now, &was)| u64::from(now) | u64::from(was) << 1));
        let received = to_first(session, mine);
        if session.rank() > 0 {
            return None;
        }
        let chunks = || self.local.iter().chain(&self.blocks);
        let lambda = chunks()
            .flat_map(|c| &received[c.rank][c.first..c.first + c.rows])
            .map(|&word| f64::from_bits(word));
        let sets: Vec<u64> = self
            .blocks
            .iter()
            .flat_map(|c| {
                let words = &received[c.rank];
                // The sets stand behind all λ, without the rows of B_loc.
                let (owned, n_local) = self.owned[c.rank];
                let first = owned + c.first - n_local;
                &words[first..first + c.rows]
            })
            .copied()
            .collect();
        Some(GlobalState {
            local: self.local.iter().map(|c| c.rows as u64).collect(),
            blocks: self.blocks.iter().map(|c| (c.key, c.rows as u64)).collect(),
            lambda: lambda.collect(),
            active: sets.iter().map(|s| s & 1 == 1).collect(),
            before: sets.iter().map(|s| s >> 1 == 1).collect(),
            reference: state.reference,
            steps: state.steps as u64,
            visited: state.visited.clone(),
            caution: state.caution,
            mu: state.mu.clone(),
        })
    }

    /// This rank's part of what rank 0 has read from `file`. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] that names the file if its rows are not those of this run.
    pub fn scatter(
        &self,
        session: &Session,
        file: &Path,
        global: Option<&GlobalState>,
    ) -> Result<State> {
        let fits = match global {
            Some(global) if session.rank() == 0 => self.fits(file, global),
            _ => Ok(()),
        };
        session.agree(fits)?;
        let outgoing = match global {
            Some(global) if session.rank() == 0 => self.deal(global),
            _ => vec![Vec::new(); session.size()],
        };
        let received = exchange_words(session.comm(), outgoing).swap_remove(0);
        Ok(self.unpack(&received))
    }

    /// For every rank: [reference, steps, caution, n visited, n μ, visited, μ, λ of its rows, sets of its contact rows].
    fn deal(&self, global: &GlobalState) -> Vec<Vec<u64>> {
        let mut head = vec![
            global.reference.to_bits(),
            global.steps,
            global.caution as u64,
            global.visited.len() as u64,
            global.mu.len() as u64,
        ];
        head.extend(&global.visited);
        head.extend(global.mu.iter().map(|m| m.to_bits()));
        let owned = self.owned.iter();
        let mut out: Vec<Vec<u64>> = owned
            .map(|(owned, n_local)| {
                let mut words = head.clone();
                words.resize(head.len() + 2 * owned - n_local, 0);
                words
            })
            .collect();
        let mut next = 0;
        for c in self.local.iter().chain(&self.blocks) {
            let at = head.len() + c.first;
            let values = &global.lambda[next..next + c.rows];
            for (word, value) in out[c.rank][at..].iter_mut().zip(values) {
                *word = value.to_bits();
            }
            next += c.rows;
        }
        let mut next = 0;
        for c in &self.blocks {
            let (owned, n_local) = self.owned[c.rank];
            let at = head.len() + owned + c.first - n_local;
            for (k, word) in out[c.rank][at..at + c.rows].iter_mut().enumerate() {
                let (now, was) = (global.active[next + k], global.before[next + k]);
                *word = u64::from(now) | u64::from(was) << 1;
            }
            next += c.rows;
        }
        out
    }

    fn unpack(&self, words: &[u64]) -> State {
        let (head, rest) = words.split_at(5);
        let (visited, rest) = rest.split_at(head[3] as usize);
        let (mu, rest) = rest.split_at(head[4] as usize);
        let (lambda, sets) = rest.split_at(self.initial.len());
        // Equations stay what they are.
        let set = |bit: u64| {
            let mut on = self.initial.clone();
            for (r, word) in self.contact.clone().zip(sets) {
                if self.inequality[r] {
                    on[r] = word >> bit & 1 == 1;
                }
            }
            on
        };
        State {
            lambda: lambda.iter().map(|&l| f64::from_bits(l)).collect(),
            active: set(0),
            before: set(1),
            reference: f64::from_bits(head[0]),
            steps: head[1] as usize,
            visited: visited.to_vec(),
            caution: Caution::ALL[head[2] as usize],
            mu: mu.iter().map(|&m| f64::from_bits(m)).collect(),
        }
    }

    fn fits(&self, file: &Path, global: &GlobalState) -> Result<()> {
        let local = self.local.iter().map(|c| c.rows as u64);
        let blocks = self.blocks.iter().map(|c| (c.key, c.rows as u64));
        let here = [&self.local, &self.blocks].map(|c| c.iter().map(|c| c.rows).sum::<usize>());
        let same =
            local.eq(global.local.iter().copied()) && blocks.eq(global.blocks.iter().copied());
        if !same {
            let n = global.active.len();
            return Err(Error::input(format!(
                "{}: the checkpoint is for {} subdomains with {} local and {n} global multipliers, expected {} with {} and {} numbered alike",
                file.display(),
                global.local.len(),
                global.lambda.len() - n,
                self.local.len(),
                here[0],
                here[1],
            )));
        }
        if !global.mu.is_empty() && global.mu.len() != self.r {
            return Err(Error::input(format!(
                "{}: the checkpoint is for bodies with {} rigid motions, expected {}",
                file.display(),
                global.mu.len(),
                self.r
            )));
        }
        Ok(())
    }
}

/// Every rank's words on rank 0; nothing on the others. Collective.
fn to_first(session: &Session, mine: Vec<u64>) -> Vec<Vec<u64>> {
    let mut outgoing = vec![Vec::new(); session.size()];
    outgoing[0] = mine;
    exchange_words(session.comm(), outgoing)
}
