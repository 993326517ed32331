//! Bodies: subdomains that are held together, grouped as the user says or by a partition of their graph.

use super::hold::Bond;
use crate::{Error, Result};

/// Subdomains per body that a partition aims at where nothing is said.
const USUAL: usize = 8;

/// How subdomains become bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// One body for every eight subdomains.
    Auto,
    /// This many bodies.
    Number(usize),
}

impl Grouping {
    /// The number of bodies that `n` subdomains are to form.
    pub fn bodies(self, n: usize) -> usize {
        match self {
            Grouping::Auto => n.div_ceil(USUAL),
            Grouping::Number(wanted) => wanted.min(n),
        }
    }
}

/// The body of every subdomain, numbered from 0 by lowest subdomain. `named` has what the host says of each subdomain.
///
/// A group that is not in one piece becomes several bodies: it takes bonds that hold to make one.
///
/// # Errors
/// Bodies named for some subdomains and not for others.
pub fn bodies(named: &[Option<u64>], bonds: &[Bond], grouping: Grouping) -> Result<Vec<usize>> {
    let n = named.len();
    let group: Vec<u64> = if named.iter().any(Option::is_some) {
        let missing = named.iter().position(Option::is_none);
        match missing {
            None => named.iter().map(|b| b.unwrap_or(0)).collect(),
            Some(s) => {
                return Err(Error::input(format!(
                    "subdomain {s} was given no body but others were, expected a body for every subdomain (KSPFETIFETISetBody on all ranks) or for none"
                )))
            }
        }
    } else {
        partition(n, bonds, grouping.bodies(n))
    };
    // Connected pieces of the groups.
    let mut label = vec![usize::MAX; n];
    let mut near: Vec<Vec<usize>> = vec![Vec::new(); n];
    for bond in bonds.iter().filter(|b| b.holds) {
        near[bond.low].push(bond.high);
        near[bond.high].push(bond.low);
    }
    let mut next = 0;
    for start in 0..n {
        if label[start] != usize::MAX {
            continue;
        }
        label[start] = next;
        let mut stack = vec![start];
        while let Some(s) = stack.pop() {
            for &t in &near[s] {
                if label[t] == usize::MAX && group[t] == group[s] {
                    label[t] = next;
                    stack.push(t);
                }
            }
        }
        next += 1;
    }
    Ok(label)
}

/// Groups of nearly equal size, each grown from a corner of what is left, in two ways: by what has most in common with the group, or
/// in rings around its first. The one with less in common between groups is taken: long groups are held badly by their neighbours.
fn partition(n: usize, bonds: &[Bond], parts: usize) -> Vec<u64> {
    let cut = |group: &Vec<u64>| -> usize {
        let cut = bonds.iter().filter(|b| group[b.low] != group[b.high]);
        cut.map(|b| b.shared).sum()
    };
    let ways = [false, true].map(|rings| grown(n, bonds, parts, rings));
    let best = ways.into_iter().min_by_key(cut);
    best.expect("there are two ways")
}

fn grown(n: usize, bonds: &[Bond], parts: usize, rings: bool) -> Vec<u64> {
    let mut near: Vec<Vec<(usize, usize)>> = vec![Vec::new(); n];
    for bond in bonds.iter().filter(|b| b.holds) {
        near[bond.low].push((bond.high, bond.shared));
        near[bond.high].push((bond.low, bond.shared));
    }
    let mut group = vec![u64::MAX; n];
    for g in 0..parts {
        let left = group.iter().filter(|&&x| x == u64::MAX).count();
        let size = left.div_ceil(parts - g);
        let mut pull = vec![0usize; n];
        let mut steps = vec![usize::MAX; n];
        for _ in 0..size {
            let open = (0..n).filter(|&s| group[s] == u64::MAX);
            // Reached at all, or a new start; the ring; many dofs in common with the group, few with the rest; the lowest number.
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
mod tests {
    use super::*;

    /// Bonds of a w × h grid of subdomains: 9 dofs along sides, 1 at corners.
    fn grid(w: usize, h: usize) -> Vec<Bond> {
        let mut bonds = Vec::new();
        for low in 0..w * h {
            for high in low + 1..w * h {
                let (dx, dy) = ((low % w).abs_diff(high % w), high / w - low / w);
                if dx <= 1 && dy <= 1 {
                    bonds.push(Bond {
                        low,
                        high,
                        shared: if dx + dy == 1 { 9 } else { 1 },
                        holds: true,
                    });
                }
            }
        }
        bonds
    }

    #[test]
    fn groups_are_equal_and_connected() {
        for (w, h, parts) in [(4, 4, 2), (4, 4, 4), (6, 4, 3), (3, 3, 2), (5, 1, 2)] {
            let group = partition(w * h, &grid(w, h), parts);
            let body = bodies(&vec![None; w * h], &grid(w, h), Grouping::Number(parts)).unwrap();
            assert_eq!(body.iter().max().unwrap() + 1, parts, "{group:?}");
            for b in 0..parts {
                let size = body.iter().filter(|&&x| x == b).count();
                assert!(size == w * h / parts || size == (w * h).div_ceil(parts));
            }
        }
    }

    #[test]
    fn groups_are_round() {
        // Also where corners hold nothing, as in elasticity.
        let mut bonds = grid(4, 4);
        bonds.iter_mut().for_each(|b| b.holds = b.shared > 1);
        let group = partition(16, &bonds, 4);
        let block = |s: usize| s % 4 / 2 + 2 * (s / 8);
        for (s, t) in (0..16).flat_map(|s| (0..16).map(move |t| (s, t))) {
            assert_eq!(group[s] == group[t], block(s) == block(t), "{group:?}");
        }
    }

    #[test]
    fn a_group_in_two_pieces_is_two_bodies() {
        let named = [Some(7), Some(3), Some(7)];
        assert_eq!(
            bodies(&named, &grid(3, 1), Grouping::Auto).unwrap(),
            [0, 1, 2]
        );
        assert!(bodies(&[Some(1), None], &grid(2, 1), Grouping::Auto).is_err());
    }
}
