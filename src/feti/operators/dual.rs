//! The dual problem as PETSc sees it: a MatShell Pᵀ F P and a PCShell P M⁻¹ Pᵀ.
//!
//! The projector stands on both sides of both, so that every Krylov method, flexible or pipelined, left or right
//! preconditioned, works in the space V = ker Gᵀ without knowing of it. Between the steps of the contact loop Z^k changes, and with it
//! G, the touched blocks of B_D, and nothing else.

use std::cell::{Cell, Ref, RefCell};
use std::rc::Rc;

use super::preconditioner::Preconditioner;
use super::stiffness::Stiffness;
use crate::feti::deflation::Deflation;
use crate::feti::krylov::recycle::Recycle;
use crate::feti::krylov::tally::Tally;
use crate::feti::projector::natural::NaturalCoarse;
use crate::parallel::exchange::sum_all;
use crate::petsc::{Event, Mat, Session, ShellMat, ShellPc, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

/// F, M⁻¹ and P of one problem.
pub struct Dual {
    /// S̃⁺, B and F.
    pub stiffness: Stiffness,
    /// M⁻¹.
    pub preconditioner: Preconditioner,
    /// G and P.
    pub natural: NaturalCoarse,
    /// P_2, where it is in use.
    deflation: RefCell<Option<Deflation>>,
    watch: Cell<Option<f64>>,
    /// Iterations before the first look at the spectrum.
    pub watched_from: usize,
    /// Directions of earlier iterations.
    recycled: RefCell<Recycle>,
    /// What the running iteration adds its correction to.
    start: RefCell<Option<PetscVec>>,
    session: Session,
    /// Whether G belongs to other rows than those that hold.
    stale: bool,
    events: [Event; 3],
    /// What the iterations have sent and how long they took.
    tally: Cell<Tally>,
    /// Buffers for projected copies.
    x: PetscVec,
    y: PetscVec,
}

impl Dual {
    /// Puts the operators together. Collective.
    pub fn new(
        session: &Session,
        stiffness: Stiffness,
        preconditioner: Preconditioner,
        natural: NaturalCoarse,
    ) -> Result<Dual> {
        let x = PetscVec::mpi(session, stiffness.jump.n_owned)?;
        let event = |name| Event::register(session, name);
        Ok(Dual {
            events: [
                event("FetiFetiF")?,
                event("FetiFetiM")?,
                event("FetiFetiP")?,
            ],
            deflation: RefCell::new(None),
            watch: Cell::new(None),
            watched_from: 0,
            recycled: RefCell::new(Recycle::default()),
            start: RefCell::new(None),
            session: session.clone(),
            stale: false,
            tally: Cell::default(),
            y: x.duplicate()?,
            x,
            stiffness,
            preconditioner,
            natural,
        })
    }

    /// Changes Z^k to `active` (one per owned row): new blocks of B_D where rows changed, a new G. Nothing that depends on K
    /// is touched. Returns the number of rows that changed over all ranks. Collective.
    pub fn set_active(&mut self, problem: &Substructures, active: &[bool]) -> Result<usize> {
        let comm = self.session.comm();
        let mut changed = [self.stiffness.jump.set_active(comm, active) as f64];
        sum_all(comm, &mut changed);
        if changed[0] > 0.0 || self.stale {
            let (stiffness, preconditioner) = (&self.stiffness, &self.preconditioner);
            self.natural
                .renew(&self.session, problem, stiffness, preconditioner)?;
            self.stale = false;
            if let Some(mut deflation) = self.deflation.take() {
                deflation.renew(&self.session, self)?;
                self.deflation.replace(Some(deflation));
            }
        }
        Ok(changed[0] as usize)
    }

    /// Changes Z^k in B and B_D alone and leaves G behind: enough for M⁻¹ in a face of a bound-constrained problem. Collective.
    pub fn set_face(&mut self, free: &[bool]) {
        self.stiffness.jump.set_active(self.session.comm(), free);
        self.stale = true;
    }

    /// What the iterations of this rank have sent and how long they took.
    pub fn tally(&self) -> Tally {
        self.tally.get()
    }

    /// Adds iterations to the [`tally`](Self::tally).
    pub fn count(&self, more: &Tally) {
        let mut tally = self.tally.get();
        tally.add(more);
        self.tally.set(tally);
    }

    /// A vector of multipliers.
    pub fn multipliers(&self) -> Result<PetscVec> {
        self.x.duplicate()
    }

    /// y ← F x.
    pub fn f(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let _timed = self.events[0].scope()?;
        self.stiffness.f_mult(x, y)
    }

    /// y ← M⁻¹ x.
    pub fn m(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let _timed = self.events[1].scope()?;
        self.preconditioner.apply(&self.stiffness, x, y)
    }

    /// ys ← M⁻¹ xs, several columns at once. Collective.
    pub fn m_many(&self, xs: &[PetscVec], ys: &[PetscVec]) -> Result<()> {
        let _timed = self.events[1].scope()?;
        self.preconditioner.apply_many(&self.stiffness, xs, ys)
    }

    /// x ← P x.
    pub fn p(&self, x: &PetscVec) -> Result<()> {
        let _timed = self.events[2].scope()?;
        self.natural.project(self.session.comm(), x)
    }

    /// x ← Pᵀ x.
    pub fn p_transpose(&self, x: &PetscVec) -> Result<()> {
        let _timed = self.events[2].scope()?;
        self.natural.project_transpose(self.session.comm(), x)
    }

    /// Uses P_2, or none.
    pub fn deflate(&self, deflation: Option<Deflation>) {
        // A directions were taken with is another operator now.
        self.recycled.borrow_mut().forget();
        self.deflation.replace(deflation);
    }

    /// Whether there are vectors to deflate; there are none any more. What was found stays known.
    pub fn give_deflation_up(&self) -> bool {
        match &mut *self.deflation.borrow_mut() {
            Some(deflation) if deflation.matrices().is_some() => {
                deflation.give_up();
                self.recycled.borrow_mut().forget();
                self.watch.set(None);
                true
            }
            _ => false,
        }
    }

    /// P_2, which is not in use any more.
    pub fn take_deflation(&self) -> Option<Deflation> {
        self.recycled.borrow_mut().forget();
        self.deflation.take()
    }

    /// P_2, where it is in use.
    pub fn deflation(&self) -> Ref<'_, Option<Deflation>> {
        self.deflation.borrow()
    }

    /// What the running iteration adds its correction to, for those who want to know how far it has come.
    pub fn start(&self) -> Option<PetscVec> {
        self.start.borrow().clone()
    }

    /// Says what the next iterations add their corrections to.
    pub fn set_start(&self, lambda: Option<&PetscVec>) {
        *self.start.borrow_mut() = lambda.cloned();
    }

    /// Eigenvalue from which on an iteration is broken off, so that what is above τ can be deflated.
    pub fn watch(&self) -> Option<f64> {
        self.watch.get()
    }

    /// Sets that eigenvalue; `None`: iterations run to their end.
    pub fn set_watch(&self, limit: Option<f64>) {
        self.watch.set(limit);
    }

    /// λ ← λ + W (Wᵀ F W)⁺ Wᵀ r and r ← P_2ᵀ r, where something is deflated. Collective.
    pub fn deflated_part(&self, residual: &PetscVec, lambda: &PetscVec) -> Result<()> {
        if let Some(p2) = self
            .deflation
            .borrow()
            .as_ref()
            .and_then(Deflation::matrices)
        {
            // What is left in range F W stays there: the preconditioner does not see it. The second time removes the rounding of the first.
            for _ in 0..2 {
                p2.solve(&self.session, residual, lambda)?;
                p2.project_transpose(&self.session, residual)?;
                self.natural
                    .project_transpose(self.session.comm(), residual)?;
            }
        }
        Ok(())
    }

    /// Keeps at most so many directions from load to load.
    pub fn recycle(&self, most: usize) {
        self.recycled.replace(Recycle::new(most));
    }

    /// λ ← λ + x₀ and r ← r − A x₀ with what earlier iterations have left for the rows that hold. Collective.
    pub fn recycled_part(&self, residual: &PetscVec, lambda: &PetscVec) -> Result<()> {
        let mut recycled = self.recycled.borrow_mut();
        let comm = self.session.comm();
        recycled.fit(comm, &self.stiffness.jump.active);
        if recycled.is_empty() {
            return Ok(());
        }
        recycled.begin(comm, residual, lambda)?;
        self.p_transpose(residual)
    }

    /// Directions that the iteration takes are kept from now on, or are not.
    pub fn record_directions(&self, on: bool) {
        self.recycled.borrow_mut().record(on);
    }

    /// x ← P_2 x for x in V. Collective.
    pub fn p2(&self, x: &PetscVec) -> Result<()> {
        match self
            .deflation
            .borrow()
            .as_ref()
            .and_then(Deflation::matrices)
        {
            Some(p2) => p2.project(&self.session, x),
            None => Ok(()),
        }
    }

    /// x ← P_2ᵀ x. Collective.
    pub fn p2_transpose(&self, x: &PetscVec) -> Result<()> {
        match self
            .deflation
            .borrow()
            .as_ref()
            .and_then(Deflation::matrices)
        {
            Some(p2) => p2.project_transpose(&self.session, x),
            None => Ok(()),
        }
    }

    /// y ← Pᵀ P_2ᵀ F P x. Residuals that this makes have no part in range F W, where the preconditioner would not see it.
    fn projected_f(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        if self.natural.r == 0 {
            self.f(x, y)?;
            self.p2_transpose(y)?;
            return self.recycled.borrow_mut().keep(x, y);
        }
        self.x.copy_from(x)?;
        self.p(&self.x)?; /*            x ← P x          */
        self.f(&self.x, y)?; /*         y ← F x          */
        self.p2_transpose(y)?; /*       y ← P_2ᵀ y       */
        self.p_transpose(y)?; /*        y ← Pᵀ y         */
        self.recycled.borrow_mut().keep(&self.x, y)
    }

    /// y ← P_2 P M⁻¹ Pᵀ x for residuals x, which P_2ᵀ leaves as they are.
    fn projected_m(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        if self.natural.r == 0 && self.deflation.borrow().is_none() {
            return self.m(x, y);
        }
        self.y.copy_from(x)?;
        self.p_transpose(&self.y)?; /*  x ← Pᵀ x         */
        self.m(&self.y, y)?; /*         y ← M⁻¹ x        */
        self.p(y)?; /*                  y ← P y          */
        self.p2(y) /*                   y ← P_2 y        */
    }

    fn describe(&self) -> String {
        let (jump, natural) = (&self.stiffness.jump, &self.natural);
        let lifted = match self.preconditioner.lifting() {
            Some(l) => {
                let (rank, order) = l.rank_and_order;
                format!(", {rank} independent of {order} coarse functions on this rank")
            }
            None => String::new(),
        };
        format!(
            "  multipliers: {} local, {} global\n  projector: {} ({} kernel vectors of floating bodies)\n  preconditioner: {}{lifted}\n",
            jump.n_local,
            jump.n_global - jump.n_local,
            natural.projector.name(),
            natural.r,
            self.preconditioner.kind().name(),
        )
    }
}

/// The operators as PETSc's shells and the contact loop share them.
pub type Shared = Rc<RefCell<Dual>>;

struct Range(Shared);

impl ShellMat for Range {
    /// y ← E x
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let dual = self.0.borrow();
        dual.x.copy_from(x)?;
        dual.p(&dual.x)?;
        dual.stiffness.range_projection(&dual.x, y)?;
        if dual.deflation.borrow().is_some() {
            dual.p2(y)?;
            dual.x.copy_from(y)?;
            dual.stiffness.range_projection(&dual.x, y)?;
        }
        Ok(())
    }
    /// y ← Eᵀ x
    fn mult_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let dual = self.0.borrow();
        if dual.deflation.borrow().is_some() {
            dual.stiffness.range_projection(x, &dual.x)?;
            dual.p2_transpose(&dual.x)?;
            dual.p_transpose(&dual.x)?;
            dual.stiffness.range_projection(&dual.x, y)?;
        } else {
            dual.stiffness.range_projection(x, y)?;
        }
        dual.p_transpose(y)
    }
}

struct Deflated(Shared);

impl ShellMat for Deflated {
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let dual = self.0.borrow();
        let inner = dual.multipliers()?;
        inner.copy_from(x)?;
        dual.p(&inner)?; /*             x ← P x          */
        dual.p2(&inner)?; /*            x ← P_2 x        */
        dual.f(&inner, y)?; /*          y ← F x          */
        dual.p2_transpose(y)?; /*       y ← P_2ᵀ y       */
        dual.p_transpose(y) /*          y ← Pᵀ y         */
    }
    fn symmetric(&self) -> bool {
        true
    }
}

struct Operator(Shared);
struct Projected(Shared);

impl ShellMat for Operator {
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.borrow().projected_f(x, y)
    }
    fn mult_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.borrow().projected_f(x, y)
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn view(&self) -> String {
        self.0.borrow().describe()
    }
}

impl ShellMat for Projected {
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.borrow().projected_m(x, y)
    }
    fn mult_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.borrow().projected_m(x, y)
    }
    fn symmetric(&self) -> bool {
        true
    }
}

impl ShellPc for Projected {
    fn apply(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.borrow().projected_m(x, y)
    }
    fn apply_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.borrow().projected_m(x, y)
    }
    fn view(&self) -> String {
        self.0.borrow().describe()
    }
}

/// Pᵀ F P as a matrix. Collective.
pub fn operator(session: &Session, dual: &Shared) -> Result<Mat> {
    let n = dual.borrow().stiffness.jump.n_owned;
    Mat::shell(session, n, n, Box::new(Operator(dual.clone())))
}

/// P_2ᵀ Pᵀ F P P_2 as a matrix: what CG works with where a part is deflated. Collective.
pub fn deflated_operator(session: &Session, dual: &Shared) -> Result<Mat> {
    let n = dual.borrow().stiffness.jump.n_owned;
    Mat::shell(session, n, n, Box::new(Deflated(dual.clone())))
}

/// P M⁻¹ Pᵀ, deflated where a part is, as a matrix. Collective.
pub fn preconditioner_matrix(session: &Session, dual: &Shared) -> Result<Mat> {
    let n = dual.borrow().stiffness.jump.n_owned;
    Mat::shell(session, n, n, Box::new(Projected(dual.clone())))
}

/// E = Π P as a matrix, Π the orthogonal projection onto range B: F (I − Π) = 0 and P (I − Π) = I − Π make E a projection
/// with Pᵀ F P E = Pᵀ F P, and Pᵀ F P is definite on its range V ∩ range B. With deflation it is E P_2 E, whose range is the
/// F-orthogonal complement of W in that space. Collective.
pub fn range_matrix(session: &Session, dual: &Shared) -> Result<Mat> {
    let n = dual.borrow().stiffness.jump.n_owned;
    Mat::shell(session, n, n, Box::new(Range(dual.clone())))
}

/// P M⁻¹ Pᵀ as what a PCShell applies.
pub fn preconditioner_shell(dual: &Shared) -> Box<dyn ShellPc> {
    Box::new(Projected(dual.clone()))
}
