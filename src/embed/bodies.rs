//! Bodies: groups of subdomains that are connected by primal constraints. The user names the groups, or a partition of
//! the subdomain graph finds them ([`partition`](super::partition)).

use super::hold::Bond;
use super::parts::Part;
use crate::linalg::union_find::UnionFind;
use crate::parallel::halo::Halo;
use crate::petsc::{Session, Vec as PetscVec};
use crate::{Error, Result};
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Default number of subdomains per body of a partition.
const USUAL: usize = 8;

/// The number of bodies for `n` subdomains where the host wants `wanted`; 0: one for every eight of the `given` local
/// matrices. A matrix that falls into many fragments does not make more bodies.
pub fn number(wanted: usize, given: usize, n: usize) -> usize {
    match wanted {
        0 => given.div_ceil(USUAL).clamp(1, n.max(1)),
        wanted => wanted.min(n),
    }
}

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
    parts: &mut [Part],
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

/// The groups that the host named; `None` if it named none.
///
/// # Errors The host named bodies for some subdomains but not for all.
pub fn named_groups(named: &[Option<u64>]) -> Result<Option<Vec<u64>>> {
    if named.iter().all(Option::is_none) {
        return Ok(None);
    }
    let given = |(s, body): (usize, &Option<u64>)| {
        body.ok_or_else(|| {
            Error::input(format!(
                "subdomain {s} was given no body but others were, \
                 expected a body for every subdomain (KSPFETIFETISetBody on all ranks) or for none"
            ))
        })
    };
    named
        .iter()
        .enumerate()
        .map(given)
        .collect::<Result<_>>()
        .map(Some)
}

/// The body of every subdomain, numbered from 0 by lowest subdomain.
///
/// A group that is not connected through bonds that hold becomes several bodies.
pub fn bodies(group: &[u64], bonds: &[Bond]) -> Vec<usize> {
    let mut sets = UnionFind::new(group.len());
    let joins = |b: &&Bond| b.holds && group[b.low] == group[b.high];
    for bond in bonds.iter().filter(joins) {
        sets.join(bond.low, bond.high);
    }
    let mut next = 0..;
    let mut body_of: Vec<usize> = Vec::with_capacity(group.len());
    for s in 0..group.len() {
        // The representative of a set is its lowest member, which comes before the others.
        let body = match sets.find(s) {
            lowest if lowest < s => body_of[lowest],
            _ => next.next().expect("numbers do not end"),
        };
        body_of.push(body);
    }
    body_of
}

#[cfg(test)]
#[path = "../../tests/inside/embed/bodies.rs"]
mod tests;
