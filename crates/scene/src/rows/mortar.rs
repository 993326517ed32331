//! Rows between sides whose nodes do not match.

use crate::rows::at_node::AtNode;
use std::collections::{HashMap, HashSet};

use super::bounds::Checks;
use super::points::InterfacePoint;
use super::row::{Bound, Combination, Row};
use crate::body::Body;
use crate::geometry::interface::{BodyInterface, Link};
use crate::geometry::mortar_sides::{BodyRow, Surfaces};
use crate::model::entry::EntryId;
use base::linalg::vec3::dot;
use base::Result;
use elements::form::Form;
use fetifeti::problem::{BodyNode, RowSource};

/// The rows of all interfaces that have surfaces, which are freed, after those that are known already, and sentences on
/// nodes that are left out. A node that is tied carries no multiplier of another tie or of a contact.
pub(crate) fn collect(
    bodies: &[Body],
    form: &Form,
    interfaces: &mut [BodyInterface],
    points: &[InterfacePoint],
    checks: &Checks<'_>,
    known: Vec<Row>,
) -> Result<(Vec<Row>, Vec<String>)> {
    let mut tied = tied_at(points);
    let mut masters = Masters::default();
    let equations = known.iter().filter(|row| !row.law.is_inequality());
    tied.extend(equations.filter_map(|row| {
        let RowSource::Interface(k) = row.source else {
            return None;
        };
        let own = interfaces[k].mortar.as_ref().map_or(0, |m| m.multipliers);
        row.members[usize::from(interfaces[k].order[0] != own)]
    }));
    let (mut out, mut notes) = (known, Vec::new());
    // Ties come first: nodes that they hold are not in contact.
    for contact in [false, true] {
        for (k, interface) in interfaces.iter_mut().enumerate() {
            let Some(surfaces) = interface
                .mortar
                .as_ref()
                .and_then(|m| m.surfaces.as_deref())
            else {
                continue;
            };
            let mut pair = Pairing::new(bodies, form, k, interface, surfaces);
            let rows = if contact {
                Pairing::contacts
            } else {
                Pairing::ties
            };
            let mut found = rows(&mut pair, &tied);
            notes.extend(pair.note(contact, &tied));
            let back: HashSet<BodyNode> = found
                .iter()
                .filter(|r| masters.lead_back(r))
                .map(|r| r.carrier)
                .collect();
            if !back.is_empty() {
                notes.push(pair.note_of_cycle(contact, back.len()));
                found = rows(&mut pair, &tied.union(&back).copied().collect());
            }
            let rows = found;
            if !contact {
                tied.extend(rows.iter().map(|r| r.carrier));
                rows.iter().for_each(|r| masters.add(r));
            }
            let mut distances = Vec::new();
            for Carried { row, distance, .. } in rows {
                distances.push((row.node, distance));
                if !checks.is_decided_mortar(&row)? {
                    out.push(row);
                }
            }
            for (node, distance) in distances {
                interface.distances[node] = distance;
            }
        }
    }
    let mut known: HashMap<(Option<EntryId>, BodyNode), Vec<[f64; 3]>> = HashMap::new();
    for (k, obstacle) in checks.obstacles.iter().enumerate() {
        // Sides of one body that go on smoothly share a row at their common nodes.
        let entry = obstacle.entry();
        let taken = |node: BodyNode, direction: [f64; 3]| {
            let before = known.get(&(entry, node)).into_iter().flatten();
            tied.contains(&node) || before.into_iter().any(|d| dot(*d, direction) > SMOOTH)
        };
        let rows = obstacle.mortar_rows(bodies, form, k, &taken);
        for row in rows {
            if let Some(member) = row.members[0] {
                let list = known.entry((entry, member)).or_default();
                list.push(row.direction);
            }
            if !checks.is_decided_mortar(&row)? {
                out.push(row);
            }
        }
    }
    for interface in interfaces {
        if let Some(mortar) = &mut interface.mortar {
            mortar.surfaces = None;
        }
    }
    Ok((out, notes))
}

/// Terms with each degree of freedom once: sides of one body may have common nodes.
pub(super) fn merged(mut terms: Vec<(u64, f64)>) -> Vec<(u64, f64)> {
    terms.sort_by_key(|t| t.0);
    let same = terms.chunk_by(|a, b| a.0 == b.0);
    same.map(|t| (t[0].0, t.iter().map(|t| t.1).sum()))
        .collect()
}

/// Nodes that are tied at a point.
fn tied_at(points: &[InterfacePoint]) -> HashSet<BodyNode> {
    let mut out = HashSet::new();
    for point in points {
        for (m, &to) in point.tied_to.iter().enumerate().filter(|(m, to)| m != *to) {
            out.extend([point.members[m], point.members[to]]);
        }
    }
    out
}

/// Sides of a body go on smoothly at a node if the cosine of the angle between their normals is above this.
const SMOOTH: f64 = 0.8;

/// A row, the node that carries its multiplier, the nodes opposite it, and the distance of the sides there.
struct Carried {
    row: Row,
    carrier: BodyNode,
    opposite: Vec<BodyNode>,
    distance: f64,
}

/// The nodes opposite each node that carries the multiplier of a tie: those determine it.
#[derive(Default)]
struct Masters(HashMap<BodyNode, Vec<BodyNode>>);

impl Masters {
    fn add(&mut self, row: &Carried) {
        let list = self.0.entry(row.carrier).or_default();
        list.extend(&row.opposite);
    }

    /// Whether the nodes opposite a row are determined by its own node, through the ties so far. Around a point at
    /// which bodies meet each of them may carry multipliers towards the next: the last row says nothing new there.
    fn lead_back(&self, row: &Carried) -> bool {
        let mut seen: HashSet<BodyNode> = HashSet::new();
        let mut next = row.opposite.clone();
        while let Some(node) = next.pop() {
            if node == row.carrier {
                return true;
            }
            if let Some(more) = self.0.get(&node).filter(|_| seen.insert(node)) {
                next.extend(more);
            }
        }
        false
    }
}

/// One interface.
struct Pairing<'a> {
    bodies: &'a [Body],
    form: &'a Form,
    number: usize,
    interface: &'a BodyInterface,
    surfaces: &'a Surfaces,
    /// The body with the multipliers, 0 or 1, and the sign of its terms in a row.
    own: usize,
    sign: f64,
    /// Index into `shared` of each node with a multiplier.
    place: HashMap<usize, usize>,
}

impl<'a> Pairing<'a> {
    fn new(
        bodies: &'a [Body],
        form: &'a Form,
        number: usize,
        interface: &'a BodyInterface,
        surfaces: &'a Surfaces,
    ) -> Pairing<'a> {
        let own = interface.mortar.as_ref().map_or(0, |m| m.multipliers);
        let shared = interface.shared.iter().enumerate();
        Pairing {
            bodies,
            form,
            number,
            interface,
            surfaces,
            own,
            sign: if interface.order[0] == own { 1.0 } else { -1.0 },
            place: shared.map(|(i, s)| (s.nodes[own], i)).collect(),
        }
    }

    /// A node of the body with the multipliers.
    fn carrier(&self, node: usize) -> BodyNode {
        let body = self.interface.bodies[self.own];
        BodyNode { body, node }
    }

    fn link(&self, node: usize) -> Link {
        let place = self.place.get(&node);
        place.map_or(Link::Free, |&i| self.interface.shared[i].link)
    }

    /// The rows u = u° by component.
    fn ties(&mut self, tied: &HashSet<BodyNode>) -> Vec<Carried> {
        let mut out = Vec::new();
        if self.interface.shared.iter().all(|s| s.link != Link::Tied) {
            return out;
        }
        let mut known: Vec<(Vec<usize>, Vec<BodyRow>)> = Vec::new();
        for c in 0..self.bodies[0].components {
            let held = |node: usize| {
                let carrier = self.carrier(node);
                self.link(node) != Link::Tied
                    || carrier.given(self.bodies, c).is_some()
                    || tied.contains(&carrier)
            };
            let mut left_out: Vec<usize> =
                self.place.keys().copied().filter(|&n| held(n)).collect();
            left_out.sort_unstable();
            let same = known.iter().position(|(list, _)| *list == left_out);
            let which = same.unwrap_or_else(|| {
                known.push((left_out, self.surfaces.rows(self.form, &held)));
                known.len() - 1
            });
            let mut direction = [0.0; 3];
            direction[c] = 1.0;
            let rows = known[which].1.iter();
            out.extend(rows.map(|row| self.carried(row, direction, None)));
        }
        out
    }

    /// The rows n · (u_first − u_second) ≤ g.
    fn contacts(&mut self, tied: &HashSet<BodyNode>) -> Vec<Carried> {
        if !self.interface.has_contact() {
            return Vec::new();
        }
        let held = |node: usize| {
            let carrier = self.carrier(node);
            !self.link(node).is_contact() || tied.contains(&carrier) || self.is_given(node)
        };
        let rows = self.surfaces.rows(self.form, &held);
        let contact = |row: &BodyRow| {
            let i = self.place[&row.node];
            let n = self.interface.normal_in_order(i);
            // Out of the body with the multipliers.
            let out = n.map(|v| self.sign * v);
            let [own, other] =
                [self.own, 1 - self.own].map(|k| &self.bodies[self.interface.bodies[k]].spec);
            let closed = self.interface.distances[i] == 0.0;
            let adjusted = self.interface.adjusted.get(&i).copied().unwrap_or(0.0);
            let apart = || row.distance(own, &|k| other.undeformed(k), out) + adjusted;
            let distance = if closed { 0.0 } else { apart() };
            self.carried(row, self.along(i), Some(distance))
        };
        rows.iter().map(contact).collect()
    }

    /// The direction of contact at a node of `shared`: the normal out of the first body of the inequality; scalars have
    /// one component.
    fn along(&self, i: usize) -> [f64; 3] {
        match self.bodies[0].components {
            1 => [1.0, 0.0, 0.0],
            _ => self.interface.normal_in_order(i),
        }
    }

    /// Whether u is given along the normal at a node with a multiplier.
    fn is_given(&self, node: usize) -> bool {
        let Some(&i) = self.place.get(&node) else {
            return true;
        };
        let carrier = self.carrier(node);
        carrier.along(self.bodies, self.along(i)).terms.is_empty()
    }

    /// A row along a direction; with a distance it is an inequality.
    fn carried(&self, row: &BodyRow, direction: [f64; 3], distance: Option<f64>) -> Carried {
        let i = self.place[&row.node];
        let (mut terms, mut given) = (Vec::new(), [0.0; 2]);
        let mut weights = [Vec::new(), Vec::new()];
        for (k, list) in [(self.own, &row.own), (1 - self.own, &row.other)] {
            let sign = if k == self.own { self.sign } else { -self.sign };
            let first = usize::from(k != self.interface.order[0]);
            weights[first].clone_from(list);
            for &(node, v) in list {
                let body = self.interface.bodies[k];
                let along = BodyNode { body, node }.along(self.bodies, direction);
                terms.extend(along.terms.into_iter().map(|(dof, n)| (dof, sign * v * n)));
                given[first] += v * along.given;
            }
        }
        if self.interface.bodies[0] == self.interface.bodies[1] {
            terms = merged(terms);
        }
        let members = self.interface.order.map(|k| BodyNode {
            body: self.interface.bodies[k],
            node: self.interface.shared[i].nodes[k],
        });
        let dofs = terms.iter().map(|t| t.0);
        let owners = members.map(|m| {
            let body = &self.bodies[m.body];
            body.first_subdomain + body.mesh().owner(m.node)
        });
        let place = (dofs.min().unwrap_or_default(), owners[0].min(owners[1]));
        let source = RowSource::Interface(self.number);
        let tie = Row::tie(source, i, members.map(Some), direction, place);
        let joined = match distance {
            None => tie.equal_to(0.0, given),
            Some(value) => tie.in_contact(Bound {
                limits: self.interface.limits.at(i).to_vec(),
                value,
                given,
            }),
        };
        let other = self.interface.bodies[1 - self.own];
        Carried {
            carrier: self.carrier(row.node),
            opposite: row
                .other
                .iter()
                .map(|&(node, _)| BodyNode { body: other, node })
                .collect(),
            distance: distance.unwrap_or(self.interface.distances[i]),
            row: joined.with_terms(Combination {
                terms,
                weights,
                area: row.area,
                ..Combination::default()
            }),
        }
    }

    /// Sentences on the nodes that carry no multiplier because they are tied elsewhere, or have given values.
    fn note(&self, contact: bool, tied: &HashSet<BodyNode>) -> Vec<String> {
        let meant = |node: &usize| {
            if contact {
                self.link(*node).is_contact()
            } else {
                self.link(*node) == Link::Tied
            }
        };
        let nodes = self.place.keys().copied().filter(meant);
        let (elsewhere, free): (Vec<usize>, Vec<usize>) =
            nodes.partition(|n| tied.contains(&self.carrier(*n)));
        let given = free.iter().filter(|&&n| {
            if contact {
                self.is_given(n)
            } else {
                let given = |c| self.carrier(n).given(self.bodies, c).is_some();
                (0..self.bodies[0].components).any(given)
            }
        });
        let (n, given) = (elsewhere.len(), given.count());
        let (a, rest) = self.names(contact);
        let mut out = Vec::new();
        if n > 0 {
            out.push(format!("Another tie holds nodes of `{a}` ({n}): {rest}."));
        }
        if given > 0 {
            out.push(format!(
                "Nodes of `{a}` ({given}) have given values: along these {rest}."
            ));
        }
        out
    }

    /// A sentence on nodes whose rows lead back to themselves.
    fn note_of_cycle(&self, contact: bool, n: usize) -> String {
        let (a, rest) = self.names(contact);
        format!(
            "Nodes of `{a}` ({n}) already determine the nodes opposite through other ties: {rest}."
        )
    }

    /// The body with the multipliers, and the end of a sentence on some of its nodes.
    fn names(&self, contact: bool) -> (&str, String) {
        let [a, b] =
            [self.own, 1 - self.own].map(|k| &self.bodies[self.interface.bodies[k]].spec.name);
        let what = if contact { "contact" } else { "tie" };
        (
            a,
            format!("they carry no multipliers of the {what} with `{b}`"),
        )
    }
}
