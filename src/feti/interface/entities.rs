//! Averages over edges and faces: the entities of the subdomains that become primal constraints.
//!
//! Every entity is reported to a rendezvous rank that follows from its key. That rank sees all subdomains that list the
//! entity, compares their lists and sends back the number of subdomains.

use std::hash::{DefaultHasher, Hash, Hasher};

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::motions;
use super::sharing::DofSharing;
use crate::feti::settings::{Averages, Primal};
use crate::substructures::{Entity, Problem, Subdomain};
use crate::{Error, Result};
use bytemuck::{Pod, Zeroable};
use parallel::exchange::exchange_by_rank;

/// The kind of a primal constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AverageKind {
    /// The mean of a component over an edge or face.
    Mean,
    /// The part in a motion without energy, beyond the means.
    Motion,
    /// A functional that adaptivity has added.
    Adaptive,
}

impl AverageKind {
    /// The number of the kind among those of primal dofs, where vertices have 0 and fixing dofs 2.
    pub fn number(self) -> u32 {
        match self {
            AverageKind::Mean => 1,
            AverageKind::Adaptive => 3,
            AverageKind::Motion => 4,
        }
    }
}

/// A primal constraint that several subdomains of a body share: the mean over some dofs, or another functional of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Average {
    /// Its kind.
    pub kind: AverageKind,
    /// The key of the entity of a mean. For others, a body dof that no other functional of the kind has.
    pub key: u64,
    /// Local dofs, none of them a shared vertex.
    pub dofs: Vec<u32>,
    /// Weights of the functional: Σ weights · u is the same in all these subdomains; `None` for the mean.
    pub weights: Option<Vec<f64>>,
}

/// An entity as one of its subdomains lists it.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
struct Listed {
    key: u64,
    body: usize,
    subdomain: usize,
    n_dofs: usize,
    /// A hash of the body dofs.
    hash: u64,
}

/// The entities of a subdomain that the user's choice makes primal.
pub fn chosen(sub: &Subdomain, primal: Primal) -> impl Iterator<Item = &Entity> {
    sub.entities.iter().filter(move |e| primal.takes(e.kind))
}

/// The averages that each local subdomain shares with other subdomains. The entities must have passed [`check`].
/// Collective.
pub fn averages(
    comm: &SimpleCommunicator,
    problem: &Problem,
    sharing: &DofSharing,
    primal: Primal,
) -> Result<Vec<Vec<Average>>> {
    let size = comm.size() as usize;
    let mut reports: Vec<Vec<Listed>> = vec![Vec::new(); size];
    for sub in &problem.local {
        for entity in chosen(sub, primal) {
            let mut state = DefaultHasher::new();
            for &i in &entity.dofs {
                sub.dofs[i as usize].hash(&mut state);
            }
            reports[(entity.key % size as u64) as usize].push(Listed {
                key: entity.key,
                body: sub.body,
                subdomain: sub.index,
                n_dofs: entity.dofs.len(),
                hash: state.finish(),
            });
        }
    }
    let received = exchange_by_rank(comm, reports);
    let mut all = received.concat();
    all.sort_unstable();
    let agreed = all
        .chunk_by(|a, b| a.key == b.key)
        .try_for_each(|group| agree(problem, group));
    let count = |report: &Listed| {
        let start = all.partition_point(|r| r.key < report.key);
        let same = all[start..].iter().take_while(|r| r.key == report.key);
        same.count()
    };
    let replies = received.iter().map(|list| list.iter().map(count).collect());
    let answers: Vec<Vec<usize>> = exchange_by_rank(comm, replies.collect());
    agreed?;

    let mut next = vec![0; size];
    let (mut out, mut wholes) = (Vec::new(), Vec::new());
    for sub in &problem.local {
        let (mut mine, mut whole) = (Vec::new(), Vec::new());
        for entity in chosen(sub, primal) {
            let home = (entity.key % size as u64) as usize;
            let count = answers[home][next[home]];
            next[home] += 1;
            if let Some(average) = average(problem, sharing, sub, entity, count)? {
                mine.push(average);
                whole.push(entity.whole);
            }
        }
        out.push(mine);
        wholes.push(whole);
    }
    if primal.averages == Averages::Motions {
        motions::add(comm, problem, sharing, &wholes, &mut out);
    }
    Ok(out)
}

/// Checks of each local subdomain by itself: the dofs of the chosen entities exist and belong to one entity each.
pub fn check(problem: &Problem, primal: Primal) -> Result<()> {
    let mut each = problem.local.iter();
    each.try_for_each(|sub| valid(problem, sub, primal))
}

/// The constraint of an entity that `count` subdomains share; `None` for one subdomain, or where all its dofs are
/// vertices.
fn average(
    problem: &Problem,
    sharing: &DofSharing,
    sub: &Subdomain,
    entity: &Entity,
    count: usize,
) -> Result<Option<Average>> {
    let mut dofs = Vec::new();
    for &i in &entity.dofs {
        let copies = sharing.shared(sub.dofs[i as usize]);
        if DofSharing::is_primal(copies) {
            continue;
        }
        if copies.len().max(1) != count {
            return Err(Error::input(format!(
                "{} lists entity {} with local dof {i}, which {} subdomains hold, \
                 but {count} list the entity, expected the same number",
                name(problem, sub.index, sub.body),
                entity.key,
                copies.len().max(1),
            )));
        }
        dofs.push(i);
    }
    Ok((count > 1 && !dofs.is_empty()).then_some(Average {
        kind: AverageKind::Mean,
        key: entity.key,
        dofs,
        weights: None,
    }))
}

fn valid(problem: &Problem, sub: &Subdomain, primal: Primal) -> Result<()> {
    let mut taken = vec![false; sub.dofs.len()];
    for entity in chosen(sub, primal) {
        let who = || {
            format!(
                "{} lists entity {}",
                name(problem, sub.index, sub.body),
                entity.key
            )
        };
        if entity.dofs.is_empty() {
            return Err(Error::input(format!(
                "{} without dofs, expected at least one",
                who()
            )));
        }
        for &i in &entity.dofs {
            match taken.get_mut(i as usize) {
                None => {
                    return Err(Error::input(format!(
                        "{} with local dof {i}, expected one below {}",
                        who(),
                        sub.dofs.len()
                    )))
                }
                Some(true) => {
                    return Err(Error::input(format!(
                        "{} with local dof {i}, which is listed before, expected every dof in one edge or face",
                        who()
                    )))
                }
                Some(free) => *free = true,
            }
        }
    }
    Ok(())
}

/// Checks that the subdomains agree on an entity that they list under one key.
fn agree(problem: &Problem, group: &[Listed]) -> Result<()> {
    let first = &group[0];
    let who = |r: &Listed| name(problem, r.subdomain, r.body);
    for other in &group[1..] {
        let twice = first.subdomain == other.subdomain;
        let dofs = |r: &Listed| (r.body, r.n_dofs, r.hash);
        if !twice && dofs(first) == dofs(other) {
            continue;
        }
        let what = if twice {
            "twice"
        } else {
            "with different dofs"
        };
        return Err(Error::input(format!(
            "entity {} is listed by {} and by {} {what}, \
             expected the same body dofs in the same order, once in each subdomain of one body",
            first.key,
            who(first),
            who(other)
        )));
    }
    Ok(())
}

fn name(problem: &Problem, subdomain: usize, body: usize) -> String {
    match problem.body_names.get(body) {
        Some(name) => format!("subdomain {subdomain} of body \"{name}\""),
        // A body that does not exist is found later.
        None => format!("subdomain {subdomain}"),
    }
}
