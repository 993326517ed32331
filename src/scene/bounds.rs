//! Inequalities at points: obstacles get their rows, and what is decided by given values or by ties is checked and dropped.

use super::interface::Interface;
use super::obstacles::Obstacle;
use super::points::{Member, Point, PointBound, PointRow};
use super::spec::SceneSpec;
use super::steps::{Factors, Steps};
use super::Body;
use crate::error::{Error, Result};
use std::collections::HashMap;

/// What inequalities are checked against.
pub(super) struct Checks<'a> {
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
        let given = members.map(|m| m.given(self.bodies));
        let tied = point.tied_to[a] == point.tied_to[b];
        for factors in &self.factors {
            let (gap, entry) = self.finite(factors, limits, members[0])?;
            let fail = |why: String| {
                let [a, b] = members.map(|m| &self.bodies[m.body].spec.name);
                let [x, y] = members[0].position(self.bodies);
                Err(Error::Input(format!(
                    "{}bodies `{a}` and `{b}` {why} at ({x}, {y}){}, which contradicts their contact \
                     (u of `{a}` − u of `{b}` ≤ {gap} was expected)",
                    self.place(entry, members[1]),
                    factors.when()
                )))
            };
            match given {
                [Some(v), Some(w)] => {
                    let [v, w] = [v, w].map(|v| v * factors.dirichlet());
                    if exceeds(v - w, gap) {
                        return fail(format!("have the given values {v} and {w}"));
                    }
                }
                _ if tied && exceeds(0.0, gap) => return fail("are tied through others".into()),
                _ => {}
            }
        }
        Ok(!tied && given.contains(&None))
    }

    /// The tightest bound at a step, which must be finite with its factor.
    fn finite<'l>(
        &self,
        factors: &Factors<'_>,
        limits: impl IntoIterator<Item = &'l super::profile::Limit>,
        member: Member,
    ) -> Result<Tightest> {
        let found = factors.tightest(limits);
        let (value, entry) = found.expect("a row of an inequality has a bound");
        if value.is_finite() {
            return Ok((value, entry));
        }
        let [x, y] = member.position(self.bodies);
        Err(Error::Input(format!(
            "{}the bound of body `{}` with its factor is {value} at ({x}, {y}){} where a finite number was expected",
            self.place(entry, member),
            self.bodies[member.body].spec.name,
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
                if let Some(given) = member.given(self.bodies) {
                    self.check_given(obstacle, member, given)?;
                    continue;
                }
                let &mut (p, m) = index.entry(member).or_insert_with(|| {
                    points.push(Member::point(vec![member], self.bodies));
                    (points.len() - 1, 0)
                });
                let bounds = &mut points[p].bounds;
                let upper = obstacle.upper;
                let beside = |b: &&mut PointBound| {
                    b.member == m && self.obstacles[b.obstacle].upper == upper
                };
                match bounds.iter_mut().find(beside) {
                    Some(bound) => bound.other = Some(o),
                    None => bounds.push(PointBound {
                        member: m,
                        obstacle: o,
                        other: None,
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
                point.bounds[k].holds = point.bounds[k].member != point.bounds[k - 1].member;
            }
        }
        points.sort_by_key(|p| p.block);
        Ok(())
    }

    fn check_given(&self, obstacle: &Obstacle, member: Member, given: f64) -> Result<()> {
        for factors in &self.factors {
            let (bound, entry) = self.finite(factors, obstacle.limits.at(member.node), member)?;
            let value = given * factors.dirichlet();
            let signed = if obstacle.upper { value } else { 0.0 - value };
            if exceeds(signed, bound) {
                let [x, y] = member.position(self.bodies);
                let (relation, bound) = if obstacle.upper {
                    ("≤", bound)
                } else {
                    ("≥", 0.0 - bound)
                };
                return Err(Error::Input(format!(
                    "{}body `{}` has the given value {value} at ({x}, {y}){}, beyond its obstacle (u {relation} {bound} was \
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
                let Some(partner) = partner else { continue };
                let (below, _) = self.finite(factors, self.limits(point, partner), member)?;
                if exceeds(0.0, below + above) {
                    let [x, y] = member.position(self.bodies);
                    return Err(Error::Input(format!(
                        "{}the obstacles of body `{}` leave nothing at ({x}, {y}){}: below = {} and above = {above} \
                         (below ≤ above was expected)",
                        self.place(entry, member),
                        self.bodies[member.body].spec.name,
                        factors.when(),
                        0.0 - below
                    )));
                }
            }
        }
        Ok(())
    }

    fn limits<'l>(
        &'l self,
        point: &Point,
        bound: &PointBound,
    ) -> impl Iterator<Item = &'l super::profile::Limit> {
        limits(self.obstacles, point, bound)
    }
}

/// All limits that count for a bound at a point.
pub(super) fn limits<'l>(
    obstacles: &'l [Obstacle],
    point: &Point,
    bound: &PointBound,
) -> impl Iterator<Item = &'l super::profile::Limit> {
    let node = point.members[bound.member].node;
    let both = [Some(bound.obstacle), bound.other].into_iter().flatten();
    both.flat_map(move |o| obstacles[o].limits.at(node))
}

/// Whether `value` lies above `bound` by more than rounding.
fn exceeds(value: f64, bound: f64) -> bool {
    value - bound > 1e-10 * 1.0_f64.max(value.abs()).max(bound.abs())
}
