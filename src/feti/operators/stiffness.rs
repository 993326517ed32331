//! S̃⁺ and F: the FETI-DP solve inside every body (docs/theory.md, section 2).
//!
//! ```text
//!     S̃⁺ v = Σ_j T_j v_j + Ψ S_Π⁺ Ψᵀ v            F = Z (B S̃⁺ Bᵀ + C) Z
//! ```
//!
//! C is the compliance of the rows, a diagonal matrix. It is zero unless a caller puts springs into the rows.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;

use super::coupling::Coupling;
use super::products::BatchedProducts;
use super::springs::Springs;
use super::work::InterfaceBuffers;
use crate::feti::jump::operator::Jump;
use crate::feti::primal::coarse::PrimalProblem;
use crate::feti::primal::refinement::{self, PrimalRefinement};
use crate::feti::primal::space::PrimalSpace;
use crate::feti::subdomain::problem::LocalProblem;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::Operator;
use crate::substructures::Problem;
use crate::Result;
use parallel::halo::Halo;
use parallel::team::Team;
use petsc::{Session, Vec as PetscVec};

/// S̃⁺, which depends on the matrices alone, and the jump operator.
pub struct Stiffness {
    /// The session.
    pub session: Session,
    /// B and B_D.
    pub jump: Jump,
    /// The factored subdomains of this rank.
    pub locals: Vec<ScaledSubdomain>,
    /// Numbering and kernels of the bodies.
    pub space: PrimalSpace,
    /// The bodies' primal problem S_Π with its solver.
    pub primal: PrimalProblem,
    /// Exchanges multipliers between their owners and the ranks of the subdomains.
    pub dual_halo: Halo,
    /// Exchanges the dofs of coupled blocks, where there are any.
    pub(super) coupling: Option<Coupling>,
    /// The threads of this rank.
    pub team: Team,
    /// Products with T for subdomains that share it.
    products: BatchedProducts,
    /// Corrections of S_Π⁺, where coefficients jump inside bodies.
    refinement: Option<PrimalRefinement>,
    /// C; `None` stands for zero.
    springs: Option<Springs>,
    /// By how much nodes give way, by owned row, where there may be springs.
    nodes: Option<Vec<f64>>,
    pub(super) buffers: RefCell<Buffers>,
}

/// Buffers of the products.
#[derive(Default)]
pub(super) struct Buffers {
    /// Of every local subdomain.
    pub work: Vec<InterfaceBuffers>,
    /// Multipliers at this rank's ghosts.
    pub ghost: Vec<f64>,
}

impl Stiffness {
    /// Builds the operator from its parts.
    pub fn new(
        session: &Session,
        jump: Jump,
        locals: Vec<ScaledSubdomain>,
        space: PrimalSpace,
        primal: PrimalProblem,
        dual_halo: Halo,
        team: Team,
    ) -> Result<Stiffness> {
        let buffers = Buffers {
            work: locals.iter().map(InterfaceBuffers::for_subdomain).collect(),
            ghost: vec![0.0; jump.ghosts.len()],
        };
        let products = BatchedProducts::new(&locals, |most| batches(&locals, most));
        let mut out = Stiffness {
            session: session.clone(),
            products,
            coupling: Coupling::new(session, &jump)?,
            jump,
            locals,
            space,
            primal,
            dual_halo,
            team,
            refinement: None,
            springs: None,
            nodes: None,
            buffers: RefCell::new(buffers),
        };
        out.set_compliance(None);
        out.renew_springs();
        Ok(out)
    }

    /// The ranks.
    pub fn comm(&self) -> &SimpleCommunicator {
        self.session.comm()
    }

    /// Makes `refinement` correct S_Π⁺ from now on.
    pub fn refine(&mut self, refinement: PrimalRefinement) {
        self.refinement = Some(refinement);
    }

    /// Whether there are springs in the rows.
    pub fn has_springs(&self) -> bool {
        self.springs.is_some()
    }

    /// Replaces C; `None` gives the rows the compliance that they have of themselves.
    pub(super) fn set_compliance(&mut self, compliance: Option<Vec<f64>>) {
        // All ranks have springs or none has: products with them are collective.
        let own = || self.jump.is_soft.then(|| self.jump.compliance.clone());
        let compliance = compliance.or_else(own);
        self.springs = compliance.map(|c| Springs::new(&self.jump, c));
    }

    /// Adapts what depends on the rows that hold in C. Call it after they have changed.
    pub(super) fn renew_springs(&mut self) {
        if let Some(springs) = &mut self.springs {
            springs.renew(&self.jump, self.nodes.as_deref());
        }
    }

    /// Notes how far nodes give way, for springs in the rows. Collective.
    pub fn know_nodes(&mut self, problem: &Problem) -> Result<()> {
        self.nodes = Some(self.compliance_of_rows(problem)?);
        self.renew_springs();
        Ok(())
    }

    /// C, unless it is zero.
    pub(super) fn springs(&self) -> Option<&Springs> {
        self.springs.as_ref()
    }

    /// q ← (q⁻¹ + C)⁻¹, row by row.
    pub fn add_springs(&self, q: &mut [f64]) {
        if let Some(springs) = &self.springs {
            springs.soften(q);
        }
    }

    /// out ← out + α Z C λ.
    pub fn add_compliance(&self, alpha: f64, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        if let Some(springs) = &self.springs {
            springs.add(&self.jump, alpha, &lambda.array()?, &mut out.array_mut()?);
        }
        Ok(())
    }

    /// Receives the contributions to Ψᵀ v that are under way and applies S_Π⁺. `c` (at this rank's ghosts) has this
    /// rank's contributions on entry and S_Π⁺ of their sum on return. Collective.
    pub(super) fn primal_finish(&self, c: &mut [f64]) -> Result<()> {
        let Some(refinement) = &self.refinement else {
            return self.primal.finish(&self.team, c);
        };
        let b = c.to_vec();
        self.primal.finish(&self.team, c)?;
        for _ in 0..refinement::STEPS {
            let mut r = b.clone();
            refinement.subtract(&self.space, &self.locals, c, &mut r);
            self.primal.solve(&self.team, &mut r)?;
            c.iter_mut().zip(&r).for_each(|(c, r)| *c += r);
        }
        Ok(())
    }

    /// Ψᵀ work.v at this rank's ghosts; starts sending it to the owners. Collective.
    fn coarse_begin(&self, work: &mut [InterfaceBuffers]) -> Result<Vec<f64>> {
        let locals = &self.locals;
        self.team.for_each(work, |j, w| {
            w.half = locals[j].begin(&w.v, &mut w.p); /*  p ← Ψᵀ v       */
        });
        self.sum_begin(work.iter().map(|w| &w.p[..]))
    }

    /// The sum at this rank's ghosts of the coarse values of all local subdomains; starts sending it to the owners.
    /// Collective.
    pub(super) fn sum_begin<'a>(
        &self,
        values: impl Iterator<Item = &'a [f64]>,
    ) -> Result<Vec<f64>> {
        let mut sum = vec![0.0; self.space.ghosts.len()];
        for (p, places) in values.zip(&self.space.of_subdomain) {
            for (&g, p) in places.iter().zip(p) {
                sum[g as usize] += p;
            }
        }
        self.primal.begin(&sum)?;
        Ok(sum)
    }

    /// p ← the coarse values of local subdomain `j`.
    pub(super) fn local_values(space: &PrimalSpace, j: usize, coarse: &[f64], p: &mut [f64]) {
        for (&g, p) in space.of_subdomain[j].iter().zip(p) {
            *p = coarse[g as usize];
        }
    }

    /// work.y ← S̃⁺ work.v on every subdomain. Collective.
    pub fn s_plus(&self, work: &mut [InterfaceBuffers]) -> Result<()> {
        let (locals, space) = (&self.locals, &self.space);
        let mut coarse = self.coarse_begin(work)?; /*     p ← Ψᵀ v       */
        let (team, products) = (&self.team, &self.products);
        let panels = products.multiply(team, locals, work, Operator::T, |j, v, y, n| {
            locals[j].kind().apply(Operator::T, v, y, n)
        });
        let products = products.results(&panels, Operator::T);
        // These products overlap with the messages:
        self.team.for_each(work, |j, w| {
            products.take(j, &locals[j], &mut w.y, |y| {
                if !locals[j].in_halves() {
                    locals[j].apply_one(Operator::T, &w.v, y); /* y ← T v    */
                }
            });
        });
        self.primal_finish(&mut coarse)?; /*              c ← S_Π⁺ p     */
        self.team.for_each(work, |j, w| {
            Self::local_values(space, j, &coarse, &mut w.p);
            if locals[j].in_halves() {
                let half = std::mem::take(&mut w.half);
                locals[j].finish(half, &w.p, &mut w.y); /* y ← T v + Ψ c  */
            } else {
                locals[j].add_psi(&w.p, &mut w.y); /*     y ← y + Ψ c    */
            }
        });
        Ok(())
    }

    /// out ← F λ = B S̃⁺ Bᵀ λ + C λ. Collective.
    pub fn f_mult(&self, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        let Buffers { work, ghost } = &mut *self.buffers.borrow_mut();
        self.dual_halo.fetch(lambda, ghost)?;
        let columns = &self.jump.columns;
        self.team.for_each(work, |j, w| {
            columns.of(j).b_transpose(ghost, &mut w.v); /*   v ← Bᵀ λ       */
        });
        self.s_plus(work)?; /*                            y ← S̃⁺ v       */
        self.jump_of(work, out)?; /*                      out ← B y      */
        self.add_compliance(1.0, lambda, out) /*          out ← out + C λ */
    }

    /// outs ← F λs for the bodies of each colour. λ and F λ of one colour belong to the bodies of that colour alone;
    /// `colour` is that of each local subdomain's body. One product with S̃⁺ serves all colours. Collective.
    pub fn f_mult_coloured(
        &self,
        lambdas: &[PetscVec],
        outs: &[PetscVec],
        colour: &[usize],
    ) -> Result<()> {
        let Buffers { work, ghost } = &mut *self.buffers.borrow_mut();
        let columns = &self.jump.columns;
        for (c, lambda) in lambdas.iter().enumerate() {
            self.dual_halo.fetch(lambda, ghost)?;
            let ghost = &*ghost;
            self.team.for_each(work, |j, w| {
                if colour[j] == c {
                    columns.of(j).b_transpose(ghost, &mut w.v); /* v ← Bᵀ λ */
                }
            });
        }
        self.s_plus(work)?; /*                            y ← S̃⁺ v       */
        for (c, out) in outs.iter().enumerate() {
            ghost.fill(0.0);
            for (j, w) in work.iter().enumerate().filter(|w| colour[w.0] == c) {
                columns.of(j).add_b(&w.y, ghost); /*      out ← B y      */
            }
            self.dual_halo.sum(ghost, out)?;
        }
        Ok(())
    }

    /// out ← B S̃⁺ Bᵀ λ with all rows of B_gl, including those that do not hold. Collective.
    pub fn f_mult_all(&self, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        let Buffers { work, ghost } = &mut *self.buffers.borrow_mut();
        self.dual_halo.fetch(lambda, ghost)?;
        let columns = &self.jump.columns;
        self.team.for_each(work, |j, w| {
            columns.of(j).b_transpose_all(ghost, &mut w.v); /* v ← Bᵀ λ     */
        });
        self.s_plus(work)?; /*                            y ← S̃⁺ v       */
        self.jump_of_all(work, out) /*                    out ← B y      */
    }

    /// The orthogonal projection onto B W̃: out ← B N B_Dᵀ λ on the rows of B_loc, out ← B B_Dᵀ λ on those of B_gl. It
    /// removes redundant multipliers, and multipliers that do no work because functionals are continuous in W̃. N
    /// removes these functionals from the jumps inside bodies. It is not used for B_gl, which acts on weighted averages
    /// of the copies: N does not commute with these averages. Collective.
    pub fn range_projection(&self, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        let work = &mut self.buffers.borrow_mut().work;
        let mut ghosts = self.scaled_ghosts();
        self.fetch_scaled(lambda, &mut ghosts)?;
        let contact = &self.jump.ghost_is_contact;
        let mut inside = vec![0.0; contact.len()];
        let mut between = inside.clone();
        for (j, w) in work.iter_mut().enumerate() {
            let columns = self.jump.columns.of(j);
            columns.bd_transpose_inside(&ghosts, contact, &mut w.y);
            self.locals[j].gamma().basis.remove(&mut w.y); /*     y ← N B_D,locᵀ λ */
            columns.add_b(&w.y, &mut inside); /*          inside ← B y     */
            columns.bd_transpose_between(&ghosts, contact, &mut w.y);
            columns.add_b(&w.y, &mut between); /*         between ← B B_D,glᵀ λ */
        }
        for ((sum, other), contact) in inside.iter_mut().zip(&between).zip(contact) {
            *sum = if *contact { *other } else { *sum };
        }
        self.dual_halo.sum(&inside, out)
    }

    /// The subdomains of this rank in groups of at most `most` that share their operators.
    pub fn batches(&self, most: usize) -> Vec<Vec<usize>> {
        batches(&self.locals, most)
    }

    /// Applies `work` to every batch at once; returns the results by local subdomain.
    pub fn by_batch<T: Send>(
        &self,
        batches: &[Vec<usize>],
        work: impl Fn(&[&ScaledSubdomain], &[usize]) -> Vec<T> + Sync + Send,
    ) -> Vec<T> {
        let locals = &self.locals;
        let of = |b: usize| {
            let members: Vec<&ScaledSubdomain> = batches[b].iter().map(|&j| &locals[j]).collect();
            work(&members, &batches[b])
        };
        let done = self.team.map(batches.len(), of).into_iter().flatten();
        let mut placed: Vec<(usize, T)> = batches.iter().flatten().copied().zip(done).collect();
        placed.sort_unstable_by_key(|(j, _)| *j);
        placed.into_iter().map(|(_, value)| value).collect()
    }

    /// Fresh buffers for all subdomains of this rank.
    pub fn work(&self) -> Vec<InterfaceBuffers> {
        self.locals
            .iter()
            .map(InterfaceBuffers::for_subdomain)
            .collect()
    }
}

fn batches(locals: &[ScaledSubdomain], most: usize) -> Vec<Vec<usize>> {
    let mut kinds: BTreeMap<*const LocalProblem, Vec<usize>> = BTreeMap::new();
    for (j, local) in locals.iter().enumerate() {
        kinds.entry(Arc::as_ptr(local.kind())).or_default().push(j);
    }
    let mut kinds: Vec<Vec<usize>> = kinds.into_values().collect();
    // Addresses differ from run to run.
    kinds.sort_unstable();
    let chunks = kinds.iter().flat_map(|kind| kind.chunks(most));
    chunks.map(<[usize]>::to_vec).collect()
}
