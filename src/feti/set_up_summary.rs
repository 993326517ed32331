//! Facts about the problem that the set-up finds.

use std::collections::BTreeMap;
use std::mem::size_of_val;
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;

use super::operators::dual::Dual;
use super::settings::Scaling;
use super::subdomain::problem::LocalProblem;
use super::subdomain::scaled::ScaledSubdomain;
use parallel::exchange::sum_all;

/// Facts about the problem as the solver sees it.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct SetUpSummary {
    /// The weights of the scaled jump operator.
    pub scaling: Scaling,
    /// Rows of B_loc.
    pub multipliers_local: usize,
    /// Rows of B_gl.
    pub multipliers_global: usize,
    /// Rows of B_gl that hold.
    pub multipliers_active: usize,
    /// Rows of B_gl that are inequalities.
    pub inequalities: usize,
    /// Bodies with a kernel.
    pub floating_bodies: usize,
    /// Dimension of all kernels, r.
    pub kernel_dimension: usize,
    /// The part of r that this rank has numbers for: the kernels of its own bodies and of those around them, and what
    /// its part of the natural coarse problem leads to. r where it is small, and where ranks do not share one factor.
    pub kernel_dimension_here: usize,
    /// Primal dofs of all bodies.
    pub primal: usize,
    /// Adaptive primal constraints in each body; empty where no edge or face is tested.
    pub adaptive_constraints: Vec<usize>,
    /// Seconds of set-up for finding the adaptive constraints and making them primal.
    pub adaptive_seconds: f64,
    /// Number of different subdomains on this rank. Each of them is factored once.
    pub kinds: usize,
    /// Number of these kinds with S and T as sparse solves.
    pub implicit_kinds: usize,
    /// Number of subdomains of this rank with S in single precision.
    pub in_single: usize,
    /// Bytes of the subdomains' sparse factors on this rank.
    pub factor_bytes: usize,
    /// Bytes of the subdomains' dense operators on this rank.
    pub dense_bytes: usize,
    /// Seconds of set-up.
    pub setup_seconds: f64,
}

impl SetUpSummary {
    /// The facts of these operators. The fields about the time and the additions of set-up are left empty. Collective.
    pub(super) fn new(comm: &SimpleCommunicator, dual: &Dual, scaling: Scaling) -> SetUpSummary {
        let (stiffness, natural) = (&dual.stiffness, &dual.natural);
        let jump = &stiffness.jump;
        let contact = jump.active[jump.n_owned_local..].iter();
        let active = contact.filter(|a| **a).count();
        let inequalities = jump.law.iter().filter(|law| law.is_inequality()).count();
        let mut counts = [active as f64, inequalities as f64];
        sum_all(comm, &mut counts);
        let mut kinds: Vec<&Arc<LocalProblem>> =
            stiffness.locals.iter().map(ScaledSubdomain::kind).collect();
        kinds.sort_by_key(|l| Arc::as_ptr(l));
        kinds.dedup_by(|a, b| Arc::ptr_eq(a, b));
        let bytes = kinds.iter().map(|l| l.bytes());
        let (factor_bytes, dense_bytes) = bytes.fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        // Turned copies have Ψ of their own, those that are turned alike one in common.
        let turned = stiffness.locals.iter().filter(|l| l.turn().is_some());
        let psi: BTreeMap<u64, usize> = turned
            .map(|l| (l.name(), size_of_val(&l.gamma().psi.data[..])))
            .collect();
        let dense_bytes = dense_bytes + psi.values().sum::<usize>();
        SetUpSummary {
            scaling,
            multipliers_local: jump.n_local,
            multipliers_global: jump.n_global - jump.n_local,
            multipliers_active: counts[0] as usize,
            inequalities: counts[1] as usize,
            floating_bodies: natural.columns.floating(),
            kernel_dimension: natural.r,
            kernel_dimension_here: natural.known().n(),
            primal: stiffness.space.n_global,
            kinds: kinds.len(),
            implicit_kinds: kinds.iter().filter(|k| k.is_implicit()).count(),
            in_single: dual.preconditioner.in_single(),
            factor_bytes,
            dense_bytes,
            ..SetUpSummary::default()
        }
    }
}
