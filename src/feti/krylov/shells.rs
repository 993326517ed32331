//! The operators of [`DualSystem`] as PETSc's KSP and SLEPc's EPS take them: MatShells and a PCShell.

use std::rc::Rc;

use super::system::DualSystem;
use crate::Result;
use petsc::{Mat, ShellMat, ShellPc, Vec as PetscVec};

/// A product: (system, x, y) with y ← A x.
type Product = fn(&DualSystem, &PetscVec, &PetscVec) -> Result<()>;

/// An operator of the system.
struct Shell {
    system: Rc<DualSystem>,
    apply: Product,
    /// The product with the transpose; `None` for a symmetric operator.
    transpose: Option<Product>,
}

impl ShellMat for Shell {
    fn mult(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        (self.apply)(&self.system, x, y)
    }
    fn mult_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.transpose.unwrap_or(self.apply)(&self.system, x, y)
    }
    fn symmetric(&self) -> bool {
        self.transpose.is_none()
    }
    fn view(&self) -> String {
        self.system.dual().describe()
    }
}

impl ShellPc for Shell {
    fn apply(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.mult(x, y)
    }
    fn view(&self) -> String {
        ShellMat::view(self)
    }
}

fn shell(system: &Rc<DualSystem>, apply: Product, transpose: Option<Product>) -> Box<Shell> {
    let system = system.clone();
    Box::new(Shell {
        system,
        apply,
        transpose,
    })
}

fn matrix(shell: Box<Shell>) -> Result<Mat> {
    let n = shell.system.dual().stiffness.jump.n_owned;
    let session = shell.system.session.clone();
    Mat::shell(&session, n, n, shell)
}

/// Pᵀ F P as a matrix. Collective.
pub fn operator(system: &Rc<DualSystem>) -> Result<Mat> {
    matrix(shell(system, DualSystem::apply, None))
}

/// P_2ᵀ Pᵀ F P P_2 as a matrix: the operator of CG with deflation. Collective.
pub fn deflated_operator(system: &Rc<DualSystem>) -> Result<Mat> {
    matrix(shell(system, DualSystem::apply_deflated, None))
}

/// P M⁻¹ Pᵀ as a matrix, with deflation if it is in use. Collective.
pub fn preconditioner(system: &Rc<DualSystem>) -> Result<Mat> {
    matrix(shell(system, DualSystem::precondition, None))
}

/// E = Π P as a matrix, with Π the orthogonal projection onto range B; with springs in the rows the projection of
/// [`Dual::off_kernel`](crate::feti::operators::dual::Dual::off_kernel). From F (I − Π) = 0 and P (I − Π) = I − Π it
/// follows that E is a projection with Pᵀ F P E = Pᵀ F P, and Pᵀ F P is definite on its range, V ∩ range B without
/// springs. With deflation the matrix is E P_2 E. Its range is the F-orthogonal complement of W in that space.
/// Collective.
pub fn range(system: &Rc<DualSystem>) -> Result<Mat> {
    let transpose = Some(DualSystem::to_range_transpose as Product);
    matrix(shell(system, DualSystem::to_range, transpose))
}

/// P M⁻¹ Pᵀ as the operator of a PCShell.
pub fn preconditioner_shell(system: &Rc<DualSystem>) -> Box<dyn ShellPc> {
    shell(system, DualSystem::precondition, None)
}
