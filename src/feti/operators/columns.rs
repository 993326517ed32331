//! F for several columns at once: the operators of every subdomain are read once for all of them.

use super::stiffness::{Buffers, Stiffness};
use super::work::InterfaceBuffers;
use crate::feti::subdomain::halves::Halfway;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::Result;
use base::linalg::dense::Dense;
use petsc::Vec as PetscVec;

/// The columns of one subdomain.
struct Columns {
    /// Loads on Γ.
    v: Dense,
    /// Displacements on Γ.
    y: Dense,
    /// Coarse values.
    p: Dense,
    half: Halfway,
}

impl Columns {
    fn new(local: &ScaledSubdomain, n: usize) -> Columns {
        let gamma = local.gamma();
        Columns {
            v: Dense::zeros(gamma.n_gamma(), n),
            y: Dense::zeros(gamma.n_gamma(), n),
            p: Dense::zeros(gamma.n_pi(), n),
            half: Halfway::default(),
        }
    }
}

impl Stiffness {
    /// outs ← F λs, several columns at once. `change` may modify the loads Bᵀ λ of each column before S̃⁺ is applied.
    /// Collective.
    pub fn f_mult_many(
        &self,
        lambdas: &[PetscVec],
        outs: &[PetscVec],
        change: impl Fn(&mut [InterfaceBuffers]),
    ) -> Result<()> {
        let Buffers { work, ghost } = &mut *self.buffers.borrow_mut();
        let (columns, locals) = (&self.jump.columns, &self.locals);
        let n = lambdas.len();
        let mut all: Vec<Columns> = locals.iter().map(|l| Columns::new(l, n)).collect();
        for (c, lambda) in lambdas.iter().enumerate() {
            self.dual_halo.fetch(lambda, ghost)?;
            let received = &*ghost;
            self.team.for_each(work, |j, w| {
                columns.of(j).b_transpose(received, &mut w.v); /* v ← Bᵀ λ      */
            });
            change(work);
            for (w, own) in work.iter().zip(&mut all) {
                own.v.col_mut(c).copy_from_slice(&w.v);
            }
        }
        self.team.for_each(&mut all, |j, own| {
            own.half = locals[j].begin_many(&own.v, &mut own.p); /* p ← Ψᵀ v     */
        });
        for c in 0..n {
            let mut coarse = self.sum_begin(all.iter().map(|own| own.p.col(c)))?;
            self.primal_finish(&mut coarse)?; /*                  c ← S_Π⁺ p    */
            for (j, own) in all.iter_mut().enumerate() {
                Self::local_values(&self.space, j, &coarse, own.p.col_mut(c));
            }
        }
        self.team.for_each(&mut all, |j, own| {
            let half = std::mem::take(&mut own.half);
            locals[j].finish_many(half, &own.v, &own.p, &mut own.y); /* y ← T v + Ψ c */
        });
        for (c, out) in outs.iter().enumerate() {
            for (w, own) in work.iter_mut().zip(&all) {
                w.y.copy_from_slice(own.y.col(c));
            }
            self.jump_of(work, out)?; /*                          out ← B y     */
            self.add_compliance(1.0, &lambdas[c], out)?; /*       out ← out + C λ */
        }
        Ok(())
    }
}
