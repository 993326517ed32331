//! Inequalities at points: adds the rows of obstacles; checks and drops inequalities that given values or ties decide.

use super::entry::both;
use super::obstacles::Obstacle;
use super::points::InterfacePoint;
use super::row::{Bound, Row};
use crate::body::Body;
use crate::model::entry::EntryId;
use crate::model::profile::Limit;
use crate::model::spec::SceneSpec;
use crate::model::steps::{Factors, Steps};
use crate::quantity::unfit_length;
use crate::rows::at_node::AtNode;
use crate::validate::agree;
use base::{Error, Location, Result};
use fetifeti::problem::{BodyNode, RowSource};
use std::collections::HashMap;

/// The data against which inequalities are checked.
pub(crate) struct Checks<'a> {
    pub bodies: &'a [Body],
    pub obstacles: &'a [Obstacle],
    pub spec: &'a SceneSpec,
    /// The factors of every load step.
    pub factors: Vec<Factors<'a>>,
}

/// The tightest bound at one step, and the entry that it comes from.
type Tightest = (f64, Option<EntryId>);

impl<'a> Checks<'a> {
    /// The checks of a scene.
    pub fn new(
        bodies: &'a [Body],
        obstacles: &'a [Obstacle],
        spec: &'a SceneSpec,
        steps: &'a Option<Steps>,
    ) -> Checks<'a> {
        Checks {
            bodies,
            obstacles,
            spec,
            factors: Factors::every(steps),
        }
    }

    /// Drops the contact rows that ties or given values decide, and adds the rows of obstacles.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) if ties or given values violate an inequality, or if two bounds
    /// contradict each other.
    pub fn apply(&self, points: &mut Vec<InterfacePoint>, rows: &mut Vec<Row>) -> Result<()> {
        let mut decided = Vec::with_capacity(rows.len());
        let mut at = 0;
        for row in rows.iter_mut() {
            // Rows are in the order of points.
            while points[at].block != row.block {
                at += 1;
            }
            decided.push(self.is_decided(&points[at], row)?);
        }
        let mut decided = decided.into_iter();
        rows.retain(|_| decided.next() == Some(false));
        let beside = self.beside_obstacles(points)?;
        self.check_between(&beside)?;
        if !beside.is_empty() {
            // At a point, pairs come before obstacles.
            rows.extend(beside);
            rows.sort_by_key(|row| row.block);
        }
        Ok(())
    }

    /// Whether ties or given values decide a row. Stores the given values on both sides of a contact.
    fn is_decided(&self, point: &InterfacePoint, row: &mut Row) -> Result<bool> {
        let (Some(bound), [Some(a), Some(b)]) = (&mut row.bound, row.members) else {
            return Ok(false);
        };
        let members = [a, b];
        let sides = members.map(|m| m.along(self.bodies, row.direction));
        bound.given = [0, 1].map(|k| sides[k].given);
        let fixed = sides.iter().all(|s| s.terms.is_empty());
        let tied = point.ties(members);
        for factors in &self.factors {
            let (gap, entry) = self.finite(factors, &bound.limits, members[0])?;
            let gap = gap + bound.value;
            let fail = |why: String| {
                let [a, b] = members.map(|m| &self.bodies[m.body].spec.name);
                let at = members[0].spot(self.bodies);
                Err(Error::input(format!(
                    "{}{} {why} at {at}{}, which contradicts their contact \
                     (u of `{a}` − u of `{b}` ≤ {gap} was expected)",
                    self.place(entry, members[1]),
                    both(a, b),
                    factors.when()
                )))
            };
            if fixed {
                let [v, w] = bound.given.map(|given| given * factors.dirichlet());
                if exceeds(v - w, gap) {
                    return fail(format!("have the given values {v} and {w}"));
                }
            } else if tied && exceeds(0.0, gap) {
                return fail("are tied through others".into());
            }
        }
        Ok(tied || fixed)
    }

    /// Whether given values decide a row between sides whose nodes do not match.
    pub fn is_decided_mortar(&self, row: &Row) -> Result<bool> {
        let first = row.members[0].expect("every row has a first member");
        if !row.terms(self.bodies).is_empty() {
            if row.law.is_inequality() {
                for factors in &self.factors {
                    self.finite(factors, row.limits(), first)?;
                }
            }
            return Ok(false);
        }
        let named = row.members.iter().flatten();
        let named: Vec<String> = named
            .map(|m| format!("`{}`", self.bodies[m.body].spec.name))
            .collect();
        let who = match named.len() {
            1 => format!("body {} contradict its obstacle", named[0]),
            _ => format!("bodies {} contradict their joint", named.join(" and ")),
        };
        let at = first.spot(self.bodies);
        for factors in &self.factors {
            let c = row.right_hand_side(factors);
            let wrong = if row.law.is_inequality() {
                exceeds(0.0, c)
            } else {
                !agree(c, 0.0)
            };
            if wrong {
                return Err(Error::input(format!(
                    "the given values of {who} at {at}{} by {}",
                    factors.when(),
                    c.abs()
                ))
                .at(&self.bodies[first.body].spec.location));
            }
        }
        Ok(true)
    }

    /// The tightest bound at a step; an error if the bound times its factor is not finite.
    fn finite(
        &self,
        factors: &Factors<'_>,
        limits: &[Limit],
        member: BodyNode,
    ) -> Result<Tightest> {
        let (value, entry) = factors.bound(limits);
        let Some(expected) = unfit_length(value) else {
            return Ok((value, entry));
        };
        Err(Error::input(format!(
            "{}the bound of body `{}` with its factor is {value:e} at {}{} where {expected}",
            self.place(entry, member),
            self.bodies[member.body].spec.name,
            member.spot(self.bodies),
            factors.when()
        )))
    }

    /// The place for messages: the entry, or the body if the default made the contact.
    fn place(&self, entry: Option<EntryId>, member: BodyNode) -> &Location {
        let location = entry.map(|e| self.spec.location_of(e));
        location.unwrap_or(&self.bodies[member.body].spec.location)
    }

    /// The rows at free nodes beside obstacles, by point. A node that has no point yet gets one.
    fn beside_obstacles(&self, points: &mut Vec<InterfacePoint>) -> Result<Vec<Row>> {
        let mut rows: Vec<Row> = Vec::new();
        if self.obstacles.is_empty() {
            return Ok(rows);
        }
        let mut place: HashMap<BodyNode, usize> = HashMap::new();
        for (p, point) in points.iter().enumerate() {
            place.extend(point.members.iter().map(|member| (*member, p)));
        }
        let mut at_node: HashMap<BodyNode, Vec<usize>> = HashMap::new();
        for (o, obstacle) in self.obstacles.iter().enumerate() {
            let body = obstacle.body;
            for same in obstacle.limits.all().chunk_by(|a, b| a.node == b.node) {
                let node = same[0].node;
                let member = BodyNode { body, node };
                let (distance, direction) = obstacle.ahead(node);
                let side = member.along(self.bodies, direction);
                if side.terms.is_empty() {
                    self.check_given(obstacle, member, side.given, distance)?;
                    continue;
                }
                if obstacle.surface.is_some() {
                    continue;
                }
                // Sides of a body that meet at a corner or edge share a row there.
                let known = at_node.entry(member).or_default();
                let before = known.iter().find(|&&k| {
                    let other = self.obstacle(&rows[k]);
                    other.is_some_and(|o| o.is_one_with(obstacle))
                });
                if let Some(bound) = before.and_then(|&k| rows[k].bound.as_mut()) {
                    bound.limits.extend(same);
                    continue;
                }
                let p = place.entry(member).or_insert_with(|| {
                    points.push(InterfacePoint::of(vec![member], self.bodies));
                    points.len() - 1
                });
                known.push(rows.len());
                let place = (points[*p].block, points[*p].subdomain);
                let source = RowSource::Obstacle(o);
                let row = Row::tie(source, node, [Some(member), None], direction, place);
                rows.push(row.in_contact(Bound {
                    limits: same.to_vec(),
                    value: distance,
                    given: [side.given, 0.0],
                }));
            }
        }
        let order = |row: &Row| {
            let member = row.members[0].map(|m| (m.body, m.node));
            (row.block, member, self.obstacle(row).map(|o| o.upper))
        };
        rows.sort_by_key(order);
        for k in 1..rows.len() {
            let same = rows[k].members[0] == rows[k - 1].members[0];
            let rigid = self.obstacle(&rows[k]).is_some_and(|o| o.rigid.is_some());
            rows[k].holds = rigid || !same;
        }
        points.sort_by_key(|p| p.block);
        Ok(rows)
    }

    /// The obstacle that a row comes from.
    fn obstacle(&self, row: &Row) -> Option<&'a Obstacle> {
        match row.source {
            RowSource::Obstacle(o) => Some(&self.obstacles[o]),
            RowSource::Interface(_) | RowSource::Equation(_) => None,
        }
    }

    fn check_given(
        &self,
        obstacle: &Obstacle,
        member: BodyNode,
        given: f64,
        distance: f64,
    ) -> Result<()> {
        for factors in &self.factors {
            let (bound, entry) = self.finite(factors, obstacle.limits.at(member.node), member)?;
            let bound = bound + distance;
            // `given` is the value along the row's direction; messages report u itself.
            let signed = given * factors.dirichlet();
            let value = if obstacle.upper { signed } else { 0.0 - signed };
            if exceeds(signed, bound) {
                let at = member.spot(self.bodies);
                let (relation, bound) = if obstacle.upper {
                    ("≤", bound)
                } else {
                    ("≥", 0.0 - bound)
                };
                let what = if obstacle.rigid.is_some() || obstacle.surface.is_some() {
                    "n·u"
                } else {
                    "u"
                };
                return Err(Error::input(format!(
                    "{}body `{}` has the given value {value} at {at}{}, \
                     beyond its obstacle ({what} {relation} {bound} was expected)",
                    self.place(entry, member),
                    self.bodies[member.body].spec.name,
                    factors.when()
                )));
            }
        }
        Ok(())
    }

    /// Checks of rows beside obstacles that the lower bound of a node does not lie above its upper bound.
    fn check_between(&self, rows: &[Row]) -> Result<()> {
        let mut below: Option<&Row> = None;
        for row in rows {
            let (Some(obstacle), [Some(member), _]) = (self.obstacle(row), row.members) else {
                continue;
            };
            let limits = row.limits();
            let partner =
                below.filter(|other| other.members == row.members && obstacle.rigid.is_none());
            for factors in &self.factors {
                let (above, entry) = self.finite(factors, limits, member)?;
                let Some(partner) = partner else { continue };
                let (below, _) = self.finite(factors, partner.limits(), member)?;
                if exceeds(0.0, below + above) {
                    return Err(Error::input(format!(
                        "{}the obstacles of body `{}` leave nothing at {}{}: below = {} and above = {above} \
                         (below ≤ above was expected)",
                        self.place(entry, member),
                        self.bodies[member.body].spec.name,
                        member.spot(self.bodies),
                        factors.when(),
                        0.0 - below
                    )));
                }
            }
            if below.is_none_or(|other| other.members != row.members) {
                below = Some(row);
            }
        }
        Ok(())
    }
}

/// Whether `value` lies above `bound` by more than rounding.
fn exceeds(value: f64, bound: f64) -> bool {
    value - bound > 1e-10 * 1.0_f64.max(value.abs()).max(bound.abs())
}
