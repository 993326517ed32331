//! The solvers that eliminate the interior of a subdomain, and their orderings.
//!
//! A solver has two tasks. The first is to factor K = L Lᵀ and to solve with it ([`SparseCholesky`]). The second is to
//! eliminate the interior alone: this gives the Schur complement S on the interface, and a [`Factor`] for condensed
//! loads and interior solutions:
//!
//! | solver | S | factor of the interior |
//! |---|---|---|
//! | own multifrontal | what reaches the root | its fronts |
//! | faer | interface last in L Lᵀ = K + diag(0, D): S = L_ΓΓ L_ΓΓᵀ − D | the supernodes of L, without those of Γ |
//!
//! Adding D, the diagonal of K_ΓΓ, makes K of a floating subdomain definite; S loses no more than rounding errors of
//! K_ΓΓ.
//!
//! With both solvers, a pivot is an error if it is not positive, or is below 1e-13 of the diagonal entry it came from.

mod analysed;
mod analysis;
mod boundary;
mod factor;
mod faer;
mod graph;
mod order;
mod own;
mod triangle;

#[cfg(test)]
#[path = "../../tests/interior.rs"]
mod tests;

use std::sync::Arc;

use super::symbolic::{Keep, Symbolic};
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::{Error, Result};
use petsc::{named, Options};

pub use analysed::Analysed;
pub use analysis::{Analysis, NoFactor};
pub use factor::Factor;
pub use order::{Elimination, Ordering};
pub use own::Own;

/// The solver that factors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Our multifrontal method on faer's dense kernels.
    #[default]
    Multifrontal,
    /// faer's supernodal or simplicial factorisation.
    Faer,
}

named!(Solver { Multifrontal = "multifrontal", Faer = "faer" });

impl Solver {
    /// All solvers.
    pub const ALL: [Solver; 2] = [Solver::Multifrontal, Solver::Faer];
}

/// Names that the option accepted before 0.2.
const REMOVED: [&str; 2] = ["cholmod", "mumps"];

/// How subdomains are factored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LocalSolver {
    /// The solver.
    pub kind: Solver,
    /// The order of elimination.
    pub ordering: Ordering,
}

impl LocalSolver {
    /// Reads the options `local_solver` and `local_ordering`; the values of `self` are the defaults.
    ///
    /// # Errors A name that does not exist, or no longer exists; [`Error::Environment`] for an ordering that this build
    /// does not have.
    pub fn from_options(self, o: &Options) -> Result<LocalSolver> {
        let name = o.get_string("local_solver")?.unwrap_or_default();
        if REMOVED.iter().any(|r| r.eq_ignore_ascii_case(&name)) {
            return Err(Error::input(format!(
                "option {} is \"{name}\", which is not there any more: it was never faster; expected one of {}",
                o.full_name("local_solver"),
                Solver::ALL.map(Solver::name).join(", ")
            )));
        }
        let help = "factorisation of the subdomains";
        let kind = o.named("local_solver", self.kind, help)?;
        let help = "order of elimination in the subdomains";
        let names = Ordering::NAMES;
        let ordering = o.choice("local_ordering", names, self.ordering as usize, help)?;
        let chosen = LocalSolver {
            kind,
            ordering: match ordering {
                0 => Ordering::Auto,
                i => Ordering::ALL[i - 1],
            },
        };
        if !chosen.ordering.available() {
            let there = Ordering::ALL.into_iter().filter(|o| o.available());
            let there: Vec<&str> = there.map(Ordering::name).collect();
            return Err(Error::environment(format!(
                "option {} is \"{}\", which this build does not have; it has {}",
                o.full_name("local_ordering"),
                chosen.ordering.name(),
                there.join(", ")
            )));
        }
        Ok(chosen)
    }

    /// Analyses the pattern of `k`; `interface` lists the dofs that are kept, in the order wanted for S.
    ///
    /// # Errors
    /// [`NoFactor::Failed`].
    pub fn analyse(
        self,
        k: &Csr,
        interface: &[u32],
        coordinates: Option<&[[f64; 3]]>,
    ) -> std::result::Result<Arc<dyn Analysis>, NoFactor> {
        let ordering = self.ordering.taken();
        if (self.kind, ordering) == (Solver::Multifrontal, Ordering::Nd) {
            // Nested dissection yields the fronts directly: no elimination tree is needed.
            let symbolic = Symbolic::new(k, interface, coordinates);
            return Ok(Arc::new(Own::new(symbolic)));
        }
        let order =
            Elimination::new(k, interface, coordinates, ordering).map_err(NoFactor::Failed)?;
        Ok(match self.kind {
            Solver::Faer if !order.interior.is_empty() => Arc::new(faer::Faer::new(k, order)?),
            // This arm also serves an empty interior.
            _ => {
                let symbolic = Symbolic::with_supernodes(k, interface, &order.supernodes);
                Arc::new(Own::new(symbolic))
            }
        })
    }

    /// A condenser that analyses each matrix anew and keeps nothing of it.
    pub fn condenser(self, keep: Keep) -> Condenser<'static> {
        Condenser {
            solver: self,
            analysed: None,
            keep,
        }
    }
}

/// How the interior of one subdomain is eliminated.
#[derive(Debug, Clone, Copy)]
pub struct Condenser<'a> {
    /// The solver and the ordering.
    pub solver: LocalSolver,
    /// Where analyses of the same pattern and interface are found and left, if they are to be used again.
    pub analysed: Option<&'a Analysed>,
    /// The part of the factor that is kept.
    pub keep: Keep,
}

impl Condenser<'_> {
    /// Returns the factor and S of `k`; analyses `k` first where that has not been done.
    ///
    /// # Errors
    /// [`NoFactor`].
    pub fn condense(
        self,
        k: &Csr,
        interface: &[u32],
        coordinates: Option<&[[f64; 3]]>,
    ) -> std::result::Result<(Factor, Dense), NoFactor> {
        if let Some(analysis) = self.analysed.and_then(|a| a.dense.get()) {
            return analysis.condense(k, self.keep);
        }
        let analysis = self.solver.analyse(k, interface, coordinates)?;
        let made = analysis.condense(k, self.keep);
        if let Some(analysed) = self.analysed {
            // Another thread may have left one in the meantime, which is the same.
            let _ = analysed.dense.set(analysis);
        }
        made
    }
}
