//! The sparsity of products AᵀB of rows between bodies: entries where two bodies meet in a row.

use std::ops::Range;

use faer::MatRef;
use mpi::topology::SimpleCommunicator;

use super::rows::KernelRows;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;
use parallel::clock::{self, Phase};
use parallel::exchange::gather_all;

/// The places of the entries of an r × r matrix, block by block: each block belongs to two bodies. A rank may have the
/// rows of some bodies alone; the others are empty there.
#[derive(Debug)]
pub struct BlockPattern {
    /// First column of each body, and the end; length n_bodies + 1.
    start: Vec<usize>,
    /// The body of each column.
    body: Vec<u32>,
    /// For each body, the bodies in its rows of the matrix, increasing, and where the columns of each of these begin in
    /// such a row.
    near: Vec<Vec<(u32, u32)>>,
    row_ptr: Vec<usize>,
    col: Vec<u32>,
}

/// For each body those that it meets in rows of A and of B, which are distributed alike, and itself, increasing.
/// `start` has the first column of each body. The same on every rank. Collective.
pub fn meeting(
    comm: &SimpleCommunicator,
    a: &KernelRows,
    b: &KernelRows,
    start: &[usize],
) -> Vec<Vec<u32>> {
    let n = start.len() - 1;
    let body = body_of_columns(start);
    let mut pairs: Vec<[u32; 2]> = Vec::new();
    for i in 0..a.n() {
        let (left, right) = (a.entries(i).0, b.entries(i).0);
        for p in runs(&body, left) {
            for q in runs(&body, right) {
                pairs.push([body[left[p.start] as usize], body[right[q.start] as usize]]);
            }
        }
        // Rows of one face meet the same bodies.
        if pairs.len() > 1 << 20 {
            pairs = distinct(std::mem::take(&mut pairs));
        }
    }
    let mut lists: Vec<Vec<u32>> = (0..n as u32).map(|k| vec![k]).collect();
    let all = gather_all(comm, &distinct(pairs)).concat();
    clock::timed(Phase::NaturalOrder, || {
        for [a, b] in all {
            lists[a as usize].push(b);
        }
        lists.into_iter().map(distinct).collect()
    })
}

impl BlockPattern {
    /// The pattern with entries for each body and those in its list, which increases and contains the body itself, in
    /// the rows of bodies that are `here`.
    pub fn new(lists: &[Vec<u32>], start: &[usize], here: impl Fn(usize) -> bool) -> BlockPattern {
        let mut pattern = BlockPattern {
            start: start.to_vec(),
            body: body_of_columns(start),
            near: Vec::with_capacity(lists.len()),
            row_ptr: vec![0],
            col: Vec::new(),
        };
        for (k, list) in lists.iter().enumerate() {
            let list: &[u32] = if here(k) { list } else { &[] };
            let mut length = 0;
            let mut near = Vec::with_capacity(list.len());
            for &other in list {
                near.push((other, length));
                length += pattern.columns(other as usize).len() as u32;
            }
            for _ in pattern.columns(k) {
                for &other in list {
                    let columns = pattern.columns(other as usize);
                    pattern.col.extend(columns.map(|c| c as u32));
                }
                pattern.row_ptr.push(pattern.col.len());
            }
            pattern.near.push(near);
        }
        pattern.col.shrink_to_fit();
        pattern
    }

    /// The columns of a body.
    pub fn columns(&self, body: usize) -> Range<usize> {
        self.start[body]..self.start[body + 1]
    }

    /// The first column of a body, or the end.
    pub fn start_of(&self, body: usize) -> usize {
        self.start[body]
    }

    /// Number of bodies.
    pub fn n_bodies(&self) -> usize {
        self.near.len()
    }

    /// The body of each column.
    pub fn bodies(&self) -> &[u32] {
        &self.body
    }

    /// The bodies in the rows of a body.
    pub fn near(&self, body: usize) -> impl Iterator<Item = u32> + '_ {
        self.near[body].iter().map(|n| n.0)
    }

    /// A matrix of zeros.
    pub fn zeros(&self) -> Csr {
        Csr {
            row_ptr: self.row_ptr.clone(),
            col: self.col.clone(),
            val: vec![0.0; self.col.len()],
        }
    }

    /// Adds `block` to the entries of `matrix`, which has this pattern, in the rows of body `a` and the columns of
    /// body `b`.
    ///
    /// # Panics
    /// If the pattern has no such entries.
    pub fn add_block(&self, matrix: &mut Csr, (a, b): (usize, usize), block: MatRef<'_, f64>) {
        let place = self.place(a as u32, b as u32);
        for (i, row) in self.columns(a).enumerate() {
            let first = self.row_ptr[row] + place;
            let entries = &mut matrix.val[first..first + block.ncols()];
            entries
                .iter_mut()
                .enumerate()
                .for_each(|(j, v)| *v += block[(i, j)]);
        }
    }

    /// Whether it has entries for all these bodies in the rows of each body.
    pub fn contains(&self, lists: &[Vec<u32>]) -> bool {
        let has = |a: usize, b: &u32| self.near[a].binary_search_by_key(b, |n| n.0).is_ok();
        lists.len() == self.near.len()
            && lists
                .iter()
                .enumerate()
                .all(|(a, list)| list.iter().all(|b| has(a, b)))
    }

    /// Where the columns of body `b` begin among the entries of a row of body `a`.
    fn place(&self, a: u32, b: u32) -> usize {
        let near = &self.near[a as usize];
        let at = near.binary_search_by_key(&b, |n| n.0);
        near[at.expect("the pattern has the rows")].1 as usize
    }

    /// The place of an entry.
    pub fn entry(&self, row: u32, column: u32) -> usize {
        let of = self.body[column as usize];
        let place = self.place(self.body[row as usize], of);
        self.row_ptr[row as usize] + place + column as usize - self.start[of as usize]
    }

    /// The row of each entry.
    pub fn entries(&self) -> impl Iterator<Item = (u32, Range<usize>)> + '_ {
        let rows = self.row_ptr.windows(2).enumerate();
        let some = rows.filter(|(_, ends)| ends[0] < ends[1]);
        some.map(|(row, ends)| (row as u32, ends[0]..ends[1]))
    }

    /// The column of an entry.
    pub fn column(&self, entry: usize) -> u32 {
        self.col[entry]
    }

    /// This rank's share of AᵀB over the rows that `chosen` selects.
    pub fn product_here(
        &self,
        a: &KernelRows,
        b: &KernelRows,
        chosen: impl Fn(usize) -> bool,
    ) -> Csr {
        let mut product = self.zeros();
        self.add_product(&mut product.val, (a, b), chosen, |_| true);
        product
    }

    /// Adds AᵀB, over the rows that `chosen` selects, to the entries between bodies that are `on`.
    pub fn add_product(
        &self,
        val: &mut [f64],
        (a, b): (&KernelRows, &KernelRows),
        chosen: impl Fn(usize) -> bool,
        on: impl Fn(u32) -> bool,
    ) {
        let mut sum = Dense::default();
        let mut blocks: Vec<(Range<usize>, Range<usize>, [usize; 2])> = Vec::new();
        for (rows, [left, right]) in a.alike(b) {
            // The columns of two bodies; where those of the second begin in a row of the matrix, and the first of them.
            blocks.clear();
            for p in runs(&self.body, left).filter(|p| on(self.body[left[p.start] as usize])) {
                for q in runs(&self.body, right) {
                    let of = self.body[right[q.start] as usize];
                    if on(of) {
                        let place = self.place(self.body[left[p.start] as usize], of);
                        blocks.push((p.clone(), q, [place, self.start[of as usize]]));
                    }
                }
            }
            let mut rows = rows.iter().filter(|&&i| chosen(i as usize)).peekable();
            if blocks.is_empty() || rows.peek().is_none() {
                continue;
            }
            sum.become_zero(right.len(), left.len());
            for &i in rows {
                let (x, y) = (a.entries(i as usize).1, b.entries(i as usize).1);
                for (column, x) in sum.data.chunks_exact_mut(right.len()).zip(x) {
                    column.iter_mut().zip(y).for_each(|(s, y)| *s += x * y);
                }
            }
            for (p, q, [place, first]) in &blocks {
                for k in p.clone() {
                    let row = self.row_ptr[left[k] as usize] + place;
                    let sums = &sum.col(k)[q.clone()];
                    for (&l, s) in right[q.clone()].iter().zip(sums) {
                        val[row + l as usize - first] += s;
                    }
                }
            }
        }
    }

    /// (row, its entries) for the blocks between these bodies, which increase and are here.
    pub fn blocks_between<'a>(
        &'a self,
        bodies: &'a [u32],
    ) -> impl Iterator<Item = (u32, Range<usize>)> + 'a {
        bodies.iter().flat_map(move |&p| {
            let near = self.near[p as usize].iter();
            let near = near.filter(|n| bodies.binary_search(&n.0).is_ok());
            near.flat_map(move |&(q, place)| {
                let width = self.columns(q as usize).len();
                self.columns(p as usize).map(move |row| {
                    let first = self.row_ptr[row] + place as usize;
                    (row as u32, first..first + width)
                })
            })
        })
    }
}

/// The body of each column.
fn body_of_columns(start: &[usize]) -> Vec<u32> {
    let mut body = vec![0u32; *start.last().expect("there is an end")];
    for (k, columns) in start.windows(2).enumerate() {
        body[columns[0]..columns[1]].fill(k as u32);
    }
    body
}

/// The runs of columns that belong to one body.
fn runs<'a>(body: &'a [u32], columns: &'a [u32]) -> impl Iterator<Item = Range<usize>> + 'a {
    let mut end = 0;
    std::iter::from_fn(move || {
        let start = end;
        let of = body[*columns.get(start)? as usize];
        while columns.get(end).is_some_and(|&c| body[c as usize] == of) {
            end += 1;
        }
        Some(start..end)
    })
}
