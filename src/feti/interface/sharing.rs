//! The copies of every degree of freedom, found from the body dof numbers alone.
//!
//! A rank knows only its own subdomains. Every copy is reported to a rendezvous rank that follows from the number of
//! the body dof. That rank sees all copies of the dof and reports them to the ranks that hold one. Memory and messages
//! are proportional to the dofs of a rank, never to the whole problem.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::candidates::{candidates, DofMap};
use super::entities::{self, Average};
use crate::feti::settings::Primal;
use crate::linalg::sorted::distinct;
use crate::parallel::exchange::{exchange, exchange_words, gather_all, Record};
use crate::substructures::{Subdomain, Substructures};
use crate::{Error, Result};

/// One subdomain's instance of a body dof.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Copy {
    /// Global index of the subdomain.
    pub subdomain: u32,
    /// Local dof in that subdomain.
    pub local: u32,
    /// Whether that subdomain lists the dof as primal.
    pub primal: bool,
    /// Diagonal entry of D: the scaling weight of this copy.
    pub weight: f64,
}

/// The copies of the dofs that this rank needs, and the rank of every subdomain.
#[derive(Debug, Default)]
pub struct Sharing {
    /// Copies, by increasing subdomain, of two sets of dofs: those that a subdomain of this rank shares with another
    /// one, and those in rows that this rank provides.
    pub copies: DofMap<Vec<Copy>>,
    /// For each local subdomain, the local dofs that it shares with others, increasing.
    pub shared_dofs: Vec<Vec<u32>>,
    /// Rank that holds each subdomain; length n_subdomains.
    pub rank_of: Vec<u32>,
    /// Body of each subdomain; length n_subdomains.
    pub body_of: Vec<u32>,
    /// The averages that are primal in each local subdomain.
    pub averages: Vec<Vec<Average>>,
    /// Whether vertices are primal.
    pub vertices: bool,
}

impl Record for (u64, Copy) {
    const WORDS: usize = 4;
    fn pack(&self, out: &mut Vec<u64>) {
        let (dof, c) = self;
        let flag = u64::from(c.primal) << 63;
        out.extend([
            *dof,
            flag | u64::from(c.subdomain),
            u64::from(c.local),
            c.weight.to_bits(),
        ]);
    }
    fn unpack(w: &[u64]) -> Self {
        let copy = Copy {
            subdomain: (w[1] & u64::from(u32::MAX)) as u32,
            local: w[2] as u32,
            primal: w[1] >> 63 == 1,
            weight: f64::from_bits(w[3]),
        };
        (w[0], copy)
    }
}

impl Sharing {
    /// Finds the copies, and the averages among the chosen constraints. `weights[j]` holds D of local subdomain j, by
    /// local dof. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        problem: &Substructures,
        weights: &[Vec<f64>],
        constraints: Primal,
    ) -> Result<Sharing> {
        let size = comm.size() as usize;
        let home = |dof: u64| (dof % size as u64) as usize;
        let (rank_of, body_of) = locate(comm, problem)?;

        let mut reports: Vec<Vec<(u64, Copy)>> = vec![Vec::new(); size];
        let possible = candidates(comm, problem, &home);
        for ((sub, weight), possible) in problem.local.iter().zip(weights).zip(&possible) {
            let mut primal = vec![false; sub.dofs.len()];
            if constraints.vertices {
                sub.primal.iter().for_each(|&i| primal[i as usize] = true);
            }
            for &i in possible {
                let (dof, i) = (sub.dofs[i as usize], i as usize);
                let copy = Copy {
                    subdomain: sub.index as u32,
                    local: i as u32,
                    primal: primal[i],
                    weight: weight[i],
                };
                reports[home(dof)].push((dof, copy));
            }
        }
        let mut all: Vec<(u64, Copy)> = exchange(comm, reports);
        all.sort_unstable_by_key(|(dof, c)| (*dof, c.subdomain, c.local));

        // Shared dofs go back to all ranks that hold a copy.
        let mut replies: Vec<Vec<(u64, Copy)>> = vec![Vec::new(); size];
        let mut ranks = Vec::new();
        for group in all.chunk_by(|a, b| a.0 == b.0).filter(|g| g.len() > 1) {
            ranks.clear();
            ranks.extend(group.iter().map(|(_, c)| rank_of[c.subdomain as usize]));
            ranks.sort_unstable();
            ranks.dedup();
            for &r in &ranks {
                replies[r as usize].extend_from_slice(group);
            }
        }
        let mut sharing = Sharing {
            copies: DofMap::default(),
            shared_dofs: Vec::new(),
            rank_of,
            body_of,
            averages: Vec::new(),
            vertices: constraints.vertices,
        };
        sharing.absorb(exchange(comm, replies));

        // The dofs in the rows of this rank, shared or not.
        let mut queries: Vec<Vec<u64>> = vec![Vec::new(); size];
        for dof in problem
            .rows
            .iter()
            .flat_map(|r| r.terms.iter().map(|t| t.0))
        {
            queries[home(dof)].push(dof);
        }
        let queries = queries.into_iter().map(|list| {
            let mut list = distinct(list);
            list.retain(|dof| !sharing.copies.contains_key(dof));
            list
        });
        let answers: Vec<Vec<(u64, Copy)>> = exchange_words(comm, queries.collect())
            .iter()
            .map(|asked| {
                let find = |&dof: &u64| {
                    let start = all.partition_point(|e| e.0 < dof);
                    all[start..].iter().copied().take_while(move |e| e.0 == dof)
                };
                asked.iter().flat_map(find).collect()
            })
            .collect();
        sharing.absorb(exchange(comm, answers));
        let shared = |(sub, possible): (&Subdomain, Vec<u32>)| {
            let kept = possible.into_iter();
            kept.filter(|&i| !sharing.shared(sub.dofs[i as usize]).is_empty())
                .collect()
        };
        sharing.shared_dofs = problem.local.iter().zip(possible).map(shared).collect();
        let averages = entities::averages(comm, problem, &sharing, constraints);
        sharing.check(problem)?;
        sharing.averages = averages?;
        Ok(sharing)
    }

    fn absorb(&mut self, list: Vec<(u64, Copy)>) {
        for group in list.chunk_by(|a, b| a.0 == b.0) {
            let copies = group.iter().map(|(_, c)| *c).collect();
            self.copies.insert(group[0].0, copies);
        }
    }

    /// The copies of a dof that this rank knows to be shared; empty for a dof of one subdomain alone.
    pub fn shared(&self, dof: u64) -> &[Copy] {
        self.copies
            .get(&dof)
            .filter(|c| c.len() > 1)
            .map_or(&[], |c| &c[..])
    }

    /// Whether a shared dof is primal: one of its subdomains lists it as primal.
    pub fn is_primal(copies: &[Copy]) -> bool {
        copies.len() > 1 && copies.iter().any(|c| c.primal)
    }

    fn check(&self, problem: &Substructures) -> Result<()> {
        for (dof, copies) in &self.copies {
            let body = |c: &Copy| self.body_of[c.subdomain as usize];
            if let Some(c) = copies.iter().find(|c| body(c) != body(&copies[0])) {
                return Err(Error::input(format!(
                    "body dof {dof} is listed by subdomain {} of body \"{}\" \
                     and by subdomain {} of body \"{}\", but bodies share dofs only through interface rows",
                    copies[0].subdomain,
                    problem.body_names[body(&copies[0]) as usize],
                    c.subdomain,
                    problem.body_names[body(c) as usize],
                )));
            }
            if copies.windows(2).any(|w| w[0].subdomain == w[1].subdomain) {
                return Err(Error::input(format!(
                    "subdomain {} lists body dof {dof} twice, expected once",
                    copies[0].subdomain
                )));
            }
        }
        for row in &problem.rows {
            for (dof, _) in &row.terms {
                if !self.copies.contains_key(dof) {
                    return Err(Error::input(format!(
                        "an interface row names body dof {dof}, which no subdomain holds"
                    )));
                }
            }
        }
        Ok(())
    }
}

/// (rank, body) of every subdomain. Collective.
fn locate(comm: &SimpleCommunicator, problem: &Substructures) -> Result<(Vec<u32>, Vec<u32>)> {
    let mine: Vec<u64> = problem
        .local
        .iter()
        .flat_map(|s| [s.index as u64, s.body as u64])
        .collect();
    let mut rank_of = vec![u32::MAX; problem.n_subdomains];
    let mut body_of = vec![0; problem.n_subdomains];
    for (rank, words) in gather_all(comm, &mine).iter().enumerate() {
        for pair in words.chunks_exact(2) {
            let (index, body) = (pair[0] as usize, pair[1] as usize);
            if index >= rank_of.len() || rank_of[index] != u32::MAX {
                return Err(Error::input(format!(
                    "subdomain index {index} is used twice or is not below {}",
                    problem.n_subdomains
                )));
            }
            if body >= problem.n_bodies {
                return Err(Error::input(format!(
                    "subdomain {index} names body {body}, but there are {} bodies",
                    problem.n_bodies
                )));
            }
            rank_of[index] = rank as u32;
            body_of[index] = body as u32;
        }
    }
    match rank_of.iter().position(|&r| r == u32::MAX) {
        Some(missing) => Err(Error::input(format!("no rank holds subdomain {missing}"))),
        None => Ok((rank_of, body_of)),
    }
}
