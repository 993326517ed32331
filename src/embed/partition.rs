//! Groups of subdomains where the host names none: a partition of the subdomain graph, weighted by common dofs.
//!
//! The graph is small (one vertex for each subdomain), and all ranks get it; where the host names bodies none does. The
//! first rank partitions it: the groups do not depend on the distribution of subdomains over ranks.

use super::bonds::Bond;
use crate::Result;
use base::linalg::union_find::UnionFind;
use parallel::exchange::{gather_all, sum_all};
use petsc::{partition as by_petsc, Options, PetscInt, Session};
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Partitions that this process has looked for as the first rank of its communicator.
static PARTITIONS: AtomicUsize = AtomicUsize::new(0);

/// Number of partitions that this process has looked for so far, as the first rank of a communicator.
pub fn partitions() -> usize {
    PARTITIONS.load(Ordering::Relaxed)
}

/// Subdomains of one body at most where the host says nothing about bodies. One rank factors the primal problem of a
/// body, in space with operations as the square of their number, while tearing costs iterations of all ranks. With 4096
/// elastic subdomains in space one body takes half the time of eight (docs/embedding.md).
pub const MOST: usize = 4096;

/// The groups where the host says nothing: connected pieces of up to `most` subdomains as they are, larger ones in
/// groups of about equal size that are no larger. Tearing costs iterations, as between bodies displacements are equal
/// at the end alone. `n` and `mine` as for [`partition`]. Collective.
///
/// # Errors
/// PETSc's own.
pub fn whole_pieces(
    session: &Session,
    prefix: &str,
    n: usize,
    mine: &[Bond],
    most: usize,
) -> Result<Vec<u64>> {
    if n <= most {
        return Ok(vec![0; n]);
    }
    let bonds = everywhere(session, mine);
    let piece_of = connected(&vec![0; n], &bonds);
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); piece_of.iter().max().map_or(0, |p| p + 1)];
    let mut place = vec![0; n];
    for (s, &piece) in piece_of.iter().enumerate() {
        place[s] = members[piece].len();
        members[piece].push(s);
    }
    let mut group = vec![0; n];
    let mut first = 0;
    for (piece, members) in members.iter().enumerate() {
        let parts = members.len().div_ceil(most);
        let inside = |b: &&Bond| piece_of[b.low] == piece && piece_of[b.high] == piece;
        let own = bonds.iter().filter(inside).map(|b| Bond {
            low: place[b.low],
            high: place[b.high],
            ..*b
        });
        let of = match parts {
            1 => vec![0; members.len()],
            _ => best(
                session,
                prefix,
                members.len(),
                &own.collect::<Vec<_>>(),
                parts,
            )?,
        };
        members
            .iter()
            .zip(of)
            .for_each(|(&s, of)| group[s] = first + of);
        first += parts as u64;
    }
    Ok(group)
}

/// `parts` groups of about equal size of all `n` subdomains; `mine` has the bonds whose lower subdomain is on this
/// rank. If the option `-<prefix>mat_partitioning_type` is set, PETSc's MatPartitioning of this type makes the groups.
/// Otherwise groups are grown in two ways, and subdomains exchanged between neighbours. Among candidates with the right
/// number of connected groups, the one with the fewest dofs in common between groups is taken, since neighbours
/// constrain an elongated group only weakly. Collective.
///
/// # Errors
/// PETSc's own.
pub fn partition(
    session: &Session,
    prefix: &str,
    n: usize,
    mine: &[Bond],
    parts: usize,
) -> Result<Vec<u64>> {
    best(session, prefix, n, &everywhere(session, mine), parts)
}

/// The best of the candidates of [`partition`]; `bonds` has those of all ranks. Collective.
fn best(
    session: &Session,
    prefix: &str,
    n: usize,
    bonds: &[Bond],
    parts: usize,
) -> Result<Vec<u64>> {
    PARTITIONS.fetch_add(usize::from(session.rank() == 0), Ordering::Relaxed);
    let chosen = Options::new(session, prefix).has("mat_partitioning_type")?;
    let near = neighbours(n, bonds);
    let candidates = if chosen && parts > 1 {
        let found = if session.rank() == 0 {
            let (row, col, weight) = graph(&near);
            by_petsc(session, prefix, (&row, &col, &weight), parts)
        } else {
            Ok(vec![0; n])
        };
        vec![session.agree(found)?]
    } else {
        let grown = [false, true].map(|rings| grown(&near, parts, rings));
        let exchanged = grown.clone().map(|group| exchanged(&near, group));
        grown.into_iter().chain(exchanged).collect()
    };
    let score = |group: &Vec<u64>| -> (usize, usize) {
        let n_bodies = connected(group, bonds).iter().max().map_or(0, |b| b + 1);
        let cut = bonds.iter().filter(|b| group[b.low] != group[b.high]);
        (n_bodies.abs_diff(parts), cut.map(|b| b.shared).sum())
    };
    let best = candidates.into_iter().min_by_key(score);
    // The other ranks also have candidates, but take the first rank's choice.
    let mut words: Vec<f64> = match best {
        Some(group) if session.rank() == 0 => group.iter().map(|&g| g as f64).collect(),
        _ => vec![0.0; n],
    };
    sum_all(session.comm(), &mut words);
    Ok(words.iter().map(|&g| g as u64).collect())
}

/// The bonds of all ranks, on all of them. Collective.
fn everywhere(session: &Session, mine: &[Bond]) -> Vec<Bond> {
    let mine = mine.iter();
    let mine = mine.map(|b| [b.low, b.high, b.shared, b.holds.into()]);
    let all = gather_all(session.comm(), &mine.collect::<Vec<_>>()).concat();
    let bond = |[low, high, shared, holds]: [usize; 4]| Bond {
        low,
        high,
        shared,
        holds: holds != 0,
    };
    all.into_iter().map(bond).collect()
}

/// The body of every subdomain if these are the groups, numbered from 0 by lowest subdomain: a group that is not
/// connected through bonds that hold becomes several bodies.
fn connected(group: &[u64], bonds: &[Bond]) -> Vec<usize> {
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

/// For each subdomain those that bonds hold to it, increasing, each with the number of common dofs.
type Neighbours = [Vec<(usize, usize)>];

fn neighbours(n: usize, bonds: &[Bond]) -> Vec<Vec<(usize, usize)>> {
    let mut near = vec![Vec::new(); n];
    for bond in bonds.iter().filter(|b| b.holds) {
        near[bond.low].push((bond.high, bond.shared));
        near[bond.high].push((bond.low, bond.shared));
    }
    near.iter_mut().for_each(|list| list.sort_unstable());
    near
}

/// The graph in compressed rows.
fn graph(near: &Neighbours) -> (Vec<PetscInt>, Vec<PetscInt>, Vec<PetscInt>) {
    let mut row = vec![0];
    let (mut col, mut weight) = (Vec::new(), Vec::new());
    for list in near {
        col.extend(list.iter().map(|l| l.0 as PetscInt));
        weight.extend(list.iter().map(|l| l.1 as PetscInt));
        row.push(col.len() as PetscInt);
    }
    (row, col, weight)
}

/// Exchanges subdomains between neighbouring groups while that leaves fewer dofs in common between groups, as Kernighan
/// and Lin do: each subdomain at the border in turn, with the best of those that touch its group. Groups keep their
/// sizes.
fn exchanged(near: &Neighbours, mut group: Vec<u64>) -> Vec<u64> {
    // The dofs that a subdomain has in common with another group, beside those with its own.
    let gain = |group: &[u64], s: usize, to: u64| -> i64 {
        let common = near[s].iter().map(|&(t, w)| match group[t] {
            g if g == to => w as i64,
            g if g == group[s] => -(w as i64),
            _ => 0,
        });
        common.sum()
    };
    let around =
        |group: &[u64], s: usize| -> BTreeSet<u64> { near[s].iter().map(|l| group[l.0]).collect() };
    loop {
        let mut changed = false;
        for s in 0..near.len() {
            let others = around(&group, s);
            let mut best = (0, s);
            for &to in others.iter().filter(|&&to| to != group[s]) {
                let own = gain(&group, s, to);
                let touching =
                    |t: &usize| group[*t] == to && around(&group, *t).contains(&group[s]);
                for t in (0..near.len()).filter(touching) {
                    let both = near[s].iter().find(|l| l.0 == t).map_or(0, |l| l.1 as i64);
                    let all = own + gain(&group, t, group[s]) - 2 * both;
                    best = if all > best.0 { (all, t) } else { best };
                }
            }
            if best.0 > 0 {
                group.swap(s, best.1);
                changed = true;
            }
        }
        if !changed {
            return group;
        }
    }
}

/// Grows groups one after the other from a corner of the remaining graph. The next subdomain is the one with most dofs
/// in common with the group, or with `rings` the one nearest to the group's first.
fn grown(near: &Neighbours, parts: usize, rings: bool) -> Vec<u64> {
    let n = near.len();
    let mut group = vec![u64::MAX; n];
    for g in 0..parts {
        let left = group.iter().filter(|&&x| x == u64::MAX).count();
        let size = left.div_ceil(parts - g);
        let mut pull = vec![0usize; n];
        let mut steps = vec![usize::MAX; n];
        for _ in 0..size {
            let open = (0..n).filter(|&s| group[s] == u64::MAX);
            // Sort key: reached or a new start; the ring; many dofs in common with the group, few with the rest; the
            // lowest number.
            let rank = |&s: &usize| {
                let free = near[s].iter().filter(|(t, _)| group[*t] == u64::MAX);
                let rest: usize = free.map(|(_, w)| w).sum();
                let ring = if rings { steps[s] } else { 0 };
                let reached = steps[s] != usize::MAX;
                (!reached, ring, rest as i64 - 2 * pull[s] as i64, s)
            };
            let Some(s) = open.min_by_key(rank) else {
                break;
            };
            group[s] = g as u64;
            let next = if steps[s] == usize::MAX {
                1
            } else {
                steps[s] + 1
            };
            for &(t, weight) in &near[s] {
                pull[t] += weight;
                steps[t] = steps[t].min(next);
            }
        }
    }
    group
}

#[cfg(test)]
#[path = "../../tests/inside/embed/partition.rs"]
mod tests;
