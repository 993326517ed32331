//! M_C or M_D: whether lifting jumps into whole bodies pays.
//!
//! M_C takes fewer iterations the more subdomains lie across a body, and costs a product S Z_c per subdomain, a dense A per body, and reading Y = S Z_c
//! twice in every iteration. In the plane a subdomain sees some 40 columns of Z_c, in space several hundred, more than its interface has dofs.

use std::collections::BTreeSet;

use mpi::topology::SimpleCommunicator;

use super::exchange::sum_all;
use super::forms::{APPLICATIONS, DENSE, DENSE_SHARED, FLOP};
use super::jump::Jump;
use super::settings::PcType;
use super::sharing::Sharing;
use crate::substructures::Substructures;

/// Each neighbour adds this part of a subdomain's own primal dofs to the columns that it sees; the others it shares already.
const NEW_COLUMNS: f64 = 0.4;

/// Each primal dof is shared by so many subdomains, in the plane and in space.
const SHARED_BY: [f64; 2] = [2.7, 5.0];

/// Subdomains with more neighbours lie in space.
const PLANE: f64 = 9.0;

/// Seconds of an application of F and M⁻¹ per dof of an interface besides the dense operators: jumps, Ψ, vectors.
const PER_DOF: f64 = 6e-8;

/// Iterations of M_D grow with the subdomains across a body, H_b/H_s, as √(1 + this · (H_b/H_s − 1)) where those of M_C do not.
const GROWTH: f64 = 0.35;

/// What both cost on this rank, from sizes alone: the same on any number of ranks once it is added up.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Estimate {
    /// Seconds of set-up that M_C adds.
    setup: f64,
    /// Seconds that it adds to an iteration.
    more: f64,
    /// Seconds of an iteration with M_D.
    iteration: f64,
}

/// H_b/H_s, and the applications that a set-up is for.
#[derive(Debug, Clone, Copy)]
struct Shape {
    across: f64,
    applications: f64,
}

impl Estimate {
    /// Whether what M_C adds is less than all iterations with M_D: it is the safer one, with numbers of iterations that neither subdomains nor
    /// coefficients change much, and takes more memory.
    fn pays(&self, shape: Shape) -> bool {
        let few = shape.applications;
        let many = few * (1.0 + GROWTH * (shape.across - 1.0)).sqrt();
        self.setup + few * self.more < many * self.iteration
    }
}

/// M_C where there is something to lift, a body cut into subdomains that other bodies pull at, and where it costs little enough; else M_D. Collective.
pub fn preconditioner(
    comm: &SimpleCommunicator,
    problem: &Substructures,
    sharing: &Sharing,
    jump: &Jump,
) -> PcType {
    let cut = problem.n_subdomains > problem.n_bodies;
    if !(cut && problem.n_bodies > 1 && jump.n_global > jump.n_local) {
        return PcType::Dirichlet;
    }
    let mut sum = Estimate::default();
    let (mut neighbours, mut primal) = (0.0, 0.0);
    for (j, sub) in problem.local.iter().enumerate() {
        let shared = sharing.shared_dofs[j].iter();
        let copies = shared.flat_map(|&i| sharing.shared(sub.dofs[i as usize]));
        let others: BTreeSet<u32> = copies.map(|c| c.subdomain).collect();
        let m = (others.len() as f64 - 1.0).max(0.0);
        let own = (jump.n_shared[j] + jump.averages[j].len()) as f64;
        let columns = own * (1.0 + NEW_COLUMNS * m);
        let n_gamma = (jump.delta[j].len() + jump.primal[j].len()) as f64;
        sum.setup += FLOP * (n_gamma.powi(2) * columns + n_gamma * columns.powi(2));
        sum.more += DENSE * 2.0 * n_gamma * columns;
        sum.iteration += DENSE_SHARED * 2.0 * n_gamma.powi(2) + PER_DOF * n_gamma;
        neighbours += m;
        primal += own;
    }
    let inequalities = jump.inequality.iter().filter(|i| **i).count() as f64;
    let mut all = [
        sum.setup,
        sum.more,
        sum.iteration,
        neighbours,
        primal,
        inequalities,
    ];
    sum_all(comm, &mut all);
    let [setup, more, iteration, neighbours, primal, inequalities] = all;
    let (n, bodies) = (problem.n_subdomains as f64, problem.n_bodies as f64);
    let in_space = neighbours / n > PLANE;
    let order = primal / SHARED_BY[usize::from(in_space)] / bodies;
    let estimate = Estimate {
        // A of every body is factored, and solved with.
        setup: setup + bodies * FLOP * order.powi(3) / 3.0,
        more: more + bodies * DENSE * order.powi(2),
        iteration,
    };
    let dimension = if in_space { 3.0 } else { 2.0 };
    let shape = Shape {
        across: (n / bodies).powf(1.0 / dimension),
        applications: APPLICATIONS[usize::from(inequalities > 0.0)],
    };
    match estimate.pays(shape) {
        true => PcType::CoarseCorrected,
        false => PcType::Dirichlet,
    }
}
