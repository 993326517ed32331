//! The primal spaces of the bodies: numbering, the matrix S_Π, and the kernels it shows.
//!
//! All primal dofs of a body are owned by one rank: that of the body's lowest subdomain. S_Π is therefore block
//! diagonal by rank as well as by body. Primal dofs are numbered rank after rank, body after body.

use std::ops::Range;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use rustc_hash::FxHashMap;

use super::kernel::{self, SentFactors};
use super::matrix::{Blocks, PrimalMatrix};
use crate::feti::interface::entities::Average;
use crate::feti::interface::sharing::DofSharing;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::Problem;
use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;
use bytemuck::{Pod, Zeroable};
use parallel::exchange::{exchange_by_rank, offsets};
use parallel::halo::numbered;
use parallel::parcels::Parcels;

/// A body whose primal dofs this rank owns.
#[derive(Debug)]
pub struct OwnedBody {
    /// Index of the body.
    pub body: usize,
    /// Its primal dofs among this rank's owned ones.
    pub range: Range<usize>,
    /// Basis of the kernel at the primal dofs, n × defect.
    pub z: Dense,
    /// Its columns as combinations of the candidates of [`Subdomain::near_kernel`](crate::Subdomain), k × defect;
    /// empty if these are not known.
    pub combinations: Dense,
    /// Primal dofs of the body (indices in 0..n) that are held to make S_Π regular; as many as the defect.
    pub fixing: Vec<usize>,
}

/// A primal dof by what the subdomains that share it have in common, in the order in which the dofs are numbered.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
struct PrimalName {
    body: u32,
    kind: u32,
    key: u64,
}

/// The numbering of the primal dofs and the kernels of the bodies.
#[derive(Debug, Default)]
pub struct PrimalSpace {
    /// First global number owned by this rank.
    pub first: usize,
    /// Number of primal dofs owned by this rank.
    pub n_owned: usize,
    /// Number of primal dofs over all ranks.
    pub n_global: usize,
    /// Global numbers of the primal dofs that this rank's subdomains use, increasing.
    pub ghosts: Vec<u32>,
    /// For each local subdomain, the place in `ghosts` of each of its primal dofs.
    pub of_subdomain: Vec<Vec<u32>>,
    /// Bodies owned by this rank.
    pub owned: Vec<OwnedBody>,
    /// For each local subdomain, the rank that owns its body's primal dofs.
    owner: Vec<u32>,
    /// For each ghost the row of the kernel basis; its length is the defect of the body.
    pub z_at_ghosts: Vec<Vec<f64>>,
    /// S_Π of the owned bodies, regularised at the fixing dofs of floating ones.
    pub matrix: PrimalMatrix,
}

impl PrimalSpace {
    /// Numbers the primal dofs, assembles S_Π and finds the kernels. `averages` are those of every local subdomain.
    /// Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        problem: &Problem,
        sharing: &DofSharing,
        averages: &[Vec<Average>],
        locals: &[ScaledSubdomain],
    ) -> PrimalSpace {
        let mut space = PrimalSpace {
            owner: (problem.local.iter())
                .map(|s| sharing.homes[&s.body].rank)
                .collect(),
            ..PrimalSpace::default()
        };
        let asked = space.number(comm, problem, averages, locals);
        let mut room = vec![0; comm.size() as usize];
        let to = |j: usize| space.owner(j);
        for (j, local) in locals.iter().enumerate() {
            room[to(j)] += local.gamma().n_pi().pow(2);
        }
        let mut outgoing: Vec<Blocks> = room.into_iter().map(Blocks::with_capacity).collect();
        for (j, local) in locals.iter().enumerate() {
            let numbers = space.of_subdomain[j].iter();
            let numbers = numbers.map(|&g| space.ghosts[g as usize]);
            let sigma = local.sigma();
            let rows = (0..sigma.rows).flat_map(|i| (0..sigma.cols).map(move |j| (i, j)));
            outgoing[to(j)].push(numbers, rows.map(|(i, j)| sigma.get(i, j)));
        }
        space.matrix = PrimalMatrix::new(comm, outgoing, space.first, space.n_owned);
        space.find_kernels(comm, problem, locals, &asked);
        space
    }

    /// The rank that owns the primal dofs of the body of local subdomain `j`.
    pub fn owner(&self, j: usize) -> usize {
        self.owner[j] as usize
    }

    /// Numbers the primal dofs rank after rank. Returns, for the owner, the numbers that every rank asked for.
    fn number(
        &mut self,
        comm: &SimpleCommunicator,
        problem: &Problem,
        averages: &[Vec<Average>],
        locals: &[ScaledSubdomain],
    ) -> Vec<Vec<u32>> {
        let mut requests: Vec<Vec<PrimalName>> = vec![Vec::new(); comm.size() as usize];
        for (j, (sub, local)) in problem.local.iter().zip(locals).enumerate() {
            // A vertex is identified by its body dof, an average by its entity, another functional by a body dof. A
            // fixing dof belongs to its subdomain alone.
            let vertices = local.gamma().interface[local.gamma().n_delta..].iter();
            let vertices = vertices.map(|&i| (0, sub.dofs[i as usize]));
            let averages = averages[j].iter();
            let averages = averages.map(|a| (a.kind.number(), a.key));
            let fixing = local.gamma().fixing.iter();
            let fixing = fixing.map(|&i| (2, (sub.index as u64) << 32 | i as u64));
            for (kind, key) in vertices.chain(averages).chain(fixing) {
                let body = sub.body as u32;
                requests[self.owner(j)].push(PrimalName { body, kind, key });
            }
        }
        let received = exchange_by_rank(comm, requests);
        let all = distinct(received.iter().flatten().copied());
        self.n_owned = all.len();
        (self.first, self.n_global) = offsets(comm, all.len());
        let first = self.first;
        let mut start = 0;
        for group in all.chunk_by(|a, b| a.body == b.body) {
            self.owned.push(OwnedBody {
                body: group[0].body as usize,
                range: start..start + group.len(),
                z: Dense::default(),
                combinations: Dense::default(),
                fixing: Vec::new(),
            });
            start += group.len();
        }
        let number = |name: &PrimalName| {
            let at = all.binary_search(name);
            (first + at.expect("every request was collected")) as u32
        };
        let asked: Vec<Vec<u32>> = received
            .iter()
            .map(|names| names.iter().map(number).collect())
            .collect();
        let answers = exchange_by_rank(comm, asked.clone());

        let mut next = vec![0; answers.len()];
        let global: Vec<Vec<u32>> = problem
            .local
            .iter()
            .zip(locals)
            .zip(&self.owner)
            .map(|((_, local), &r)| {
                let r = r as usize;
                let n = local.gamma().n_pi();
                next[r] += n;
                answers[r][next[r] - n..next[r]].to_vec()
            })
            .collect();
        (self.ghosts, self.of_subdomain) = numbered(&global);
        asked
    }

    fn find_kernels(
        &mut self,
        comm: &SimpleCommunicator,
        problem: &Problem,
        locals: &[ScaledSubdomain],
        asked: &[Vec<u32>],
    ) {
        // The factors of each subdomain by body, and N at the primal dofs by their numbers.
        let mut factors: Vec<SentFactors> = Parcels::for_each_rank(comm);
        let mut values = Parcels::for_each_rank(comm);
        for (j, sub) in problem.local.iter().enumerate() {
            let to = self.owner(j);
            let local = &locals[j];
            let columns = sub.near_kernel.as_deref().unwrap_or(&[]);
            kernel::push_factors(&mut factors[to], sub);
            if columns.is_empty() {
                continue;
            }
            let on_gamma = |c: &Vec<f64>| {
                let values = local.gamma().interface.iter().map(|&i| c[i as usize]);
                local.gamma().primal_values(&values.collect::<Vec<f64>>())
            };
            let primal: Vec<Vec<f64>> = columns.iter().map(on_gamma).collect();
            for (p, &place) in self.of_subdomain[j].iter().enumerate() {
                let number = self.ghosts[place as usize];
                values[to].push(number, primal.iter().map(|c| c[p]));
            }
        }
        let mut factors_of: FxHashMap<usize, Vec<Dense>> = FxHashMap::default();
        for (body, entries) in exchange_by_rank(comm, factors)
            .iter()
            .flat_map(Parcels::iter)
        {
            let of_body = factors_of.entry(body).or_default();
            of_body.push(kernel::received_factors(entries));
        }
        let values = exchange_by_rank(comm, values);
        let mut values_of: FxHashMap<usize, Vec<(usize, &[f64])>> = FxHashMap::default();
        for (number, row) in values.iter().flat_map(Parcels::iter) {
            let i = number as usize - self.first;
            let body = self.owned[self.body_at(i)].body;
            values_of.entry(body).or_default().push((i, row));
        }
        let stiffness = self.local_stiffness(problem, locals);
        let mut owned = std::mem::take(&mut self.owned);
        for body in &mut owned {
            // The owner of a body has a subdomain of it.
            let stiffness = stiffness[&body.body];
            let factors = factors_of.remove(&body.body).unwrap_or_default();
            let values = values_of.remove(&body.body).unwrap_or_default();
            (body.z, body.combinations) = self.kernel_of(body, &factors, &values, stiffness);
            body.fixing = kernel::fixing_rows(&body.z);
            let n = body.range.len() as f64;
            // Any positive number makes S_Π regular; the mean diagonal entry keeps its condition. If nothing but the
            // fixing dof holds a body, its diagonal is rounding; the number is one then.
            let trace = self.matrix.trace(&body.range);
            let shift = if trace / n > 1e-10 * stiffness {
                trace / n
            } else {
                stiffness.max(1.0)
            };
            for &i in &body.fixing {
                self.matrix.shift(body.range.start + i, shift);
            }
        }
        self.owned = owned;
        self.share_kernels(comm, asked);
    }

    /// The place among the owned bodies of that of owned primal dof `i`.
    fn body_at(&self, i: usize) -> usize {
        self.owned.partition_point(|b| b.range.end <= i)
    }

    /// Largest diagonal entry of K on the interface among this rank's subdomains of each body.
    fn local_stiffness(
        &self,
        problem: &Problem,
        locals: &[ScaledSubdomain],
    ) -> FxHashMap<usize, f64> {
        let mut out: FxHashMap<usize, f64> = FxHashMap::default();
        for (sub, local) in problem.local.iter().zip(locals) {
            let interface = local.gamma().interface.iter();
            let diagonal = interface.map(|&i| sub.k.get(i as usize, i as usize));
            let largest = out.entry(sub.body).or_default();
            *largest = diagonal.fold(*largest, f64::max);
        }
        out
    }

    /// The kernel of a body at its primal dofs, and its columns as combinations of the candidates.
    fn kernel_of(
        &self,
        body: &OwnedBody,
        factors: &[Dense],
        values: &[(usize, &[f64])],
        stiffness: f64,
    ) -> (Dense, Dense) {
        if factors.iter().any(|f| f.cols == 0) {
            let large = body.range.len() > kernel::LARGE;
            if large && kernel::is_held(&self.matrix.sparse(&body.range)) {
                return (Dense::zeros(body.range.len(), 0), Dense::default());
            }
            let s_pi = self.matrix.dense(&body.range);
            return (kernel::null_space(&s_pi, stiffness), Dense::default());
        }
        let combinations = kernel::null_combinations(factors);
        let mut z = Dense::zeros(body.range.len(), combinations.cols);
        for (i, row) in values {
            for c in 0..combinations.cols {
                let terms = row.iter().zip(combinations.col(c));
                let sum = terms.map(|(v, c)| v * c).sum();
                z.set(i - body.range.start, c, sum);
            }
        }
        (z, combinations)
    }

    fn share_kernels(&mut self, comm: &SimpleCommunicator, asked: &[Vec<u32>]) {
        let mut outgoing = Parcels::for_each_rank(comm);
        for (to, numbers) in outgoing.iter_mut().zip(asked) {
            for &g in numbers {
                let i = g as usize - self.first;
                let body = &self.owned[self.body_at(i)];
                let row = (0..body.z.cols).map(|c| body.z.get(i - body.range.start, c));
                to.push(g, row);
            }
        }
        self.z_at_ghosts = vec![Vec::new(); self.ghosts.len()];
        for (number, row) in exchange_by_rank(comm, outgoing)
            .iter()
            .flat_map(Parcels::iter)
        {
            let at = self.ghosts.binary_search(&number);
            let at = at.expect("answers are to our own requests");
            self.z_at_ghosts[at] = row.to_vec();
        }
    }

    /// R of local subdomain `j` on its interface, n_Γ × defect of its body: Ψ times the kernel at the primal dofs.
    pub fn kernel_on_interface(&self, j: usize, local: &ScaledSubdomain) -> Dense {
        // A floating body has primal dofs in each of its subdomains.
        let first = self.of_subdomain[j].first();
        let defect = first.map_or(0, |&g| self.z_at_ghosts[g as usize].len());
        let mut r = Dense::zeros(local.gamma().n_gamma(), defect);
        for c in 0..r.cols {
            let z: Vec<f64> = self.of_subdomain[j]
                .iter()
                .map(|&g| self.z_at_ghosts[g as usize][c])
                .collect();
            local.add_psi(&z, r.col_mut(c));
        }
        r
    }
}
