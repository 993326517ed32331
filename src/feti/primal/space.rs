//! The primal spaces of the bodies: numbering, the matrix S_Π, and the kernels it shows.
//!
//! All primal dofs of a body are owned by one rank: that of the body's lowest subdomain. S_Π is therefore block
//! diagonal by rank as well as by body. Primal dofs are numbered rank after rank, body after body.

use std::collections::BTreeMap;
use std::ops::Range;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use rustc_hash::FxHashMap;

use super::kernel;
use super::matrix::{Outgoing, PrimalMatrix};
use crate::feti::interface::entities::Average;
use crate::feti::interface::sharing::Sharing;
use crate::feti::subdomain::scaled::Scaled;
use crate::substructures::Problem;
use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;
use parallel::exchange::{exchange_words, offsets};
use parallel::halo::numbered;

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
        sharing: &Sharing,
        averages: &[Vec<Average>],
        locals: &[Scaled],
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
            room[to(j)] += Outgoing::words(local.gamma().n_pi());
        }
        let mut outgoing = Outgoing::with_capacity(&room);
        for (j, local) in locals.iter().enumerate() {
            let numbers = space.of_subdomain[j].iter();
            let numbers = numbers.map(|&g| space.ghosts[g as usize]);
            outgoing.push(to(j), numbers, &local.sigma());
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
        locals: &[Scaled],
    ) -> Vec<Vec<u32>> {
        let mut requests: Vec<Vec<u64>> = vec![Vec::new(); comm.size() as usize];
        for (j, (sub, local)) in problem.local.iter().zip(locals).enumerate() {
            // A vertex is identified by its body dof, an average by its entity, another functional by a body dof. A
            // fixing dof belongs to its subdomain alone.
            let vertices = local.gamma().interface[local.gamma().n_delta..].iter();
            let vertices = vertices.map(|&i| (0, sub.dofs[i as usize]));
            let averages = averages[j].iter();
            let averages = averages.map(|a| (if a.weights.is_some() { 3 } else { 1 }, a.key));
            let fixing = local.gamma().fixing.iter();
            let fixing = fixing.map(|&i| (2, (sub.index as u64) << 32 | i as u64));
            for (kind, key) in vertices.chain(averages).chain(fixing) {
                let body = (sub.body as u64) << 2 | kind;
                requests[self.owner(j)].extend([body, key]);
            }
        }
        let sent: Vec<usize> = requests.iter().map(|r| r.len() / 2).collect();
        let received = exchange_words(comm, requests);
        let pairs = |words: &[u64]| -> Vec<(u64, u64)> {
            words.chunks_exact(2).map(|w| (w[0], w[1])).collect()
        };
        let all = distinct(received.iter().flat_map(|w| pairs(w)));
        self.n_owned = all.len();
        (self.first, self.n_global) = offsets(comm, all.len());
        let first = self.first;
        let mut start = 0;
        for group in all.chunk_by(|a, b| a.0 >> 2 == b.0 >> 2) {
            self.owned.push(OwnedBody {
                body: (group[0].0 >> 2) as usize,
                range: start..start + group.len(),
                z: Dense::default(),
                combinations: Dense::default(),
                fixing: Vec::new(),
            });
            start += group.len();
        }
        let number = |pair: (u64, u64)| {
            let at = all
                .binary_search(&pair)
                .expect("every request was collected");
            (first + at) as u32
        };
        let asked: Vec<Vec<u32>> = received
            .iter()
            .map(|w| pairs(w).into_iter().map(number).collect())
            .collect();
        let replies = asked
            .iter()
            .map(|list| list.iter().map(|&g| u64::from(g)).collect())
            .collect();
        let answers = exchange_words(comm, replies);
        debug_assert!(answers.iter().zip(&sent).all(|(a, &n)| a.len() == n));

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
                answers[r][next[r] - n..next[r]]
                    .iter()
                    .map(|&g| g as u32)
                    .collect()
            })
            .collect();
        (self.ghosts, self.of_subdomain) = numbered(&global);
        asked
    }

    fn find_kernels(
        &mut self,
        comm: &SimpleCommunicator,
        problem: &Problem,
        locals: &[Scaled],
        asked: &[Vec<u32>],
    ) {
        // Messages of the subdomains: [body, k, factors (2k²)], and N at the primal dofs: [number, k values].
        let size = comm.size() as usize;
        let mut factors: Vec<Vec<u64>> = vec![Vec::new(); size];
        let mut values: Vec<Vec<u64>> = vec![Vec::new(); size];
        for (j, sub) in problem.local.iter().enumerate() {
            let to = self.owner(j);
            let local = &locals[j];
            let columns = sub.near_kernel.as_deref().unwrap_or(&[]);
            let factor = kernel::motion_factors(&sub.k, columns);
            factors[to].extend([sub.body as u64, columns.len() as u64]);
            factors[to].extend(factor.data.iter().map(|v| v.to_bits()));
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
                values[to].extend([u64::from(number), columns.len() as u64]);
                values[to].extend(primal.iter().map(|c| c[p].to_bits()));
            }
        }
        let factors = exchange_words(comm, factors).concat();
        let factors = self.by_body(&factors, |w| {
            (w[0] as usize, 2 + 2 * (w[1] * w[1]) as usize)
        });
        let values = exchange_words(comm, values).concat();
        let values = self.by_body(&values, |w| (self.body_at(w[0]), 2 + w[1] as usize));
        let stiffness = self.local_stiffness(problem, locals);
        let mut owned = std::mem::take(&mut self.owned);
        for body in &mut owned {
            // The owner of a body has a subdomain of it.
            let stiffness = stiffness[&body.body];
            let of = |messages: &BTreeMap<usize, Vec<u64>>| {
                messages.get(&body.body).cloned().unwrap_or_default()
            };
            (body.z, body.combinations) =
                self.kernel_of(body, &of(&factors), &of(&values), stiffness);
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

    /// The messages of each body; `read` gives the body and the length of the message at the front.
    fn by_body(
        &self,
        words: &[u64],
        read: impl Fn(&[u64]) -> (usize, usize),
    ) -> BTreeMap<usize, Vec<u64>> {
        let mut out: BTreeMap<usize, Vec<u64>> = BTreeMap::new();
        let mut rest = words;
        while !rest.is_empty() {
            let (body, length) = read(rest);
            let (message, tail) = rest.split_at(length);
            out.entry(body).or_default().extend(message);
            rest = tail;
        }
        out
    }

    /// The owned body of an owned primal dof, given by its global number.
    fn body_at(&self, number: u64) -> usize {
        let i = number as usize - self.first;
        let at = self.owned.partition_point(|b| b.range.end <= i);
        self.owned[at].body
    }

    /// Largest diagonal entry of K on the interface among this rank's subdomains of each body.
    fn local_stiffness(&self, problem: &Problem, locals: &[Scaled]) -> FxHashMap<usize, f64> {
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
        factors: &[u64],
        values: &[u64],
        stiffness: f64,
    ) -> (Dense, Dense) {
        let n = body.range.len();
        let mut mine = Vec::new();
        let mut known = true;
        let mut rest = factors;
        while let [_, k, tail @ ..] = rest {
            let k = *k as usize;
            let (data, tail) = tail.split_at(2 * k * k);
            known &= k > 0;
            mine.push(Dense {
                rows: 2 * k,
                cols: k,
                data: data.iter().map(|&w| f64::from_bits(w)).collect(),
            });
            rest = tail;
        }
        if !known {
            let s_pi = self.matrix.dense(&body.range);
            return (kernel::null_space(&s_pi, stiffness), Dense::default());
        }
        let combinations = kernel::null_combinations(&mine);
        let mut z = Dense::zeros(n, combinations.cols);
        let mut rest = values;
        while let [number, k, tail @ ..] = rest {
            let (row, tail) = tail.split_at(*k as usize);
            let i = *number as usize - self.first;
            if body.range.contains(&i) {
                for c in 0..combinations.cols {
                    let terms = row.iter().zip(combinations.col(c));
                    let sum = terms.map(|(&w, c)| f64::from_bits(w) * c).sum();
                    z.set(i - body.range.start, c, sum);
                }
            }
            rest = tail;
        }
        (z, combinations)
    }

    fn share_kernels(&mut self, comm: &SimpleCommunicator, asked: &[Vec<u32>]) {
        let row_of = |g: &u32| -> Vec<u64> {
            let i = *g as usize - self.first;
            let body = &self.owned[self.owned.partition_point(|b| b.range.end <= i)];
            let row = (0..body.z.cols).map(|c| body.z.get(i - body.range.start, c).to_bits());
            [u64::from(*g), body.z.cols as u64]
                .into_iter()
                .chain(row)
                .collect()
        };
        let replies = asked
            .iter()
            .map(|l| l.iter().flat_map(row_of).collect())
            .collect();
        let answers = exchange_words(comm, replies).concat();
        self.z_at_ghosts = vec![Vec::new(); self.ghosts.len()];
        let mut rest = &answers[..];
        while let [number, k, tail @ ..] = rest {
            let (row, tail) = tail.split_at(*k as usize);
            let at = self.ghosts.binary_search(&(*number as u32));
            let at = at.expect("answers are to our own requests");
            self.z_at_ghosts[at] = row.iter().map(|&w| f64::from_bits(w)).collect();
            rest = tail;
        }
    }

    /// R of local subdomain `j` on its interface, n_Γ × defect of its body: Ψ times the kernel at the primal dofs.
    pub fn kernel_on_interface(&self, j: usize, local: &Scaled) -> Dense {
        // A floating body has primal dofs in each of its subdomains.
        let first = self.of_subdomain[j].first();
        let defect = first.map_or(0, |&g| self.z_at_ghosts[g as usize].len());
        let mut r = Dense::zeros(local.gamma().n_gamma(), defect);
        for c in 0..r.cols {
            let z: Vec<f64> = self.of_subdomain[j]
                .iter()
                .map(|&g| self.z_at_ghosts[g as usize][c])
                .collect();
            local.gamma().add_psi(&z, r.col_mut(c));
        }
        r
    }
}
