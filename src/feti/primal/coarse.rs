//! The bodies' primal problem S_Π.
//!
//! S_Π is block diagonal by body, and the rows of a body live on one rank. The crate's own Cholesky factorisation of
//! each body solves S_Π exactly and without a message. Any option `-fetifeti_coarse_…` selects a PETSc KSP instead.

use super::body::{AnalysedPattern, PrimalFactor};
use super::matrix::PrimalMatrix;
use super::space::PrimalSpace;
use crate::{Error, Result};
use parallel::clock::{self, Phase};
use parallel::exchange::any;
use parallel::halo::Halo;
use parallel::team::Team;
use petsc::{Comm, Ksp, Mat, MatFlag, Options, Session, Vec as PetscVec};

/// S_Π, regularised, with its solver; empty if no body has primal dofs.
pub struct PrimalProblem {
    parts: Option<AssembledPrimal>,
}

struct AssembledPrimal {
    session: Session,
    solver: PrimalSolver,
    rhs: PetscVec,
    solution: PetscVec,
    halo: Halo,
}

enum PrimalSolver {
    /// A factor for each body of this rank.
    Own(Vec<PrimalFactor>),
    Petsc(Ksp),
}

impl PrimalProblem {
    /// Assembles the matrix and sets its solver up; consumes S_Π. `known` has patterns of an earlier set-up by body,
    /// and may be empty; `keeps`: there may be a later one. Collective.
    pub fn new(
        session: &Session,
        space: &mut PrimalSpace,
        team: &Team,
        prefix: &str,
        (known, keeps): (&[AnalysedPattern], bool),
    ) -> Result<PrimalProblem> {
        if space.n_global == 0 {
            return Ok(PrimalProblem { parts: None });
        }
        let matrix = std::mem::take(&mut space.matrix);
        let rhs = PetscVec::mpi(session, space.n_owned)?;
        let own = if Options::new(session, prefix).any()? {
            None
        } else {
            own(session, space, team, &matrix, (known, keeps))
        };
        let solver = match own {
            Some(bodies) => PrimalSolver::Own(bodies),
            // A factorisation may fail on one rank alone.
            None => PrimalSolver::Petsc(session.agree(petsc(session, space, &matrix, prefix))?),
        };
        let solution = rhs.duplicate()?;
        let halo = Halo::new(session, &rhs, &space.ghosts)?;
        Ok(PrimalProblem {
            parts: Some(AssembledPrimal {
                session: session.clone(),
                solver,
                rhs,
                solution,
                halo,
            }),
        })
    }

    /// The patterns of this rank's bodies, if they are kept; or none.
    pub fn patterns(&self) -> Vec<AnalysedPattern> {
        let of = |solver: &PrimalSolver| match solver {
            PrimalSolver::Own(bodies) => bodies.iter().map(|b| b.pattern.clone()).collect(),
            PrimalSolver::Petsc(_) => None,
        };
        let found = self.parts.as_ref().and_then(|p| of(&p.solver));
        found.unwrap_or_default()
    }

    /// Applies S_Π⁺. `values` (at this rank's ghosts) has the rank's contributions to Ψᵀ v on entry and S_Π⁺ of their
    /// sum on return. Collective.
    pub fn solve(&self, team: &Team, values: &mut [f64]) -> Result<()> {
        self.begin(values)?;
        self.finish(team, values)
    }

    /// The first half of [`solve`](Self::solve): sends the contributions. Collective.
    pub fn begin(&self, values: &[f64]) -> Result<()> {
        match &self.parts {
            Some(p) => p.halo.sum_begin(values, &p.rhs),
            None => Ok(()),
        }
    }

    /// The second half: receives the contributions and solves. Collective.
    pub fn finish(&self, team: &Team, values: &mut [f64]) -> Result<()> {
        let Some(p) = &self.parts else { return Ok(()) };
        p.halo.sum_end(&p.rhs)?;
        match &p.solver {
            PrimalSolver::Petsc(ksp) => {
                let solved = clock::timed(Phase::Primal, || ksp.solve(&p.rhs, &p.solution));
                // Every rank has blocks of its own, and a reason of its own: that of a block which cannot be factored
                // does not reach the others, which would wait for ever in the next exchange.
                p.session
                    .agree(solved.and_then(|()| solved_to_the_end(ksp)))?;
            }
            PrimalSolver::Own(bodies) => {
                p.solution.copy_from(&p.rhs)?;
                let mut solution = p.solution.array_mut()?;
                // The part of each body.
                let (mut rest, mut first) = (&mut solution[..], 0);
                let mut parts = Vec::with_capacity(bodies.len());
                for body in bodies {
                    let (_, from) = rest.split_at_mut(body.first - first);
                    let (part, after) = from.split_at_mut(body.factor.n());
                    (rest, first) = (after, body.first + part.len());
                    parts.push(part);
                }
                clock::timed(Phase::Primal, || {
                    team.for_each(&mut parts, |b, x| bodies[b].factor.solve(x));
                });
            }
        }
        p.halo.fetch(&p.solution, values)
    }

    /// Σ r²/d, where every rank has contributions to the vectors r and d at its ghosts. Collective.
    pub fn weighted_square(&self, r: &[f64], d: &[f64]) -> Result<f64> {
        let Some(p) = &self.parts else { return Ok(0.0) };
        p.halo.sum(r, &p.rhs)?;
        p.halo.sum(d, &p.solution)?;
        let quotient = p.rhs.duplicate()?;
        quotient.pointwise_divide(&p.rhs, &p.solution)?;
        quotient.dot(&p.rhs)
    }
}

/// A factor for each body of this rank; `None` on all ranks if one of the matrices is too close to singular for a
/// Cholesky factorisation. Collective.
fn own(
    session: &Session,
    space: &PrimalSpace,
    team: &Team,
    matrix: &PrimalMatrix,
    (known, keeps): (&[AnalysedPattern], bool),
) -> Option<Vec<PrimalFactor>> {
    let bodies = team.map(space.owned.len(), |b| {
        let range = &space.owned[b].range;
        PrimalFactor::new(range.start, &matrix.sparse(range), known.get(b), keeps)
    });
    let bodies: Option<Vec<_>> = bodies.into_iter().collect();
    // All ranks make the same choice.
    let failed = any(session.comm(), bodies.is_none());
    bodies.filter(|_| !failed)
}

/// Returns an error if the last solve failed on this rank.
fn solved_to_the_end(ksp: &Ksp) -> Result<()> {
    let reason = ksp.converged_reason()?;
    if reason.code >= 0 {
        return Ok(());
    }
    Err(Error::not_converged(format!(
        "the primal problem of the bodies was not solved ({}): leave the -fetifeti_coarse_ options \
         at their defaults, or take a solver for symmetric matrices that are close to singular, \
         such as -fetifeti_coarse_ksp_type cg -fetifeti_coarse_pc_type jacobi",
        reason.name
    )))
}

/// The KSP with the prefix `fetifeti_coarse_`.
fn petsc(
    session: &Session,
    space: &PrimalSpace,
    matrix: &PrimalMatrix,
    prefix: &str,
) -> Result<Ksp> {
    let triplets = matrix.triplets();
    let n = space.n_owned;
    let matrix = Mat::from_triplets(session, Comm::World, n, n, &triplets)?;
    matrix.set_flag(MatFlag::Spd)?;
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_operators(&matrix, &matrix)?;
    ksp.set_options_prefix(prefix)?;
    ksp.set_type("preonly")?;
    let pc = ksp.pc()?;
    let options = Options::new(session, prefix);
    let mut lent = Vec::new();
    if session.size() == 1 {
        pc.set_type("cholesky")?;
    } else {
        // Every body's primal dofs are on one rank.
        pc.set_type("bjacobi")?;
        for (name, value) in [("sub_ksp_type", "preonly"), ("sub_pc_type", "cholesky")] {
            if options.set_default(name, value)? {
                lent.push(name);
            }
        }
    }
    ksp.set_from_options()?;
    ksp.setup()?;
    // The blocks have read their options. The host's options database must not keep them.
    for name in lent {
        options.clear_value(name)?;
    }
    Ok(ksp)
}
