//! Automatic choices of the method: the weights by the kind of problem; M_C or M_D by a model of cost, which decides
//! whether lifting jumps into whole bodies pays.
//!
//! M_C takes fewer iterations than M_D if many subdomains lie across a body. It costs a product S Z_c per subdomain and
//! a dense A per body; in every iteration it reads Y = S Z_c twice or S once more. In the plane a subdomain sees a
//! dozen columns of Z_c for each component, in space 200 from vertices and 600 with averages.

use std::collections::BTreeSet;

use mpi::topology::SimpleCommunicator;

use super::forms::{self, APPLICATIONS, DENSE_SHARED, FLOP};
use crate::feti::interface::sharing::DofSharing;
use crate::feti::jump::operator::Jump;
use crate::feti::operators::preconditioner::coarse_corrected::COARSE_CORRECTED;
use crate::feti::operators::preconditioner::dirichlet::DIRICHLET;
use crate::feti::operators::preconditioner::PreconditionerKind;
use crate::feti::settings::{Averages, CoarseFunctions, MethodSettings, Primal, Scaling};
use crate::substructures::Problem;
use parallel::exchange::{sum_all, total};

/// Columns that each neighbour adds to those that a subdomain sees, relative to the subdomain's own columns, in the
/// plane and in space. The neighbour's other columns are shared already.
const NEW_COLUMNS: [f64; 2] = [0.4, 0.3];

/// Number of subdomains that share a column, in the plane and in space.
const SHARED_BY: [f64; 2] = [2.7, 5.0];

/// Seconds per entry of a matrix that is read for one vector.
const DENSE_BY_ITSELF: f64 = 4e-10;

/// A subdomain with more neighbours than this lies in space; so does every mesh that is called ragged. A mesh of a thin
/// part may have fewer.
const PLANE: f64 = 9.0;

/// Seconds of an application of F and M⁻¹ per interface dof, without the dense operators, in the plane and in space:
/// jumps, Ψ, vectors. In space more copies are tied.
const PER_DOF: [f64; 2] = [6e-8, 1.6e-7];

/// The iterations of M_D grow with the number of subdomains across a body, H_b/H_s, as √(1 + this · (H_b/H_s − 1));
/// those of M_C do not. The values are for the plane, for tied problems in space, and for inequalities in space
/// (measured at H_b/H_s from 4.8 to 6.3).
const GROWTH: [f64; 3] = [0.35, 0.65, 1.6];

/// Iterations of M_C in space, in all steps of a contact loop together.
const ITERATIONS_IN_SPACE: f64 = 12.0;

/// Fraction of the subdomains in space that need a block of A of their own if bodies are cut regularly. The others
/// share a block with subdomains in the same surroundings.
const OF_ITS_OWN: f64 = 0.5;

/// Cost of both preconditioners on this rank, from sizes alone. The sum over the ranks does not depend on their number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct PreconditionerCost {
    /// Seconds of set-up that M_C adds.
    setup: f64,
    /// Seconds that M_C adds to an iteration.
    more: f64,
    /// Seconds of an iteration with M_D.
    iteration: f64,
}

/// The preconditioner that `auto` takes.
#[derive(Debug, Clone, Copy)]
pub struct PreconditionerChoice {
    /// Its kind.
    pub kind: &'static PreconditionerKind,
    /// Its reason, for `plan`.
    pub why: &'static str,
}

/// The quantities that determine the number of iterations.
#[derive(Debug, Clone, Copy)]
struct IterationModel {
    /// H_b/H_s.
    across: f64,
    in_space: bool,
    inequalities: bool,
}

impl PreconditionerCost {
    /// Whether M_C pays. In space it pays if it takes less time. In the plane it pays if its additional time is less
    /// than the time of all iterations with M_D. It is the safer choice there, because neither subdomains nor
    /// coefficients change its number of iterations much.
    fn pays(&self, shape: IterationModel) -> bool {
        let contact = usize::from(shape.inequalities);
        let (few, growth, own) = if shape.in_space {
            (ITERATIONS_IN_SPACE, GROWTH[1 + contact], self.iteration)
        } else {
            (APPLICATIONS[contact], GROWTH[0], 0.0)
        };
        let many = few * (1.0 + growth * (shape.across - 1.0)).sqrt();
        self.setup + few * (own + self.more) < many * self.iteration
    }
}

/// The primal constraints.
pub fn constraints(settings: &MethodSettings) -> Primal {
    Primal {
        averages: settings.averages.unwrap_or(Averages::Components),
        ..settings.primal
    }
}

/// The weights D. Where a subdomain of a mesh in space has a single corner of a cell at a node, it resists little
/// there. As large a weight as its neighbours have lets κ grow: 889 instead of 55 for the case `rod-4` of `bench`. In
/// the plane ρ is the better weight (8 instead of 20 for the case `holes`).
pub fn scaling(problem: &Problem) -> Scaling {
    if problem.ragged {
        Scaling::Stiffness
    } else {
        Scaling::Rho
    }
}

/// The preconditioner of the model: M_C if there is something to lift (a body cut into subdomains that other bodies
/// pull at) and if it pays; else M_D. Collective.
pub fn preconditioner(
    comm: &SimpleCommunicator,
    problem: &Problem,
    sharing: &DofSharing,
    jump: &Jump,
    functions: CoarseFunctions,
) -> PreconditionerChoice {
    let cut = problem.n_subdomains > problem.n_bodies;
    if !(cut && problem.n_bodies > 1 && jump.n_global > jump.n_local) {
        return PreconditionerChoice {
            kind: &DIRICHLET,
            why: "there is nothing to lift",
        };
    }
    let neighbours = |j: usize| {
        let sub = &problem.local[j];
        let shared = sharing.shared_dofs[j].iter();
        let copies = shared.flat_map(|&i| sharing.shared(sub.dofs[i as usize]));
        let others: BTreeSet<u32> = copies.map(|c| c.subdomain).collect();
        (others.len() as f64 - 1.0).max(0.0)
    };
    let neighbours: Vec<f64> = (0..problem.local.len()).map(neighbours).collect();
    let seen = total(comm, neighbours.iter().sum());
    let (n, bodies) = (problem.n_subdomains as f64, problem.n_bodies as f64);
    let space = usize::from(problem.ragged || seen / n > PLANE);
    let mut sum = PreconditionerCost::default();
    let mut primal = 0.0;
    for (j, m) in neighbours.iter().enumerate() {
        let averages = match functions {
            CoarseFunctions::All => jump.averages[j].len(),
            CoarseFunctions::Vertices => 0,
        };
        let own = (jump.n_shared[j] + averages) as f64;
        let columns = own * (1.0 + NEW_COLUMNS[space] * m);
        let n_gamma = (jump.delta[j].len() + jump.primal[j].len()) as f64;
        sum.setup += FLOP * (n_gamma.powi(2) * columns + n_gamma * columns.powi(2));
        // M_C reads S as a matrix. Without copies every subdomain has S and T made for itself alone then, where M_D
        // solves with sparse factors.
        if problem.ragged && !forms::is_short(n_gamma as usize) {
            sum.setup += FLOP * n_gamma.powi(3);
        }
        let stored = DENSE_BY_ITSELF * 2.0 * n_gamma * columns;
        let again = DENSE_SHARED * n_gamma.powi(2) + 0.5 * PER_DOF[space] * n_gamma;
        sum.more += stored.min(again);
        sum.iteration += DENSE_SHARED * 2.0 * n_gamma.powi(2) + PER_DOF[space] * n_gamma;
        primal += own;
    }
    let inequalities = jump.law.iter().filter(|law| law.is_inequality()).count() as f64;
    let mut all = [sum.setup, sum.more, sum.iteration, primal, inequalities];
    sum_all(comm, &mut all);
    let [setup, more, iteration, primal, inequalities] = all;
    let order = primal / SHARED_BY[space] / bodies;
    let part = if space == 1 { OF_ITS_OWN } else { 1.0 };
    let estimate = PreconditionerCost {
        // A of every body is factored, and applied in every iteration.
        setup: part * setup + bodies * FLOP * order.powi(3) / 3.0,
        more: more + bodies * DENSE_BY_ITSELF * order.powi(2),
        iteration,
    };
    let dimension = if space == 1 { 3.0 } else { 2.0 };
    let shape = IterationModel {
        across: (n / bodies).powf(1.0 / dimension),
        in_space: space == 1,
        inequalities: inequalities > 0.0,
    };
    if estimate.pays(shape) {
        PreconditionerChoice {
            kind: &COARSE_CORRECTED,
            why: "jumps between bodies are lifted into whole bodies",
        }
    } else {
        PreconditionerChoice {
            kind: &DIRICHLET,
            why: "to lift jumps into whole bodies would cost more than it saves",
        }
    }
}
