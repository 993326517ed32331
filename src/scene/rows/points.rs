//! Points at which bodies meet: which copies of u are one there, which are given, and the rows that follow.

use crate::error::{Error, Result};
use crate::linalg::union_find::UnionFind;
use crate::scene::body::Body;
use crate::scene::geometry::interface::{Interface, Link, Shape};
use crate::scene::validate::agree;
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
    /// Of what the row takes the difference.
    pub direction: Direction,
    /// The interface that it comes from.
    pub interface: usize,
    /// Index into its `shared`.
    pub node: usize,
}

/// What a row looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// One component of u.
    Component(usize),
    /// n·u with the normal of the interface or obstacle there.
    Normal,
}

/// A member of a point with a row u ≤ g (upper bound) or −u ≤ g (lower bound).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointBound {
    /// Index into [`Point::members`].
    pub member: usize,
    /// The obstacle, an index into [`Scene::obstacles`](crate::scene::Scene::obstacles).
    pub obstacle: usize,
    /// At a corner or an edge, the obstacles beside the other sides; the tightest bound counts.
    pub others: [Option<usize>; 2],
    /// Whether the row holds to begin with: of two bounds at one node only the lower one can.
    pub holds: bool,
}

/// The points of a scene. Nodes that are tied to a given value are added to the given nodes of their body.
pub(crate) fn collect(bodies: &mut [Body], interfaces: &[Interface]) -> Result<Vec<Point>> {
    let mut points = coinciding(bodies, interfaces);
    let mut inherited = Vec::new();
    for (point, links) in &mut points {
        let components = bodies[point.members[0].body].components;
        close(point, links, components);
        for c in 0..components {
            prescribe(bodies, point, c, &mut inherited)?;
        }
    }
    for (Member { body, node }, component, value) in inherited {
        let body = &mut bodies[body];
        body.prescribed
            .push((node * body.components + component, value));
    }
    for body in bodies.iter_mut() {
        body.prescribed.sort_by_key(|&(dof, _)| dof);
    }
    let mut out: Vec<Point> = points.into_iter().map(|(point, _)| point).collect();
    for point in &mut out {
        let Point { members, rows, .. } = point;
        rows.retain(|row| {
            let Direction::Component(c) = row.direction else {
                return true;
            };
            let given = |m: usize| members[m].given(bodies, c).is_some();
            row.contact || !row.members.into_iter().any(given)
        });
    }
    Ok(out)
}

/// What u does at a member along a direction: the free degrees of freedom with their coefficients, and the sum of the given ones.
pub(crate) struct Along {
    pub terms: Vec<(u64, f64)>,
    pub given: f64,
}

impl PointRow {
    /// The unit vector along which the row looks, in the order of the inequality.
    pub(crate) fn vector(&self, interfaces: &[Interface]) -> [f64; 3] {
        let interface = &interfaces[self.interface];
        match self.direction {
            Direction::Component(c) => unit(c),
            Direction::Normal if interface.order == [0, 1] => interface.normals[self.node],
            Direction::Normal => interface.normals[self.node].map(|v| 0.0 - v),
        }
    }
}

/// The unit vector along component `c`.
pub(crate) fn unit(c: usize) -> [f64; 3] {
    let mut out = [0.0; 3];
    out[c] = 1.0;
    out
}

impl Member {
    /// u along `direction` at this member.
    pub(crate) fn along(&self, bodies: &[Body], direction: [f64; 3]) -> Along {
        let mut out = Along {
            terms: Vec::new(),
            given: 0.0,
        };
        for (c, n) in direction.into_iter().enumerate() {
            // Normals of curved sides come with the rounding of their computation.
            if c >= bodies[self.body].components || n.abs() < 1e-14 {
                continue;
            }
            match self.given(bodies, c) {
                Some(value) => out.given += n * value,
                None => out.terms.push((self.dof(bodies, c), n)),
            }
        }
        out
    }

    /// The given value, if there is one.
    pub(crate) fn given(&self, bodies: &[Body], component: usize) -> Option<f64> {
        let body = &bodies[self.body];
        body.prescribed_at(self.node * body.components + component)
    }

    /// Its position.
    pub(crate) fn position(&self, bodies: &[Body]) -> [f64; 3] {
        let spec = &bodies[self.body].spec;
        spec.position(spec.mesh.place(self.node))
    }

    /// Its body dof.
    pub(crate) fn dof(&self, bodies: &[Body], component: usize) -> u64 {
        let body = &bodies[self.body];
        body.first_dof + (self.node * body.components + component) as u64
    }

    /// The position as messages name it.
    pub(crate) fn spot(&self, bodies: &[Body]) -> String {
        let spec = &bodies[self.body].spec;
        spec.spot(spec.mesh.place(self.node))
    }

    /// The point of these members, the lowest body first.
    pub(crate) fn point(members: Vec<Member>, bodies: &[Body]) -> Point {
        let first = members[0];
        let body = &bodies[first.body];
        let place = body.mesh().place(first.node);
        Point {
            block: first.dof(bodies, 0),
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
                *index.entry(member.dof(bodies, 0)).or_insert_with(|| {
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
fn close(point: &mut Point, links: &mut [PairLink], components: usize) {
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
            let members = if contact {
                pair.order.map(|k| pair.members[k])
            } else {
                pair.members
            };
            let row = |direction| PointRow {
                members,
                holds,
                contact,
                direction,
                interface: pair.from[0],
                node: pair.from[1],
            };
            if contact && components > 1 {
                point.rows.push(row(Direction::Normal));
            } else {
                let each = (0..components).map(Direction::Component);
                point.rows.extend(each.map(row));
            }
        }
    }
}

/// The lowest member that each of `n` members is joined to by links that satisfy `counts`.
fn joined(n: usize, links: &[PairLink], counts: impl Fn(Link) -> bool) -> Vec<usize> {
    let mut sets = UnionFind::new(n);
    for pair in links.iter().filter(|p| counts(p.link)) {
        sets.join(pair.members[0], pair.members[1]);
    }
    (0..n).map(|m| sets.find(m)).collect()
}

/// A node that is tied to a given value is given itself: adds it to `inherited`.
fn prescribe(
    bodies: &[Body],
    point: &Point,
    component: usize,
    inherited: &mut Vec<(Member, usize, f64)>,
) -> Result<()> {
    for root in 0..point.members.len() {
        if point.tied_to[root] != root {
            continue;
        }
        let tied: Vec<Member> = (0..point.members.len())
            .filter(|&m| point.tied_to[m] == root)
            .map(|m| point.members[m])
            .collect();
        let given: Vec<Option<f64>> = tied.iter().map(|m| m.given(bodies, component)).collect();
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
                    return Err(Error::Input(format!(
                        "{}bodies `{}` and `{}` are tied at {}, where they prescribe {value} and {other} \
                         (equal values were expected)",
                        bodies[m.body].spec.written,
                        bodies[tied[k].body].spec.name,
                        bodies[m.body].spec.name,
                        m.spot(bodies),
                    )));
                }
                Some(_) => {}
                None => inherited.push((*m, component, value)),
            }
        }
    }
    Ok(())
}
