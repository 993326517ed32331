//! The entries of B and B_D in the columns of one subdomain, on interface positions, side by side.

use super::coupled::slots::Places;

/// The entries of B and B_D in the columns of one subdomain.
#[derive(Debug, Clone, Default)]
pub struct JumpColumns {
    /// Ghost row of each entry.
    pub row: Vec<u32>,
    /// Interface position (index into Γ) of each entry; the local dof before
    /// [`Jump::place`](super::operator::Jump::place).
    pub at: Vec<u32>,
    /// Entry of Z B; zero where only B_D has one, and in rows that do not hold.
    pub b: Vec<f64>,
    /// Entry of Z B_D; zero in coupled blocks.
    pub bd: Vec<f64>,
    /// (Ghost, interface position) of each dof in a coupled block; (ghost, local dof) before
    /// [`Jump::place`](super::operator::Jump::place).
    pub coupled: Places,
    /// Entries of B_gl: (place in the lists above, value in B whether or not the row holds).
    pub contact: Vec<(u32, f64)>,
}

impl JumpColumns {
    /// Empty lists with room for `n` entries.
    pub(super) fn with_room(n: usize) -> JumpColumns {
        JumpColumns {
            row: Vec::with_capacity(n),
            at: Vec::with_capacity(n),
            b: Vec::with_capacity(n),
            bd: Vec::with_capacity(n),
            contact: Vec::with_capacity(n),
            ..JumpColumns::default()
        }
    }

    /// v ← Bᵀ λ on this subdomain's interface.
    pub fn b_transpose(&self, ghost: &[f64], v: &mut [f64]) {
        v.fill(0.0);
        for ((&r, &i), &b) in self.row.iter().zip(&self.at).zip(&self.b) {
            v[i as usize] += b * ghost[r as usize];
        }
    }

    /// v ← Bᵀ λ with all rows of B_gl, including those that do not hold.
    pub fn b_transpose_all(&self, ghost: &[f64], v: &mut [f64]) {
        self.b_transpose(ghost, v);
        for &(k, full) in &self.contact {
            let k = k as usize;
            v[self.at[k] as usize] += (full - self.b[k]) * ghost[self.row[k] as usize];
        }
    }

    /// ghost ← ghost + B y on the rows of B_gl, including those that do not hold.
    pub fn add_contact(&self, y: &[f64], ghost: &mut [f64]) {
        for &(k, full) in &self.contact {
            let k = k as usize;
            ghost[self.row[k] as usize] += full * y[self.at[k] as usize];
        }
    }

    /// The interface positions that may be in contact, of `n_gamma`: those with an entry of B_gl.
    pub fn between_bodies(&self, n_gamma: usize) -> Vec<bool> {
        let mut out = vec![false; n_gamma];
        let at = self.contact.iter().map(|&(k, _)| self.at[k as usize]);
        at.for_each(|at| out[at as usize] = true);
        out
    }

    /// v ← B_Dᵀ λ on this subdomain's interface.
    pub fn bd_transpose(&self, ghosts: &ScaledGhosts, v: &mut [f64]) {
        self.bd_transpose_of(&ghosts.rows, v, |_| true);
        self.add_coupled(ghosts, v);
    }

    /// v ← B_D,locᵀ λ on this subdomain's interface; `between` says of each ghost row whether it is a row of B_gl.
    pub fn bd_transpose_inside(&self, ghosts: &ScaledGhosts, between: &[bool], v: &mut [f64]) {
        self.bd_transpose_of(&ghosts.rows, v, |r| !between[r]);
    }

    /// v ← B_D,glᵀ λ on this subdomain's interface.
    pub fn bd_transpose_between(&self, ghosts: &ScaledGhosts, between: &[bool], v: &mut [f64]) {
        self.bd_transpose_of(&ghosts.rows, v, |r| between[r]);
        self.add_coupled(ghosts, v);
    }

    fn add_coupled(&self, ghosts: &ScaledGhosts, v: &mut [f64]) {
        for &(slot, at) in &self.coupled {
            v[at as usize] += ghosts.dofs[slot as usize];
        }
    }

    /// v ← B_Dᵀ λ with the ghost rows that `rows` selects.
    fn bd_transpose_of(&self, ghost: &[f64], v: &mut [f64], rows: impl Fn(usize) -> bool) {
        v.fill(0.0);
        for ((&r, &i), &b) in self.row.iter().zip(&self.at).zip(&self.bd) {
            if rows(r as usize) {
                v[i as usize] += b * ghost[r as usize];
            }
        }
    }

    /// ghost ← ghost + B y.
    pub fn add_b(&self, y: &[f64], ghost: &mut [f64]) {
        for ((&r, &i), &b) in self.row.iter().zip(&self.at).zip(&self.b) {
            ghost[r as usize] += b * y[i as usize];
        }
    }

    /// Adds this subdomain's part of B_D y to the ghosts.
    pub fn add_bd(&self, y: &[f64], ghosts: &mut ScaledGhosts) {
        let ghost = &mut ghosts.rows;
        for ((&r, &i), &b) in self.row.iter().zip(&self.at).zip(&self.bd) {
            ghost[r as usize] += b * y[i as usize];
        }
        for &(slot, at) in &self.coupled {
            ghosts.dofs[slot as usize] += y[at as usize];
        }
    }
}

/// What the subdomains of a rank exchange with the owners of multipliers for B_Dᵀ λ and B_D y
/// ([`Stiffness::fetch_scaled`](crate::feti::operators::stiffness::Stiffness::fetch_scaled) and `sum_scaled`).
#[derive(Debug, Clone, Default)]
pub struct ScaledGhosts {
    /// By ghost row: λ, or sums of entries of B_D times y.
    pub rows: Vec<f64>,
    /// By ghost dof of coupled blocks: B_Dᵀ λ, or sums of y.
    pub dofs: Vec<f64>,
}

impl ScaledGhosts {
    /// Sets all to zero.
    pub fn clear(&mut self) {
        self.rows.fill(0.0);
        self.dofs.fill(0.0);
    }
}
