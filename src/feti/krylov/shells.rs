//! The operators of [`System`] as PETSc's KSP and SLEPc's EPS take them: MatShells and a PCShell.

use std::rc::Rc;

use super::system::System;
use crate::petsc::{Mat, Session, ShellMat, ShellPc, Vec as PetscVec};
use crate::Result;

/// Pᵀ F P.
struct Operator(Rc<System>);

/// P_2ᵀ Pᵀ F P P_2.
struct Deflated(Rc<System>);

/// P M⁻¹ Pᵀ, with deflation if it is in use.
struct Preconditioner(Rc<System>);

/// E.
struct Range(Rc<System>);

impl ShellMat for Operator {
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.apply(x, y)
    }
    fn mult_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.apply(x, y)
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn view(&self) -> String {
        self.0.dual().describe()
    }
}

impl ShellMat for Deflated {
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.apply_deflated(x, y)
    }
    fn symmetric(&self) -> bool {
        true
    }
}

impl ShellMat for Preconditioner {
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.precondition(x, y)
    }
    fn mult_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.precondition(x, y)
    }
    fn symmetric(&self) -> bool {
        true
    }
}

impl ShellPc for Preconditioner {
    fn apply(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.precondition(x, y)
    }
    fn apply_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.precondition(x, y)
    }
    fn view(&self) -> String {
        self.0.dual().describe()
    }
}

impl ShellMat for Range {
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.to_range(x, y)
    }
    fn mult_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.to_range_transpose(x, y)
    }
}

fn shell(session: &Session, system: &Rc<System>, context: Box<dyn ShellMat>) -> Result<Mat> {
    let n = system.dual().stiffness.jump.n_owned;
    Mat::shell(session, n, n, context)
}

/// Pᵀ F P as a matrix. Collective.
pub fn operator(session: &Session, system: &Rc<System>) -> Result<Mat> {
    shell(session, system, Box::new(Operator(system.clone())))
}

/// P_2ᵀ Pᵀ F P P_2 as a matrix: the operator of CG with deflation. Collective.
pub fn deflated_operator(session: &Session, system: &Rc<System>) -> Result<Mat> {
    shell(session, system, Box::new(Deflated(system.clone())))
}

/// P M⁻¹ Pᵀ as a matrix, with deflation if it is in use. Collective.
pub fn preconditioner(session: &Session, system: &Rc<System>) -> Result<Mat> {
    shell(session, system, Box::new(Preconditioner(system.clone())))
}

/// E = Π P as a matrix, with Π the orthogonal projection onto range B. From F (I − Π) = 0 and P (I − Π) = I − Π it
/// follows that E is a projection with Pᵀ F P E = Pᵀ F P, and Pᵀ F P is definite on its range V ∩ range B. With
/// deflation the matrix is E P_2 E. Its range is the F-orthogonal complement of W in that space. Collective.
pub fn range(session: &Session, system: &Rc<System>) -> Result<Mat> {
    shell(session, system, Box::new(Range(system.clone())))
}

/// P M⁻¹ Pᵀ as the operator of a PCShell.
pub fn preconditioner_shell(system: &Rc<System>) -> Box<dyn ShellPc> {
    Box::new(Preconditioner(system.clone()))
}
