//! Primal dofs that nothing holds: rows of zeros in all subdomains that share a vertex.

use super::space::PrimalSpace;
use crate::feti::subdomain::factor::no_stiffness;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::Problem;
use crate::Result;
use parallel::exchange::{any, gather_all};
use petsc::Session;

/// Refuses vertices whose rows of S_Π are zero, by the place of the first. Collective.
///
/// # Errors
/// [`ErrorKind::Unfit`](base::ErrorKind::Unfit), on all ranks.
pub fn check(
    session: &Session,
    problem: &Problem,
    space: &PrimalSpace,
    locals: &[ScaledSubdomain],
) -> Result<()> {
    let comm = session.comm();
    let slack: Vec<usize> = space.matrix.slack().map(|i| space.first + i).collect();
    if !any(comm, !slack.is_empty()) {
        return Ok(());
    }
    let slack = gather_all(comm, &slack).concat();
    let numbers = space.of_subdomain.iter().enumerate();
    let mut vertices = numbers.flat_map(|(j, numbers)| {
        let n = locals[j].gamma().n_vertices();
        numbers[..n]
            .iter()
            .enumerate()
            .map(move |(p, &g)| (j, p, g))
    });
    let found = vertices.find(|&(_, _, g)| slack.contains(&(space.ghosts[g as usize] as usize)));
    session.agree(match found {
        None => Ok(()),
        Some((j, p, _)) => {
            let gamma = locals[j].gamma();
            let dof = gamma.interface[gamma.n_delta + p];
            Err(no_stiffness(problem, &problem.local[j], dof))
        }
    })
}
