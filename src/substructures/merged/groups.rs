//! Which bodies are tied for good.

use std::collections::{BTreeMap, BTreeSet};

use mpi::topology::SimpleCommunicator;

use super::interface::TiedDofs;
use crate::substructures::{Law, Problem, Row};
use base::linalg::union_find::UnionFind;
use parallel::exchange::{gather_all, max_all};

/// The group of each body.
pub struct Groups {
    /// Group of each body; groups are numbered by their lowest body.
    pub of: Vec<usize>,
    /// Bodies of each group, increasing.
    pub members: Vec<Vec<usize>>,
}

/// A row between two bodies, as ranks tell each other: the bodies, and whether it is a tie that can be merged.
type Joined = [u64; 3];

impl Groups {
    /// `None` where no bodies are tied for good. Collective.
    pub fn new(comm: &SimpleCommunicator, problem: &Problem) -> Option<Groups> {
        let bodies = BodiesOfDofs::new(comm, problem);
        let mut mine: BTreeSet<Joined> = BTreeSet::new();
        for row in &problem.rows {
            let of: BTreeSet<usize> = row.terms.iter().map(|t| bodies.of(t.0)).collect();
            let good = of.len() == 2 && is_tie(row);
            let of: Vec<usize> = of.into_iter().collect();
            for (k, &a) in of.iter().enumerate() {
                for &b in &of[k + 1..] {
                    mine.insert([a as u64, b as u64, good.into()]);
                }
            }
        }
        let mine: Vec<Joined> = mine.into_iter().collect();
        let mut joined: BTreeMap<[u64; 2], bool> = BTreeMap::new();
        for [a, b, good] in gather_all(comm, &mine).concat() {
            let all = joined.entry([a, b]).or_insert(true);
            *all &= good != 0;
        }
        let fit = fit(comm, problem);
        let mut sets = UnionFind::new(problem.n_bodies);
        let mut any = false;
        for ([a, b], _) in joined.into_iter().filter(|(_, good)| *good) {
            let (a, b) = (a as usize, b as usize);
            if fit[a].is_some() && fit[a] == fit[b] {
                sets.join(a, b);
                any = true;
            }
        }
        if !any {
            return None;
        }
        let mut number: BTreeMap<usize, usize> = BTreeMap::new();
        let mut of = Vec::new();
        let mut members: Vec<Vec<usize>> = Vec::new();
        for body in 0..problem.n_bodies {
            let next = number.len();
            let group = *number.entry(sets.find(body)).or_insert(next);
            if group == members.len() {
                members.push(Vec::new());
            }
            members[group].push(body);
            of.push(group);
        }
        Some(Groups { of, members })
    }

    /// Whether a body has others in its group.
    pub fn is_merged(&self, body: usize) -> bool {
        self.members[self.of[body]].len() > 1
    }

    /// Whether a row ties bodies of one group, so that the method does not need it.
    pub fn is_inside(&self, dofs: &TiedDofs, row: &Row) -> bool {
        is_tie(row) && dofs.are_one(row.terms[0].0, row.terms[1].0)
    }
}

/// Whether a row is u_a − u_b = 0 for two dofs, and holds.
pub fn is_tie(row: &Row) -> bool {
    let opposite = matches!(row.terms[..], [(_, a), (_, b)] if a == -b && a != 0.0);
    opposite && row.law == Law::Tie && row.holds && row.gap == 0.0 && row.compliance == 0.0
}

/// The number of motions of every body that can be merged, the same on all ranks; `None` where one has motions of its
/// own, or where positions and motions are not known. Collective.
fn fit(comm: &SimpleCommunicator, problem: &Problem) -> Vec<Option<usize>> {
    // The largest number of motions, and minus the smallest; 0 on ranks without a subdomain of the body.
    let n = problem.n_bodies;
    let mut found = vec![0.0; 2 * n];
    found[n..].fill(f64::NEG_INFINITY);
    for sub in &problem.local {
        let known = sub.near_kernel.as_ref().filter(|_| sub.idle.is_empty());
        let known = known.filter(|_| sub.coordinates.is_some());
        let number = known.map_or(0, Vec::len) as f64;
        found[sub.body] = f64::max(found[sub.body], number);
        found[n + sub.body] = f64::max(found[n + sub.body], -number);
    }
    max_all(comm, &mut found);
    let weak = |b: &usize| problem.weak.iter().any(|w| w.0 == *b);
    let of = |b: usize| {
        let (most, least) = (found[b], -found[n + b]);
        (most == least && most > 0.0 && !weak(&b)).then_some(most as usize)
    };
    (0..n).map(of).collect()
}

/// The body of each dof that rows name.
struct BodiesOfDofs(Vec<(u64, usize)>);

impl BodiesOfDofs {
    fn new(comm: &SimpleCommunicator, problem: &Problem) -> BodiesOfDofs {
        let named = super::interface::named(comm, problem, |_| true);
        let mut mine: BTreeSet<[u64; 2]> = BTreeSet::new();
        for sub in &problem.local {
            let named = |d: &&u64| named.binary_search(d).is_ok();
            mine.extend(sub.dofs.iter().filter(named).map(|&d| [d, sub.body as u64]));
        }
        let mine: Vec<[u64; 2]> = mine.into_iter().collect();
        let all: BTreeSet<[u64; 2]> = gather_all(comm, &mine).into_iter().flatten().collect();
        BodiesOfDofs(all.into_iter().map(|[d, b]| (d, b as usize)).collect())
    }

    fn of(&self, dof: u64) -> usize {
        let at = self.0.binary_search_by_key(&dof, |d| d.0);
        self.0[at.expect("rows name dofs of subdomains")].1
    }
}
