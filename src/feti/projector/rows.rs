//! Sparse rows with few columns, such as those of G: one row for every multiplier that this rank owns.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;
use rustc_hash::FxHashMap;

use super::by_column::ByColumn;
use super::column_map::ColumnMap;
use base::linalg::csr::Csr;
use base::linalg::dense::{dot, Dense};
use base::linalg::semidefinite::Semidefinite;
use base::linalg::sorted::distinct;
use bytemuck::{Pod, Zeroable};
use parallel::exchange::sum_all;

/// An entry of which no more than this part is left was along the motions as a whole.
const ALL: f64 = 1e-3;

/// An entry on its way to the rank that owns its row.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct RowEntry {
    /// Global row.
    pub row: u32,
    /// Column.
    pub col: u32,
    /// Value to be added.
    pub value: f64,
}

/// Rows of a matrix with r columns, on the rank that owns them. Columns have their names or their numbers
/// ([`column_map`](super::column_map)).
///
/// Rows with the same columns, such as those of a face between two bodies, are a group. Products go through them group
/// by group: a group reads its columns once, and a row takes the memory of its values and hardly more.
#[derive(Debug, Clone, Default)]
pub struct KernelRows {
    layout: Rc<RowLayout>,
    /// The values of the rows, group after group.
    values: Vec<f64>,
}

/// Where the entries are; matrices that differ in their values share it.
#[derive(Debug, Default)]
struct RowLayout {
    /// Where the values of each row begin, and its group.
    row: Vec<(usize, u32)>,
    groups: Vec<RowGroup>,
    /// The columns of all groups, those of each increasing.
    columns: Vec<u32>,
    /// The rows, group after group.
    order: Vec<u32>,
}

/// Rows with the same columns: where they begin in the lists.
#[derive(Debug, Clone, Copy, Default)]
struct RowGroup {
    columns: usize,
    rows: usize,
    values: usize,
}

impl KernelRows {
    /// From (row, column, value) entries, repeated ones added up.
    pub fn from_triplets(n: usize, entries: Vec<(u32, u32, f64)>) -> KernelRows {
        KernelRows::of_matrix(Csr::from_triplets(n, &entries))
    }

    /// Rows from (row, column, value) entries, repeated ones added up, without entries below `part` of the largest in
    /// their row, each relative to the `scale` of its column: a body that moves across a normal which rounding has
    /// turned a little does no work there. Sums below `part` of their terms are left out, too: a body that touches
    /// itself moves along with what it touches.
    pub fn without_rounding(
        n: usize,
        entries: &[(u32, u32, f64)],
        scale: &[f64],
        part: f64,
    ) -> KernelRows {
        let mut all = Csr::from_triplets(n, entries);
        let sizes = entries.iter().map(|&(i, c, v)| (i, c, v.abs()));
        let sizes = Csr::from_triplets(n, &sizes.collect::<Vec<_>>());
        for (v, size) in all.val.iter_mut().zip(&sizes.val) {
            if v.abs() <= part * size {
                *v = 0.0;
            }
        }
        for i in 0..n {
            let row = all.row_ptr[i]..all.row_ptr[i + 1];
            let columns = &all.col[row.clone()];
            let values = &mut all.val[row];
            let size = |(&c, v): (&u32, &f64)| v.abs() / scale[c as usize];
            let most = columns.iter().zip(&*values).map(size).fold(0.0, f64::max);
            for (c, v) in columns.iter().zip(values) {
                if size((c, v)) <= part * most {
                    *v = 0.0;
                }
            }
        }
        KernelRows::of_matrix(all)
    }

    fn of_matrix(matrix: Csr) -> KernelRows {
        let n = matrix.n();
        let Csr {
            row_ptr: start,
            col,
            val,
        } = matrix.without_zeros();
        let columns_of = |i: usize| &col[start[i]..start[i + 1]];
        // Groups are numbered in the order in which they come.
        let mut layout = RowLayout::default();
        let mut number: FxHashMap<&[u32], u32> = FxHashMap::default();
        let mut sizes: Vec<usize> = Vec::new();
        for i in 0..n {
            let columns = columns_of(i);
            let group = *number.entry(columns).or_insert_with(|| {
                let begin = layout.columns.len();
                layout.columns.extend_from_slice(columns);
                layout.groups.push(RowGroup {
                    columns: begin,
                    ..RowGroup::default()
                });
                sizes.push(0);
                sizes.len() as u32 - 1
            });
            sizes[group as usize] += 1;
            layout.row.push((0, group));
        }
        let (mut before, mut values) = (0, 0);
        layout.groups.push(RowGroup {
            columns: layout.columns.len(),
            ..RowGroup::default()
        });
        for g in 0..layout.groups.len() {
            (layout.groups[g].rows, layout.groups[g].values) = (before, values);
            if let Some(size) = sizes.get(g) {
                before += size;
                values += size * (layout.groups[g + 1].columns - layout.groups[g].columns);
            }
        }
        layout.order = vec![0; n];
        let mut values = vec![0.0; values];
        let mut next = layout.groups.clone();
        for i in 0..n {
            let (at, group) = &mut layout.row[i];
            let next = &mut next[*group as usize];
            *at = next.values;
            layout.order[next.rows] = i as u32;
            let from = start[i]..start[i + 1];
            values[*at..*at + from.len()].copy_from_slice(&val[from.clone()]);
            next.rows += 1;
            next.values += from.len();
        }
        KernelRows {
            layout: layout.into(),
            values,
        }
    }

    /// These rows with the numbers that columns have here in the place of their names.
    pub fn numbered(&self, known: &ColumnMap) -> KernelRows {
        self.renamed(|name| known.number(name))
    }

    /// These rows with the names of columns in the place of their numbers.
    pub fn named(&self, known: &ColumnMap) -> KernelRows {
        self.renamed(|column| known.name(column))
    }

    /// These rows with other numbers for the columns, in the same order.
    fn renamed(&self, name: impl Fn(u32) -> u32) -> KernelRows {
        let old = &*self.layout;
        let layout = RowLayout {
            row: old.row.clone(),
            groups: old.groups.clone(),
            columns: old.columns.iter().map(|&c| name(c)).collect(),
            order: old.order.clone(),
        };
        KernelRows {
            layout: layout.into(),
            values: self.values.clone(),
        }
    }

    /// The entries of row `i`.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (columns, values) = self.entries(i);
        let columns = columns.iter().map(|&c| c as usize);
        columns.zip(values.iter().copied())
    }

    /// The columns and values of row `i`.
    pub fn entries(&self, i: usize) -> (&[u32], &[f64]) {
        let (at, group) = self.layout.row[i];
        let columns = self.layout.columns_of(group as usize);
        (columns, &self.values[at..at + columns.len()])
    }

    /// The columns with entries; some are named several times.
    pub fn columns(&self) -> &[u32] {
        &self.layout.columns
    }

    /// Number of rows.
    pub fn n(&self) -> usize {
        self.layout.row.len()
    }

    /// Aᵀ B for matrices of r columns whose rows are distributed alike, over the rows that `chosen` selects.
    /// Collective.
    pub fn product(
        &self,
        comm: &SimpleCommunicator,
        b: &KernelRows,
        r: usize,
        chosen: impl Fn(usize) -> bool,
    ) -> Dense {
        let mut product = Dense::zeros(r, r);
        for i in (0..self.n()).filter(|&i| chosen(i)) {
            for (p, ap) in self.row(i) {
                for (q, bq) in b.row(i) {
                    product.data[p + q * r] += ap * bq;
                }
            }
        }
        sum_all(comm, &mut product.data);
        product
    }

    /// The groups that have columns: rows, columns, and values row by row.
    fn groups(&self) -> impl Iterator<Item = (&[u32], &[u32], &[f64])> + '_ {
        let all = self.layout.groups.windows(2).enumerate().map(|(g, ends)| {
            let rows = &self.layout.order[ends[0].rows..ends[1].rows];
            let values = &self.values[ends[0].values..ends[1].values];
            (rows, self.layout.columns_of(g), values)
        });
        all.filter(|(_, columns, _)| !columns.is_empty())
    }

    /// The sets of columns that rows have, each increasing.
    pub fn sets(&self) -> impl Iterator<Item = &[u32]> + '_ {
        self.groups().map(|(_, columns, _)| columns)
    }

    /// Rows that have the same columns, in these rows and in those of `other`: their numbers, and both sets of columns.
    pub fn alike<'a>(
        &'a self,
        other: &'a KernelRows,
    ) -> impl Iterator<Item = (&'a [u32], [&'a [u32]; 2])> {
        let group = |&i: &u32| other.layout.row[i as usize].1;
        self.groups().flat_map(move |(rows, columns, _)| {
            let same = rows.chunk_by(move |i, j| group(i) == group(j));
            same.map(move |rows| {
                let of_other = other.layout.columns_of(group(&rows[0]) as usize);
                (rows, [columns, of_other])
            })
        })
    }

    /// out ← out + Aᵀ λ, this rank's share.
    pub fn add_transpose(&self, lambda: &[f64], out: &mut [f64]) {
        let mut sums = Vec::new();
        for (rows, columns, values) in self.groups() {
            sums.clear();
            sums.resize(columns.len(), 0.0);
            for (&i, row) in rows.iter().zip(values.chunks_exact(columns.len())) {
                let l = lambda[i as usize];
                sums.iter_mut().zip(row).for_each(|(s, v)| *s += v * l);
            }
            let both = columns.iter().zip(&sums);
            both.for_each(|(&c, s)| out[c as usize] += s);
        }
    }

    /// λ ← λ + α A x.
    pub fn add(&self, alpha: f64, x: &[f64], lambda: &mut [f64]) {
        let mut here = Vec::new();
        for (rows, columns, values) in self.groups() {
            here.clear();
            here.extend(columns.iter().map(|&c| x[c as usize]));
            for (&i, row) in rows.iter().zip(values.chunks_exact(columns.len())) {
                let sum: f64 = row.iter().zip(&here).map(|(v, x)| v * x).sum();
                lambda[i as usize] += alpha * sum;
            }
        }
    }

    /// Each row without its part along these motions, in the columns that it has: row ← row − V (VᵀV)⁺ Vᵀ row. A motion
    /// counts in a row if a coefficient there is more than rounding of its `largest`; of these coefficients those count
    /// that are more than rounding beside each other. `rounding` is by column.
    #[must_use]
    pub fn across(
        mut self,
        motions: &ByColumn,
        largest: &[f64],
        rounding: impl Fn(u32) -> f64,
    ) -> KernelRows {
        for i in 0..self.n() {
            let (at, group) = self.layout.row[i];
            let columns = self.layout.columns_of(group as usize);
            let row = &mut self.values[at..at + columns.len()];
            let rounding = columns.iter().fold(0.0f64, |a, &c| a.max(rounding(c)));
            let meet = columns.iter().flat_map(|&c| motions.at(c));
            let meet = distinct(meet.map(|e| e.0));
            let mut v: Vec<Vec<f64>> = vec![vec![0.0; columns.len()]; meet.len()];
            for (k, &c) in columns.iter().enumerate() {
                for &(m, x) in motions.at(c) {
                    let place = meet.partition_point(|&other| other < m);
                    v[place][k] = x;
                }
            }
            let mut counts = meet.iter().map(|&m| largest[m as usize]);
            v.retain_mut(|v| {
                let of_motion = counts.next().unwrap_or(0.0);
                let here = v.iter().fold(0.0f64, |a, x| a.max(x.abs()));
                let rounded = v.iter_mut().filter(|x| x.abs() <= rounding * here);
                rounded.for_each(|x| *x = 0.0);
                here > rounding * of_motion
            });
            let mut along: Vec<f64> = v.iter().map(|v| dot(v, row)).collect();
            if along.iter().all(|work| *work == 0.0) {
                continue;
            }
            let gram = Dense::from_fn(v.len(), v.len(), |p, q| dot(&v[p], &v[q]));
            Semidefinite::new(&gram).solve(&mut along);
            let before = row.to_vec();
            for (p, z) in along.iter().enumerate() {
                row.iter_mut().zip(&v[p]).for_each(|(g, x)| *g -= z * x);
            }
            // What is left of an entry that was nothing else is rounding, and scaling by the diagonal would magnify it.
            for (g, was) in row.iter_mut().zip(before) {
                if g.abs() <= ALL * was.abs() {
                    *g = 0.0;
                }
            }
        }
        self
    }

    /// Row i ← q_i · row i.
    pub fn scale_rows(&mut self, q: &[f64]) {
        let layout = &self.layout;
        for (g, ends) in layout.groups.windows(2).enumerate() {
            let columns = layout.columns_of(g).len().max(1);
            let values = &mut self.values[ends[0].values..ends[1].values];
            let rows = &layout.order[ends[0].rows..ends[1].rows];
            for (&i, row) in rows.iter().zip(values.chunks_exact_mut(columns)) {
                row.iter_mut().for_each(|v| *v *= q[i as usize]);
            }
        }
    }
}

impl RowLayout {
    fn columns_of(&self, group: usize) -> &[u32] {
        &self.columns[self.groups[group].columns..self.groups[group + 1].columns]
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/rows.rs"]
mod tests;
