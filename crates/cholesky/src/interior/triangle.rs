//! The upper triangle of a matrix in the order of elimination, as faer expects it.

use super::order::Elimination;
use base::linalg::csr::Csr;

/// The upper triangle by compressed columns, rows increasing, each entry with its place in the [`Csr`] it comes from.
#[derive(Debug)]
pub struct Triangle {
    /// Start of each column; length n + 1.
    pub ptr: Vec<u32>,
    /// Row of each entry.
    pub row: Vec<u32>,
    source: Vec<usize>,
    /// Place of each diagonal entry in the values, and the shift that is added there: zero in the interior, K_ii on the
    /// interface.
    diagonal: Vec<usize>,
    interior: usize,
    /// The dofs in the order of elimination.
    pub dofs: Vec<u32>,
}

impl Triangle {
    /// The pattern of `k` in the order [interior, interface].
    pub fn new(k: &Csr, order: &Elimination) -> Triangle {
        let dofs = order.dofs();
        let mut place = vec![0u32; k.n()];
        for (p, &i) in dofs.iter().enumerate() {
            place[i as usize] = p as u32;
        }
        let half = k.nnz() / 2 + k.n();
        let mut out = Triangle {
            ptr: vec![0],
            row: Vec::with_capacity(half),
            source: Vec::with_capacity(half),
            diagonal: Vec::with_capacity(k.n()),
            interior: order.interior.len(),
            dofs: Vec::new(),
        };
        let mut column: Vec<(u32, usize)> = Vec::new();
        for (p, &i) in dofs.iter().enumerate() {
            let first = k.row_ptr[i as usize];
            let entries = k.row(i as usize).0.iter().enumerate();
            column.clear();
            column.extend(
                entries
                    .map(|(e, &j)| (place[j as usize], first + e))
                    .filter(|e| e.0 as usize <= p),
            );
            column.sort_unstable();
            out.row.extend(column.iter().map(|e| e.0));
            out.source.extend(column.iter().map(|e| e.1));
            // The diagonal entry is the last of its column.
            out.diagonal.push(out.row.len().wrapping_sub(1));
            out.ptr.push(out.row.len() as u32);
        }
        out.dofs = dofs;
        out
    }

    /// Number of rows.
    pub fn n(&self) -> usize {
        self.dofs.len()
    }

    /// Number of interior rows.
    pub fn n_interior(&self) -> usize {
        self.interior
    }

    /// The values of `k`.
    pub fn values(&self, k: &Csr) -> Vec<f64> {
        self.source.iter().map(|&e| k.val[e]).collect()
    }

    /// The values of K + diag(0, D), and D.
    pub fn shifted(&self, k: &Csr) -> (Vec<f64>, Vec<f64>) {
        let mut values = self.values(k);
        let largest = self.diagonal.iter().map(|&e| values[e]);
        let largest = largest.fold(0.0, f64::max);
        let shift = self.diagonal[self.interior..].iter().map(|&e| {
            // A dof without stiffness may have any shift that is not too small compared with the other shifts.
            let d = if values[e] > 0.0 { values[e] } else { largest };
            values[e] += d;
            d
        });
        let shift = shift.collect();
        (values, shift)
    }

    /// The diagonal of the interior.
    pub fn interior_diagonal<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.diagonal[..self.interior].iter().map(|&e| values[e])
    }

    /// Applies `solve`, which works in the order of elimination, to a vector by dof.
    pub fn solve(&self, x: &mut [f64], solve: impl FnOnce(&mut [f64])) {
        let mut b: Vec<f64> = self.gather(x).collect();
        solve(&mut b);
        self.scatter(&b, x);
    }

    /// The same for several vectors; `solve` gets them in one slice, one after the other.
    pub fn solve_many(&self, x: &mut [Vec<f64>], solve: impl FnOnce(&mut [f64])) {
        if x.is_empty() || self.n() == 0 {
            return;
        }
        let mut b: Vec<f64> = x.iter().flat_map(|x| self.gather(x)).collect();
        solve(&mut b);
        for (x, b) in x.iter_mut().zip(b.chunks_exact(self.n())) {
            self.scatter(b, x);
        }
    }

    fn gather<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.dofs.iter().map(|&i| x[i as usize])
    }

    fn scatter(&self, from: &[f64], x: &mut [f64]) {
        for (&i, &v) in self.dofs.iter().zip(from) {
            x[i as usize] = v;
        }
    }
}
