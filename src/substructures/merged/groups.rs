//! Which bodies are tied for good.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use mpi::topology::SimpleCommunicator;

use super::interface::TiedDofs;
use crate::substructures::{Law, Problem, Row};
use base::linalg::sorted::distinct;
use base::linalg::union_find::UnionFind;
use parallel::exchange::{gather_all, max_all, sum_all};

/// The group of each body.
pub struct Groups {
    /// Group of each body; groups are numbered by their lowest body.
    pub of: Vec<usize>,
    /// Bodies of each group, increasing.
    pub members: Vec<Vec<usize>>,
}

/// Numbers of copies that differ by no more, relatively, are equal to rounding.
const EQUAL: f64 = 1e-10;

/// Whether bodies that are copies of each other are merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Copies {
    /// They stay bodies.
    Stay,
    /// As all others.
    Merge,
}

/// A row between two bodies, as ranks tell each other: the bodies, and whether it is a tie that can be merged.
type Joined = [u64; 3];

impl Groups {
    /// `None` where no bodies are tied for good. Where `copies` stay, a body that there is once more is not merged: its
    /// subdomains would have other interfaces than those of its copies, and share their factors no longer. Collective.
    pub fn new(comm: &SimpleCommunicator, problem: &Problem, copies: Copies) -> Option<Groups> {
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
        let mut fit = fit(comm, problem);
        if copies == Copies::Stay {
            for body in repeated(comm, problem) {
                fit[body] = None;
            }
        }
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

/// The bodies of which there are others with as many subdomains, dofs and entries, and with the same (tr K)²/‖K‖_F²,
/// which turns, mirrors and multiples keep. Collective.
fn repeated(comm: &SimpleCommunicator, problem: &Problem) -> Vec<usize> {
    let mut sums = vec![[0.0; 5]; problem.n_bodies];
    for sub in &problem.local {
        let rows = (0..sub.k.n()).flat_map(|i| sub.k.row(i).1);
        let square: f64 = rows.map(|v| v * v).sum();
        let trace: f64 = sub.k.diagonal().iter().sum();
        let more = [1.0, sub.f.len() as f64, sub.k.nnz() as f64, trace, square];
        let of = sums[sub.body].iter_mut();
        of.zip(more).for_each(|(s, m)| *s += m);
    }
    sum_all(comm, sums.as_flattened_mut());
    let key = |s: &[f64; 5]| [s[0], s[1], s[2], s[3] * s[3] / s[4]];
    let keys: Vec<[f64; 4]> = sums.iter().map(key).collect();
    let mut order: Vec<usize> = (0..problem.n_bodies).collect();
    order.sort_by(|&a, &b| {
        let mut pairs = keys[a].iter().zip(&keys[b]);
        let differ = pairs.find(|(x, y)| x != y);
        differ.map_or(Ordering::Equal, |(x, y)| x.total_cmp(y))
    });
    let alike = |a: [f64; 4], b: [f64; 4]| a[..3] == b[..3] && (a[3] - b[3]).abs() <= EQUAL * a[3];
    let pairs = order.windows(2).filter(|p| alike(keys[p[0]], keys[p[1]]));
    distinct(pairs.flatten().copied())
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
