//! S_Π of the bodies: the sum of the subdomains' matrices Σ, formed by the rank that owns the body.

use petsc::PetscInt;
use std::ops::Range;

use mpi::topology::SimpleCommunicator;

use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use parallel::exchange::exchange_by_rank;
use parallel::parcels::Parcels;

/// Blocks of matrices, as ranks send them to the owners of bodies.
#[derive(Debug, Clone, Default)]
pub struct Blocks {
    /// The global numbers of the dofs of each block, and where its entries begin.
    numbers: Parcels<usize, u32>,
    entries: Vec<f64>,
}

impl Blocks {
    /// Blocks with memory for so many entries.
    pub fn with_capacity(entries: usize) -> Blocks {
        Blocks {
            numbers: Parcels::default(),
            entries: Vec::with_capacity(entries),
        }
    }

    /// Adds a block; one without dofs is left out.
    pub fn push(
        &mut self,
        numbers: impl IntoIterator<Item = u32>,
        entries: impl IntoIterator<Item = f64>,
    ) {
        let mut numbers = numbers.into_iter().peekable();
        if numbers.peek().is_some() {
            self.numbers.push(self.entries.len(), numbers);
            self.entries.extend(entries);
        }
    }

    /// The numbers of the dofs of block `k`, and its entries.
    fn get(&self, k: usize) -> (&[u32], &[f64]) {
        let (start, numbers) = self.numbers.get(k);
        let end = if k + 1 < self.numbers.len() {
            self.numbers.get(k + 1).0
        } else {
            self.entries.len()
        };
        (numbers, &self.entries[start..end])
    }

    /// For each block the numbers of its dofs, and its entries.
    pub fn iter(&self) -> impl Iterator<Item = (&[u32], &[f64])> {
        (0..self.numbers.len()).map(|k| self.get(k))
    }

    /// Sends `outgoing[r]` to rank r and returns what every rank sent here. Collective.
    pub fn exchange(comm: &SimpleCommunicator, outgoing: Vec<Blocks>) -> Vec<Blocks> {
        let both = outgoing.into_iter().map(|b| (b.numbers, b.entries));
        let (numbers, entries) = both.unzip();
        let numbers = exchange_by_rank(comm, numbers).into_iter();
        let both = numbers.zip(exchange_by_rank(comm, entries));
        both.map(|(numbers, entries)| Blocks { numbers, entries })
            .collect()
    }
}

/// The blocks of this rank's bodies, and the shifts that regularise them.
#[derive(Debug, Default)]
pub struct PrimalMatrix {
    /// First global number owned by this rank.
    first: usize,
    /// By sender; entries are row by row.
    received: Vec<Blocks>,
    /// The blocks by their first owned dof: (that dof, sender, place). The blocks of a body are consecutive.
    index: Vec<(u32, u32, usize)>,
    /// The diagonal of the sum, by owned dof.
    diagonal: Vec<f64>,
    /// Shifts added to the diagonal.
    shifts: Vec<f64>,
}

/// A subdomain's part: owned dofs, and entries row by row.
type SubdomainBlock<'a> = (Vec<u32>, &'a [f64]);

impl PrimalMatrix {
    /// Sends the blocks; `n` dofs from global number `first` on are owned here. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        outgoing: Vec<Blocks>,
        first: usize,
        n: usize,
    ) -> PrimalMatrix {
        PrimalMatrix::received(Blocks::exchange(comm, outgoing), first, n)
    }

    fn received(received: Vec<Blocks>, first: usize, n: usize) -> PrimalMatrix {
        let mut index = Vec::new();
        for (sender, blocks) in (0..).zip(&received) {
            let firsts = blocks.iter().map(|(numbers, _)| numbers[0] - first as u32);
            index.extend(firsts.zip(0..).map(|(dof, at)| (dof, sender, at)));
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
                diagonal[*i as usize] += value;
            }
        }
        matrix.diagonal = diagonal;
        matrix
    }

    /// Blocks of the body (or bodies) with these owned dofs. Dofs are counted from the first one of the body.
    fn of_body<'a>(&'a self, body: &Range<usize>) -> impl Iterator<Item = SubdomainBlock<'a>> {
        let place = |dof: usize| self.index.partition_point(|b| (b.0 as usize) < dof);
        let offset = (self.first + body.start) as u32;
        let blocks = self.index[place(body.start)..place(body.end)].iter();
        blocks.map(move |&(_, sender, at)| {
            let (numbers, entries) = self.received[sender as usize].get(at);
            let dofs = numbers.iter().map(|&g| g - offset);
            (dofs.collect(), entries)
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
                    out.data[i as usize + j as usize * n] += v;
                }
            }
        }
        self.shifts(body)
            .for_each(|(i, v)| out.data[i + i * n] += v);
        out
    }

    /// S_Π of the body with these owned dofs, sparse.
    pub fn sparse(&self, body: &Range<usize>) -> Csr {
        let (lists, values): (Vec<Vec<u32>>, Vec<&[f64]>) = self.of_body(body).unzip();
        let value = |b: usize, i: usize, j: usize| values[b][i * lists[b].len() + j];
        let mut out = Csr::from_blocks(body.len(), &lists, value);
        for (i, value) in self.shifts(body) {
            let at = out.row(i).0.binary_search(&(i as u32));
            let at = out.row_ptr[i] + at.expect("a primal dof is in some block");
            out.val[at] += value;
        }
        out
    }

    /// All entries as (global row, global column, value); repeated ones are not added up.
    pub fn triplets(&self) -> Vec<(PetscInt, PetscInt, f64)> {
        let first = self.first as PetscInt;
        let mut out = Vec::new();
        for (dofs, values) in self.of_body(&(0..self.shifts.len())) {
            for (&i, row) in dofs.iter().zip(values.chunks_exact(dofs.len())) {
                let entry =
                    |(&j, &v): (&u32, &f64)| (first + i as PetscInt, first + j as PetscInt, v);
                out.extend(dofs.iter().zip(row).map(entry));
            }
        }
        let shifts = self.shifts(&(0..self.shifts.len()));
        out.extend(shifts.map(|(i, v)| (first + i as PetscInt, first + i as PetscInt, v)));
        out
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/primal/matrix.rs"]
mod tests;
