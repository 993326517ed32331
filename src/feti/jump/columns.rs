//! The entries of B and B_D in the columns of each subdomain, on interface positions, side by side.
//!
//! Products with many small subdomains wait for memory. The lists of all subdomains follow each other, so that they are
//! read in one go.

use super::coupled::slots::CoupledDofs;

/// The entries of B and B_D in the columns of the local subdomains, one subdomain after the other.
#[derive(Debug, Clone, Default)]
pub struct JumpEntries {
    /// Where the lists of each subdomain begin, and the end.
    start: Vec<ListStart>,
    row: Vec<u32>,
    at: Vec<u32>,
    b: Vec<f64>,
    bd: Vec<f64>,
    contact: Vec<(u32, f64)>,
    coupled: Vec<CoupledDofs>,
}

/// Where lists begin.
#[derive(Debug, Clone, Copy, Default)]
struct ListStart {
    entries: usize,
    contact: usize,
}

/// An entry of B and B_D.
#[derive(Debug, Clone, Copy)]
pub(super) struct JumpEntry {
    pub row: u32,
    pub at: u32,
    pub b: f64,
    pub bd: f64,
}

/// The entries of B and B_D in the columns of one subdomain.
#[derive(Debug, Clone, Copy)]
pub struct JumpColumns<'a> {
    /// Ghost row of each entry.
    pub row: &'a [u32],
    /// Interface position (index into Γ) of each entry; the local dof before
    /// [`Jump::place`](super::operator::Jump::place).
    pub at: &'a [u32],
    /// Entry of Z B; zero where only B_D has one, and in rows that do not hold.
    pub b: &'a [f64],
    /// Entry of Z B_D; zero in coupled blocks.
    pub bd: &'a [f64],
    /// (Ghost, interface position) of each dof in a coupled block; (ghost, local dof) before
    /// [`Jump::place`](super::operator::Jump::place).
    pub coupled: &'a [(u32, u32)],
    /// Entries of B_gl: (place in the lists above, value in B whether or not the row holds).
    pub contact: &'a [(u32, f64)],
}

impl JumpEntries {
    /// No subdomain yet, and room for `entries` entries, of which `contact` are those of B_gl.
    pub(super) fn with_room(entries: usize, contact: usize) -> JumpEntries {
        JumpEntries {
            start: vec![ListStart::default()],
            row: Vec::with_capacity(entries),
            at: Vec::with_capacity(entries),
            b: Vec::with_capacity(entries),
            bd: Vec::with_capacity(entries),
            contact: Vec::with_capacity(contact),
            coupled: Vec::new(),
        }
    }

    /// Adds an entry to the subdomain that is being listed; returns its place in the lists of that.
    pub(super) fn push(&mut self, entry: JumpEntry) -> u32 {
        self.row.push(entry.row);
        self.at.push(entry.at);
        self.b.push(entry.b);
        self.bd.push(entry.bd);
        let first = self.start.last().map_or(0, |s| s.entries);
        (self.row.len() - 1 - first) as u32
    }

    /// Notes the value in B, whether or not the row holds, of an entry of B_gl.
    pub(super) fn push_contact(&mut self, place: u32, full: f64) {
        self.contact.push((place, full));
    }

    /// Ends the lists of a subdomain.
    pub(super) fn end(&mut self) {
        self.start.push(ListStart {
            entries: self.row.len(),
            contact: self.contact.len(),
        });
    }

    /// Sets the dofs of each subdomain in coupled blocks.
    pub(super) fn couple(&mut self, places: Vec<CoupledDofs>) {
        self.coupled = places;
    }

    /// Replaces the entry of B with place `k` in the lists of subdomain `j`.
    pub(super) fn set_b(&mut self, j: usize, k: usize, value: f64) {
        self.b[self.start[j].entries + k] = value;
    }

    /// Replaces the entry of B_D with place `k` in the lists of subdomain `j`.
    pub(super) fn set_bd(&mut self, j: usize, k: usize, value: f64) {
        self.bd[self.start[j].entries + k] = value;
    }

    /// Replaces the value in B, whether or not the row holds, of the entry with place `k` in the lists of subdomain
    /// `j`.
    pub(super) fn set_full(&mut self, j: usize, k: usize, value: f64) {
        let of = self.start[j].contact..self.start[j + 1].contact;
        let contact = &mut self.contact[of];
        let found = contact.binary_search_by_key(&(k as u32), |c| c.0);
        contact[found.expect("the entry is one of B_gl")].1 = value;
    }

    /// Changes the positions of the entries of subdomain `j`.
    pub(super) fn renumber(&mut self, j: usize, new: impl Fn(u32) -> u32) {
        let of = self.start[j].entries..self.start[j + 1].entries;
        let coupled = self.coupled[j].iter_mut().map(|c| &mut c.1);
        for at in self.at[of].iter_mut().chain(coupled) {
            *at = new(*at);
        }
    }

    /// These entries with more of them at the end of the lists of each subdomain.
    pub(super) fn extended(self, more: &[Vec<JumpEntry>]) -> JumpEntries {
        let n = more.iter().map(Vec::len).sum::<usize>();
        let mut out = JumpEntries::with_room(self.row.len() + n, self.contact.len());
        for (old, more) in self.iter().zip(more) {
            out.row.extend_from_slice(old.row);
            out.at.extend_from_slice(old.at);
            out.b.extend_from_slice(old.b);
            out.bd.extend_from_slice(old.bd);
            for &entry in more {
                out.push(entry);
            }
            out.contact.extend_from_slice(old.contact);
            out.end();
        }
        out.coupled = self.coupled;
        out
    }

    /// The entries of local subdomain `j`.
    pub fn of(&self, j: usize) -> JumpColumns<'_> {
        let (from, to) = (self.start[j], self.start[j + 1]);
        let entries = from.entries..to.entries;
        JumpColumns {
            row: &self.row[entries.clone()],
            at: &self.at[entries.clone()],
            b: &self.b[entries.clone()],
            bd: &self.bd[entries],
            coupled: self.coupled.get(j).map_or(&[], |places| places),
            contact: &self.contact[from.contact..to.contact],
        }
    }

    /// The entries of each local subdomain, one after the other.
    pub fn iter(&self) -> impl Iterator<Item = JumpColumns<'_>> {
        (0..self.start.len().saturating_sub(1)).map(|j| self.of(j))
    }
}

impl JumpColumns<'_> {
    /// v ← Bᵀ λ on this subdomain's interface.
    pub fn b_transpose(&self, ghost: &[f64], v: &mut [f64]) {
        v.fill(0.0);
        for ((&r, &i), &b) in self.row.iter().zip(self.at).zip(self.b) {
            v[i as usize] += b * ghost[r as usize];
        }
    }

    /// v ← Bᵀ λ with all rows of B_gl, including those that do not hold.
    pub fn b_transpose_all(&self, ghost: &[f64], v: &mut [f64]) {
        self.b_transpose(ghost, v);
        for &(k, full) in self.contact {
            let k = k as usize;
            v[self.at[k] as usize] += (full - self.b[k]) * ghost[self.row[k] as usize];
        }
    }

    /// ghost ← ghost + B y on the rows of B_gl, including those that do not hold.
    pub fn add_contact(&self, y: &[f64], ghost: &mut [f64]) {
        for &(k, full) in self.contact {
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
        for &(slot, at) in self.coupled {
            v[at as usize] += ghosts.dofs[slot as usize];
        }
    }

    /// v ← B_Dᵀ λ with the ghost rows that `rows` selects.
    fn bd_transpose_of(&self, ghost: &[f64], v: &mut [f64], rows: impl Fn(usize) -> bool) {
        v.fill(0.0);
        for ((&r, &i), &b) in self.row.iter().zip(self.at).zip(self.bd) {
            if rows(r as usize) {
                v[i as usize] += b * ghost[r as usize];
            }
        }
    }

    /// ghost ← ghost + B y.
    pub fn add_b(&self, y: &[f64], ghost: &mut [f64]) {
        for ((&r, &i), &b) in self.row.iter().zip(self.at).zip(self.b) {
            ghost[r as usize] += b * y[i as usize];
        }
    }

    /// Adds this subdomain's part of B_D y to the ghosts.
    pub fn add_bd(&self, y: &[f64], ghosts: &mut ScaledGhosts) {
        let ghost = &mut ghosts.rows;
        for ((&r, &i), &b) in self.row.iter().zip(self.at).zip(self.bd) {
            ghost[r as usize] += b * y[i as usize];
        }
        for &(slot, at) in self.coupled {
            ghosts.dofs[slot as usize] += y[at as usize];
        }
    }
}

/// The values that the subdomains of a rank exchange with the owners of multipliers for B_Dᵀ λ and B_D y
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
