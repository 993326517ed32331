//! Products AᵀB of rows between bodies, summed over the ranks: a rank gets the rows of the matrix that it has in the
//! factor. Of few columns, and where ranks have copies of a factor, it gets all.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::column_map::ColumnMap;
use super::gram_pattern::GramPattern;
use super::pattern::BlockPattern;
use super::rows::{KernelRows, RowEntry};
use base::linalg::csr::Csr;
use cholesky::team::FactorTeam;
use parallel::exchange::{exchange_by_rank, gather_all, sum_all};

/// Entries on their way to the ranks that have their rows.
pub struct OutgoingEntries<'a> {
    team: &'a FactorTeam,
    known: &'a ColumnMap,
    entries: Vec<Vec<RowEntry>>,
}

/// An entry that another rank has sent.
#[derive(Debug, Clone, Copy)]
pub struct ReceivedEntry {
    /// Its place in the pattern.
    pub entry: usize,
    /// The sender.
    pub rank: usize,
    /// Its value.
    pub value: f64,
}

impl<'a> OutgoingEntries<'a> {
    /// Nothing yet.
    pub fn new(team: &'a FactorTeam, known: &'a ColumnMap) -> OutgoingEntries<'a> {
        let entries = vec![Vec::new(); team.comm().size() as usize];
        OutgoingEntries {
            team,
            known,
            entries,
        }
    }

    /// Adds an entry.
    pub fn add(&mut self, row: u32, column: u32, value: f64) {
        let to = self.team.place(row).rank as usize;
        let [row, col] = [row, column].map(|c| self.known.name(c));
        self.entries[to].push(RowEntry { row, col, value });
    }

    /// Sends them; returns what others have sent to this rank, by increasing rank. Collective.
    pub fn send(self, pattern: &BlockPattern) -> Vec<ReceivedEntry> {
        let mut sent = Vec::new();
        let number = |name: u32| self.known.number(name);
        let received = exchange_by_rank(self.team.comm(), self.entries);
        for (rank, entries) in received.iter().enumerate() {
            sent.extend(entries.iter().map(|e| ReceivedEntry {
                entry: pattern.entry(number(e.row), number(e.col)),
                rank,
                value: e.value,
            }));
        }
        sent
    }
}

impl GramPattern {
    /// The ranks that share factors, if all of them share one: a rank then has some rows of the matrix.
    fn shared(&self) -> Option<&FactorTeam> {
        let team = self.team().map(|team| &**team);
        team.filter(|team| team.is_shared())
    }

    /// AᵀB over the rows that `chosen` selects: the rows of the matrix that this rank has. Others are not to be read.
    /// Collective.
    pub fn product(
        &self,
        comm: &SimpleCommunicator,
        a: &KernelRows,
        b: &KernelRows,
        chosen: impl Fn(usize) -> bool,
    ) -> Csr {
        let mut product = self.pattern.product_here(a, b, chosen);
        let Some(team) = self.shared() else {
            sum_all(comm, &mut product.val);
            return product;
        };
        let mut outgoing = OutgoingEntries::new(team, &self.known);
        for (row, span) in self.pattern.entries().filter(|(row, _)| !team.has(*row)) {
            for k in span.filter(|&k| product.val[k] != 0.0) {
                outgoing.add(row, product.col[k], product.val[k]);
            }
        }
        for sent in outgoing.send(&self.pattern) {
            product.val[sent.entry] += sent.value;
        }
        product
    }

    /// AᵀB, which rounding makes unsymmetric, and its transpose, likewise. Collective.
    pub fn product_and_transpose(
        &self,
        comm: &SimpleCommunicator,
        a: &KernelRows,
        b: &KernelRows,
    ) -> [Csr; 2] {
        let Some(team) = self.shared() else {
            let product = self.product(comm, a, b, |_| true);
            let transpose = transposed(&product);
            return [product, transpose];
        };
        let mut product = self.pattern.product_here(a, b, |_| true);
        let mut transpose = self.pattern.zeros();
        let mut outgoing = [(); 2].map(|()| OutgoingEntries::new(team, &self.known));
        for (row, span) in self.pattern.entries() {
            let own = team.has(row);
            for k in span.filter(|&k| product.val[k] != 0.0) {
                let (column, value) = (product.col[k], product.val[k]);
                if !own {
                    outgoing[0].add(row, column, value);
                }
                if team.has(column) {
                    transpose.val[self.pattern.entry(column, row)] += value
                } else {
                    outgoing[1].add(column, row, value)
                }
            }
        }
        for (outgoing, to) in outgoing.into_iter().zip([&mut product, &mut transpose]) {
            for sent in outgoing.send(&self.pattern) {
                to.val[sent.entry] += sent.value;
            }
        }
        [product, transpose]
    }

    /// All rows of a matrix of which this rank has some, with the names of columns. Collective.
    pub fn gathered(&self, comm: &SimpleCommunicator, a: Csr) -> Csr {
        let Some(team) = self.shared() else {
            return a;
        };
        let mut mine: Vec<RowEntry> = Vec::new();
        for row in team.own_dofs() {
            let (col, val) = a.row(row as usize);
            for (&column, &value) in col.iter().zip(val) {
                let [row, col] = [row, column].map(|c| self.known.name(c));
                mine.push(RowEntry { row, col, value });
            }
        }
        let all = gather_all(comm, &mine).concat();
        let triplets: Vec<_> = all.iter().map(|e| (e.row, e.col, e.value)).collect();
        Csr::from_triplets(self.known.r(), &triplets)
    }
}

/// Aᵀ for a pattern that is symmetric.
pub(super) fn transposed(a: &Csr) -> Csr {
    let mut out = a.clone();
    for i in 0..a.n() {
        for k in a.row_ptr[i]..a.row_ptr[i + 1] {
            out.val[k] = a.get(a.col[k] as usize, i);
        }
    }
    out
}
