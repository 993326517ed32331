//! The bodies' primal problem S_Π behind a PETSc KSP (prefix `fetifeti_coarse_`).
//!
//! S_Π is block diagonal by body, and a body's rows live on one rank, so block Jacobi with a Cholesky factorisation per rank
//! solves it exactly without a message. Any other KSP and PC may be chosen by options.

use super::clock::{self, Phase};
use super::halo::Halo;
use super::primal::PrimalSpace;
use crate::petsc::{Comm, Ksp, Mat, MatFlag, Options, Session, Vec as PetscVec};
use crate::{Error, Result};

/// S_Π, regularised, with its solver. Nothing at all where no body has primal dofs.
pub struct PrimalProblem {
    parts: Option<Parts>,
}

struct Parts {
    ksp: Ksp,
    rhs: PetscVec,
    solution: PetscVec,
    halo: Halo,
}

impl PrimalProblem {
    /// Assembles the matrix and sets its solver up. Collective.
    pub fn new(session: &Session, space: &PrimalSpace, prefix: &str) -> Result<PrimalProblem> {
        if space.n_global == 0 {
            return Ok(PrimalProblem { parts: None });
        }
        let entries = space.entries.iter();
        let triplets: Vec<(i32, i32, f64)> = entries
            .map(|e| (e.row as i32, e.col as i32, e.value))
            .collect();
        let matrix = Mat::from_triplets(
            session,
            Comm::World,
            space.n_owned,
            space.n_owned,
            &triplets,
        )?;
        matrix.set_flag(MatFlag::Spd)?;
        let rhs = PetscVec::mpi(session, space.n_owned)?;
        let solution = rhs.duplicate()?;
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
        // The blocks have read theirs; a host's database is not ours to keep things in.
        for name in lent {
            options.clear_value(name)?;
        }
        let halo = Halo::new(session, &rhs, &space.ghosts)?;
        Ok(PrimalProblem {
            parts: Some(Parts {
                ksp,
                rhs,
                solution,
                halo,
            }),
        })
    }

    /// `values` (at this rank's ghosts): in, every rank's contributions to Ψᵀ v; out, S_Π⁺ of their sum. Collective.
    pub fn solve(&self, values: &mut [f64]) -> Result<()> {
        let Some(p) = &self.parts else { return Ok(()) };
        p.halo.sum(values, &p.rhs)?;
        clock::timed(Phase::Primal, || p.ksp.solve(&p.rhs, &p.solution))?;
        let reason = p.ksp.converged_reason()?;
        if reason.code < 0 {
            return Err(Error::NotConverged(format!(
                "the primal problem of the bodies was not solved ({}): change the -fetifeti_coarse_ options, or take more constraints with -fetifeti_primal",
                reason.name
            )));
        }
        p.halo.fetch(&p.solution, values)
    }

    /// Σ r²/d of two vectors of which every rank has contributions at its ghosts. Collective.
    pub fn weighted_square(&self, r: &[f64], d: &[f64]) -> Result<f64> {
        let Some(p) = &self.parts else { return Ok(0.0) };
        p.halo.sum(r, &p.rhs)?;
        p.halo.sum(d, &p.solution)?;
        let quotient = p.rhs.duplicate()?;
        quotient.pointwise_divide(&p.rhs, &p.solution)?;
        quotient.dot(&p.rhs)
    }
}
