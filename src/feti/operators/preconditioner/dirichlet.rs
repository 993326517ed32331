//! The Dirichlet preconditioner M_D⁻¹ = Z B_D S̃ B_Dᵀ Z of \[Lee\] section 3.1, and the products with S that it has in
//! common with the coarse-corrected one.

use std::collections::HashMap;
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;

use super::scaled_jumps::ScaledJumps;
use super::{DualPreconditioner, PreconditionerInput, PreconditionerKind};
use crate::feti::operators::products::BatchedProducts;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::operators::work::{InterfaceBuffers, InterfaceColumns};
use crate::feti::settings::{PcType, Precision};
use crate::feti::subdomain::problem::LocalProblem;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::Operator;
use crate::Result;
use base::linalg::dense::Dense;
use base::linalg::single::Single;
use parallel::exchange::{highest, lowest};
use petsc::Vec as PetscVec;

/// M_D.
pub static DIRICHLET: PreconditionerKind = PreconditionerKind {
    pc_type: PcType::Dirichlet,
    symbol: "M_D",
    needs_s: false,
    floor: Some(1.0),
    set_up: |input| Ok(Box::new(Dirichlet::new(input))),
};

/// M_D, set up.
pub struct Dirichlet {
    /// B_D and B_Dᵀ.
    pub jumps: ScaledJumps,
    /// S of each local subdomain in single precision, if that is asked for; `None` in it where S is no dense matrix, or
    /// rounding would not be safe. Equal subdomains share it.
    single: Option<Vec<Option<Arc<Single>>>>,
    /// Products with S for subdomains that share it.
    products: BatchedProducts,
}

impl Dirichlet {
    /// With S of these subdomains. Collective.
    pub fn new(input: &PreconditionerInput<'_>) -> Dirichlet {
        let stiffness = input.stiffness;
        let mixed = input.settings.precision == Precision::Mixed;
        Dirichlet {
            jumps: ScaledJumps::new(stiffness),
            single: mixed.then(|| in_single(stiffness.comm(), stiffness)),
            products: BatchedProducts::new(&stiffness.locals, |most| stiffness.batches(most)),
        }
    }

    /// work.y ← S work.v; equal subdomains share a product.
    pub fn multiply(&self, stiffness: &Stiffness, work: &mut [InterfaceBuffers]) {
        let (team, locals, products) = (&stiffness.team, &stiffness.locals, &self.products);
        let single = self.single.as_ref();
        let rounded = |j: usize| single.and_then(|s| s[j].as_ref());
        let many = |j: usize, v: &Dense, y: &mut Dense, n: usize| match rounded(j) {
            Some(s) => s.mul_columns(v, y, n),
            None => locals[j].kind().apply(Operator::S, v, y, n),
        };
        let panels = products.multiply(team, locals, work, Operator::S, many);
        let products = products.results(&panels, Operator::S);
        team.for_each(work, |j, w| {
            let v = &w.v;
            products.take(j, &locals[j], &mut w.y, |y| match rounded(j) {
                Some(s) => locals[j].around(v, y, |v, y| s.mul(locals[j].factor, v, y)),
                None => locals[j].apply_one(Operator::S, v, y),
            });
        });
    }

    /// blocks.y ← S blocks.v in double precision. S is read once for all columns, and only for columns that reach the
    /// subdomain.
    pub fn multiply_columns(&self, stiffness: &Stiffness, blocks: &mut [InterfaceColumns]) {
        let locals = &stiffness.locals;
        stiffness.team.for_each(blocks, |j, b| {
            locals[j].apply(Operator::S, &b.v, &mut b.y);
        });
    }

    /// Whether these vectors are better multiplied together than one after the other.
    pub fn takes_columns(&self, lambdas: &[PetscVec]) -> bool {
        lambdas.len() != 1 && self.single.is_none()
    }
}

impl DualPreconditioner for Dirichlet {
    fn kind(&self) -> &'static PreconditionerKind {
        &DIRICHLET
    }

    fn apply(&self, stiffness: &Stiffness, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        self.jumps.apply(stiffness, lambda, out, |work| {
            self.multiply(stiffness, work);
            Ok(())
        })
    }

    fn apply_many(
        &self,
        stiffness: &Stiffness,
        lambdas: &[PetscVec],
        outs: &[PetscVec],
    ) -> Result<()> {
        if !self.takes_columns(lambdas) {
            return self.apply_each(stiffness, lambdas, outs);
        }
        self.jumps.apply_many(stiffness, lambdas, outs, |blocks| {
            self.multiply_columns(stiffness, blocks);
            Ok(())
        })
    }

    fn in_single(&self) -> usize {
        self.single.iter().flatten().flatten().count()
    }
}

/// S is rounded to single precision if its condition number on Δ, estimated from below by max T_ii max S_ii, is less
/// than this. The softest motions then keep two digits.
const ROUNDABLE: f64 = 1e5;

/// S is not rounded either if the stiffness of subdomains differs by a larger factor. The rounding of rigid motions of
/// stiff subdomains would be large beside soft ones.
const ALIKE: f64 = 1e3;

/// S of every local subdomain in single precision, where that is safe. Collective.
fn in_single(comm: &SimpleCommunicator, stiffness: &Stiffness) -> Vec<Option<Arc<Single>>> {
    let each = stiffness.locals.iter().map(ScaledSubdomain::stiffness);
    let (low, high) = each.fold((f64::INFINITY, 0.0f64), |(l, h), s| (l.min(s), h.max(s)));
    if highest(comm, high) > ALIKE * lowest(comm, low) {
        return vec![None; stiffness.locals.len()];
    }
    let mut known: HashMap<*const LocalProblem, Arc<Single>> = HashMap::new();
    let of = |local: &ScaledSubdomain| {
        if local.is_implicit() || local.kind().condition() > ROUNDABLE {
            return None;
        }
        let entry = known.entry(Arc::as_ptr(local.kind()));
        let single = entry.or_insert_with(|| Arc::new(Single::new(&local.kind().s())));
        Some(single.clone())
    };
    stiffness.locals.iter().map(of).collect()
}
