//! Motions that even all candidate rows leave free, before anything is factored.

use mpi::topology::SimpleCommunicator;

use super::candidates::rows_of_bodies;
use super::columns::KernelColumns;
use super::freedom::{grouped, FreeMotion};
use super::gram::Gram;
use super::gram_matrix::GramMatrix;
use super::gram_pattern::{FactorSharing, GramPattern};
use super::pattern::meeting;
use super::rigid_motion::twists;
use super::rounding::rounding_of_rows;
use crate::feti::jump::operator::Jump;
use crate::substructures::Problem;
use base::linalg::dense::Dense;

/// The motions that all candidate rows together leave free, found without a factorisation. `combinations` has the
/// kernel of each body as combinations of the candidates for it, on every rank; `jump` has its entries at local dofs.
/// Collective.
pub fn free_motions(
    comm: &SimpleCommunicator,
    problem: &Problem,
    jump: &Jump,
    combinations: &[Dense],
) -> Vec<FreeMotion> {
    let columns = KernelColumns::of_defects(combinations.iter().map(|c| c.cols));
    if columns.n() == 0 {
        return Vec::new();
    }
    let kernels: Vec<Dense> = (problem.local.iter())
        .map(|sub| {
            let of_body = &combinations[sub.body];
            let mut kernel = Dense::zeros(sub.dofs.len(), of_body.cols);
            for c in 0..of_body.cols {
                let terms = of_body.col(c).iter().zip(sub.near_kernel.iter().flatten());
                for (factor, candidate) in terms {
                    let sums = kernel.col_mut(c).iter_mut().zip(candidate);
                    sums.for_each(|(sum, x)| *sum += factor * x);
                }
            }
            kernel
        })
        .collect();
    let rows = rows_of_bodies(comm, problem, jump, (&columns, &kernels));
    let lists = meeting(comm, &rows, &rows, columns.start());
    let shape = GramPattern::new(comm, &lists, columns.start(), &FactorSharing::any());
    let rows = rows.numbered(&shape.known);
    let candidates: Vec<bool> = (0..jump.n_owned).map(|i| jump.is_candidate(i)).collect();
    let noise = rounding_of_rows(comm, problem, jump, (&rows, &shape));
    let product = GramMatrix::default().renewed(comm, &shape, &rows, &candidates);
    let motions = Gram::without(&shape, product, (&[], &noise)).unheld;
    // The first rank with a subdomain of a body speaks for it.
    let first = jump.subdomains.first().copied();
    let owned = combinations.iter().enumerate();
    let owned =
        owned.filter(|(body, _)| first.is_some() && problem.local.iter().any(|s| s.body == *body));
    let mut twists = twists(comm, problem, &columns, owned, &motions);
    twists.iter_mut().for_each(|of| of.dedup_by_key(|t| t.body));
    grouped(problem, &columns, &motions, &twists)
}
