//! Sparse matrices of a coupled block: B by rows and by columns, and products B W Bᵀ with a diagonal matrix W.

use crate::feti::jump::turn::Turn;
use base::linalg::csr::Csr;

/// An entry below this fraction of the largest of its row does not make the row independent by itself.
pub const FAINT: f64 = 1e-3;

/// B by rows and by columns.
#[derive(Debug)]
pub struct JumpMatrices {
    /// B.
    pub rows: Csr,
    /// Bᵀ.
    pub columns: Csr,
}

impl JumpMatrices {
    /// The rows that dof `j` is in. Rows that may be turned have zeros for dofs that others of their node are in.
    pub fn users(&self, j: usize) -> impl Iterator<Item = usize> + '_ {
        let (rows, values) = self.columns.row(j);
        let entries = rows.iter().zip(values);
        entries.filter(|e| *e.1 != 0.0).map(|e| *e.0 as usize)
    }

    /// Turns two rows, which have the dofs of both.
    pub fn turn(&mut self, turn: &Turn) {
        let [a, b] = turn.rows;
        let dofs = self.rows.row(a).0.to_vec();
        debug_assert_eq!(dofs, self.rows.row(b).0);
        for j in dofs {
            let j = j as usize;
            let turned = turn.of([self.rows.get(a, j), self.rows.get(b, j)]);
            for (r, value) in turn.rows.into_iter().zip(turned) {
                set(&mut self.rows, r, j, value);
                set(&mut self.columns, j, r, value);
            }
        }
    }
}

/// Changes an entry.
fn set(matrix: &mut Csr, row: usize, col: usize, value: f64) {
    let range = matrix.row_ptr[row]..matrix.row_ptr[row + 1];
    let found = matrix.col[range.clone()].binary_search(&(col as u32));
    matrix.val[range][found.expect("an entry of the pattern")] = value;
}

/// Rows of (column, value), repeated columns added up.
pub fn compressed(rows: &[Vec<(u32, f64)>]) -> Csr {
    let mut out = Csr {
        row_ptr: vec![0],
        ..Csr::default()
    };
    for row in rows {
        let mut row = row.clone();
        row.sort_by_key(|e| e.0);
        for equal in row.chunk_by(|a, b| a.0 == b.0) {
            out.col.push(equal[0].0);
            out.val.push(equal.iter().map(|e| e.1).sum());
        }
        out.row_ptr.push(out.col.len());
    }
    out
}

/// Bᵀ for a matrix with this number of columns.
pub fn transposed(b: &Csr, columns: usize) -> Csr {
    let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); columns];
    for r in 0..b.n() {
        let (col, val) = b.row(r);
        let entries = col.iter().zip(val);
        entries.for_each(|(&j, v)| rows[j as usize].push((r as u32, *v)));
    }
    compressed(&rows)
}

/// B Bᵀ with zeros for values, and the whole diagonal.
pub fn product_pattern(b: &Csr, transpose: &Csr) -> Csr {
    let mut out = Csr {
        row_ptr: vec![0],
        ..Csr::default()
    };
    let mut seen = vec![u32::MAX; b.n()];
    for r in 0..b.n() {
        let start = out.col.len();
        let others = b.row(r).0.iter().flat_map(|&j| transpose.row(j as usize).0);
        for &s in others.chain(&[r as u32]) {
            if std::mem::replace(&mut seen[s as usize], r as u32) != r as u32 {
                out.col.push(s);
            }
        }
        out.col[start..].sort_unstable();
        out.row_ptr.push(out.col.len());
    }
    out.val = vec![0.0; out.col.len()];
    out
}

/// out ← B W Bᵀ on the rows in `on`, the identity on the others; `out` has the pattern of the product.
pub fn product(out: &mut Csr, b: &Csr, transpose: &Csr, w: &[f64], on: &[bool]) {
    let mut sums = vec![0.0; b.n()];
    for r in 0..b.n() {
        let range = out.row_ptr[r]..out.row_ptr[r + 1];
        for &s in &out.col[range.clone()] {
            sums[s as usize] = 0.0;
        }
        if on[r] {
            let (col, val) = b.row(r);
            for (&j, v) in col.iter().zip(val).filter(|e| w[*e.0 as usize] != 0.0) {
                let scaled = v * w[j as usize];
                let (rows, others) = transpose.row(j as usize);
                for (&s, u) in rows.iter().zip(others).filter(|e| on[*e.0 as usize]) {
                    sums[s as usize] += scaled * u;
                }
            }
        } else {
            sums[r] = 1.0;
        }
        for k in range {
            out.val[k] = sums[out.col[k] as usize];
        }
    }
}
