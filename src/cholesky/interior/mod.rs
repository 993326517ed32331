//! Sparse Cholesky factorisation of a subdomain, by several solvers in several orders, behind one face.
//!
//! Two things are asked of a solver: K = L Lᵀ with solves ([`SparseCholesky`]), and elimination of the interior alone, which leaves the Schur
//! complement S on the interface and a [`Factor`] for condensed loads and interior solutions:
//!
//! | solver | S | factor of the interior |
//! |---|---|---|
//! | own multifrontal | what reaches the root | its fronts |
//! | faer, CHOLMOD | interface last in L Lᵀ = K + diag(0, D): S = L_ΓΓ L_ΓΓᵀ − D | the supernodes of L, without those of Γ |
//! | MUMPS | its own Schur complement | solves with K_II: MUMPS does not show its factor |
//!
//! D, the diagonal of K_ΓΓ, makes K of a floating subdomain definite; S loses no more than rounding errors of K_ΓΓ.
//!
//! A pivot that is not positive, or below 1e-13 of the diagonal entry it came from, is an error for all of them.

mod boundary;
mod cholmod;
mod condensation;
mod faer;
mod graph;
mod mumps;
mod order;
mod own;
mod triangle;

#[cfg(test)]
mod tests;

use std::fmt::Debug;

use super::multifrontal::SingularInterior;
use crate::linalg::csr::Csr;
use crate::linalg::dense::Dense;
use crate::petsc;
use crate::{Error, Result};

pub use condensation::Factor;
pub use order::Elimination;

/// Who factors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Our multifrontal method on faer's dense kernels.
    #[default]
    Multifrontal,
    /// faer's supernodal or simplicial factorisation.
    Faer,
    /// CHOLMOD of SuiteSparse.
    Cholmod,
    /// MUMPS on each process alone.
    Mumps,
}

impl Solver {
    /// All of them.
    pub const ALL: [Solver; 4] = [
        Solver::Multifrontal,
        Solver::Faer,
        Solver::Cholmod,
        Solver::Mumps,
    ];

    /// Names as the option takes them.
    pub const NAMES: &'static [&'static str] = &["multifrontal", "faer", "cholmod", "mumps"];

    /// The name as the option takes it.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Whether this build has it.
    pub fn available(self) -> bool {
        match self {
            Solver::Multifrontal | Solver::Faer => true,
            Solver::Cholmod => petsc::have_cholmod(),
            Solver::Mumps => petsc::have_mumps(),
        }
    }
}

/// In which order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ordering {
    /// The best one as measured: [`Ordering::Nd`].
    #[default]
    Auto,
    /// Nested dissection: by coordinates where there are any, else by distance in the graph.
    Nd,
    /// Approximate minimum degree (faer's).
    Amd,
    /// METIS's nested dissection, through CHOLMOD.
    Metis,
    /// Scotch's nested dissection.
    Scotch,
}

impl Ordering {
    /// Those that differ.
    pub const ALL: [Ordering; 4] = [
        Ordering::Nd,
        Ordering::Amd,
        Ordering::Metis,
        Ordering::Scotch,
    ];

    /// Names as the option takes them.
    pub const NAMES: &'static [&'static str] = &["auto", "nd", "amd", "metis", "scotch"];

    /// The name as the option takes it.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The one that is taken.
    pub fn taken(self) -> Ordering {
        match self {
            Ordering::Auto => Ordering::Nd,
            chosen => chosen,
        }
    }

    /// Whether this build has it.
    pub fn available(self) -> bool {
        match self {
            Ordering::Auto | Ordering::Nd | Ordering::Amd => true,
            Ordering::Metis => petsc::ordering::have_metis(),
            Ordering::Scotch => petsc::ordering::have_scotch(),
        }
    }
}

/// What is kept of [L_II; L_ΓI].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// All of it: condensing a load and recovering a solution are half a solve each.
    Boundary,
    /// L_II: they are a whole solve each, in three quarters of the memory in the plane and in a quarter of it in space.
    Interior,
}

/// How subdomains are factored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LocalSolver {
    /// Who factors.
    pub kind: Solver,
    /// In which order.
    pub ordering: Ordering,
}

/// Why there is no factor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoFactor {
    /// A pivot of the interior is not positive: nothing holds it, or K is no stiffness matrix.
    Interior(SingularInterior),
    /// K is not positive semidefinite at this dof of the interface.
    Indefinite(u32),
    /// The library failed, in one sentence without a full stop.
    Failed(String),
}

impl From<SingularInterior> for NoFactor {
    fn from(e: SingularInterior) -> NoFactor {
        NoFactor::Interior(e)
    }
}

/// L Lᵀ of a symmetric positive definite matrix; any thread may use it.
pub trait SparseCholesky: Debug + Send + Sync {
    /// x ← K⁻¹ x.
    fn solve(&self, x: &mut [f64]);

    /// The same for several vectors of equal length.
    fn solve_many(&self, x: &mut [Vec<f64>]);

    /// Bytes held by the factor.
    fn bytes(&self) -> usize;
}

/// What depends on the pattern of K alone: one analysis serves matrices of equal pattern.
pub trait Analysis: Debug + Send + Sync {
    /// L Lᵀ of the whole matrix.
    ///
    /// # Errors
    /// [`NoFactor`].
    ///
    /// # Panics
    /// If the analysis was made with an interface.
    fn factor(&self, k: &Csr) -> std::result::Result<Box<dyn SparseCholesky>, NoFactor>;

    /// Eliminates the interior: the factor and S, both triangles, in the order of the interface.
    ///
    /// # Errors
    /// [`NoFactor`].
    fn condense(&self, k: &Csr, keep: Keep) -> std::result::Result<(Factor, Dense), NoFactor>;
}

impl LocalSolver {
    /// Analyses the pattern of `k`; `interface` lists the dofs that are kept, in the order wanted for S.
    ///
    /// # Errors
    /// [`NoFactor::Failed`].
    pub fn analyse(
        self,
        k: &Csr,
        interface: &[u32],
        coordinates: Option<&[[f64; 3]]>,
    ) -> std::result::Result<Box<dyn Analysis>, NoFactor> {
        let ordering = self.ordering.taken();
        if (self.kind, ordering) == (Solver::Multifrontal, Ordering::Nd) {
            // Nested dissection knows its fronts: no elimination tree is needed.
            return Ok(Box::new(own::Own::nested(k, interface, coordinates)));
        }
        let order = Elimination::new(k, interface, coordinates, ordering)?;
        let kind = match self.kind {
            // There is nothing to factor, which MUMPS refuses to do.
            _ if order.interior.is_empty() => Solver::Multifrontal,
            kind => kind,
        };
        Ok(match kind {
            Solver::Multifrontal => Box::new(own::Own::new(k, &order)),
            Solver::Faer => Box::new(faer::Faer::new(k, order)?),
            Solver::Cholmod => Box::new(cholmod::OfCholmod::new(k, order)?),
            Solver::Mumps => Box::new(mumps::OfMumps::new(k, order)?),
        })
    }

    /// The way of one that nothing is known of.
    pub fn way(self, keep: Keep) -> Way<'static> {
        Way {
            solver: self,
            analysis: None,
            keep,
        }
    }

    /// Says so where this build has not what was chosen.
    ///
    /// # Errors
    /// [`Error::Environment`] naming the option and what there is.
    pub fn check(self, prefix: &str) -> Result<()> {
        let list = |names: Vec<&str>| names.join(", ");
        let absent = |option: &str, name: &str, there: Vec<&str>| {
            Error::environment(format!(
                "option -{prefix}{option} is \"{name}\", which this build does not have; it has {}",
                list(there)
            ))
        };
        if !self.kind.available() {
            let there = Solver::ALL.into_iter().filter(|s| s.available());
            let there = there.map(Solver::name).collect();
            return Err(absent("local_solver", self.kind.name(), there));
        }
        if !self.ordering.available() {
            let there = Ordering::ALL.into_iter().filter(|o| o.available());
            let there = there.map(Ordering::name).collect();
            return Err(absent("local_ordering", self.ordering.name(), there));
        }
        Ok(())
    }

    /// The largest number of threads that may factor and solve; `None`: any. MUMPS is not safe on several, and speaks to MPI.
    pub fn most_threads(self) -> Option<usize> {
        (self.kind == Solver::Mumps).then_some(1)
    }
}

/// How the interior of one subdomain is eliminated.
#[derive(Debug, Clone, Copy)]
pub struct Way<'a> {
    /// By whom.
    pub solver: LocalSolver,
    /// The analysis of a matrix with the same pattern and interface, where there is one.
    pub analysis: Option<&'a dyn Analysis>,
    /// What is kept.
    pub keep: Keep,
}

impl Way<'_> {
    /// The factor and S of `k`, which is analysed if it has not been.
    ///
    /// # Errors
    /// [`NoFactor`].
    pub fn condense(
        self,
        k: &Csr,
        interface: &[u32],
        coordinates: Option<&[[f64; 3]]>,
    ) -> std::result::Result<(Factor, Dense), NoFactor> {
        match self.analysis {
            Some(analysis) => analysis.condense(k, self.keep),
            None => {
                let analysis = self.solver.analyse(k, interface, coordinates)?;
                analysis.condense(k, self.keep)
            }
        }
    }
}

/// No pivot can be positive where the diagonal is not: asked before a library sees the matrix, as NaN is none of their errors.
fn positive_diagonal(k: &Csr, interior: &[u32]) -> std::result::Result<(), SingularInterior> {
    let positive = |&i: &u32| {
        let d = k.get(i as usize, i as usize);
        d > 0.0 && d.is_finite()
    };
    match interior.iter().find(|i| !positive(i)) {
        Some(&dof) => Err(SingularInterior { dof }),
        None => Ok(()),
    }
}

/// The error of a library about the matrix in the order `dofs`, the first `interior` of which are eliminated.
fn refused(error: petsc::Refusal, dofs: &[u32], interior: usize, unknown: u32) -> NoFactor {
    match error {
        petsc::Refusal::NotPositive(column) => match column {
            Some(p) if p >= interior => NoFactor::Indefinite(dofs[p]),
            Some(p) => SingularInterior { dof: dofs[p] }.into(),
            None => SingularInterior { dof: unknown }.into(),
        },
        petsc::Refusal::Failed(why) => NoFactor::Failed(why),
    }
}
