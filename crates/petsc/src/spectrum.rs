//! Extreme eigenvalues of a product of two symmetric positive semidefinite operators.
//!
//! The goal is the non-zero eigenvalues of C A, for example with A = P^T F P and C = P M^-1 P^T. C A is self-adjoint in
//! the inner product of A, but this inner product is only semidefinite. It does not see the components of the Krylov
//! vectors in ker A. These grow like the Lanczos polynomials at zero, and in the end swamp the vectors. Therefore the
//! operator and the inner product are extended to the kernel. With a projection E, A E = A, and N = I - E,
//! ```text
//! OP = E C Eᵀ A + σ N          has the non-zero eigenvalues of C A on range E, and σ on range N ⊂ ker A
//! B  = A + s NᵀN               is positive definite, and B OP is symmetric, for A N = 0 and N E = 0
//! ```
//!
//! σ is a Rayleigh quotient of C A: it lies between the extreme eigenvalues, and does not extend the spectrum.

use super::{Comm, End, Eps, Mat, ProblemType, Session, Settled, ShellMat, Vec, Which};
use base::{Error, Result};

/// The projection E with two work vectors, or the identity.
struct Split {
    e: Option<Mat>,
}

impl Split {
    /// y ← E x.
    fn range(&self, x: &Vec, y: &Vec) -> Result<()> {
        match &self.e {
            Some(e) => e.mult(x, y),
            None => y.copy_from(x),
        }
    }

    /// y ← Eᵀ x.
    fn range_transpose(&self, x: &Vec, y: &Vec) -> Result<()> {
        match &self.e {
            Some(e) => e.mult_transpose(x, y),
            None => y.copy_from(x),
        }
    }
}

/// OP, see the module.
struct ShiftedOperator {
    a: Mat,
    c: Mat,
    split: Split,
    sigma: f64,
    w: [Vec; 2],
}

impl ShellMat for ShiftedOperator {
    fn mult(&self, x: &Vec, y: &Vec) -> Result<()> {
        let [v, w] = &self.w;
        self.a.mult(x, v)?; //                     v <- A x
        self.split.range_transpose(v, w)?; //      w <- E' A x
        self.c.mult(w, v)?; //                     v <- C E' A x
        if self.split.e.is_none() {
            return y.copy_from(v);
        }
        v.axpy(-self.sigma, x)?; //                v <- C E' A x - s x
        self.split.range(v, y)?; //                y <- E (C E' A x - s x)
        y.axpy(self.sigma, x) //                   y <- E C E' A x + s N x
    }
}

/// B, see the module.
struct InnerProduct {
    a: Mat,
    split: Split,
    s: f64,
    w: [Vec; 2],
}

impl ShellMat for InnerProduct {
    fn mult(&self, x: &Vec, y: &Vec) -> Result<()> {
        self.a.mult(x, y)?; //                     y <- A x
        if self.split.e.is_none() {
            return Ok(());
        }
        let [v, w] = &self.w;
        self.split.range(x, v)?;
        v.aypx(-1.0, x)?; //                       v <- N x
        self.split.range_transpose(v, w)?;
        y.axpy(self.s, v)?;
        y.axpy(-self.s, w) //                      y <- A x + s N'N x
    }

    fn symmetric(&self) -> bool {
        true
    }
}

/// Products with the operator before an eigenvalue may count as settled.
const PRODUCTS: usize = 2_400;

/// Number of restarts over which an eigenvalue hardly changes before it counts as settled.
const PATIENCE: usize = 4;

/// Largest residual of an eigenvalue that counts as settled, relative to the eigenvalue.
const LOOSE: f64 = 1e-3;

/// Number of vectors between restarts; SLEPc tests convergence at restarts only. The largest eigenvalue is well
/// separated and converges after some tens of vectors; the smallest ones are clustered at the lower end.
fn subspace(which: Which) -> usize {
    match which {
        Which::LargestReal => 40,
        _ => 240,
    }
}

/// The smallest and the largest eigenvalue of C A on range A.
///
/// `a` and `c` are symmetric positive semidefinite, of the same shape and distribution. `e` is a projection with A E =
/// A and range E ∩ ker A = {0} that also provides its transposed product; `None` stands for the identity and is right
/// only for a positive definite A. `start` is any vector that A does not annihilate. `tol` bounds the residual relative
/// to the eigenvalue; the error of the eigenvalue is of the order of its square where the eigenvalue is well separated,
/// and never larger than `tol`. Options with `prefix` go to SLEPc's solver. Collective.
///
/// At the end of a cluster the residual, about the square root of the error, falls for thousands of products after the
/// value has all its digits. Two more conditions end the search there. With `floor`, which no eigenvalue is below, the
/// smallest one is known where a Rayleigh quotient is above `floor` by no more than `tol`. Otherwise a value ends the
/// search that has settled: its changes let expect an error below `tol`, and the residual is handed over
/// ([`End::settled`]).
///
/// # Errors
/// [`ErrorKind::NotConverged`](base::ErrorKind::NotConverged) when an end of the spectrum did not converge;
/// [`ErrorKind::Input`](base::ErrorKind::Input) when A annihilates `start`.
pub fn extreme_eigenvalues(
    session: &Session,
    a: &Mat,
    c: &Mat,
    e: Option<&Mat>,
    start: &Vec,
    (tol, floor): (f64, Option<f64>),
    prefix: &str,
) -> Result<[End; 2]> {
    let split = || Split { e: e.cloned() };
    let n = start.global_len();
    let first = start.duplicate()?;
    split().range(start, &first)?;

    // s = xᵀA x / xᵀx and σ = (A x)ᵀ C (A x) / xᵀA x for the start x = E start.
    let (ax, cax) = (a.left_vec()?, a.right_vec()?);
    a.mult(&first, &ax)?;
    let energy = first.dot(&ax)?;
    let square = first.dot(&first)?;
    if !(energy > 0.0 && square > 0.0) {
        return Err(Error::input(
            "The operator annihilates the start vector: it has no non-zero eigenvalue in that direction.",
        ));
    }
    let projected = ax.duplicate()?;
    split().range_transpose(&ax, &projected)?;
    c.mult(&projected, &cax)?;
    let sigma = projected.dot(&cax)? / energy;
    let s = energy / square;

    let (rows, cols) = a.local_size()?;
    let shell = |op: Box<dyn ShellMat>| Mat::shell(session, rows, cols, op);
    let work = || -> Result<[Vec; 2]> { Ok([first.duplicate()?, first.duplicate()?]) };
    let operator = shell(Box::new(ShiftedOperator {
        a: a.clone(),
        c: c.clone(),
        split: split(),
        sigma,
        w: work()?,
    }))?;
    let inner_product = shell(Box::new(InnerProduct {
        a: a.clone(),
        split: split(),
        s,
        w: work()?,
    }))?;

    let end = |which: Which| -> Result<End> {
        let eps = Eps::new(session, Comm::World)?;
        // SLEPc takes (OP, B) as a pencil and wants B⁻¹ of it. OP has that factor already, so the solve with B is the
        // identity.
        eps.set_operators(&operator, Some(&inner_product))?;
        eps.set_problem_type(ProblemType::Ghep)?;
        eps.set_which(which)?;
        eps.set_dimensions(1, Some(n.clamp(1, subspace(which))))?;
        eps.set_tolerances(tol, Some(500))?;
        eps.set_purify(false)?;
        eps.set_initial_space(std::slice::from_ref(&first))?;
        eps.set_options_prefix(prefix)?;
        let ksp = eps.st_ksp()?;
        ksp.set_type("preonly")?;
        ksp.pc()?.set_type("none")?;
        eps.set_from_options()?;
        let floor = match which {
            Which::SmallestReal => floor.unwrap_or(f64::NAN),
            _ => f64::NAN,
        };
        let when = Settled {
            floor,
            // A restart keeps half of the vectors.
            first: 2 * PRODUCTS / subspace(which),
            patience: PATIENCE,
            loose: LOOSE,
        };
        match eps.solve_settled(when, which)? {
            Some(end) => Ok(end),
            None => Err(Error::not_converged(format!(
                "The {} eigenvalue did not converge to {tol:.0e} in {} restarts ({}); \
                 -{prefix}eps_max_it allows more of them",
                if which == Which::SmallestReal {
                    "smallest"
                } else {
                    "largest"
                },
                eps.iterations()?,
                eps.converged_reason()?.name
            ))),
        }
    };
    Ok([end(Which::SmallestReal)?, end(Which::LargestReal)?])
}
