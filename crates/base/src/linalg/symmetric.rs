//! Symmetric matrices by their lower triangle: this halves the memory, and the data that a product reads.
//!
//! The triangle is stored in squares of 4 × 4, one below the other, column after column: a product reads the matrix as
//! one stream. Each square is used twice while it is in registers: y_I ← y_I + A_IJ x_J and y_J ← y_J + A_IJᵀ x_I.
//! Squares on the diagonal hold both triangles; the last squares are padded with zeros.

use super::dense::{multiply, Dense};

/// Rows and columns of a square: one vector register.
const SIDE: usize = 4;

/// Entries of a square.
const SQUARE: usize = SIDE * SIDE;

/// From this number of vectors on, a matrix-matrix product with both triangles is faster than reading one triangle per
/// vector.
const MANY: usize = 8;

/// A symmetric n × n matrix.
#[derive(Debug, Clone)]
pub struct Symmetric {
    n: usize,
    squares: Vec<[f64; SQUARE]>,
}

impl Symmetric {
    /// The lower triangle of `a`.
    pub fn new(a: &Dense) -> Symmetric {
        let n = a.rows;
        let side = n.div_ceil(SIDE);
        let mut squares = Vec::with_capacity(side * (side + 1) / 2);
        for jb in 0..side {
            let columns = jb * SIDE..n.min((jb + 1) * SIDE);
            for ib in jb..side {
                let rows = ib * SIDE..n.min((ib + 1) * SIDE);
                let mut square = [0.0; SQUARE];
                for (j, to) in columns.clone().zip(square.chunks_exact_mut(SIDE)) {
                    to[..rows.len()].copy_from_slice(&a.col(j)[rows.clone()]);
                    if ib == jb {
                        // The entries above the diagonal mirror those below it.
                        (rows.start..j).for_each(|i| to[i - rows.start] = a.get(j, i));
                    }
                }
                squares.push(square);
            }
        }
        Symmetric { n, squares }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(&self.squares[..])
    }

    /// Entry (i, j).
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        let (ib, jb) = (i / SIDE, j / SIDE);
        let side = self.n.div_ceil(SIDE);
        let before = jb * side - jb * jb.saturating_sub(1) / 2;
        self.squares[before + ib - jb][j % SIDE * SIDE + i % SIDE]
    }

    /// Both triangles.
    pub fn to_dense(&self) -> Dense {
        let mut out = Dense::zeros(self.n, self.n);
        let side = self.n.div_ceil(SIDE);
        let places = (0..side).flat_map(|jb| (jb..side).map(move |ib| (ib, jb)));
        for ((ib, jb), square) in places.zip(&self.squares) {
            let rows = ib * SIDE..self.n.min((ib + 1) * SIDE);
            let columns = jb * SIDE..self.n.min((jb + 1) * SIDE);
            for (j, from) in columns.zip(square.chunks_exact(SIDE)) {
                out.col_mut(j)[rows.clone()].copy_from_slice(&from[..rows.len()]);
            }
        }
        out.mirror_lower();
        out
    }

    /// y ← y + A x.
    pub fn add_mul(&self, x: &[f64], y: &mut [f64]) {
        let mut sum = vec![[0.0; SIDE]; self.n.div_ceil(SIDE)];
        self.add_lots(&lots(x), &mut sum);
        for (y, s) in y.iter_mut().zip(sum.as_flattened()) {
            *y += s;
        }
    }

    /// The first `n` columns of Y ← A X.
    pub fn mul_columns(&self, x: &Dense, y: &mut Dense, n: usize) {
        if n >= MANY {
            let y = y.view_mut().subcols_mut(0, n);
            let x = x.view().subcols(0, n);
            return multiply(y, false, 1.0, self.to_dense().view(), x);
        }
        let mut sum = vec![[0.0; SIDE]; self.n.div_ceil(SIDE)];
        for c in 0..n {
            sum.fill([0.0; SIDE]);
            self.add_lots(&lots(x.col(c)), &mut sum);
            y.col_mut(c).copy_from_slice(&sum.as_flattened()[..self.n]);
        }
    }

    fn add_lots(&self, x: &[TileVector], y: &mut [TileVector]) {
        let mut squares = &self.squares[..];
        for jb in 0..x.len() {
            let (column, rest) = squares.split_at(x.len() - jb);
            squares = rest;
            let factor = x[jb];
            let (diagonal, below) = column.split_first().expect("the square on the diagonal");
            let (y_here, y_below) = y[jb..].split_first_mut().expect("as many as in x");
            for (k, a) in diagonal.chunks_exact(SIDE).enumerate() {
                for i in 0..SIDE {
                    y_here[i] = a[i].mul_add(factor[k], y_here[i]);
                }
            }
            let mut pulled = [[0.0; SIDE]; SIDE];
            for ((square, x), y) in below.iter().zip(&x[jb + 1..]).zip(y_below) {
                for (k, pulled) in pulled.iter_mut().enumerate() {
                    let a = &square[k * SIDE..(k + 1) * SIDE];
                    for i in 0..SIDE {
                        y[i] = a[i].mul_add(factor[k], y[i]);
                        pulled[i] = a[i].mul_add(x[i], pulled[i]);
                    }
                }
            }
            for (y, p) in y_here.iter_mut().zip(pulled) {
                *y += (p[0] + p[1]) + (p[2] + p[3]);
            }
        }
    }
}

/// The entries of a vector that belong to one square.
type TileVector = [f64; SIDE];

/// A vector in lots, padded with zeros.
fn lots(x: &[f64]) -> Vec<TileVector> {
    let lot = |c: &[f64]| std::array::from_fn(|i| c.get(i).copied().unwrap_or(0.0));
    x.chunks(SIDE).map(lot).collect()
}

#[cfg(test)]
#[path = "../../tests/linalg/symmetric.rs"]
mod tests;
