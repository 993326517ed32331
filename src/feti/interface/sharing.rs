//! The copies of every degree of freedom, found from the body dof numbers alone.
//!
//! A rank knows only its own subdomains. Every copy is reported to a rendezvous rank that follows from the number of
//! the body dof. That rank sees all copies of the dof and reports them to the ranks that hold one. Memory and messages
//! are proportional to the dofs of a rank, never to the whole problem.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use rustc_hash::FxHashMap;

use super::candidates::{candidates, DofMap};
use super::entities::Average;
use super::location::{homes, Home, Location, Locations};
use crate::feti::interface::entities;
use crate::feti::settings::Primal;
use crate::substructures::{Problem, Subdomain};
use crate::{Error, Result};
use base::linalg::sorted::distinct;
use bytemuck::{Pod, Zeroable};
use parallel::exchange::{exchange, exchange_by_rank};

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

/// The copies of the dofs that this rank needs, and where the subdomains are that have them.
#[derive(Debug, Default)]
pub struct DofSharing {
    /// Copies, by increasing subdomain, of two sets of dofs: those that a subdomain of this rank shares with another
    /// one, and those in rows that this rank provides.
    pub copies: DofMap<Vec<Copy>>,
    /// For each local subdomain, the local dofs that it shares with others, increasing.
    pub shared_dofs: Vec<Vec<u32>>,
    /// Where the subdomains of this rank and those with these copies are.
    pub locations: Locations,
    /// The [`Home`] of each body of this rank's subdomains, by the number of the body.
    pub homes: FxHashMap<usize, Home>,
    /// The averages that are primal in each local subdomain.
    pub averages: Vec<Vec<Average>>,
    /// Whether vertices are primal.
    pub vertices: bool,
}

/// A copy of a dof, and where its subdomain is.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct DofCopy {
    dof: u64,
    subdomain: u32,
    local: u32,
    weight: f64,
    rank: u32,
    body: u32,
    primal: u64,
}

impl DofSharing {
    /// Finds the copies, and the averages among the chosen constraints. `weights[j]` holds D of local subdomain j, by
    /// local dof. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        problem: &Problem,
        weights: &[Vec<f64>],
        constraints: Primal,
    ) -> Result<DofSharing> {
        let size = comm.size() as usize;
        let home = |dof: u64| (dof % size as u64) as usize;
        let mut reports: Vec<Vec<DofCopy>> = vec![Vec::new(); size];
        let possible = candidates(comm, problem, &home);
        for ((sub, weight), possible) in problem.local.iter().zip(weights).zip(&possible) {
            let mut primal = vec![false; sub.dofs.len()];
            if constraints.vertices {
                sub.primal.iter().for_each(|&i| primal[i as usize] = true);
            }
            for &i in possible {
                let (dof, i) = (sub.dofs[i as usize], i as usize);
                reports[home(dof)].push(DofCopy {
                    dof,
                    subdomain: sub.index as u32,
                    local: i as u32,
                    weight: weight[i],
                    rank: comm.rank() as u32,
                    body: sub.body as u32,
                    primal: primal[i].into(),
                });
            }
        }
        let mut all = exchange(comm, reports);
        all.sort_unstable_by_key(|c| (c.dof, c.subdomain, c.local));

        // Shared dofs go back to all ranks that hold a copy.
        let mut replies: Vec<Vec<DofCopy>> = vec![Vec::new(); size];
        let mut ranks = Vec::new();
        for group in all.chunk_by(|a, b| a.dof == b.dof).filter(|g| g.len() > 1) {
            ranks.clear();
            ranks.extend(group.iter().map(|c| c.rank));
            ranks.sort_unstable();
            ranks.dedup();
            for &r in &ranks {
                replies[r as usize].extend_from_slice(group);
            }
        }
        let mut sharing = DofSharing {
            copies: DofMap::default(),
            shared_dofs: Vec::new(),
            locations: Locations::own(comm, problem),
            homes: homes(comm, problem),
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
        let answers: Vec<Vec<DofCopy>> = exchange_by_rank(comm, queries.collect())
            .iter()
            .map(|asked| {
                let find = |&dof: &u64| {
                    let start = all.partition_point(|e| e.dof < dof);
                    all[start..]
                        .iter()
                        .copied()
                        .take_while(move |e| e.dof == dof)
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

    fn absorb(&mut self, list: Vec<DofCopy>) {
        for group in list.chunk_by(|a, b| a.dof == b.dof) {
            let note = |c: &DofCopy| {
                let (rank, body) = (c.rank, c.body);
                self.locations.insert(c.subdomain, Location { rank, body });
                Copy {
                    subdomain: c.subdomain,
                    local: c.local,
                    primal: c.primal != 0,
                    weight: c.weight,
                }
            };
            let copies = group.iter().map(note).collect();
            self.copies.insert(group[0].dof, copies);
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

    /// The body of the subdomain that has a copy.
    pub fn body(&self, copy: &Copy) -> u32 {
        self.locations.of(copy.subdomain).body
    }

    fn check(&self, problem: &Problem) -> Result<()> {
        for (dof, copies) in &self.copies {
            let body = |c: &Copy| self.body(c);
            if let Some(c) = copies.iter().find(|c| body(c) != body(&copies[0])) {
                return Err(Error::input(format!(
                    "body dof {dof} is listed by subdomain {} of body \"{}\" \
                     and by subdomain {} of body \"{}\", but bodies share dofs only through interface rows",
                    copies[0].subdomain,
                    problem.body_names[body(&copies[0]) as usize],
                    c.subdomain,
                    problem.body_names[body(c) as usize],
                ))
                .at(problem.location(&[body(&copies[0]), body(c)])));
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
