//! F applied to multipliers outside V without reactions at fixing dofs.
//!
//! Each column of W and of Q G by itself pushes floating bodies. S̃⁺ then puts the reaction on one fixing dof, which
//! may lie in the softest corner. The displacements become so large that F P W loses its digits when F W and F Q G X
//! cancel. Forces are therefore balanced in each body:
//!
//! ```text
//!     v ← v − f_i (R_iᵀ f_i)⁺ R_iᵀ v,    f_i = B_iᵀ M_i⁻¹ G_i
//! ```
//!
//! This changes nothing on V, where forces are balanced already. It puts the reaction where the body is stiff.

use super::pencil::Pencil;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::columns::KernelColumns;
use crate::Result;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use parallel::exchange::sum_all;
use petsc::Vec as PetscVec;

/// f_i of all bodies.
#[derive(Default)]
pub struct BalancedOperator {
    /// f on the interface of each local subdomain, n_Γ × defect; empty where its body is held.
    f: Vec<Dense>,
    /// Body of each local subdomain.
    body: Vec<usize>,
    /// R_iᵀ f_i of every body, factored; `None` for bodies that do not float.
    e: Vec<Option<Semidefinite>>,
    /// The kernel columns of every body.
    columns: KernelColumns,
}

impl BalancedOperator {
    /// Allocates the data of all bodies.
    pub fn new(dual: &Dual, bodies: &[usize], n_bodies: usize) -> BalancedOperator {
        BalancedOperator {
            f: vec![Dense::default(); dual.stiffness.locals.len()],
            body: bodies.to_vec(),
            e: (0..n_bodies).map(|_| None).collect(),
            columns: dual.natural.columns.clone(),
        }
    }

    /// Computes f_i of all bodies. Collective.
    pub fn take(&mut self, dual: &Dual, pencil: &Pencil) -> Result<()> {
        let stiffness = &dual.stiffness;
        let defect = |b: usize| self.columns.of(b).len();
        let most = pencil.bodies.iter().map(|&b| defect(b as usize)).max();
        let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
        let mut v = Vec::new();
        for p in 0..most.unwrap_or(0) {
            for (colour, reaction) in pencil.reaction(p)?.iter().enumerate() {
                stiffness.dual_halo.fetch(reaction, &mut ghost)?;
                for (j, f) in self.f.iter_mut().enumerate() {
                    if pencil.colour(j) == colour && p < defect(self.body[j]) {
                        v.clear();
                        v.resize(stiffness.locals[j].gamma().n_gamma(), 0.0);
                        stiffness.jump.columns.of(j).b_transpose(&ghost, &mut v);
                        f.rows = v.len();
                        f.cols = p + 1;
                        f.data.extend(&v);
                    }
                }
            }
        }
        for &b in pencil.bodies.iter().filter(|&&b| defect(b as usize) > 0) {
            let b = b as usize;
            let d = defect(b);
            let mut e = Dense::zeros(d, d);
            for (j, f) in self.f.iter().enumerate().filter(|f| self.body[f.0] == b) {
                let r = &dual.natural.kernels[j];
                for q in 0..d {
                    r.add_mul_transpose(f.col(q), e.col_mut(q));
                }
            }
            sum_all(dual.comm(), &mut e.data);
            self.e[b] = Some(Semidefinite::new(&e));
        }
        Ok(())
    }

    /// ys ← F xs with forces balanced. Collective.
    pub fn f(&self, dual: &Dual, xs: &[PetscVec], ys: &[PetscVec]) -> Result<()> {
        let natural = &dual.natural;
        dual.stiffness.f_mult_many(xs, ys, |work| {
            if natural.r == 0 {
                return;
            }
            let mut load = vec![0.0; natural.r];
            for (j, w) in work.iter().enumerate() {
                let range = self.columns.of(self.body[j]);
                natural.kernels[j].add_mul_transpose(&w.v, &mut load[range]);
            }
            sum_all(dual.comm(), &mut load);
            for (b, e) in self.e.iter().enumerate() {
                let part = &mut load[self.columns.of(b)];
                match e {
                    Some(e) => e.solve(part),
                    None => part.fill(0.0),
                }
            }
            load.iter_mut().for_each(|l| *l = -*l);
            for (j, w) in work.iter_mut().enumerate() {
                let range = self.columns.of(self.body[j]);
                if self.f[j].cols > 0 {
                    self.f[j].add_mul(&load[range], &mut w.v);
                }
            }
        })
    }
}
