//! Bodies: groups of subdomains that are connected by primal constraints. The user names the groups, or a partition of
//! the subdomain graph finds them ([`partition`](super::partition)).

use super::bonds::Bond;
use super::parts::TornSubdomain;
use super::sharing::Sharers;
use crate::{Error, Result};
use base::linalg::sorted::distinct;
use base::linalg::union_find::UnionFind;
use parallel::exchange::{any, exchange, exchange_by_rank, offsets};
use parallel::halo::Halo;
use petsc::{Session, Vec as PetscVec};
use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap};

/// Assigns to every part the body that most of its dofs name; in a tie, the lowest. `numbers` has the body of each
/// global dof. Collective.
///
/// # Errors
/// A body number that is not valid.
pub fn by_most_dofs(
    session: &Session,
    numbers: &PetscVec,
    halo: &Halo,
    ghosts: &[u32],
    parts: &mut [TornSubdomain],
) -> Result<()> {
    let mut values = vec![0.0; ghosts.len()];
    halo.fetch(numbers, &mut values)?;
    let negative = ghosts.iter().zip(&values).find(|(_, v)| **v < 0.0);
    session.agree(negative.map_or(Ok(()), |(dof, v)| {
        Err(Error::input(format!(
            "the body of global dof {dof} is {v}, expected a number of at least 0"
        )))
    }))?;
    for part in parts {
        let mut votes: BTreeMap<u64, usize> = BTreeMap::new();
        for dof in &part.dofs {
            let place = ghosts.binary_search(dof).expect("a part's dof is a ghost");
            *votes.entry(values[place] as u64).or_default() += 1;
        }
        let most = votes.iter().max_by_key(|(body, n)| (**n, Reverse(**body)));
        part.body = most.map(|(body, _)| *body);
    }
    Ok(())
}

/// The groups of this rank's subdomains that the host named; `None` if it named none on any rank. `first` is the number
/// of the first of them. Collective.
///
/// # Errors
/// The host named bodies for some subdomains but not for all; the same error on all ranks.
pub fn named_groups(
    session: &Session,
    first: usize,
    parts: &[TornSubdomain],
) -> Result<Option<Vec<u64>>> {
    if !any(session.comm(), parts.iter().any(|p| p.body.is_some())) {
        return Ok(None);
    }
    let given = |(j, part): (usize, &TornSubdomain)| {
        part.body.ok_or_else(|| {
            Error::input(format!(
                "subdomain {} was given no body but others were, \
                 expected a body for every subdomain (KSPFETIFETISetBody on all ranks) or for none",
                first + j
            ))
        })
    };
    let groups = parts.iter().enumerate().map(given).collect();
    session.agree(groups).map(Some)
}

/// The bodies, as a rank knows them: numbered from 0 by lowest subdomain.
pub struct Bodies {
    /// Bodies over all ranks.
    pub n: usize,
    /// The body of each of this rank's subdomains.
    pub mine: Vec<usize>,
    /// The bodies of this rank's subdomains and of their neighbours, by subdomain.
    around: HashMap<u32, usize>,
}

impl Bodies {
    /// A group that is not connected through bonds that hold becomes several bodies. `group` has the groups of this
    /// rank's subdomains, `bonds` the bonds whose lower subdomain is on this rank. Collective.
    pub fn new(session: &Session, sharers: &Sharers, group: &[u64], bonds: &[Bond]) -> Bodies {
        let comm = session.comm();
        let lowest = lowest_of_bodies(session, sharers, group, bonds);
        let own = lowest.iter().zip(sharers.first as u32..);
        let own: Vec<u32> = own.filter(|(low, s)| *low == s).map(|(_, s)| s).collect();
        let (before, n) = offsets(comm, own.len());
        // The rank of the lowest subdomain knows the number.
        let wanted = distinct(lowest.iter().copied());
        let mut outgoing = vec![Vec::new(); session.size()];
        for &low in &wanted {
            outgoing[sharers.owners.of(low)].push(low);
        }
        let number = |low: &u32| {
            let place = own.binary_search(low);
            before + place.expect("it is the lowest of a body")
        };
        let asked = exchange_by_rank(comm, outgoing);
        let replies = asked.iter().map(|list| list.iter().map(number).collect());
        // Higher ranks have higher subdomains.
        let numbers = exchange(comm, replies.collect());
        let body = |low: &u32| {
            let place = wanted.binary_search(low);
            numbers[place.expect("it was asked for")]
        };
        let mine: Vec<usize> = lowest.iter().map(body).collect();
        Bodies {
            n,
            around: sharers.around(session, &mine),
            mine,
        }
    }

    /// The body of a subdomain of this rank, or of a neighbour of one.
    pub fn of(&self, subdomain: u32) -> usize {
        self.around[&subdomain]
    }
}

/// The lowest subdomain of the body of each of this rank's subdomains. Ranks tell each other across the bonds what they
/// know, until nobody learns of a lower one. Collective.
fn lowest_of_bodies(
    session: &Session,
    sharers: &Sharers,
    group: &[u64],
    bonds: &[Bond],
) -> Vec<u32> {
    let (comm, first) = (session.comm(), sharers.first);
    let groups = sharers.around(session, group);
    let mut sets = UnionFind::new(group.len());
    // Subdomains of this rank, by their place, that a bond joins to one of another rank.
    let mut links: Vec<(usize, u32)> = Vec::new();
    let mut outgoing = vec![Vec::new(); session.size()];
    for bond in bonds.iter().filter(|b| b.holds) {
        let [low, high] = [bond.low as u32, bond.high as u32];
        if groups[&low] != groups[&high] {
            continue;
        }
        if bond.high < first + group.len() {
            sets.join(bond.low - first, bond.high - first);
        } else {
            links.push((bond.low - first, high));
            outgoing[sharers.owners.of(high)].push([high, low]);
        }
    }
    let received = exchange(comm, outgoing).into_iter();
    links.extend(received.map(|[own, other]| (own as usize - first, other)));
    // By set: a representative is the lowest of its set on this rank.
    let mut lowest: Vec<u32> = (first as u32..).take(group.len()).collect();
    let mut told = vec![u32::MAX; links.len()];
    loop {
        let mut outgoing = vec![Vec::new(); session.size()];
        let mut news = false;
        for (&(j, other), told) in links.iter().zip(&mut told) {
            let low = lowest[sets.find(j)];
            if low < *told {
                (*told, news) = (low, true);
                outgoing[sharers.owners.of(other)].push([other, low]);
            }
        }
        if !any(comm, news) {
            let lowest = |j| lowest[sets.find(j)];
            return (0..group.len()).map(lowest).collect();
        }
        for [own, low] in exchange(comm, outgoing) {
            let set = sets.find(own as usize - first);
            lowest[set] = lowest[set].min(low);
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/embed/bodies.rs"]
mod tests;
