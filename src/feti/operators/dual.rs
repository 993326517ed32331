//! F, M⁻¹ and P of one problem, for the rows that hold.
//!
//! They are immutable except for Z^k. The rows that hold change between the steps of the contact loop, and with them G
//! and some blocks of B_D. Nothing that depends on K changes.

use mpi::topology::SimpleCommunicator;

use crate::feti::jump::turn::Turn;
use crate::feti::operators::preconditioner::DualPreconditioner;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::projector::natural::NaturalCoarse;
use crate::substructures::Problem;
use crate::Result;
use parallel::exchange::total;
use petsc::{Event, Scope, Vec as PetscVec};

/// F, M⁻¹ and P. Vectors of multipliers have one entry for each row of B that this rank owns.
pub struct Dual {
    /// S̃⁺, B and F.
    pub stiffness: Stiffness,
    /// M⁻¹.
    pub preconditioner: Box<dyn DualPreconditioner>,
    /// G and P.
    pub natural: NaturalCoarse,
    /// Whether G belongs to an earlier set of rows.
    stale: bool,
    events: [Event; 5],
    like: PetscVec,
}

impl Dual {
    /// Builds the operators. Collective.
    pub fn new(
        stiffness: Stiffness,
        preconditioner: Box<dyn DualPreconditioner>,
        natural: NaturalCoarse,
    ) -> Result<Dual> {
        let like = PetscVec::mpi(&stiffness.session, stiffness.jump.n_owned)?;
        let event = |name| Event::register(&stiffness.session, name);
        Ok(Dual {
            events: [
                event("FetiFetiF")?,
                event("FetiFetiM")?,
                event("FetiFetiP")?,
                event("FetiFetiResid")?,
                event("FetiFetiCertify")?,
            ],
            stale: false,
            like,
            stiffness,
            preconditioner,
            natural,
        })
    }

    /// Changes Z^k to `active` (one per owned row): blocks of B_D where rows changed, and G, are computed again.
    /// Returns the number of rows that changed over all ranks, and whether G has changed. Collective.
    pub(crate) fn set_active(
        &mut self,
        problem: &Problem,
        active: &[bool],
    ) -> Result<(usize, bool)> {
        let session = self.stiffness.session.clone();
        let changed = self.stiffness.jump.set_active(session.comm(), active);
        let changed = total(session.comm(), changed as f64);
        let renewed = changed > 0.0 || self.stale;
        if renewed {
            // Until all has been renewed: an error must not leave operators of two sets.
            self.stale = true;
            self.stiffness.renew_springs();
            let (stiffness, preconditioner) = (&self.stiffness, self.preconditioner.as_ref());
            self.natural.renew(problem, stiffness, preconditioner)?;
            self.stale = false;
        }
        Ok((changed as usize, renewed))
    }

    /// Turns rows of this rank in B_gl, B_D and B R. What is derived from them is renewed with the next set.
    /// Collective.
    pub(crate) fn turn(&mut self, problem: &Problem, turns: &[Turn]) {
        let session = self.stiffness.session.clone();
        self.stiffness.jump.turn(session.comm(), turns);
        self.natural.turned(problem, &self.stiffness);
        self.stale = true;
    }

    /// Marks everything derived from the set of rows as outdated: it is renewed with the next set, whether or not that
    /// is another one.
    pub(crate) fn outdate(&mut self) {
        self.stale = true;
    }

    /// Changes Z^k in B and B_D alone and leaves G as it is. This is enough for M⁻¹ in a face of a bound-constrained
    /// problem. Collective.
    pub(crate) fn set_face(&mut self, free: &[bool]) {
        let Stiffness { session, jump, .. } = &mut self.stiffness;
        jump.set_active(session.comm(), free);
        self.stiffness.renew_springs();
        self.stale = true;
    }

    /// Replaces the compliance C of the rows in F; `None` makes all rows rigid. What is derived from F is renewed with
    /// the next set of rows. Collective.
    pub(crate) fn set_compliance(&mut self, compliance: Option<Vec<f64>>) {
        self.stiffness.set_compliance(compliance);
        self.stale = true;
    }

    /// The ranks.
    pub fn comm(&self) -> &SimpleCommunicator {
        self.stiffness.comm()
    }

    /// A zero vector of multipliers.
    pub fn multipliers(&self) -> Result<PetscVec> {
        self.like.duplicate()
    }

    /// y ← F x.
    pub fn f(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let _timed = self.events[0].scope()?;
        self.stiffness.f_mult(x, y)
    }

    /// ys ← F xs, several columns at once. Collective.
    pub fn f_many(&self, xs: &[PetscVec], ys: &[PetscVec]) -> Result<()> {
        let _timed = self.events[0].scope()?;
        self.stiffness.f_mult_many(xs, ys, |_| {})
    }

    /// y ← M⁻¹ x; with springs in the rows y ← (Π M⁻¹ Πᵀ + X) x.
    pub fn m(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let _timed = self.events[1].scope()?;
        let Some(springs) = self.stiffness.springs() else {
            return self.preconditioner.apply(&self.stiffness, x, y);
        };
        let reduced = self.multipliers()?;
        reduced.copy_from(x)?;
        springs.reduce(&mut reduced.array_mut()?);
        self.preconditioner.apply(&self.stiffness, &reduced, y)?;
        springs.complete(&x.array()?, &mut y.array_mut()?);
        Ok(())
    }

    /// ys ← M⁻¹ xs, several columns at once. Collective.
    pub fn m_many(&self, xs: &[PetscVec], ys: &[PetscVec]) -> Result<()> {
        let _timed = self.events[1].scope()?;
        self.preconditioner.apply_many(&self.stiffness, xs, ys)
    }

    /// y ← R x with the orthogonal projection R onto range B; with springs in the rows y ← (R + X C (I − R)) x, which
    /// keeps the multipliers without forces that springs feel. Collective.
    pub fn off_kernel(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.stiffness.range_projection(x, y)?;
        if let Some(springs) = self.stiffness.springs() {
            springs.put_back(&x.array()?, &mut y.array_mut()?);
        }
        Ok(())
    }

    /// The transpose of [`off_kernel`](Self::off_kernel): y ← (R + (I − R) C X) x. Collective.
    pub fn off_kernel_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.stiffness.range_projection(x, y)?;
        if let Some(springs) = self.stiffness.springs() {
            let (felt, inside) = (self.multipliers()?, self.multipliers()?);
            springs.felt(&x.array()?, &mut felt.array_mut()?);
            self.stiffness.range_projection(&felt, &inside)?;
            y.axpy(1.0, &felt)?;
            y.axpy(-1.0, &inside)?;
        }
        Ok(())
    }

    /// x ← P x.
    pub fn p(&self, x: &PetscVec) -> Result<()> {
        let _timed = self.events[2].scope()?;
        self.natural.project(self.comm(), x)
    }

    /// x ← Pᵀ x.
    pub fn p_transpose(&self, x: &PetscVec) -> Result<()> {
        let _timed = self.events[2].scope()?;
        self.natural.project_transpose(self.comm(), x)
    }

    /// The event of displacements and jumps that are computed from λ, until the guard is dropped.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn timed_residual(&self) -> Result<Scope> {
        self.events[3].scope()
    }

    /// The event of the certificate, until the guard is dropped.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn timed_certificate(&self) -> Result<Scope> {
        self.events[4].scope()
    }

    /// Description of the operators for `-fetifeti_ksp_view`.
    pub fn describe(&self) -> String {
        let (jump, natural) = (&self.stiffness.jump, &self.natural);
        let coarse = match natural.gtg.as_ref().map(|gtg| gtg.solver.describe()) {
            Some(Ok(coarse)) => format!(", {coarse}"),
            _ => String::new(),
        };
        format!(
            "  multipliers: {} local, {} global\n  projector: {} ({} kernel vectors of floating bodies{coarse})\
             \n  preconditioner: {}\n",
            jump.n_local,
            jump.n_global - jump.n_local,
            natural.projector.name(),
            natural.r,
            self.preconditioner.describe(),
        )
    }
}
