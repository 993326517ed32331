//! Who eliminates the interior of a subdomain, and in which order.
//!
//! Two things are asked of a solver: K = L Lᵀ with solves ([`SparseCholesky`]), and elimination of the interior alone, which leaves the Schur
//! complement S on the interface and a [`Factor`] for condensed loads and interior solutions:
//!
//! | solver | S | factor of the interior |
//! |---|---|---|
//! | own multifrontal | what reaches the root | its fronts |
//! | faer | interface last in L Lᵀ = K + diag(0, D): S = L_ΓΓ L_ΓΓᵀ − D | the supernodes of L, without those of Γ |
//!
//! D, the diagonal of K_ΓΓ, makes K of a floating subdomain definite; S loses no more than rounding errors of K_ΓΓ.
//!
//! A pivot that is not positive, or below 1e-13 of the diagonal entry it came from, is an error for both.

mod analysis;
mod boundary;
mod factor;
mod faer;
mod graph;
mod order;
mod own;
mod triangle;

#[cfg(test)]
mod tests;

use super::symbolic::Keep;
use crate::linalg::csr::Csr;
use crate::linalg::dense::Dense;
use crate::petsc::Options;
use crate::{Error, Result};

pub use analysis::{Analysis, NoFactor};
pub use factor::{Factor, SparseCholesky};
pub use order::{Elimination, Ordering};

/// Who factors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Our multifrontal method on faer's dense kernels.
    #[default]
    Multifrontal,
    /// faer's supernodal or simplicial factorisation.
    Faer,
}

impl Solver {
    /// All of them.
    pub const ALL: [Solver; 2] = [Solver::Multifrontal, Solver::Faer];

    /// Names as the option takes them.
    pub const NAMES: &'static [&'static str] = &["multifrontal", "faer"];

    /// The name as the option takes it.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// Names that the option took before 0.2.
const REMOVED: [&str; 2] = ["cholmod", "mumps"];

/// How subdomains are factored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LocalSolver {
    /// Who factors.
    pub kind: Solver,
    /// In which order.
    pub ordering: Ordering,
}

impl LocalSolver {
    /// What the options `local_solver` and `local_ordering` say, `self` where they are not given.
    ///
    /// # Errors
    /// A name that there is not, or not any more; [`Error::Environment`] for an ordering that this build does not have.
    pub fn from_options(self, o: &Options) -> Result<LocalSolver> {
        let name = o.get_string("local_solver")?.unwrap_or_default();
        if REMOVED.iter().any(|r| r.eq_ignore_ascii_case(&name)) {
            return Err(Error::input(format!(
                "option {} is \"{name}\", which is not there any more: it was never faster; expected one of {}",
                o.full_name("local_solver"),
                Solver::NAMES.join(", ")
            )));
        }
        let help = "factorisation of the subdomains";
        let kind = o.choice("local_solver", Solver::NAMES, self.kind as usize, help)?;
        let help = "order of elimination in the subdomains";
        let names = Ordering::NAMES;
        let ordering = o.choice("local_ordering", names, self.ordering as usize, help)?;
        let chosen = LocalSolver {
            kind: Solver::ALL[kind],
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
    ) -> std::result::Result<Box<dyn Analysis>, NoFactor> {
        let ordering = self.ordering.taken();
        if (self.kind, ordering) == (Solver::Multifrontal, Ordering::Nd) {
            // Nested dissection knows its fronts: no elimination tree is needed.
            return Ok(Box::new(own::Own::nested(k, interface, coordinates)));
        }
        let order =
            Elimination::new(k, interface, coordinates, ordering).map_err(NoFactor::Failed)?;
        Ok(match self.kind {
            Solver::Faer if !order.interior.is_empty() => Box::new(faer::Faer::new(k, order)?),
            // Or there is nothing to factor.
            _ => Box::new(own::Own::new(k, &order)),
        })
    }

    /// Condenses with an analysis for each matrix.
    pub fn condenser(self, keep: Keep) -> Condenser<'static> {
        Condenser {
            solver: self,
            analysis: None,
            keep,
        }
    }
}

/// How the interior of one subdomain is eliminated.
#[derive(Debug, Clone, Copy)]
pub struct Condenser<'a> {
    /// By whom.
    pub solver: LocalSolver,
    /// The analysis of a matrix with the same pattern and interface, where there is one.
    pub analysis: Option<&'a dyn Analysis>,
    /// What is kept.
    pub keep: Keep,
}

impl Condenser<'_> {
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
