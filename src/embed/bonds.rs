//! Bonds: pairs of subdomains with common dofs, and which of them hold two subdomains together without a hinge.
//!
//! Two subdomains with the same number of motions hold each other if equality at their common dofs excludes every
//! relative motion. Such bonds may be chained. A subdomain with fewer motions (a single node cannot rotate) is held by
//! a larger one, but it does not pass the hold on: two plates that a pin joins turn about it. So subdomains with
//! equally few motions that hold each other form a cluster, and each cluster is held by one larger subdomain at most.
//! The bonds that hold are then the edges of a forest of clusters, and no subset of them leaves a hinge.

use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap};

use super::motions::NearKernels;
use super::parts::TornSubdomain;
use super::rigid_constraints::{Span, LOOSE};
use super::sharing::Sharers;
use base::linalg::sorted::distinct;
use base::linalg::union_find::UnionFind;
use bytemuck::{Pod, Zeroable};
use parallel::exchange::{gather_all, highest};
use petsc::Session;

/// Two subdomains that have dofs in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bond {
    /// The lower one.
    pub low: usize,
    /// The other one.
    pub high: usize,
    /// Dofs in common.
    pub shared: usize,
    /// Whether it holds the two together.
    pub holds: bool,
}

impl NearKernels {
    /// The bonds whose lower subdomain is on this rank. Nothing holds a subdomain with a mechanism: it becomes a body
    /// of its own. `group` has the groups of this rank's subdomains where the host names them: bonds between groups are
    /// left out. Collective.
    pub fn bonds(
        &self,
        session: &Session,
        parts: &[TornSubdomain],
        sharers: &Sharers,
        group: Option<&[u64]>,
    ) -> Vec<Bond> {
        let groups = group.map(|group| sharers.around(session, group));
        let same = |a: usize, b: usize| {
            let of = |groups: &HashMap<u32, u64>| groups[&(a as u32)] == groups[&(b as u32)];
            groups.as_ref().is_none_or(of)
        };
        let mut out = Vec::new();
        for j in 0..parts.len() {
            let low = sharers.first + j;
            for (high, dofs) in &sharers.neighbours[j] {
                let neighbour = *high as usize;
                if neighbour < low || !same(low, neighbour) {
                    continue;
                }
                let mut span = Span::default();
                for row in self.between(j, *high, dofs) {
                    span.add(row, LOOSE);
                }
                let loose = self.is_loose(low) || self.is_loose(neighbour);
                out.push(Bond {
                    low,
                    high: neighbour,
                    shared: dofs.len(),
                    holds: !loose && span.rank() >= self.needed(low, neighbour),
                });
            }
        }
        // Where kernels come from matrices, a bond that holds excludes the motions of both sides.
        if !self.are_kernels() {
            self.without_hinges(session, &mut out);
        }
        out
    }

    /// Of the bonds between a cluster of subdomains with few motions and larger subdomains, keeps those to the one with
    /// most dofs in common. `mine` has the bonds whose lower subdomain is on this rank. Collective.
    fn without_hinges(&self, session: &Session, mine: &mut [Bond]) {
        let ordered = |bond: &Bond| {
            let mut ends = [bond.low, bond.high].map(|s| (self.count(s), s));
            ends.sort_unstable();
            let [(few, child), (many, parent)] = ends;
            HoldingBond {
                child,
                parent,
                equal: usize::from(few == many),
                shared: bond.shared,
            }
        };
        // Bonds of small subdomains alone matter, and there are few of them.
        let counts = mine
            .iter()
            .flat_map(|b| [b.low, b.high])
            .map(|s| self.count(s));
        let full = highest(session.comm(), counts.max().unwrap_or(0) as f64) as usize;
        let small = mine.iter().filter(|b| b.holds).map(ordered);
        let small = small
            .filter(|b| self.count(b.child) < full)
            .collect::<Vec<_>>();
        let parents = parents(&gather_all(session.comm(), &small).concat());
        for bond in mine.iter_mut().filter(|b| b.holds) {
            let of = ordered(bond);
            bond.holds = of.equal != 0 || parents[&of.child] == of.parent;
        }
    }
}

/// A bond that holds. The child has fewer motions than the parent, or equally many.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct HoldingBond {
    child: usize,
    parent: usize,
    /// Whether both have equally many motions: 0 or 1.
    equal: usize,
    /// Dofs in common.
    shared: usize,
}

/// For every subdomain that larger ones hold, the one that keeps it: the same for all subdomains of a cluster.
fn parents(bonds: &[HoldingBond]) -> HashMap<usize, usize> {
    let members = distinct(bonds.iter().flat_map(|b| [b.child, b.parent]));
    let place = |s: usize| members.binary_search(&s).expect("a member");
    let mut clusters = UnionFind::new(members.len());
    for bond in bonds.iter().filter(|b| b.equal != 0) {
        clusters.join(place(bond.child), place(bond.parent));
    }
    let cluster: Vec<usize> = (0..members.len()).map(|p| clusters.find(p)).collect();
    // Dofs that a cluster has in common with each larger subdomain.
    let mut common: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for bond in bonds.iter().filter(|b| b.equal == 0) {
        let pair = (cluster[place(bond.child)], bond.parent);
        *common.entry(pair).or_default() += bond.shared;
    }
    let mut most: HashMap<usize, (usize, Reverse<usize>)> = HashMap::new();
    for ((cluster, parent), shared) in common {
        let found = most.entry(cluster).or_insert((shared, Reverse(parent)));
        *found = (*found).max((shared, Reverse(parent)));
    }
    let kept = members.iter().zip(&cluster);
    kept.filter_map(|(&s, c)| Some((s, most.get(c)?.1 .0)))
        .collect()
}

#[cfg(test)]
#[path = "../../tests/inside/embed/bonds.rs"]
mod tests;
