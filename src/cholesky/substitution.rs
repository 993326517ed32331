//! Forward and backward substitution for one right-hand side.
//!
//! Every front works on one dense vector [x; w]: x at its pivots, w at the rows below them. Four columns of the panel
//! are applied together to all rows below them. The vector is read and written once for four columns, the panel is read
//! once.

use super::multifrontal::PartialCholesky;
use super::panel::{self, COLUMNS};

/// Number of partial sums of a product: two vector registers for each column.
const SUMS: usize = 8;

impl PartialCholesky {
    /// Forward elimination: `b` (length n, by dof) becomes [L_II⁻¹ b_I; b_Γ − L_ΓI L_II⁻¹ b_I].
    ///
    /// The interface part is the condensed load g = f_Γ − K_ΓI K_II⁻¹ f_I.
    pub fn forward(&self, b: &mut [f64]) {
        let mut y = self.in_order(b);
        self.lower(&mut y);
        self.by_dof(&y, b);
    }

    /// Back substitution: given [y_I; u_Γ] with y_I from [`forward`](Self::forward), leaves [u_I; u_Γ].
    pub fn backward(&self, b: &mut [f64]) {
        let mut y = self.in_order(b);
        self.upper(&mut y);
        self.by_dof(&y, b);
    }

    /// `b` ← [K_II⁻¹ b_I; 0].
    pub fn solve(&self, b: &mut [f64]) {
        let mut y = self.in_order(b);
        self.lower(&mut y);
        y[self.symbolic.n_interior()..].fill(0.0);
        self.upper(&mut y);
        self.by_dof(&y, b);
    }

    /// y ← [L_II⁻¹ y_I; y_Γ − L_ΓI L_II⁻¹ y_I] in the order of elimination.
    fn lower(&self, y: &mut [f64]) {
        let mut work = Vec::new();
        for front in &self.symbolic.fronts {
            let (width, size) = (front.width(), front.size());
            let panel = &self.panels[front.panel..];
            let (pivots, below) = y[front.start..].split_at_mut(width);
            work.clear();
            work.extend_from_slice(pivots);
            work.resize(size, 0.0);
            eliminate(panel, width, &mut work);
            pivots.copy_from_slice(&work[..width]);
            for (&p, w) in front.below.iter().zip(&work[width..]) {
                below[p as usize - front.end] += w;
            }
        }
    }

    /// y ← [L_II⁻ᵀ (y_I − L_ΓIᵀ y_Γ); y_Γ] in the order of elimination.
    fn upper(&self, y: &mut [f64]) {
        let mut work = Vec::new();
        for front in self.symbolic.fronts.iter().rev() {
            let width = front.width();
            let panel = &self.panels[front.panel..];
            let (pivots, below) = y[front.start..].split_at_mut(width);
            work.clear();
            work.extend_from_slice(pivots);
            let rows = front.below.iter().map(|&p| below[p as usize - front.end]);
            work.extend(rows);
            substitute(panel, width, &mut work);
            pivots.copy_from_slice(&work[..width]);
        }
    }

    fn in_order(&self, b: &[f64]) -> Vec<f64> {
        self.symbolic.dofs().map(|i| b[i as usize]).collect()
    }

    fn by_dof(&self, y: &[f64], b: &mut [f64]) {
        for (y, i) in y.iter().zip(self.symbolic.dofs()) {
            b[i as usize] = *y;
        }
    }
}

/// Column `k` of a group of columns with `rows` entries each.
fn column(group: &[f64], rows: usize, k: usize) -> &[f64] {
    &group[k * rows..(k + 1) * rows]
}

/// x ← L⁻¹ x and w ← w − L_below x for `work` = [x; w] and a panel of `width` columns.
fn eliminate(panel: &[f64], width: usize, work: &mut [f64]) {
    let size = work.len();
    for j in (0..width).step_by(COLUMNS) {
        let (n, rows) = (COLUMNS.min(width - j), size - j);
        let group = &panel[panel::group(j, size)..];
        let inverse = reciprocals(group, rows, n);
        let (x, rest) = work[j..].split_at_mut(n);
        for k in 0..n {
            let l = column(group, rows, k);
            x[k] *= inverse[k];
            for i in k + 1..n {
                x[i] -= l[i] * x[k];
            }
        }
        let below = |k: usize| &column(group, rows, k)[n..];
        if n == COLUMNS {
            let minus = [-x[0], -x[1], -x[2], -x[3]];
            add_columns([below(0), below(1), below(2), below(3)], minus, rest);
        } else {
            for (k, x) in x.iter().enumerate() {
                for (y, l) in rest.iter_mut().zip(below(k)) {
                    *y = (-l).mul_add(*x, *y);
                }
            }
        }
    }
}

/// x ← L⁻ᵀ (x − L_belowᵀ w) for `work` = [x; w].
fn substitute(panel: &[f64], width: usize, work: &mut [f64]) {
    let size = work.len();
    for j in (0..width).step_by(COLUMNS).rev() {
        let (n, rows) = (COLUMNS.min(width - j), size - j);
        let group = &panel[panel::group(j, size)..];
        let (x, rest) = work[j..].split_at_mut(n);
        let below = |k: usize| &column(group, rows, k)[n..];
        if n == COLUMNS {
            let pulled = products([below(0), below(1), below(2), below(3)], rest);
            x.iter_mut().zip(pulled).for_each(|(x, p)| *x -= p);
        } else {
            for (k, x) in x.iter_mut().enumerate() {
                *x -= crate::linalg::dense::dot(below(k), rest);
            }
        }
        let inverse = reciprocals(group, rows, n);
        for k in (0..n).rev() {
            let l = column(group, rows, k);
            let pulled: f64 = (k + 1..n).map(|i| l[i] * x[i]).sum();
            x[k] = (x[k] - pulled) * inverse[k];
        }
    }
}

/// The reciprocals of the `n` pivots of a group, computed first: these divisions do not depend on each other.
fn reciprocals(group: &[f64], rows: usize, n: usize) -> [f64; COLUMNS] {
    let mut out = [0.0; COLUMNS];
    for (k, out) in out.iter_mut().enumerate().take(n) {
        *out = 1.0 / group[k * (rows + 1)];
    }
    out
}

/// A fixed number of entries that are processed together: two vector registers.
type Lot = [f64; SUMS];

fn lot(values: &[f64], at: usize) -> &Lot {
    values[at..at + SUMS].try_into().expect("as long")
}

/// y ← y + Σ x_k column_k, in lots of fixed length, which the compiler vectorises.
fn add_columns([l0, l1, l2, l3]: [&[f64]; COLUMNS], x: [f64; COLUMNS], y: &mut [f64]) {
    let whole = y.len() - y.len() % SUMS;
    for at in (0..whole).step_by(SUMS) {
        let (l0, l1, l2, l3) = (lot(l0, at), lot(l1, at), lot(l2, at), lot(l3, at));
        let y: &mut Lot = (&mut y[at..at + SUMS]).try_into().expect("as long");
        for i in 0..SUMS {
            let first = l1[i].mul_add(x[1], l0[i].mul_add(x[0], y[i]));
            y[i] = l3[i].mul_add(x[3], l2[i].mul_add(x[2], first));
        }
    }
    for i in whole..y.len() {
        y[i] += (l0[i] * x[0] + l1[i] * x[1]) + (l2[i] * x[2] + l3[i] * x[3]);
    }
}

/// The products of four columns with one vector.
fn products([l0, l1, l2, l3]: [&[f64]; COLUMNS], w: &[f64]) -> [f64; COLUMNS] {
    let (mut s0, mut s1, mut s2, mut s3) = ([0.0; SUMS], [0.0; SUMS], [0.0; SUMS], [0.0; SUMS]);
    let whole = w.len() - w.len() % SUMS;
    let add = |sums: &mut Lot, l: &Lot, w: &Lot| {
        for i in 0..SUMS {
            sums[i] = l[i].mul_add(w[i], sums[i]);
        }
    };
    for at in (0..whole).step_by(SUMS) {
        let w = lot(w, at);
        add(&mut s0, lot(l0, at), w);
        add(&mut s1, lot(l1, at), w);
        add(&mut s2, lot(l2, at), w);
        add(&mut s3, lot(l3, at), w);
    }
    let total = |sums: Lot, l: &[f64]| {
        let rest = l[whole..].iter().zip(&w[whole..]);
        sums.iter().sum::<f64>() + rest.map(|(l, w)| l * w).sum::<f64>()
    };
    [total(s0, l0), total(s1, l1), total(s2, l2), total(s3, l3)]
}

#[cfg(test)]
#[path = "../../tests/inside/cholesky/substitution.rs"]
mod tests;
