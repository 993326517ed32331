//! Sizes of all operators, counted exactly without a factorisation (`fetifeti plan`).

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::choice::{self, PreconditionerChoice};
use super::forms;
use crate::feti::interface::sharing::DofSharing;
use crate::feti::interface::{entities, location};
use crate::feti::jump::operator::Jump;
use crate::feti::primal::kernel::{self, SentFactors};
use crate::feti::projector::freedom::FreeMotion;
use crate::feti::projector::planned::free_motions;
use crate::feti::settings::{CoarseFunctions, Operators, Primal};
use crate::feti::subdomain::equal;
use crate::feti::subdomain::which::OperatorForm;
use crate::substructures::Problem;
use crate::Result;
use base::linalg::dense::Dense;
use parallel::exchange::{highest, sum_all};
use parallel::parcels::Parcels;
use parallel::team::Team;
use petsc::Session;

/// Sizes over all ranks.
#[derive(Debug, Clone)]
pub struct ProblemSizes {
    /// Rows of B_loc.
    pub multipliers_local: usize,
    /// Rows of B_gl.
    pub multipliers_global: usize,
    /// Rows of B_gl that hold.
    pub multipliers_active: usize,
    /// Rows of B_gl that are inequalities.
    pub inequalities: usize,
    /// Primal dofs of all bodies, averages included, fixing dofs left out.
    pub primal: usize,
    /// Largest primal problem of a body.
    pub largest_primal: usize,
    /// Largest number of interface dofs of a subdomain.
    pub largest_interface: usize,
    /// Dimension of every body's kernel.
    pub defect: Vec<usize>,
    /// The motions that no candidate row holds.
    pub free: Vec<FreeMotion>,
    /// Number of different subdomains, counted once per rank.
    pub kinds: usize,
    /// Number of these kinds with S and T as sparse solves.
    pub implicit_kinds: usize,
    /// The preconditioner that is used if the user chooses none.
    pub preconditioner: PreconditionerChoice,
    /// Bytes of the sparse factors.
    pub factor_bytes: f64,
    /// Bytes of the dense operators S, T, Ψ.
    pub dense_bytes: f64,
}

impl ProblemSizes {
    /// Counts the sizes with the chosen constraints. Collective.
    ///
    /// # Errors
    /// Numbers of dofs, subdomains or bodies that make no problem; the same error on all ranks.
    pub fn with(
        session: &Session,
        problem: &Problem,
        team: &Team,
        constraints: Primal,
    ) -> Result<ProblemSizes> {
        let comm = session.comm();
        session.agree(entities::check(problem, constraints))?;
        session.agree(location::check(comm, problem))?;
        let weights: Vec<Vec<f64>> = problem.local.iter().map(|s| s.rho.clone()).collect();
        let sharing = DofSharing::new(comm, problem, &weights, constraints)?;
        let jump = Jump::new(comm, problem, &sharing);
        let first = equal::representatives(problem, &jump, team);
        let kinds = forms::kinds(problem, &jump, &first);
        let preconditioner =
            choice::preconditioner(comm, problem, &sharing, &jump, CoarseFunctions::Vertices);
        let contact = jump.law.iter().any(|law| law.is_inequality());
        let (forms, _) = forms::choose(
            &kinds,
            &vec![None; kinds.len()],
            team,
            Operators::Auto,
            forms::APPLICATIONS[usize::from(contact)],
            forms::usual_memory(comm.size() as usize),
            preconditioner.kind.needs_s,
        );
        let entries = team.map(kinds.len(), |k| kinds[k].factor_entries(forms[k]));

        let mut primal = vec![0.0; problem.n_bodies];
        let mut sums = [0.0; 6];
        sums[4] = kinds.len() as f64;
        for ((kind, form), &entries) in kinds.iter().zip(&forms).zip(&entries) {
            let j = kind.j;
            let n_delta = jump.delta[j].len() as f64;
            let n_gamma = n_delta + jump.primal[j].len() as f64;
            let n_pi = (jump.primal[j].len() + jump.averages[j].len()) as f64;
            sums[0] += 8.0 * entries as f64;
            // Σ; Ψ, unless sparse solves stand for it; S and T.
            sums[1] += 8.0 * n_pi.powi(2);
            if *form == OperatorForm::Explicit || kind.copies > 1 {
                sums[1] += 8.0 * n_delta * n_pi;
            }
            match form {
                OperatorForm::Explicit => sums[1] += 8.0 * (n_gamma.powi(2) + n_delta.powi(2)),
                OperatorForm::Implicit => sums[5] += 1.0,
            }
        }
        let mut largest = 0.0f64;
        for (j, sub) in problem.local.iter().enumerate() {
            let n_gamma = jump.delta[j].len() + jump.primal[j].len();
            largest = largest.max(n_gamma as f64);
            let averages = jump.averages[j].iter().map(|a| &a.dofs[0]);
            for &i in jump.primal[j].iter().chain(averages) {
                // Every primal dof is counted by its lowest subdomain. An average belongs to the subdomains of its
                // dofs.
                let copies = sharing.shared(sub.dofs[i as usize]);
                let first = copies
                    .first()
                    .is_none_or(|c| c.subdomain as usize == sub.index);
                primal[sub.body] += f64::from(u8::from(first));
            }
        }
        let contact = jump.n_owned_local..jump.n_owned;
        sums[2] = contact.clone().filter(|&r| jump.active[r]).count() as f64;
        sums[3] = contact.filter(|&r| jump.law[r].is_inequality()).count() as f64;
        sum_all(comm, &mut sums);
        sum_all(comm, &mut primal);
        let kernels = kernels(comm, problem);
        Ok(ProblemSizes {
            free: free_motions(comm, problem, &jump, &kernels),
            multipliers_local: jump.n_local,
            multipliers_global: jump.n_global - jump.n_local,
            multipliers_active: sums[2] as usize,
            inequalities: sums[3] as usize,
            primal: primal.iter().sum::<f64>() as usize,
            largest_primal: primal.iter().fold(0.0f64, |a, &b| a.max(b)) as usize,
            largest_interface: highest(comm, largest) as usize,
            defect: kernels.iter().map(|kernel| kernel.cols).collect(),
            kinds: sums[4] as usize,
            implicit_kinds: sums[5] as usize,
            preconditioner,
            factor_bytes: sums[0],
            dense_bytes: sums[1],
        })
    }
}

/// Every body's kernel as combinations of its candidates, from its matrices; a body without candidates counts as held.
fn kernels(comm: &SimpleCommunicator, problem: &Problem) -> Vec<Dense> {
    let mut mine = SentFactors::default();
    for sub in &problem.local {
        kernel::push_factors(&mut mine, sub);
    }
    let mut factors: Vec<Vec<Dense>> = vec![Vec::new(); problem.n_bodies];
    for (body, entries) in mine.gather_all(comm).iter().flat_map(Parcels::iter) {
        factors[body].push(kernel::received_factors(entries));
    }
    let kernel = |f: &Vec<Dense>| kernel::null_combinations(f);
    factors.iter().map(kernel).collect()
}
