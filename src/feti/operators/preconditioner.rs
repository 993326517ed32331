//! M⁻¹: none, lumped, Dirichlet (M_D) and coarse-corrected Dirichlet (M_C).
//!
//! ```text
//!     lumped      M_L⁻¹ = Z B_D K_ΓΓ B_Dᵀ Z
//!     dirichlet   M_D⁻¹ = Z B_D S̃ B_Dᵀ Z                      [Lee, section 3.1]
//!     corrected   M_C⁻¹ = Z B_D (S̃ − S̃ Z_c (Z_cᵀ S̃ Z_c)⁺ Z_cᵀ S̃) B_Dᵀ Z
//! ```

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;

use super::products::BatchedProducts;
use super::stiffness::Stiffness;
use super::work::{InterfaceBuffers, InterfaceColumns};
use crate::feti::jump::columns::ScaledGhosts;
use crate::feti::lifting::correction::Lifting;
use crate::feti::settings::{PcType, Precision};
use crate::feti::subdomain::problem::LocalProblem;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::Operator;
use crate::substructures::Problem;
use crate::Result;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::linalg::single::Single;
use parallel::exchange::{highest, lowest};
use petsc::Vec as PetscVec;

/// The preconditioner of the dual problem.
pub struct Preconditioner {
    /// Its kind.
    pub kind: PcType,
    /// Z_c, where it is used.
    pub lifting: Option<Lifting>,
    /// K_ΓΓ of each local subdomain in the order of Γ, for the lumped preconditioner.
    k_gamma: Vec<Csr>,
    /// S of each local subdomain in single precision; `None` unless that is asked for and S is a dense matrix. Equal
    /// subdomains share it.
    single: Vec<Option<Arc<Single>>>,
    /// Products with S for subdomains that share it.
    products: BatchedProducts,
    buffers: RefCell<(Vec<InterfaceBuffers>, ScaledGhosts)>,
}

impl Preconditioner {
    /// A preconditioner of the given kind. Only the coarse-corrected one needs `lifting`. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        kind: PcType,
        problem: &Problem,
        stiffness: &Stiffness,
        lifting: Option<Lifting>,
        precision: Precision,
    ) -> Preconditioner {
        let k_gamma = match kind {
            PcType::Lumped => problem
                .local
                .iter()
                .zip(&stiffness.locals)
                .map(|(sub, local)| {
                    sub.k
                        .block(&local.gamma().interface, &local.gamma().interface)
                })
                .collect(),
            _ => Vec::new(),
        };
        let uses_s = matches!(kind, PcType::Dirichlet | PcType::CoarseCorrected);
        let single = match (precision, uses_s) {
            (Precision::Mixed, true) => in_single(comm, stiffness),
            _ => Vec::new(),
        };
        Preconditioner {
            kind,
            lifting,
            k_gamma,
            single,
            products: BatchedProducts::new(&stiffness.locals, |most| stiffness.batches(most)),
            buffers: RefCell::new((stiffness.work(), stiffness.scaled_ghosts())),
        }
    }

    /// Number of local subdomains with S in single precision.
    pub fn in_single(&self) -> usize {
        self.single.iter().flatten().count()
    }

    /// out ← M⁻¹ λ. Collective.
    pub fn apply(&self, stiffness: &Stiffness, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        if self.kind == PcType::None {
            return out.copy_from(lambda);
        }
        let (work, ghost) = &mut *self.buffers.borrow_mut();
        let columns = &stiffness.jump.columns;
        stiffness.fetch_scaled(lambda, ghost)?;
        let (received, kind, k_gamma) = (&*ghost, self.kind, &self.k_gamma);
        let team = &stiffness.team;
        team.for_each(work, |j, w| {
            columns.of(j).bd_transpose(received, &mut w.v); /*   v ← B_Dᵀ λ         */
        });
        let lifting = self.lifting.as_ref();
        // Yᵀ v is sent while S v is computed.
        if let Some(lifting) = lifting {
            lifting.begin(stiffness, work)?;
        }
        match kind {
            PcType::Lumped => team.for_each(work, |j, w| {
                w.y.fill(0.0);
                k_gamma[j].add_mul(1.0, &w.v, &mut w.y); /*   y ← K_ΓΓ v         */
            }),
            _ => self.multiply(stiffness, work), /*           y ← S v            */
        }
        if let Some(lifting) = lifting {
            lifting.finish(stiffness, work, |work| self.multiply(stiffness, work))?;
        }
        ghost.clear();
        for (w, columns) in work.iter().zip(columns.iter()) {
            columns.add_bd(&w.y, ghost); /*                   out ← B_D y        */
        }
        stiffness.sum_scaled(ghost, out)
    }
}

impl Preconditioner {
    /// work.y ← S work.v.
    fn multiply(&self, stiffness: &Stiffness, work: &mut [InterfaceBuffers]) {
        let (team, locals, products) = (&stiffness.team, &stiffness.locals, &self.products);
        let single = &self.single;
        let rounded = |j: usize| single.get(j).and_then(|s| s.as_ref());
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

    /// outs ← M⁻¹ λs. S is read once for all columns, and only for columns that reach the subdomain. Collective.
    pub fn apply_many(
        &self,
        stiffness: &Stiffness,
        lambdas: &[PetscVec],
        outs: &[PetscVec],
    ) -> Result<()> {
        let direct = matches!(self.kind, PcType::Dirichlet | PcType::CoarseCorrected);
        if lambdas.len() == 1 || !direct || !self.single.is_empty() {
            let mut pairs = lambdas.iter().zip(outs);
            return pairs.try_for_each(|(l, out)| self.apply(stiffness, l, out));
        }
        let (_, ghost) = &mut *self.buffers.borrow_mut();
        let (columns, locals) = (&stiffness.jump.columns, &stiffness.locals);
        let room = |local: &ScaledSubdomain| InterfaceColumns {
            v: Dense::zeros(local.gamma().n_gamma(), lambdas.len()),
            y: Dense::zeros(local.gamma().n_gamma(), lambdas.len()),
        };
        let mut blocks: Vec<InterfaceColumns> = locals.iter().map(room).collect();
        for (c, lambda) in lambdas.iter().enumerate() {
            stiffness.fetch_scaled(lambda, ghost)?;
            let received = &*ghost;
            stiffness.team.for_each(&mut blocks, |j, b| {
                columns.of(j).bd_transpose(received, b.v.col_mut(c)); /* v ← B_Dᵀ λ   */
            });
        }
        let multiply = |blocks: &mut [InterfaceColumns]| {
            stiffness.team.for_each(blocks, |j, b| {
                locals[j].apply(Operator::S, &b.v, &mut b.y); /*  y ← S v          */
            });
        };
        multiply(&mut blocks);
        if let Some(lifting) = &self.lifting {
            lifting.finish_many(stiffness, &mut blocks, multiply)?;
        }
        for (c, out) in outs.iter().enumerate() {
            ghost.clear();
            let all = blocks.iter().zip(columns.iter());
            for (b, columns) in all.filter(|(b, _)| !b.y.is_zero(c)) {
                columns.add_bd(b.y.col(c), ghost); /*             out ← B_D y      */
            }
            stiffness.sum_scaled(ghost, out)?;
        }
        Ok(())
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
