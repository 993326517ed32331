//! Points at which bodies meet: which copies of u are tied, which are given, and the rows that follow.

use super::entry::both;
use super::meeting::{CoincidentMembers, Meeting};
use super::reach::Reach;
use super::row::{Bound, Row};
use crate::body::Body;
use crate::geometry::interface::{BodyInterface, InterfaceShape, Link};
use crate::rows::at_node::AtNode;
use crate::validate::agree;
use base::linalg::union_find::UnionFind;
use base::{Error, Result};
use fetifeti::problem::{BodyNode, RowSource};

/// A point at which nodes of several bodies coincide, or a single node beside an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct InterfacePoint {
    /// The block of its rows: the lowest body dof at the point, or at the points to which equations and rows between
    /// sides whose nodes do not match lead.
    pub block: u64,
    /// The subdomain of lowest index that contains the point, or one of these.
    pub subdomain: usize,
    /// The nodes, by increasing body and node.
    pub members: Vec<BodyNode>,
    /// Lowest member (index into `members`) to which each member is tied; the member itself if there is no lower one.
    pub tied_to: Vec<usize>,
}

/// The points of a scene that satisfy `wanted`, each of which has a node of a body that is `near`, and the rows between
/// their members in the order of points. There are no equalities where u is given. Nodes that are tied to a given value
/// are added to the given nodes of their body, at all points.
pub(crate) fn collect(
    bodies: &mut [Body],
    interfaces: &[BodyInterface],
    near: &dyn Fn(usize) -> bool,
    wanted: &dyn Fn(&InterfacePoint) -> bool,
) -> Result<(Vec<InterfacePoint>, Vec<Row>)> {
    let (mut points, mut rows) = (Vec::new(), Vec::new());
    let mut inherited = Vec::new();
    // A given value is passed on by a tie to a body that has it.
    let ties = (interfaces.iter()).any(|i| i.shared.iter().any(|s| s.link == Link::Tied));
    let passes_on = |b: usize| ties && !bodies[b].prescribed.is_empty();
    let from = (0..bodies.len()).map(|b| near(b) || passes_on(b)).collect();
    let reach = Reach::of(from, |b| bodies[b].mesh().n_nodes(), interfaces);
    let meeting = Meeting::of(bodies, interfaces, &reach);
    for (members, met) in meeting.sets() {
        let mut point = InterfacePoint::of(members.to_vec(), bodies);
        let mut pairs: Vec<CoincidentMembers> = met.collect();
        point.tied_to = joined(members.len(), &pairs, interfaces, &|l| l == Link::Tied);
        let components = bodies[members[0].body].components;
        for c in 0..components {
            prescribe(bodies, &point, c, &mut inherited)?;
        }
        if wanted(&point) {
            add_rows(&point, &mut pairs, interfaces, components, &mut rows);
            points.push(point);
        }
    }
    for (BodyNode { body, node }, component, value) in inherited {
        let body = &mut bodies[body];
        body.prescribed
            .push((node * body.components + component, value));
    }
    for body in bodies.iter_mut() {
        body.prescribed.sort_by_key(|&(dof, _)| dof);
    }
    rows.retain(|row: &Row| {
        let free = |m: &BodyNode| !m.along(bodies, row.direction).terms.is_empty();
        row.law.is_inequality() || row.members.iter().flatten().all(free)
    });
    Ok((points, rows))
}

/// u at a member along a direction: the free degrees of freedom with their coefficients, and the sum of the given
/// terms.
pub(crate) struct DirectionalValue {
    pub terms: Vec<(u64, f64)>,
    pub given: f64,
}

impl InterfacePoint {
    /// The point of these members, the lowest body first.
    pub(crate) fn of(members: Vec<BodyNode>, bodies: &[Body]) -> InterfacePoint {
        let first = members[0];
        let body = &bodies[first.body];
        // A body that touches itself has several nodes at the point.
        let own = members.iter().filter(|m| m.body == first.body);
        let owner = own.map(|m| body.mesh().owner(m.node)).min();
        InterfacePoint {
            block: first.dof(bodies, 0),
            subdomain: body.first_subdomain + owner.expect("a point has a node"),
            tied_to: (0..members.len()).collect(),
            members,
        }
    }

    /// Whether ties join two of its members.
    pub(crate) fn ties(&self, members: [BodyNode; 2]) -> bool {
        let place = |m: BodyNode| self.members.iter().position(|other| *other == m);
        let [a, b] = members.map(|m| place(m).map(|k| self.tied_to[k]));
        a == b
    }
}

/// The unit vector along component `c`.
fn unit(c: usize) -> [f64; 3] {
    let mut out = [0.0; 3];
    out[c] = 1.0;
    out
}

/// For each of `n` members the lowest one to which pairs lead whose links satisfy `counts`.
fn joined(
    n: usize,
    pairs: &[CoincidentMembers],
    interfaces: &[BodyInterface],
    counts: &dyn Fn(Link) -> bool,
) -> Vec<usize> {
    let mut sets = UnionFind::new(n);
    for pair in pairs.iter().filter(|p| counts(p.link(interfaces))) {
        sets.join(pair.members[0], pair.members[1]);
    }
    (0..n).map(|m| sets.find(m)).collect()
}

/// Adds a row for each pair that gets one; contacts without effect are dropped later.
///
/// A pair that shares a face has a row if the face is tied or in contact there, or is open there but tied elsewhere. A
/// pair that meets only in a corner has a row if ties connect it: the rows are fully redundant at cross points.
fn add_rows(
    point: &InterfacePoint,
    pairs: &mut [CoincidentMembers],
    interfaces: &[BodyInterface],
    components: usize,
    rows: &mut Vec<Row>,
) {
    let may_join = joined(point.members.len(), pairs, interfaces, &|l| {
        matches!(l, Link::Tied | Link::Open)
    });
    pairs.sort_by_key(|p| p.members);
    for pair in pairs.iter() {
        let interface = &interfaces[pair.interface];
        let (link, [a, b]) = (pair.link(interfaces), pair.members);
        let contact = link.is_contact();
        let corner = interface.shape == InterfaceShape::Corner && !contact;
        let by = |sets: &[usize]| corner && sets[a] == sets[b];
        let holds = link == Link::Tied || by(&point.tied_to) || contact;
        // If other faces tie the two members, an open row would be redundant.
        let open = (link == Link::Open || by(&may_join)) && point.tied_to[a] != point.tied_to[b];
        if !(holds || open) {
            continue;
        }
        let order = if contact { interface.order } else { [0, 1] };
        let bound = || Bound {
            limits: interface.limits.at(pair.node).to_vec(),
            value: interface.distances[pair.node],
            given: [0.0; 2],
        };
        let place = (point.block, point.subdomain);
        let row = |direction| {
            let source = RowSource::Interface(pair.interface);
            let members = order.map(|k| Some(point.members[pair.members[k]]));
            let tie = Row::tie(source, pair.node, members, direction, place);
            if contact {
                tie.in_contact(bound())
            } else {
                Row { holds, ..tie }
            }
        };
        if contact && components > 1 {
            rows.push(row(interface.normal_in_order(pair.node)));
        } else {
            rows.extend((0..components).map(|c| row(unit(c))));
        }
    }
}

/// Adds a node to `inherited` if it is tied to a given value: the node is then given itself.
fn prescribe(
    bodies: &[Body],
    point: &InterfacePoint,
    component: usize,
    inherited: &mut Vec<(BodyNode, usize, f64)>,
) -> Result<()> {
    for root in 0..point.members.len() {
        if point.tied_to[root] != root {
            continue;
        }
        let tied: Vec<BodyNode> = (0..point.members.len())
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
                    return Err(Error::input(format!(
                        "{} are tied at {}, where they prescribe {value} and {other} \
                         (equal values were expected)",
                        both(&bodies[tied[k].body].spec.name, &bodies[m.body].spec.name),
                        m.spot(bodies)
                    ))
                    .at(&bodies[m.body].spec.location));
                }
                Some(_) => {}
                None => inherited.push((*m, component, value)),
            }
        }
    }
    Ok(())
}
