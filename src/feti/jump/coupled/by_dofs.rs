//! B_D where G = B D⁻¹ Bᵀ would cost digits: a large singular matrix and a small regular one.
//!
//! B_Dᵀ λ is the smallest v in the norm of D with B v = λ. Most rows have dofs p for themselves, with coefficients c.
//! The others are solved for as many of the dofs z that rows share, with a small dense matrix wherever such rows meet.
//! Free values y of the other shared dofs remain:
//!
//! ```text
//!     z = T y + L λ_c,      v_p = D_p⁻¹ cᵀ E (λ_o − M z),      E = (c D_p⁻¹ cᵀ)⁻¹
//!     y = A⁻¹ Hᵀ W ([λ_o; 0] − [M; I] L λ_c),      H = [M; I] T,   W = diag(E, D_z),   A = Hᵀ W H
//! ```
//!
//! λ_o and M belong to rows with own dofs, λ_c to the others. E is diagonal, and T is the identity if all rows have own
//! dofs. B v = λ holds to rounding, whatever A⁻¹ is: that is what G does not give.

use std::sync::Arc;

use super::elimination::GeneralSolution;
use super::pattern::{compressed, product, product_pattern, transposed, JumpMatrices, FAINT};
use crate::feti::jump::coupled::elimination;
use base::linalg::csr::Csr;
use cholesky::multifrontal::PartialCholesky;
use cholesky::symbolic::Symbolic;

/// B_D for a set of independent rows.
#[derive(Debug)]
pub struct ByDofs {
    /// D⁻¹.
    inverse: Vec<f64>,
    /// The rows with own dofs, c on them, and E.
    with_own: Vec<u32>,
    own: Csr,
    stiffness: Vec<f64>,
    /// The dofs z, and M on (rows with own dofs, z).
    shared: Vec<u32>,
    m: Csr,
    /// The other rows, and L on (z, these rows).
    others: Vec<u32>,
    l: Csr,
    /// T on (z, y).
    t: Csr,
    /// H, W and the factor of A.
    h: Csr,
    w: Vec<f64>,
    factor: PartialCholesky,
}

impl ByDofs {
    /// The operator for these rows. `None` if too many rows without own dofs meet.
    pub fn new(b: &JumpMatrices, weights: &[f64], kept: &[bool]) -> Option<ByDofs> {
        let n_dofs = b.columns.n();
        let rows = || (0..kept.len()).filter(|&r| kept[r]);
        let mut users = vec![0u32; n_dofs];
        for r in rows() {
            entries_of(b, r).for_each(|(j, _)| users[j as usize] += 1);
        }
        let has_own = |&r: &usize| {
            let entries = || entries_of(b, r).map(|(j, v)| (j, v.abs()));
            let largest = entries().fold(0.0f64, |a, e| a.max(e.1));
            entries().any(|(j, v)| users[j as usize] == 1 && v > FAINT * largest)
        };
        let (with_own, others): (Vec<usize>, Vec<usize>) = rows().partition(has_own);
        // The place of each dof among the shared ones.
        let mut place = vec![u32::MAX; n_dofs];
        let mut is_own = vec![false; n_dofs];
        for (j, _) in with_own.iter().flat_map(|&r| entries_of(b, r)) {
            is_own[j as usize] |= users[j as usize] == 1;
        }
        let is_shared = |&j: &usize| users[j] > 0 && !is_own[j];
        let shared: Vec<u32> = (0..n_dofs).filter(is_shared).map(|j| j as u32).collect();
        for (at, &j) in (0..).zip(&shared) {
            place[j as usize] = at;
        }
        let part = |list: &[usize], of_own: bool| {
            let row = |&r: &usize| {
                let chosen = entries_of(b, r).filter(|e| is_own[e.0 as usize] == of_own);
                let at = |j: u32| if of_own { j } else { place[j as usize] };
                chosen.map(|(j, v)| (at(j), v)).collect()
            };
            compressed(&list.iter().map(row).collect::<Vec<Vec<_>>>())
        };
        let (own, m) = (part(&with_own, true), part(&with_own, false));
        let of_shared: Vec<f64> = shared.iter().map(|&j| weights[j as usize]).collect();
        let GeneralSolution { t, l } = elimination::solve(&part(&others, false), &of_shared)?;
        let inverse: Vec<f64> = weights.iter().map(|w| 1.0 / w).collect();
        let softness = |i: usize| -> f64 {
            let (col, val) = own.row(i);
            let terms = col.iter().zip(val);
            terms.map(|(&j, v)| v * v * inverse[j as usize]).sum()
        };
        let stiffness: Vec<f64> = (0..own.n()).map(|i| 1.0 / softness(i)).collect();
        let h = below(&m, &t);
        let w: Vec<f64> = stiffness.iter().chain(&of_shared).copied().collect();
        let free = shared.len() - others.len();
        let across = transposed(&h, free);
        let mut a = product_pattern(&across, &h);
        product(&mut a, &across, &h, &w, &vec![true; free]);
        let symbolic = Arc::new(Symbolic::new(&a, &[], None));
        // A is positive definite: no pivot vanishes but by rounding.
        let (factor, _) = PartialCholesky::semidefinite(&a, symbolic, 0.0);
        let numbers = |list: Vec<usize>| list.into_iter().map(|r| r as u32).collect();
        Some(ByDofs {
            inverse,
            with_own: numbers(with_own),
            own,
            stiffness,
            shared,
            m,
            others: numbers(others),
            l,
            t,
            h,
            w,
            factor,
        })
    }

    /// v ← B_Dᵀ λ.
    pub fn lift(&self, lambda: &[f64], v: &mut [f64]) {
        let pick =
            |list: &[u32]| -> Vec<f64> { list.iter().map(|&r| lambda[r as usize]).collect() };
        let mut left = pick(&self.with_own);
        let mut z = vec![0.0; self.shared.len()];
        self.l.add_mul(1.0, &pick(&self.others), &mut z);
        // [λ_o; 0] − [M; I] L λ_c
        let mut s = left.clone();
        self.m.add_mul(-1.0, &z, &mut s);
        s.extend(z.iter().map(|z| -z));
        s.iter_mut().zip(&self.w).for_each(|(s, w)| *s *= w);
        let mut y = vec![0.0; self.free()];
        self.h.add_mul_transpose(1.0, &s, &mut y);
        self.factor.solve(&mut y);
        self.t.add_mul(1.0, &y, &mut z);
        self.m.add_mul(-1.0, &z, &mut left);
        left.iter_mut()
            .zip(&self.stiffness)
            .for_each(|(l, e)| *l *= e);
        v.fill(0.0);
        self.own.add_mul_transpose(1.0, &left, v);
        v.iter_mut().zip(&self.inverse).for_each(|(v, d)| *v *= d);
        self.shared
            .iter()
            .zip(&z)
            .for_each(|(&j, z)| v[j as usize] = *z);
    }

    /// λ ← B_D y: the transpose, step by step.
    pub fn collect(&self, y: &[f64], lambda: &mut [f64]) {
        let own: Vec<f64> = y.iter().zip(&self.inverse).map(|(y, d)| y * d).collect();
        let mut w_own = vec![0.0; self.with_own.len()];
        self.own.add_mul(1.0, &own, &mut w_own);
        w_own
            .iter_mut()
            .zip(&self.stiffness)
            .for_each(|(w, e)| *w *= e);
        let mut q: Vec<f64> = self.shared.iter().map(|&j| y[j as usize]).collect();
        self.m.add_mul_transpose(-1.0, &w_own, &mut q);
        let mut a = vec![0.0; self.free()];
        self.t.add_mul_transpose(1.0, &q, &mut a);
        self.factor.solve(&mut a);
        let mut s = vec![0.0; self.w.len()];
        self.h.add_mul(1.0, &a, &mut s);
        s.iter_mut().zip(&self.w).for_each(|(s, w)| *s *= w);
        let (of_rows, of_shared) = s.split_at(w_own.len());
        self.m.add_mul_transpose(-1.0, of_rows, &mut q);
        q.iter_mut().zip(of_shared).for_each(|(q, s)| *q -= s);
        let mut of_others = vec![0.0; self.others.len()];
        self.l.add_mul_transpose(1.0, &q, &mut of_others);
        lambda.fill(0.0);
        let rows = self.with_own.iter().zip(w_own.iter().zip(of_rows));
        rows.for_each(|(&r, (w, s))| lambda[r as usize] = w + s);
        let rows = self.others.iter().zip(&of_others);
        rows.for_each(|(&r, l)| lambda[r as usize] = *l);
    }

    /// Number of free values.
    fn free(&self) -> usize {
        self.shared.len() - self.others.len()
    }
}

/// The dofs of row `r` with their coefficients.
fn entries_of(b: &JumpMatrices, r: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
    let (col, val) = b.rows.row(r);
    let entries = col.iter().copied().zip(val.iter().copied());
    entries.filter(|e| e.1 != 0.0)
}

/// [M; I] T.
fn below(m: &Csr, t: &Csr) -> Csr {
    let row_of = |col: &[u32], val: &[f64]| -> Vec<(u32, f64)> {
        let scaled = |(&z, v): (&u32, &f64)| {
            let (col, val) = t.row(z as usize);
            let v = *v;
            col.iter().zip(val).map(move |(&y, t)| (y, v * t))
        };
        col.iter().zip(val).flat_map(scaled).collect()
    };
    let above = (0..m.n()).map(|r| {
        let (col, val) = m.row(r);
        row_of(col, val)
    });
    let rows = above.chain((0..t.n()).map(|z| row_of(&[z as u32], &[1.0])));
    compressed(&rows.collect::<Vec<_>>())
}
