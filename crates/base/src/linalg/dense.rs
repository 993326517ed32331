//! Dense kernels on column-major slices: thin wrappers of faer's, always sequential.
//!
//! Subdomains are the unit of parallel work; a kernel that spawned tasks of its own would fight with them.

use std::ops::{Add, AddAssign, Mul};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    cholesky_in_place, cholesky_in_place_scratch, LltParams, LltRegularization,
};
use faer::linalg::cholesky::llt::inverse::{inverse, inverse_scratch};
use faer::linalg::matmul::triangular::{matmul as triangular_matmul, BlockStructure};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Auto, MatMut, MatRef, Par};

/// A dense matrix by columns, without padding.
#[derive(Debug, Clone, Default)]
pub struct Dense {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub cols: usize,
    /// Entries, column after column; length rows · cols.
    pub data: Vec<f64>,
}

impl Dense {
    /// The zero matrix.
    pub fn zeros(rows: usize, cols: usize) -> Dense {
        Dense {
            rows,
            cols,
            data: vec![0.0; rows * cols],
        }
    }

    /// Becomes the zero matrix of this size, in the memory that it has.
    pub fn become_zero(&mut self, rows: usize, cols: usize) {
        (self.rows, self.cols) = (rows, cols);
        self.data.clear();
        self.data.resize(rows * cols, 0.0);
    }

    /// The lower triangle of the leading square, column by column.
    pub fn lower(&self) -> Vec<f64> {
        let n = self.cols;
        let mut out = Vec::with_capacity(n * (n + 1) / 2);
        (0..n).for_each(|j| out.extend_from_slice(&self.col(j)[j..n]));
        out
    }

    /// The matrix with entries `of(i, j)`.
    pub fn from_fn(rows: usize, cols: usize, of: impl Fn(usize, usize) -> f64) -> Dense {
        let mut out = Dense::zeros(rows, cols);
        for j in 0..cols {
            for (i, entry) in out.col_mut(j).iter_mut().enumerate() {
                *entry = of(i, j);
            }
        }
        out
    }

    /// Column `j`.
    pub fn col(&self, j: usize) -> &[f64] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// Whether column `j` vanishes.
    pub fn is_zero(&self, j: usize) -> bool {
        self.col(j).iter().all(|x| *x == 0.0)
    }

    /// Column `j`, to write.
    pub fn col_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// The entry (i, j).
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.data[i + j * self.rows]
    }

    /// Sets the entry (i, j).
    pub fn set(&mut self, i: usize, j: usize, value: f64) {
        self.data[i + j * self.rows] = value;
    }

    /// The matrix as a faer view.
    pub fn view(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.data, self.rows, self.cols)
    }

    /// The matrix as a mutable faer view.
    pub fn view_mut(&mut self) -> MatMut<'_, f64> {
        MatMut::from_column_major_slice_mut(&mut self.data, self.rows, self.cols)
    }

    /// Copies the lower triangle onto the upper one.
    pub fn mirror_lower(&mut self) {
        let n = self.rows;
        // Copies block by block, which keeps the transposed writes in the cache.
        const BLOCK: usize = 32;
        for jb in (0..n).step_by(BLOCK) {
            for ib in (jb..n).step_by(BLOCK) {
                for j in jb..(jb + BLOCK).min(n) {
                    for i in ib.max(j + 1)..(ib + BLOCK).min(n) {
                        self.data[j + i * n] = self.data[i + j * n];
                    }
                }
            }
        }
    }

    /// A ← (A + Aᵀ) / 2.
    pub fn symmetrise(&mut self) {
        for j in 0..self.cols {
            for i in 0..j {
                let mean = 0.5 * (self.get(i, j) + self.get(j, i));
                self.set(i, j, mean);
                self.set(j, i, mean);
            }
        }
    }

    /// A ← D⁻¹ A D⁻¹, where D² is the diagonal of A, with ones in place of entries that are not positive. Returns 1/D.
    pub fn scale_to_unit_diagonal(&mut self) -> Vec<f64> {
        let diagonal = |i: usize| match self.get(i, i) {
            d if d > 0.0 => 1.0 / d.sqrt(),
            _ => 1.0,
        };
        let scale: Vec<f64> = (0..self.rows).map(diagonal).collect();
        for j in 0..self.cols {
            for i in 0..self.rows {
                self.set(i, j, self.get(i, j) * scale[i] * scale[j]);
            }
        }
        scale
    }

    /// y ← y + A x.
    pub fn add_mul(&self, x: &[f64], y: &mut [f64]) {
        gemv(&self.data, self.rows, x, y);
    }

    /// Y ← Y + A X; zero columns of X are skipped.
    pub fn add_mul_columns(&self, x: &Dense, y: &mut Dense) {
        add_live(self.view(), x, y, |x, y| self.add_mul(x, y));
    }

    /// Y ← Y + Aᵀ X; zero columns of X are skipped.
    pub fn add_mul_transpose_columns(&self, x: &Dense, y: &mut Dense) {
        let a = self.view().transpose();
        add_live(a, x, y, |x, y| self.add_mul_transpose(x, y));
    }

    /// y ← y + Aᵀ x.
    pub fn add_mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        if is_zero(x) {
            return;
        }
        for (j, yj) in y.iter_mut().enumerate().take(self.cols) {
            *yj += dot(self.col(j), x);
        }
    }
}

/// Y ← Y + A X for the columns of X that are not zero; `one` does the same for a single column.
fn add_live(a: MatRef<'_, f64>, x: &Dense, y: &mut Dense, one: impl Fn(&[f64], &mut [f64])) {
    let live: Vec<usize> = (0..x.cols).filter(|&c| !is_zero(x.col(c))).collect();
    if live.len() < 2 {
        live.iter().for_each(|&c| one(x.col(c), y.col_mut(c)));
        return;
    }
    let mut packed = Dense::zeros(x.rows, live.len());
    for (p, &c) in live.iter().enumerate() {
        packed.col_mut(p).copy_from_slice(x.col(c));
    }
    let mut product = Dense::zeros(a.nrows(), live.len());
    multiply(product.view_mut(), false, 1.0, a, packed.view());
    for (p, &c) in live.iter().enumerate() {
        let sums = y.col_mut(c).iter_mut().zip(product.col(p));
        sums.for_each(|(y, p)| *y += p);
    }
}

/// Whether a column is zero. Deflation vectors and coarse columns are nonzero on a few subdomains only.
fn is_zero(x: &[f64]) -> bool {
    x.iter().all(|x| *x == 0.0)
}

/// y ← y + A x for a column-major A with `rows` rows. Four columns are applied at a time, and y is read once for them;
/// columns whose entries in x are zero are not read.
pub fn gemv<T>(a: &[T], rows: usize, x: &[T], y: &mut [T])
where
    T: Copy + Default + PartialEq + AddAssign + Add<Output = T> + Mul<Output = T>,
{
    if rows == 0 {
        return;
    }
    let y = &mut y[..rows];
    let mut columns = a.chunks_exact(4 * rows);
    let mut coefficients = x.chunks_exact(4);
    for (four, c) in (&mut columns).zip(&mut coefficients) {
        if c.iter().all(|v| *v == T::default()) {
            continue;
        }
        let (a0, rest) = four.split_at(rows);
        let (a1, rest) = rest.split_at(rows);
        let (a2, a3) = rest.split_at(rows);
        for i in 0..rows {
            y[i] += (a0[i] * c[0] + a1[i] * c[1]) + (a2[i] * c[2] + a3[i] * c[3]);
        }
    }
    let rest = columns.remainder().chunks_exact(rows);
    for (column, &c) in rest.zip(coefficients.remainder()) {
        for (yi, &ai) in y.iter_mut().zip(column) {
            *yi += ai * c;
        }
    }
}

/// xᵀ y with eight partial sums, which the compiler turns into vector registers.
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (xs, ys) = (x.chunks_exact(8), y[..x.len()].chunks_exact(8));
    let tail: f64 = xs
        .remainder()
        .iter()
        .zip(ys.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in xs.zip(ys) {
        for l in 0..8 {
            sums[l] += a[l] * b[l];
        }
    }
    sums.iter().sum::<f64>() + tail
}

/// A reusable scratch buffer for the kernels below.
#[derive(Default)]
pub struct Scratch {
    buffer: Option<(usize, MemBuffer)>,
}

impl Scratch {
    fn stack(&mut self, bytes: faer::dyn_stack::StackReq) -> &mut MemStack {
        let size = bytes.unaligned_bytes_required();
        if self.buffer.as_ref().is_none_or(|(held, _)| *held < size) {
            self.buffer = Some((size, MemBuffer::new(bytes)));
        }
        let (_, buffer) = self.buffer.as_mut().expect("just filled");
        MemStack::new(buffer)
    }
}

/// The error of a Cholesky factorisation: a pivot was not positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotPositive {
    /// Column of the failing pivot.
    pub index: usize,
}

/// A ← L with A = L Lᵀ, on the lower triangle of the leading `n` × `n` part.
pub fn cholesky(a: MatMut<'_, f64>, scratch: &mut Scratch) -> Result<(), NotPositive> {
    let n = a.nrows();
    let params = <LltParams as Auto<f64>>::auto().into();
    let stack = scratch.stack(cholesky_in_place_scratch::<f64>(n, Par::Seq, params));
    let before = LltRegularization::default();
    cholesky_in_place(a, before, Par::Seq, stack, params)
        .map(|_| ())
        .map_err(
            |faer::linalg::cholesky::llt::factor::LltError::NonPositivePivot { index }| {
                NotPositive { index }
            },
        )
}

/// X ← X L⁻ᵀ for lower triangular L.
pub fn solve_right_transpose(l: MatRef<'_, f64>, x: MatMut<'_, f64>) {
    solve_lower_triangular_in_place(l, x.transpose_mut(), Par::Seq);
}

/// x ← L⁻¹ x.
pub fn solve_lower(l: MatRef<'_, f64>, x: MatMut<'_, f64>) {
    solve_lower_triangular_in_place(l, x, Par::Seq);
}

/// x ← L⁻ᵀ x.
pub fn solve_lower_transpose(l: MatRef<'_, f64>, x: MatMut<'_, f64>) {
    solve_upper_triangular_in_place(l.transpose(), x, Par::Seq);
}

/// C ← β C + α A Aᵀ on the lower triangle of C, β ∈ {0, 1}.
pub fn rank_k_update(c: MatMut<'_, f64>, add: bool, alpha: f64, a: MatRef<'_, f64>) {
    let beta = if add { Accum::Add } else { Accum::Replace };
    triangular_matmul(
        c,
        BlockStructure::TriangularLower,
        beta,
        a,
        BlockStructure::Rectangular,
        a.transpose(),
        BlockStructure::Rectangular,
        alpha,
        Par::Seq,
    );
}

/// C ← β C + α A B, β ∈ {0, 1}.
pub fn multiply(c: MatMut<'_, f64>, add: bool, alpha: f64, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let beta = if add { Accum::Add } else { Accum::Replace };
    faer::linalg::matmul::matmul(c, beta, a, b, alpha, Par::Seq);
}

/// C ← A B in single precision, all stored by columns. A is n × n, B and C are n × cols.
pub fn multiply_single(a: &[f32], b: &[f32], c: &mut [f32], (n, cols): (usize, usize)) {
    let a = MatRef::from_column_major_slice(a, n, n);
    let b = MatRef::from_column_major_slice(b, n, cols);
    let c = MatMut::from_column_major_slice_mut(c, n, cols);
    faer::linalg::matmul::matmul(c, Accum::Replace, a, b, 1.0, Par::Seq);
}

/// (L Lᵀ)⁻¹, both triangles.
pub fn inverse_from_cholesky(l: MatRef<'_, f64>, scratch: &mut Scratch) -> Dense {
    let n = l.nrows();
    let mut out = Dense::zeros(n, n);
    let stack = scratch.stack(inverse_scratch::<f64>(n, Par::Seq));
    inverse(out.view_mut(), l, Par::Seq, stack);
    out.mirror_lower();
    out
}
