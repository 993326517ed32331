//! Vertices, edges and faces. A class has the dofs of one component in a connected set of dofs that the same subdomains
//! share.
//!
//! Two dofs are connected if the matrix of some subdomain couples their nodes. A subdomain sees only its own side of a
//! face; one rank, determined by the list of subdomains, merges the sides.

use std::collections::{BTreeMap, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};

use super::parts::TornSubdomain;
use super::sharing::Sharers;
use super::torn::Torn;
use crate::substructures::EntityKind;
use mpi::traits::Communicator;
use parallel::exchange::{any, exchange_by_rank};
use petsc::Session;

/// A connected piece of interface, as one of its subdomains sees it.
#[derive(Debug, Clone)]
pub struct InterfaceClass {
    /// The lowest global dof of the class, which identifies it.
    pub root: u32,
    /// The lowest global dof of all components of the connected set.
    pub whole: u32,
    /// The subdomains that share it, of all bodies, increasing.
    pub sharers: Vec<u32>,
    /// Local dofs, increasing.
    pub dofs: Vec<u32>,
}

impl InterfaceClass {
    /// Whether the class is a single dof shared by three or more subdomains.
    pub fn is_vertex(&self) -> bool {
        self.dofs.len() == 1 && self.sharers.len() > 2
    }

    /// The kind of a class that is no vertex. In the plane, the interfaces between two subdomains count as edges.
    pub fn kind(&self, space: bool) -> EntityKind {
        if space && self.sharers.len() == 2 {
            EntityKind::Face
        } else {
            EntityKind::Edge
        }
    }
}

/// The classes of every local subdomain, by root. Collective.
pub fn classes(
    session: &Session,
    torn: &Torn,
    parts: &[TornSubdomain],
    sharers: &Sharers,
) -> Vec<Vec<InterfaceClass>> {
    let comm = session.comm();
    let size = comm.size() as usize;
    // Local candidates: lists of (rank that merges the sides, dofs of a locally connected piece).
    let mut guesses: Vec<Vec<(usize, Vec<u32>)>> = Vec::new();
    let mut asked: Vec<Vec<[u32; 2]>> = vec![Vec::new(); size];
    for part in parts {
        let mut mine = Vec::new();
        for dofs in connected(torn, part, sharers) {
            let mut state = DefaultHasher::new();
            sharers.of(part.dofs[dofs[0] as usize]).hash(&mut state);
            let home = state.finish() as usize % size;
            let root = part.dofs[dofs[0] as usize];
            for &i in &dofs {
                asked[home].push([part.dofs[i as usize], root]);
            }
            mine.push((home, dofs));
        }
        guesses.push(mine);
    }
    let received = exchange_by_rank(comm, asked);
    let mut above: HashMap<u32, u32> = HashMap::new();
    for &[dof, root] in received.iter().flatten() {
        join(&mut above, dof, root);
    }
    let replies = received
        .iter()
        .map(|list| list.iter().map(|w| find_root(&mut above, w[0])).collect())
        .collect();
    let answers: Vec<Vec<u32>> = exchange_by_rank(comm, replies);

    let mut next = vec![0; size];
    let mut out = Vec::new();
    for (part, mine) in parts.iter().zip(guesses) {
        let mut found: BTreeMap<(u32, usize), Vec<u32>> = BTreeMap::new();
        for (home, dofs) in mine {
            for i in dofs {
                let whole = answers[home][next[home]];
                next[home] += 1;
                let component = torn.component(part.dofs[i as usize]);
                found.entry((whole, component)).or_default().push(i);
            }
        }
        // All sharers have all dofs of a class, so that the lowest is the same for all.
        let class = |((whole, _), mut dofs): ((u32, usize), Vec<u32>)| {
            dofs.sort_unstable();
            let root = part.dofs[dofs[0] as usize];
            InterfaceClass {
                root,
                whole,
                sharers: sharers.of(root).to_vec(),
                dofs,
            }
        };
        let mut classes: Vec<InterfaceClass> = found.into_iter().map(class).collect();
        classes.sort_unstable_by_key(|class| class.root);
        out.push(classes);
    }
    out
}

/// Whether the problem is three-dimensional, judged from the interfaces: somewhere three or more subdomains share a
/// line of dofs. Collective.
pub fn in_space(session: &Session, classes: &[Vec<InterfaceClass>]) -> bool {
    let line = |c: &InterfaceClass| c.sharers.len() > 2 && c.dofs.len() > 1;
    any(session.comm(), classes.iter().flatten().any(line))
}

/// The locally connected pieces of a subdomain's interface: lists of local dofs, increasing.
fn connected(torn: &Torn, part: &TornSubdomain, sharers: &Sharers) -> Vec<Vec<u32>> {
    let n = part.dofs.len();
    let mut seen = vec![false; n];
    let mut out = Vec::new();
    for start in 0..n {
        let who = sharers.of(part.dofs[start]);
        if seen[start] || who.is_empty() {
            continue;
        }
        seen[start] = true;
        let mut stack = vec![start];
        let mut dofs = Vec::new();
        while let Some(i) = stack.pop() {
            dofs.push(i as u32);
            // Nodes are coupled if any of their components are: checks all dofs of this node.
            for k in of_node(torn, part, i) {
                for &j in part.k.row(k).0 {
                    for l in of_node(torn, part, j as usize) {
                        if !seen[l] && sharers.of(part.dofs[l]) == who {
                            seen[l] = true;
                            stack.push(l);
                        }
                    }
                }
            }
        }
        dofs.sort_unstable();
        out.push(dofs);
    }
    out
}

/// The local dofs of the node of local dof `i`.
fn of_node(torn: &Torn, part: &TornSubdomain, i: usize) -> std::ops::Range<usize> {
    let node = torn.node(part.dofs[i]);
    let (mut low, mut high) = (i, i + 1);
    while low > 0 && torn.node(part.dofs[low - 1]) == node {
        low -= 1;
    }
    while high < part.dofs.len() && torn.node(part.dofs[high]) == node {
        high += 1;
    }
    low..high
}

fn find_root(above: &mut HashMap<u32, u32>, dof: u32) -> u32 {
    let mut root = dof;
    while let Some(&up) = above.get(&root).filter(|&&up| up != root) {
        root = up;
    }
    // Path compression.
    above.insert(dof, root);
    root
}

/// The lower of two roots becomes the root of both.
fn join(above: &mut HashMap<u32, u32>, a: u32, b: u32) {
    let (a, b) = (find_root(above, a), find_root(above, b));
    above.insert(a.max(b), a.min(b));
}
