//! Points at which bodies meet: which copies of u are one there, which are given, and the rows that follow.

use super::interface::{Interface, Link, Shape};
use super::validate::agree;
use super::Body;
use crate::error::{Error, Result};
use std::collections::HashMap;

/// A node of one body at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Member {
    /// The body.
    pub body: usize,
    /// Its node.
    pub node: usize,
}

/// A point at which nodes of several bodies coincide.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Its number: the lowest body dof at the point, unique in the scene.
    pub block: u64,
    /// The subdomain of lowest index that contains the point; the rank that owns it provides the rows.
    pub subdomain: usize,
    /// The nodes, by increasing body.
    pub members: Vec<Member>,
    /// Lowest member (index into `members`) to which each member is tied, itself where it is tied to none lower.
    pub tied_to: Vec<usize>,
    /// Pairs of members that have a row u_a − u_b = 0. None where u is given.
    pub rows: Vec<PointRow>,
}

/// A pair of members of a point with a row u_a − u_b = 0.
///
/// Pairs that share a face have a row where the face is tied, or open in a face that is tied elsewhere. Pairs that only meet
/// in the corner have one where such faces join them, so that the rows are fully redundant at cross points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointRow {
    /// Indices into [`Point::members`], the lower first.
    pub members: [usize; 2],
    /// Whether the row holds; otherwise it only marks candidate contact nodes.
    pub holds: bool,
}

/// The points of a scene. Nodes that are tied to a given value are added to the given nodes of their body.
pub(super) fn collect(bodies: &mut [Body], interfaces: &[Interface]) -> Result<Vec<Point>> {
    let mut points = coinciding(bodies, interfaces);
    let mut inherited = Vec::new();
    for (point, links) in &mut points {
        close(point, links);
        prescribe(bodies, point, &mut inherited)?;
    }
    for (Member { body, node }, value) in inherited {
        bodies[body].prescribed.push((node, value));
    }
    for body in bodies.iter_mut() {
        body.prescribed.sort_by_key(|&(node, _)| node);
    }
    let mut out: Vec<Point> = points.into_iter().map(|(point, _)| point).collect();
    for point in &mut out {
        let Point { members, rows, .. } = point;
        rows.retain(|row| {
            row.members.iter().all(|&m| {
                let Member { body, node } = members[m];
                bodies[body].prescribed_at(node).is_none()
            })
        });
    }
    Ok(out)
}

/// How two members of a point are linked.
struct PairLink {
    members: [usize; 2],
    link: Link,
    corner: bool,
}

/// Groups the shared nodes of all interfaces by position, in order of `block`.
fn coinciding(bodies: &[Body], interfaces: &[Interface]) -> Vec<(Point, Vec<PairLink>)> {
    let mut index: HashMap<u64, usize> = HashMap::new();
    let mut nodes: Vec<Member> = Vec::new();
    let mut sets = UnionFind::default();
    let mut pairs: Vec<([usize; 2], Link, bool)> = Vec::new();
    for interface in interfaces {
        for shared in &interface.shared {
            let ids = [0, 1].map(|k| {
                let member = Member {
                    body: interface.bodies[k],
                    node: shared.nodes[k],
                };
                let dof = bodies[member.body].first_dof + member.node as u64;
                *index.entry(dof).or_insert_with(|| {
                    nodes.push(member);
                    sets.add()
                })
            });
            sets.join(ids[0], ids[1]);
            pairs.push((ids, shared.link, interface.shape == Shape::Corner));
        }
    }
    let mut members: HashMap<usize, Vec<Member>> = HashMap::new();
    for (id, member) in nodes.iter().enumerate() {
        members.entry(sets.find(id)).or_default().push(*member);
    }
    let mut links: HashMap<usize, Vec<([Member; 2], Link, bool)>> = HashMap::new();
    for (ids, link, corner) in pairs {
        links
            .entry(sets.find(ids[0]))
            .or_default()
            .push((ids.map(|id| nodes[id]), link, corner));
    }
    let mut out: Vec<(Point, Vec<PairLink>)> = members
        .into_iter()
        .map(|(root, mut members)| {
            members.sort_by_key(|m| m.body);
            let first = members[0];
            let body = &bodies[first.body];
            let place = body.mesh().place(first.node);
            let find = |m: Member| {
                members
                    .iter()
                    .position(|other| *other == m)
                    .expect("both nodes of a pair are members of its point")
            };
            let pairs = links.remove(&root).unwrap_or_default();
            let links = pairs
                .into_iter()
                .map(|(pair, link, corner)| PairLink {
                    members: pair.map(find),
                    link,
                    corner,
                })
                .collect();
            let point = Point {
                block: body.first_dof + first.node as u64,
                subdomain: body.first_subdomain + body.mesh().owner(place),
                tied_to: (0..members.len()).collect(),
                rows: Vec::new(),
                members,
            };
            (point, links)
        })
        .collect();
    out.sort_by_key(|(point, _)| point.block);
    out
}

/// Finds what is tied to what, and the pairs that get a row.
fn close(point: &mut Point, links: &mut [PairLink]) {
    point.tied_to = joined(point.members.len(), links, |l| l == Link::Tied);
    let may_join = joined(point.members.len(), links, |l| l != Link::Free);
    links.sort_by_key(|p| p.members);
    for pair in links.iter() {
        let [a, b] = pair.members;
        let by = |sets: &[usize]| pair.corner && sets[a] == sets[b];
        let holds = pair.link == Link::Tied || by(&point.tied_to);
        // Where other faces tie the two anyway, an open row would say nothing.
        let open =
            (pair.link == Link::Open || by(&may_join)) && point.tied_to[a] != point.tied_to[b];
        if holds || open {
            point.rows.push(PointRow {
                members: pair.members,
                holds,
            });
        }
    }
}

/// The lowest member that each of `n` members is joined to by links that satisfy `counts`.
fn joined(n: usize, links: &[PairLink], counts: impl Fn(Link) -> bool) -> Vec<usize> {
    let mut sets = UnionFind::default();
    for _ in 0..n {
        sets.add();
    }
    for pair in links.iter().filter(|p| counts(p.link)) {
        sets.join(pair.members[0], pair.members[1]);
    }
    (0..n).map(|m| sets.find(m)).collect()
}

/// A node that is tied to a given value is given itself: adds it to `inherited`.
fn prescribe(bodies: &[Body], point: &Point, inherited: &mut Vec<(Member, f64)>) -> Result<()> {
    for root in 0..point.members.len() {
        if point.tied_to[root] != root {
            continue;
        }
        let tied: Vec<Member> = (0..point.members.len())
            .filter(|&m| point.tied_to[m] == root)
            .map(|m| point.members[m])
            .collect();
        let given: Vec<Option<f64>> = tied
            .iter()
            .map(|m| bodies[m.body].prescribed_at(m.node))
            .collect();
        let Some((k, value)) = given
            .iter()
            .enumerate()
            .find_map(|(k, v)| v.map(|v| (k, v)))
        else {
            continue;
        };
        for (m, &own) in tied.iter().zip(&given) {
            match own {
                Some(other) if !agree(value, other) => {
                    let place = bodies[m.body].mesh().place(m.node);
                    let [x, y] = bodies[m.body].mesh().position(place);
                    return Err(Error::Input(format!(
                        "{}bodies `{}` and `{}` are tied at ({x}, {y}), where they prescribe {value} and {other} \
                         (equal values were expected)",
                        bodies[m.body].spec.written,
                        bodies[tied[k].body].spec.name,
                        bodies[m.body].spec.name,
                    )));
                }
                Some(_) => {}
                None => inherited.push((*m, value)),
            }
        }
    }
    Ok(())
}

/// Disjoint sets of 0..n; the representative is the lowest member.
#[derive(Default)]
struct UnionFind {
    parent: Vec<usize>,
}

impl UnionFind {
    fn add(&mut self) -> usize {
        self.parent.push(self.parent.len());
        self.parent.len() - 1
    }

    fn find(&mut self, mut k: usize) -> usize {
        while self.parent[k] != k {
            self.parent[k] = self.parent[self.parent[k]];
            k = self.parent[k];
        }
        k
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b)] = a.min(b);
    }
}
