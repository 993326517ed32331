//! The dual problem of the Krylov method: A = Pᵀ P_2ᵀ F P and its preconditioner P_2 P M⁻¹ Pᵀ.
//!
//! The projector P stands on both sides of both operators. Every Krylov method, flexible or pipelined, left or right
//! preconditioned, therefore works in the space V = ker Gᵀ without knowing of it. P_2 is I if nothing is deflated.
//!
//! CG keeps its directions and residuals in V by itself, to the digits that P has. Where these are all, P stands only
//! on the side where something enters V: A = Pᵀ F, and P M⁻¹.

use std::cell::{Cell, Ref, RefCell, RefMut};

use super::recycling::{Recycle, LOOSE};
use super::tally::Tally;
use crate::feti::deflation::matrices::DeflationMatrices;
use crate::feti::deflation::Deflation;
use crate::feti::jump::turn::Turn;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::kernel_motion::KernelMotion;
use crate::substructures::Problem;
use crate::Result;
use petsc::{signals, Session, Vec as PetscVec};

/// Of so many products one asks whether a signal has come.
const HEED: usize = 4;

/// F, M⁻¹, P, P_2, and the directions of earlier iterations.
pub struct DualSystem {
    pub(super) session: Session,
    dual: RefCell<Dual>,
    /// P_2, where it is in use.
    deflation: RefCell<Option<Deflation>>,
    /// Directions of earlier iterations.
    recycled: RefCell<Recycle>,
    /// The iteration that is running.
    running: RefCell<Option<Running>>,
    /// Communication and time of the iterations.
    tally: Cell<Tally>,
    /// Products with A so far.
    products: Cell<usize>,
    /// Buffers for projected copies.
    x: PetscVec,
    y: PetscVec,
}

/// A running iteration. Its directions are kept.
struct Running {
    /// The λ that it corrects, if a monitor may ask for the displacements.
    start: Option<PetscVec>,
    /// Whether everything that it applies an operator to is in V.
    stays: bool,
    /// Whether its directions replace those of earlier iterations.
    replaces: bool,
}

/// Marks the iteration as ended when it is dropped.
pub struct RunningGuard<'a>(&'a DualSystem);

impl Drop for RunningGuard<'_> {
    fn drop(&mut self) {
        self.0.running.replace(None);
    }
}

impl DualSystem {
    /// The dual problem of `dual`, without deflation. At most `recycle` directions are kept from load to load.
    /// Collective.
    pub fn new(session: &Session, dual: Dual, recycle: usize) -> Result<DualSystem> {
        let x = dual.multipliers()?;
        Ok(DualSystem {
            session: session.clone(),
            y: x.duplicate()?,
            x,
            dual: RefCell::new(dual),
            deflation: RefCell::new(None),
            recycled: RefCell::new(Recycle::new(recycle)),
            running: RefCell::new(None),
            tally: Cell::default(),
            products: Cell::default(),
        })
    }

    /// F, M⁻¹ and P.
    pub fn dual(&self) -> Ref<'_, Dual> {
        self.dual.borrow()
    }

    /// Changes Z^k to `active`, and P_2 with it. Returns the number of rows that changed over all ranks. Collective.
    pub(crate) fn set_active(&self, problem: &Problem, active: &[bool]) -> Result<usize> {
        let (changed, renewed) = self.dual.borrow_mut().set_active(problem, active)?;
        if let Some(deflation) = self.deflation.borrow_mut().as_mut().filter(|_| renewed) {
            let done = deflation.renew(&self.dual());
            // P_2 of another set must not stay in use.
            done.inspect_err(|_| self.dual.borrow_mut().outdate())?;
        }
        Ok(changed)
    }

    /// Changes Z^k in B and B_D alone; see [`Dual::set_face`]. Collective.
    pub(crate) fn set_face(&self, free: &[bool]) {
        self.dual.borrow_mut().set_face(free);
    }

    /// Replaces the compliance of the rows; see [`Dual::set_compliance`]. Kept directions belong to the old operator
    /// and are forgotten. Rows that are rigid already stay as they are. Collective.
    pub(crate) fn set_compliance(&self, compliance: Option<Vec<f64>>) {
        if compliance.is_none() && !self.dual().stiffness.has_springs() {
            return;
        }
        self.recycled.borrow_mut().forget();
        self.dual.borrow_mut().set_compliance(compliance);
    }

    /// Turns rows of this rank; see [`Dual::turn`]. Kept directions belong to the old rows and are forgotten.
    /// Collective.
    pub(crate) fn turn(&self, problem: &Problem, turns: &[Turn]) {
        self.recycled.borrow_mut().forget();
        self.dual.borrow_mut().turn(problem, turns);
    }

    /// Replaces the multipliers of rows that do not hold and have a law with given ones; empty: they have none.
    pub(crate) fn set_given_multipliers(&self, given: Vec<f64>) {
        self.dual.borrow_mut().stiffness.jump.given_multipliers = given;
    }

    /// Notes which motions alone are free; see [`NaturalCoarse::settle`].
    pub(crate) fn settle(&self, free: Vec<KernelMotion>) {
        self.dual.borrow_mut().natural.settle(free);
    }

    /// Replaces the right-hand sides of the rows.
    pub(crate) fn set_gaps(&self, gaps: &[f64]) {
        self.dual.borrow_mut().stiffness.jump.set_gaps(gaps);
    }

    /// P_2, where it is in use.
    pub fn deflation(&self) -> Ref<'_, Option<Deflation>> {
        self.deflation.borrow()
    }

    /// Access to P_2 for a change. Kept directions belong to the old operator and are forgotten.
    pub(crate) fn change_deflation(&self) -> RefMut<'_, Option<Deflation>> {
        self.recycled.borrow_mut().forget();
        self.deflation.borrow_mut()
    }

    /// Communication and time of the iterations on this rank.
    pub fn tally(&self) -> Tally {
        self.tally.get()
    }

    /// Adds iterations to the [`tally`](Self::tally).
    pub(crate) fn count(&self, more: &Tally) {
        let mut tally = self.tally.get();
        tally.add(more);
        self.tally.set(tally);
    }

    /// Marks an iteration as running while the guard lives. `start` is the λ that it corrects, if monitors may ask for
    /// it; `cg` says that the method is CG, `rtol` is the tolerance of the solve that it belongs to.
    pub(crate) fn run(&self, start: Option<&PetscVec>, cg: bool, rtol: f64) -> RunningGuard<'_> {
        let running = Running {
            start: start.cloned(),
            stays: cg && self.keeps_to_v(),
            replaces: rtol <= LOOSE,
        };
        self.running.replace(Some(running));
        RunningGuard(self)
    }

    /// Whether a projection leaves nothing outside V but rounding, and nothing is deflated.
    pub(crate) fn keeps_to_v(&self) -> bool {
        self.p2_matrices().is_none() && self.dual().natural.is_exact()
    }

    /// Whether an operator is applied to what is in V already.
    fn stays(&self) -> bool {
        self.running.borrow().as_ref().is_some_and(|r| r.stays)
    }

    /// The λ that the running iteration corrects; `None` if no iteration runs that monitors may look into.
    pub(crate) fn start(&self) -> Option<PetscVec> {
        self.running.borrow().as_ref()?.start.clone()
    }

    fn p2_matrices(&self) -> Option<Ref<'_, DeflationMatrices>> {
        let deflation = self.deflation.borrow();
        Ref::filter_map(deflation, |d| d.as_ref()?.matrices()).ok()
    }

    /// x ← P_2 x for x in V. Collective.
    pub fn p2(&self, x: &PetscVec) -> Result<()> {
        match self.p2_matrices() {
            Some(p2) => p2.project(x),
            None => Ok(()),
        }
    }

    /// x ← P_2ᵀ x. Collective.
    pub fn p2_transpose(&self, x: &PetscVec) -> Result<()> {
        match self.p2_matrices() {
            Some(p2) => p2.project_transpose(x),
            None => Ok(()),
        }
    }

    /// λ ← λ + W (Wᵀ F W)⁺ Wᵀ r and r ← P_2ᵀ r, if something is deflated. Collective.
    pub(crate) fn deflated_part(&self, residual: &PetscVec, lambda: &PetscVec) -> Result<()> {
        if let Some(p2) = self.p2_matrices() {
            // A residual in range F W would stay there, because the preconditioner does not see it. The second pass
            // removes the rounding of the first.
            for _ in 0..2 {
                p2.solve(residual, lambda)?;
                p2.project_transpose(residual)?;
                let natural = &self.dual().natural;
                natural.project_transpose(self.session.comm(), residual)?;
            }
        }
        Ok(())
    }

    /// λ ← λ + x₀ and r ← r − A x₀, with the directions that earlier iterations left for the active rows. Collective.
    pub(crate) fn recycled_part(&self, residual: &PetscVec, lambda: &PetscVec) -> Result<()> {
        let mut recycled = self.recycled.borrow_mut();
        let comm = self.session.comm();
        let dual = self.dual();
        recycled.fit(comm, &dual.stiffness.jump.active);
        if recycled.is_empty() {
            return Ok(());
        }
        recycled.begin(comm, residual, lambda)?;
        dual.p_transpose(residual)
    }

    /// An error on all ranks if a signal asks them to end; to be called before each product with A. Collective.
    pub(crate) fn heed(&self) -> Result<()> {
        self.products.set(self.products.get() + 1);
        match self.products.get() % HEED {
            0 => signals::heed(&self.session),
            _ => Ok(()),
        }
    }

    fn keep(&self, direction: &PetscVec, image: &PetscVec) -> Result<()> {
        match self.running.borrow().as_ref() {
            Some(running) => {
                let mut recycled = self.recycled.borrow_mut();
                recycled.keep(direction, image, running.replaces)
            }
            None => Ok(()),
        }
    }

    /// y ← A x = Pᵀ P_2ᵀ F P x. The residuals of this operator have no part in range F W, where the preconditioner
    /// would not see it.
    pub(super) fn apply(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.heed()?;
        let dual = self.dual();
        if dual.natural.r == 0 {
            dual.f(x, y)?;
            self.p2_transpose(y)?;
            return self.keep(x, y);
        }
        if self.stays() {
            dual.f(x, y)?;
            dual.p_transpose(y)?;
            return self.keep(x, y);
        }
        self.x.copy_from(x)?;
        dual.p(&self.x)?; /*            x ← P x          */
        dual.f(&self.x, y)?; /*         y ← F x          */
        self.p2_transpose(y)?; /*       y ← P_2ᵀ y       */
        dual.p_transpose(y)?; /*        y ← Pᵀ y         */
        self.keep(&self.x, y)
    }

    /// ys ← Pᵀ F xs for xs in V, several columns at once, without deflation. Collective.
    pub(super) fn apply_many(&self, xs: &[PetscVec], ys: &[PetscVec]) -> Result<()> {
        self.heed()?;
        let dual = self.dual();
        dual.f_many(xs, ys)?;
        ys.iter().try_for_each(|y| dual.p_transpose(y))
    }

    /// ys ← P M⁻¹ xs for residuals xs in the range of Pᵀ, several columns at once, without deflation. Collective.
    pub(super) fn precondition_many(&self, xs: &[PetscVec], ys: &[PetscVec]) -> Result<()> {
        let dual = self.dual();
        dual.m_many(xs, ys)?;
        ys.iter().try_for_each(|y| dual.p(y))
    }

    /// Whether nothing is deflated.
    pub(super) fn is_undeflated(&self) -> bool {
        self.deflation.borrow().is_none()
    }

    /// y ← P_2 P M⁻¹ Pᵀ x for residuals x with P_2ᵀ x = x.
    pub(super) fn precondition(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let dual = self.dual();
        if dual.natural.r == 0 && self.deflation.borrow().is_none() {
            return dual.m(x, y);
        }
        if self.stays() {
            dual.m(x, y)?;
            return dual.p(y);
        }
        self.y.copy_from(x)?;
        dual.p_transpose(&self.y)?; /*  x ← Pᵀ x         */
        dual.m(&self.y, y)?; /*         y ← M⁻¹ x        */
        dual.p(y)?; /*                  y ← P y          */
        self.p2(y) /*                   y ← P_2 y        */
    }

    /// y ← Pᵀ P_2ᵀ F P_2 P x: the operator of CG with deflation.
    pub(super) fn apply_deflated(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.heed()?;
        let dual = self.dual();
        let inner = dual.multipliers()?;
        inner.copy_from(x)?;
        dual.p(&inner)?; /*             x ← P x          */
        self.p2(&inner)?; /*            x ← P_2 x        */
        dual.f(&inner, y)?; /*          y ← F x          */
        self.p2_transpose(y)?; /*       y ← P_2ᵀ y       */
        dual.p_transpose(y) /*          y ← Pᵀ y         */
    }

    /// y ← E x. E = Π P with the projection Π along the kernel of F + C, the orthogonal one onto range B without
    /// springs; E P_2 E if something is deflated.
    pub(super) fn to_range(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let dual = self.dual();
        self.x.copy_from(x)?;
        dual.p(&self.x)?;
        dual.off_kernel(&self.x, y)?;
        if self.deflation.borrow().is_some() {
            self.p2(y)?;
            self.x.copy_from(y)?;
            dual.off_kernel(&self.x, y)?;
        }
        Ok(())
    }

    /// y ← Eᵀ x.
    pub(super) fn to_range_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        let dual = self.dual();
        if self.deflation.borrow().is_some() {
            dual.off_kernel_transpose(x, &self.x)?;
            self.p2_transpose(&self.x)?;
            dual.p_transpose(&self.x)?;
            dual.off_kernel_transpose(&self.x, y)?;
        } else {
            dual.off_kernel_transpose(x, y)?;
        }
        dual.p_transpose(y)
    }
}
