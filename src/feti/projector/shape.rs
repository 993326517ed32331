//! The sparsity of GᵀG and the order in which it is factored.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::gram::FEW;
use super::pattern::Pattern;
use crate::cholesky::dissection::part_of_dissection;
use crate::cholesky::symbolic::Symbolic;
use crate::cholesky::team::Team;
use crate::linalg::csr::Csr;
use crate::parallel::clock::{self, Phase};
use crate::parallel::exchange::gather_all;

/// Where GᵀG has entries, and in which order it is factored.
pub struct Shape {
    /// The entries for all candidate rows.
    pub pattern: Pattern,
    /// The order and the ranks that share the factor, if there are many columns.
    team: Option<Rc<Team>>,
}

impl Shape {
    /// The shape of matrices with this pattern; there are to be `copies` of a factor. `home` has the rank of each body,
    /// or nothing if that does not matter. Collective.
    pub fn of(comm: &SimpleCommunicator, pattern: Pattern, copies: usize, home: &[u32]) -> Shape {
        let r = pattern.bodies().len();
        // Whole bodies are ordered: the columns of one are all coupled.
        let team = (r > FEW).then(|| {
            clock::timed(Phase::NaturalOrder, || {
                let graph = pattern.graph();
                let floats = |b: &u32| !pattern.columns(*b as usize).is_empty();
                // What meets more than half of all bodies comes last: no cut would separate it from anything.
                let everywhere = |b: &u32| 2 * graph.row(*b as usize).0.len() > graph.n();
                let (last, floating): (Vec<u32>, Vec<u32>) =
                    (0..graph.n() as u32).filter(floats).partition(everywhere);
                let columns = |b: &u32| pattern.columns(*b as usize).map(|c| c as u32);
                let sets = dissected(comm, &graph, &floating).into_iter();
                let sets = sets.chain((!last.is_empty()).then_some(last));
                let sets: Vec<Vec<u32>> = sets
                    .map(|set| set.iter().flat_map(columns).collect())
                    .collect();
                let symbolic = Symbolic::with_supernodes(&pattern.zeros(), &[], &sets);
                let bodies = pattern.bodies().iter();
                let home: Vec<u32> = match home.is_empty() {
                    true => Vec::new(),
                    false => bodies.map(|&b| home[b as usize]).collect(),
                };
                Team::new(comm, symbolic, copies, &home).into()
            })
        });
        Shape { pattern, team }
    }

    /// The ranks that share factors of this shape, if there are many columns.
    pub fn team(&self) -> Option<&Rc<Team>> {
        self.team.as_ref()
    }
}

/// The nested dissection of these bodies, of which each rank makes a part. Collective.
fn dissected(comm: &SimpleCommunicator, graph: &Csr, bodies: &[u32]) -> Vec<Vec<u32>> {
    let (rank, ranks) = (comm.rank() as usize, comm.size() as usize);
    let mut words: Vec<u64> = Vec::new();
    for set in part_of_dissection(graph, bodies, rank, ranks) {
        words.push(set.len() as u64);
        words.extend(set.iter().map(|&b| u64::from(b)));
    }
    let all = gather_all(comm, &words).concat();
    let (mut rest, mut sets) = (&all[..], Vec::new());
    while let [n, tail @ ..] = rest {
        let (set, tail) = tail.split_at(*n as usize);
        sets.push(set.iter().map(|&b| b as u32).collect());
        rest = tail;
    }
    sets
}
