//! Inequalities at points: obstacles get their rows, and what is decided by given values or by ties is checked and dropped.

use super::obstacles::Obstacle;
use super::points::{Member, Point, PointBound, PointRow};
use crate::error::{Error, Result};
use crate::scene::body::Body;
use crate::scene::geometry::interface::Interface;
use crate::scene::model::spec::SceneSpec;
use crate::scene::model::steps::{Factors, Steps};
use std::collections::HashMap;

/// What inequalities are checked against.
pub(crate) struct Checks<'a> {
    pub bodies: &'a [Body],
    pub interfaces: &'a [Interface],
    pub obstacles: &'a [Obstacle],
    /// Where every contact and obstacle was written, by number of the entry.
    pub written: Vec<&'a str>,
    /// The factors of every load step.
    pub factors: Vec<Factors<'a>>,
}

/// A bound of one step and what it stands on.
type Tightest = (f64, Option<usize>);

impl<'a> Checks<'a> {
    /// Those of a scene.
    pub fn new(
        bodies: &'a [Body],
        interfaces: &'a [Interface],
        obstacles: &'a [Obstacle],
        spec: &'a SceneSpec,
        steps: &'a Option<Steps>,
    ) -> Checks<'a> {
        let contacts = spec.contacts.iter().map(|c| c.written.as_str());
        let rest = spec.obstacles.iter().map(|o| o.written.as_str());
        Checks {
            bodies,
            interfaces,
            obstacles,
            written: contacts.chain(rest).collect(),
            factors: Factors::every(steps),
        }
    }

    /// Drops the contact rows that ties or given values decide, and gives obstacles their rows.
    ///
    /// # Errors
    /// [`Error::Input`] where they decide against the inequality, or where two bounds leave nothing between them.
    pub fn apply(&self, points: &mut Vec<Point>) -> Result<()> {
        for point in points.iter_mut() {
            let mut kept = Vec::with_capacity(point.rows.len());
            for row in &point.rows {
                if !row.contact || self.contact_matters(point, row)? {
                    kept.push(*row);
                }
            }
            point.rows = kept;
        }
        self.add_bounds(points)?;
        for point in points.iter() {
            self.check_between(point)?;
        }
        Ok(())
    }

    /// Whether a contact row says something that is not decided already.
    fn contact_matters(&self, point: &Point, row: &PointRow) -> Result<bool> {
        let limits = self.interfaces[row.interface].limits.at(row.node);
        let [a, b] = row.members;
        let members = row.members.map(|m| point.members[m]);
        let direction = row.vector(self.interfaces);
        let sides = members.map(|m| m.along(self.bodies, direction));
        let fixed = sides.iter().all(|s| s.terms.is_empty());
        let distance = self.interfaces[row.interface].distances[row.node];
        let tied = point.tied_to[a] == point.tied_to[b];
        for factors in &self.factors {
            let (gap, entry) = self.finite(factors, limits, members[0])?;
            let gap = gap + distance;
            let fail = |why: String| {
                let [a, b] = members.map(|m| &self.bodies[m.body].spec.name);
                let at = members[0].spot(self.bodies);
                Err(Error::Input(format!(
                    "{}bodies `{a}` and `{b}` {why} at {at}{}, which contradicts their contact \
                     (u of `{a}` − u of `{b}` ≤ {gap} was expected)",
                    self.place(entry, members[1]),
                    factors.when()
                )))
            };
            if fixed {
                let [v, w] = [0, 1].map(|k| sides[k].given * factors.dirichlet());
                if exceeds(v - w, gap) {
                    return fail(format!("have the given values {v} and {w}"));
                }
            } else if tied && exceeds(0.0, gap) {
                return fail("are tied through others".into());
            }
        }
        Ok(!tied && !fixed)
    }

    /// The tightest bound at a step, which must be finite with its factor.
    fn finite<'l>(
        &self,
        factors: &Factors<'_>,
        limits: impl IntoIterator<Item = &'l crate::scene::model::profile::Limit>,
        member: Member,
    ) -> Result<Tightest> {
        let found = factors.tightest(limits);
        let (value, entry) = found.expect("a row of an inequality has a bound");
        if value.is_finite() {
            return Ok((value, entry));
        }
        Err(Error::Input(format!(
            "{}the bound of body `{}` with its factor is {value} at {}{} where a finite number was expected",
            self.place(entry, member),
            self.bodies[member.body].spec.name,
            member.spot(self.bodies),
            factors.when()
        )))
    }

    /// Where to look: the entry, or the body where the default made the contact.
    fn place(&self, entry: Option<usize>, member: Member) -> &str {
        let written = entry.and_then(|e| self.written.get(e).copied());
        written.unwrap_or(&self.bodies[member.body].spec.written)
    }

    /// Gives every free node beside an obstacle its row, in a point of its own where it has none yet.
    fn add_bounds(&self, points: &mut Vec<Point>) -> Result<()> {
        if self.obstacles.is_empty() {
            return Ok(());
        }
        let mut index: HashMap<Member, (usize, usize)> = HashMap::new();
        for (p, point) in points.iter().enumerate() {
            let members = point.members.iter().enumerate();
            index.extend(members.map(|(m, member)| (*member, (p, m))));
        }
        for (o, obstacle) in self.obstacles.iter().enumerate() {
            let body = obstacle.body;
            for same in obstacle.limits.all().chunk_by(|a, b| a.node == b.node) {
                let node = same[0].node;
                let member = Member { body, node };
                let (distance, direction) = self.ahead(obstacle, member);
                let side = member.along(self.bodies, direction);
                if side.terms.is_empty() {
                    self.check_given(obstacle, member, side.given, distance)?;
                    continue;
                }
                let &mut (p, m) = index.entry(member).or_insert_with(|| {
                    points.push(Member::point(vec![member], self.bodies));
                    (points.len() - 1, 0)
                });
                let bounds = &mut points[p].bounds;
                let beside = |b: &&mut PointBound| {
                    let other = &self.obstacles[b.obstacle];
                    b.member == m && other.upper == obstacle.upper && other.rigid == obstacle.rigid
                };
                match bounds.iter_mut().find(beside) {
                    Some(bound) => {
                        let room = bound.others.iter_mut().find(|other| other.is_none());
                        *room.expect("a node lies on three sides at most") = Some(o);
                    }
                    None => bounds.push(PointBound {
                        member: m,
                        obstacle: o,
                        others: [None; 2],
                        holds: true,
                    }),
                }
            }
        }
        for point in points.iter_mut() {
            point
                .bounds
                .sort_by_key(|b| (b.member, self.obstacles[b.obstacle].upper));
            for k in 1..point.bounds.len() {
                let same = point.bounds[k].member == point.bounds[k - 1].member;
                let rigid = self.obstacles[point.bounds[k].obstacle].rigid.is_some();
                point.bounds[k].holds = rigid || !same;
            }
        }
        points.sort_by_key(|p| p.block);
        Ok(())
    }

    fn check_given(
        &self,
        obstacle: &Obstacle,
        member: Member,
        given: f64,
        distance: f64,
    ) -> Result<()> {
        for factors in &self.factors {
            let (bound, entry) = self.finite(factors, obstacle.limits.at(member.node), member)?;
            let bound = bound + distance;
            // `given` is along the row's direction already; messages speak of u.
            let signed = given * factors.dirichlet();
            let value = if obstacle.upper { signed } else { 0.0 - signed };
            if exceeds(signed, bound) {
                let at = member.spot(self.bodies);
                let (relation, bound) = if obstacle.upper {
                    ("≤", bound)
                } else {
                    ("≥", 0.0 - bound)
                };
                let what = if obstacle.rigid.is_some() {
                    "n·u"
                } else {
                    "u"
                };
                return Err(Error::Input(format!(
                    "{}body `{}` has the given value {value} at {at}{}, beyond its obstacle ({what} {relation} {bound} was \
                     expected)",
                    self.place(entry, member),
                    self.bodies[member.body].spec.name,
                    factors.when()
                )));
            }
        }
        Ok(())
    }

    /// The lower bound of a node must not lie above its upper bound.
    fn check_between(&self, point: &Point) -> Result<()> {
        for (k, bound) in point.bounds.iter().enumerate() {
            let member = point.members[bound.member];
            let partner = point.bounds[..k]
                .iter()
                .find(|other| other.member == bound.member);
            for factors in &self.factors {
                let (above, entry) = self.finite(factors, self.limits(point, bound), member)?;
                let rigid = self.obstacles[bound.obstacle].rigid.is_some();
                let Some(partner) = partner.filter(|_| !rigid) else {
                    continue;
                };
                let (below, _) = self.finite(factors, self.limits(point, partner), member)?;
                if exceeds(0.0, below + above) {
                    return Err(Error::Input(format!(
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
        }
        Ok(())
    }

    /// Distance and direction of the row of an obstacle at a member.
    fn ahead(&self, obstacle: &Obstacle, member: Member) -> (f64, [f64; 3]) {
        ahead(self.bodies, obstacle, member)
    }

    fn limits<'l>(
        &'l self,
        point: &Point,
        bound: &PointBound,
    ) -> impl Iterator<Item = &'l crate::scene::model::profile::Limit> {
        limits(self.obstacles, point, bound)
    }
}

/// All limits that count for a bound at a point.
pub(crate) fn limits<'l>(
    obstacles: &'l [Obstacle],
    point: &Point,
    bound: &PointBound,
) -> impl Iterator<Item = &'l crate::scene::model::profile::Limit> {
    let node = point.members[bound.member].node;
    let [other, third] = bound.others;
    let all = [Some(bound.obstacle), other, third].into_iter().flatten();
    all.flat_map(move |o| obstacles[o].limits.at(node))
}

/// Whether `value` lies above `bound` by more than rounding.
/// Distance and direction of the row of an obstacle at a member: u ≤ g and −u ≤ −g are rows along ±1.
pub(crate) fn ahead(bodies: &[Body], obstacle: &Obstacle, member: Member) -> (f64, [f64; 3]) {
    let sign = if obstacle.upper { 1.0 } else { -1.0 };
    let found = obstacle.ahead(&bodies[member.body], member.node);
    found.unwrap_or((0.0, [sign, 0.0, 0.0]))
}

fn exceeds(value: f64, bound: f64) -> bool {
    value - bound > 1e-10 * 1.0_f64.max(value.abs()).max(bound.abs())
}
