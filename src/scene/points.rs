//! Points at which bodies meet: which copies of u are one there, which are given, and the rows that follow.

use super::interface::{Interface, Link, Shape};
use super::union_find::UnionFind;
use super::validate::agree;
use super::Body;
use crate::error::{Error, Result};
use std::collections::HashMap;

/// A node of one body at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Member {
    /// The body.
    pub body: usize,
    /// Its node.
    pub node: usize,
}

/// A point at which nodes of several bodies coincide, or a single node beside an obstacle.
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
    /// Pairs of members that have a row. No equality where u is given, and no contact where both values are.
    pub rows: Vec<PointRow>,
    /// Members with a row for an obstacle; none where u is given.
    pub bounds: Vec<PointBound>,
}

/// A pair of members of a point with a row u_a − u_b = 0 or, in contact, u_a − u_b ≤ g.
///
/// Pairs that share a face have a row where the face is tied or in contact, or open in a face that is tied elsewhere. Pairs
/// that only meet in the corner have one where ties join them, so that the rows are fully redundant at cross points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointRow {
    /// Indices a, b into [`Point::members`]: the lower first in an equality, in the order of the inequality in contact.
    pub members: [usize; 2],
    /// Whether the row holds to begin with; an equality that does not only marks candidate contact nodes.
    pub holds: bool,
    /// Whether it is an inequality.
    pub contact: bool,
    /// The interface that it comes from.
    pub interface: usize,
    /// Index into its `shared`.
    pub node: usize,
}

/// A member of a point with a row u ≤ g (upper bound) or −u ≤ g (lower bound).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointBound {
    /// Index into [`Point::members`].
    pub member: usize,
    /// The obstacle, an index into [`Scene::obstacles`](super::Scene::obstacles).
    pub obstacle: usize,
    /// In a corner, the obstacle beside the other side; the tighter bound counts.
    pub other: Option<usize>,
    /// Whether the row holds to begin with: of two bounds at one node only the lower one can.
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
            let given = |m: usize| members[m].given(bodies).is_some();
            row.contact || !row.members.into_iter().any(given)
        });
    }
    Ok(out)
}

impl Member {
    /// The given value, if there is one.
    pub(super) fn given(&self, bodies: &[Body]) -> Option<f64> {
        bodies[self.body].prescribed_at(self.node)
    }

    /// Its position.
    pub(super) fn position(&self, bodies: &[Body]) -> [f64; 2] {
        let mesh = bodies[self.body].mesh();
        mesh.position(mesh.place(self.node))
    }

    /// Its body dof.
    pub(super) fn dof(&self, bodies: &[Body]) -> u64 {
        bodies[self.body].first_dof + self.node as u64
    }

    /// The point of these members, the lowest body first.
    pub(super) fn point(members: Vec<Member>, bodies: &[Body]) -> Point {
        let first = members[0];
        let body = &bodies[first.body];
        let place = body.mesh().place(first.node);
        Point {
            block: first.dof(bodies),
            subdomain: body.first_subdomain + body.mesh().owner(place),
            tied_to: (0..members.len()).collect(),
            rows: Vec::new(),
            bounds: Vec::new(),
            members,
        }
    }
}

/// How two members of a point are linked.
struct PairLink {
    members: [usize; 2],
    link: Link,
    corner: bool,
    /// Positions in `members` of the first and second body of an inequality.
    order: [usize; 2],
    /// The interface, and the index into its `shared`.
    from: [usize; 2],
}

/// Groups the shared nodes of all interfaces by position, in order of `block`.
fn coinciding(bodies: &[Body], interfaces: &[Interface]) -> Vec<(Point, Vec<PairLink>)> {
    let mut index: HashMap<u64, usize> = HashMap::new();
    let mut nodes: Vec<Member> = Vec::new();
    let mut sets = UnionFind::default();
    let mut pairs: Vec<PairLink> = Vec::new();
    for (i, interface) in interfaces.iter().enumerate() {
        for (k, shared) in interface.shared.iter().enumerate() {
            let members = [0, 1].map(|k| {
                let member = Member {
                    body: interface.bodies[k],
                    node: shared.nodes[k],
                };
                *index.entry(member.dof(bodies)).or_insert_with(|| {
                    nodes.push(member);
                    sets.add()
                })
            });
            sets.join(members[0], members[1]);
            pairs.push(PairLink {
                members,
                link: shared.link,
                corner: interface.shape == Shape::Corner,
                order: interface.order,
                from: [i, k],
            });
        }
    }
    let mut members: HashMap<usize, Vec<Member>> = HashMap::new();
    for (id, member) in nodes.iter().enumerate() {
        members.entry(sets.find(id)).or_default().push(*member);
    }
    let mut links: HashMap<usize, Vec<PairLink>> = HashMap::new();
    for pair in pairs {
        let root = sets.find(pair.members[0]);
        links.entry(root).or_default().push(pair);
    }
    let mut out: Vec<(Point, Vec<PairLink>)> = members
        .into_iter()
        .map(|(root, mut members)| {
            members.sort_by_key(|m| m.body);
            let mut links = links.remove(&root).unwrap_or_default();
            for pair in &mut links {
                pair.members = pair.members.map(|id| {
                    let node = nodes[id];
                    let place = members.iter().position(|other| *other == node);
                    place.expect("both nodes of a pair are members of its point")
                });
            }
            (Member::point(members, bodies), links)
        })
        .collect();
    out.sort_by_key(|(point, _)| point.block);
    out
}

/// Finds what is tied to what, and the pairs that get a row; contacts that say nothing are dropped later.
fn close(point: &mut Point, links: &mut [PairLink]) {
    point.tied_to = joined(point.members.len(), links, |l| l == Link::Tied);
    let may_join = joined(point.members.len(), links, |l| {
        matches!(l, Link::Tied | Link::Open)
    });
    links.sort_by_key(|p| p.members);
    for pair in links.iter() {
        let [a, b] = pair.members;
        let contact = pair.link.is_contact();
        let by = |sets: &[usize]| pair.corner && !contact && sets[a] == sets[b];
        let holds = pair.link == Link::Tied || by(&point.tied_to) || contact;
        // Where other faces tie the two anyway, an open row would say nothing.
        let open =
            (pair.link == Link::Open || by(&may_join)) && point.tied_to[a] != point.tied_to[b];
        if holds || open {
            point.rows.push(PointRow {
                members: if contact {
                    pair.order.map(|k| pair.members[k])
                } else {
                    pair.members
                },
                holds,
                contact,
                interface: pair.from[0],
                node: pair.from[1],
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
        let given: Vec<Option<f64>> = tied.iter().map(|m| m.given(bodies)).collect();
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
                    let [x, y] = m.position(bodies);
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
