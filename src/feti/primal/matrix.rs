//! S_Π of the bodies: the sum of the subdomains' matrices Σ, formed by the rank that owns the body.

use std::ops::Range;

use mpi::topology::SimpleCommunicator;

use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use parallel::exchange::exchange_words;

/// Blocks on their way to the ranks that own their bodies: [n, global numbers (n), entries row by row (n²)] of each.
pub struct Outgoing(Vec<Vec<u64>>);

impl Outgoing {
    /// Reserves memory: a number of words for each rank.
    pub fn with_capacity(words: &[usize]) -> Outgoing {
        Outgoing(words.iter().map(|&n| Vec::with_capacity(n)).collect())
    }

    /// Words of a block of order n.
    pub fn words(n: usize) -> usize {
        1 + n + n * n
    }

    /// Adds a block for rank `to`. `numbers` are the global numbers of its rows and columns; a block without any is
    /// left out.
    pub fn push(&mut self, to: usize, numbers: impl Iterator<Item = u32>, block: &Dense) {
        if block.rows == 0 {
            return;
        }
        let words = &mut self.0[to];
        words.push(block.rows as u64);
        words.extend(numbers.map(u64::from));
        for i in 0..block.rows {
            words.extend((0..block.cols).map(|j| block.get(i, j).to_bits()));
        }
    }
}

/// The blocks of this rank's bodies, and the shifts that regularise them.
#[derive(Debug, Default)]
pub struct PrimalMatrix {
    /// First global number owned by this rank.
    first: usize,
    received: Vec<Vec<u64>>,
    /// The blocks by their first owned dof: (that dof, sender, first word). The blocks of a body are consecutive.
    index: Vec<(u32, u32, usize)>,
    /// The diagonal of the sum, by owned dof.
    diagonal: Vec<f64>,
    /// Shifts added to the diagonal.
    shifts: Vec<f64>,
}

/// A subdomain's part: owned dofs, and entries row by row.
type Block<'a> = (Vec<u32>, &'a [u64]);

impl PrimalMatrix {
    /// Sends the blocks; `n` dofs from global number `first` on are owned here. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        outgoing: Outgoing,
        first: usize,
        n: usize,
    ) -> PrimalMatrix {
        PrimalMatrix::received(exchange_words(comm, outgoing.0), first, n)
    }

    fn received(received: Vec<Vec<u64>>, first: usize, n: usize) -> PrimalMatrix {
        let mut index = Vec::new();
        for (sender, words) in (0..).zip(&received) {
            let mut at = 0;
            while at < words.len() {
                index.push((words[at + 1] as u32 - first as u32, sender, at));
                at += Outgoing::words(words[at] as usize);
            }
        }
        index.sort_unstable();
        let mut matrix = PrimalMatrix {
            first,
            received,
            index,
            diagonal: Vec::new(),
            shifts: vec![0.0; n],
        };
        let mut diagonal = vec![0.0; n];
        for (dofs, values) in matrix.of_body(&(0..n)) {
            for (i, value) in dofs.iter().zip(values.iter().step_by(dofs.len() + 1)) {
                diagonal[*i as usize] += f64::from_bits(*value);
            }
        }
        matrix.diagonal = diagonal;
        matrix
    }

    /// Blocks of the body (or bodies) with these owned dofs. Dofs are counted from the first one of the body.
    fn of_body<'a>(&'a self, body: &Range<usize>) -> impl Iterator<Item = Block<'a>> {
        let place = |dof: usize| self.index.partition_point(|b| (b.0 as usize) < dof);
        let offset = (self.first + body.start) as u32;
        let blocks = self.index[place(body.start)..place(body.end)].iter();
        blocks.map(move |&(_, sender, at)| {
            let words = &self.received[sender as usize][at..];
            let n = words[0] as usize;
            let (numbers, tail) = words[1..].split_at(n);
            let dofs = numbers.iter().map(|&g| g as u32 - offset);
            (dofs.collect(), &tail[..n * n])
        })
    }

    /// The sum of the diagonal entries of a body, without the shifts.
    pub fn trace(&self, body: &Range<usize>) -> f64 {
        self.diagonal[body.clone()].iter().sum()
    }

    /// Owned dofs whose diagonal entry is zero, with its shift.
    pub fn slack(&self) -> impl Iterator<Item = usize> + '_ {
        let all = self.diagonal.iter().zip(&self.shifts).enumerate();
        all.filter(|(_, (d, s))| **d + **s == 0.0).map(|(i, _)| i)
    }

    /// Adds to the diagonal entry of an owned dof.
    pub fn shift(&mut self, dof: usize, value: f64) {
        self.shifts[dof] += value;
    }

    fn shifts(&self, body: &Range<usize>) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.shifts[body.clone()].iter().copied().enumerate();
        all.filter(|s| s.1 != 0.0)
    }

    /// S_Π of the body with these owned dofs.
    pub fn dense(&self, body: &Range<usize>) -> Dense {
        let n = body.len();
        let mut out = Dense::zeros(n, n);
        for (dofs, values) in self.of_body(body) {
            for (&i, row) in dofs.iter().zip(values.chunks_exact(dofs.len())) {
                for (&j, v) in dofs.iter().zip(row) {
                    out.data[i as usize + j as usize * n] += f64::from_bits(*v);
                }
            }
        }
        self.shifts(body)
            .for_each(|(i, v)| out.data[i + i * n] += v);
        out
    }

    /// S_Π of the body with these owned dofs, sparse.
    pub fn sparse(&self, body: &Range<usize>) -> Csr {
        let (lists, values): (Vec<Vec<u32>>, Vec<&[u64]>) = self.of_body(body).unzip();
        let value =
            |b: usize, i: usize, j: usize| f64::from_bits(values[b][i * lists[b].len() + j]);
        let mut out = Csr::from_blocks(body.len(), &lists, value);
        for (i, value) in self.shifts(body) {
            let at = out.row(i).0.binary_search(&(i as u32));
            let at = out.row_ptr[i] + at.expect("a primal dof is in some block");
            out.val[at] += value;
        }
        out
    }

    /// All entries as (global row, global column, value); repeated ones are not added up.
    pub fn triplets(&self) -> Vec<(i32, i32, f64)> {
        let first = self.first as i32;
        let mut out = Vec::new();
        for (dofs, values) in self.of_body(&(0..self.shifts.len())) {
            for (&i, row) in dofs.iter().zip(values.chunks_exact(dofs.len())) {
                let entry = |(&j, v): (&u32, &u64)| {
                    (first + i as i32, first + j as i32, f64::from_bits(*v))
                };
                out.extend(dofs.iter().zip(row).map(entry));
            }
        }
        let shifts = self.shifts(&(0..self.shifts.len()));
        out.extend(shifts.map(|(i, v)| (first + i as i32, first + i as i32, v)));
        out
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/primal/matrix.rs"]
mod tests;
