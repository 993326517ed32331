//! B_gl: ties, contacts and obstacles row by row, and what they are called.

use super::bounds::{ahead, limits};
use super::points::{Member, Point, PointBound, PointRow};
use crate::error::Result;
use crate::scene::checked::Scene;
use crate::scene::model::steps::Factors;
use crate::substructures::{InterfaceRow, RowKind};

/// What a row comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RowSource {
    /// An index into [`Scene::interfaces`].
    Interface(usize),
    /// An index into [`Scene::obstacles`].
    Obstacle(usize),
}

/// What a row is about, for reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowLabel {
    /// What it comes from.
    pub source: RowSource,
    /// The nodes in the order of the inequality, also those whose value is given; an obstacle has one.
    pub members: [Option<Member>; 2],
    /// Their position.
    pub point: [f64; 3],
    /// Parameters along the common face or the side, 0 ≤ t ≤ 1; the second is 0 in the plane.
    pub t: [f64; 2],
    /// The vector n along which the row takes differences, in the order of the inequality.
    pub direction: [f64; 3],
    /// The block of the row.
    pub block: u64,
}

/// One row as its point has it.
enum Row<'a> {
    Pair(&'a PointRow),
    Bound(&'a PointBound),
}

impl Scene {
    /// The rows of B_gl at points whose lowest subdomain satisfies `owns`, with the right-hand sides of the last load step:
    /// u_a − u_b = 0 for every tied pair of bodies a < b, open rows at the candidate contact nodes of faces that are tied in
    /// part, u_a − u_b ≤ g in contact (a is the first body of the pair), u ≤ g and −u ≤ −g beside obstacles. A given value
    /// goes to the right-hand side.
    pub fn rows(&self, owns: &dyn Fn(usize) -> bool) -> Vec<InterfaceRow> {
        let last = Factors::last(&self.steps);
        self.each_row(owns, |point, row| {
            let (direction, _) = self.direction(point, &row);
            let along = |m: usize| point.members[m].along(&self.bodies, direction).terms;
            let (terms, holds, inequality) = match row {
                Row::Pair(r) => {
                    let [a, b] = r.members.map(along);
                    let minus = b.into_iter().map(|(dof, n)| (dof, -n));
                    (a.into_iter().chain(minus).collect(), r.holds, r.contact)
                }
                Row::Bound(b) => (along(b.member), b.holds, true),
            };
            InterfaceRow {
                terms,
                gap: self.right_hand_side(point, &row, &last),
                kind: if inequality {
                    RowKind::Inequality
                } else {
                    RowKind::Equality
                },
                holds,
                block: point.block,
            }
        })
    }

    /// What the rows of [`Scene::rows`] are about, one by one.
    pub fn row_labels(&self, owns: &dyn Fn(usize) -> bool) -> Vec<RowLabel> {
        self.each_row(owns, |point, row| {
            let (source, members, t) = match row {
                Row::Pair(r) => (
                    RowSource::Interface(r.interface),
                    r.members.map(|m| Some(point.members[m])),
                    self.interfaces[r.interface].shared[r.node].t,
                ),
                Row::Bound(b) => {
                    let member = point.members[b.member];
                    (
                        RowSource::Obstacle(b.obstacle),
                        [Some(member), None],
                        self.obstacles[b.obstacle].t(&self.bodies[member.body], member.node),
                    )
                }
            };
            let first = members[0].expect("every row has a first member");
            RowLabel {
                source,
                members,
                point: first.position(&self.bodies),
                t,
                direction: self.direction(point, &row).0,
                block: point.block,
            }
        })
    }

    /// The right-hand sides of the rows of [`Scene::rows`] at load step `step` (0 is the only one without `[steps]`).
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for a step that the scene does not have.
    pub fn gaps(&self, owns: &dyn Fn(usize) -> bool, step: usize) -> Result<Vec<f64>> {
        let factors = Factors::of(&self.steps, step)?;
        Ok(self.each_row(owns, |point, row| {
            self.right_hand_side(point, &row, &factors)
        }))
    }

    /// Whether there is an inequality, and with it an outer loop.
    pub fn has_contact(&self) -> bool {
        let inequality = |p: &Point| !p.bounds.is_empty() || p.rows.iter().any(|r| r.contact);
        self.points.iter().any(inequality)
    }

    /// Visits the rows in their order: by point, pairs before obstacles.
    fn each_row<T>(
        &self,
        owns: &dyn Fn(usize) -> bool,
        visit: impl Fn(&Point, Row<'_>) -> T,
    ) -> Vec<T> {
        let mut out = Vec::new();
        for point in self.points.iter().filter(|p| owns(p.subdomain)) {
            out.extend(point.rows.iter().map(|r| visit(point, Row::Pair(r))));
            out.extend(point.bounds.iter().map(|b| visit(point, Row::Bound(b))));
        }
        out
    }

    fn right_hand_side(&self, point: &Point, row: &Row<'_>, factors: &Factors<'_>) -> f64 {
        let (direction, distance) = self.direction(point, row);
        let bound = match row {
            Row::Pair(r) if !r.contact => return 0.0,
            Row::Pair(r) => factors.tightest(self.interfaces[r.interface].limits.at(r.node)),
            Row::Bound(b) => factors.tightest(limits(&self.obstacles, point, b)),
        };
        let (mut g, _) = bound.expect("a row of an inequality has a bound");
        g += distance;
        let given = |m: usize| {
            let side = point.members[m].along(&self.bodies, direction);
            side.given * factors.dirichlet()
        };
        match row {
            // u_a ≤ g + u_b, −u_b ≤ g − u_a
            Row::Pair(r) => {
                g -= given(r.members[0]);
                g += given(r.members[1]);
            }
            Row::Bound(b) => g -= given(b.member),
        }
        g
    }

    /// The vector along which a row takes differences, and the distance that there is to begin with.
    fn direction(&self, point: &Point, row: &Row<'_>) -> ([f64; 3], f64) {
        match row {
            Row::Pair(r) => {
                let interface = &self.interfaces[r.interface];
                let distance = if r.contact {
                    interface.distances[r.node]
                } else {
                    0.0
                };
                (r.vector(&self.interfaces), distance)
            }
            Row::Bound(b) => {
                let obstacle = &self.obstacles[b.obstacle];
                let (distance, direction) = ahead(&self.bodies, obstacle, point.members[b.member]);
                (direction, distance)
            }
        }
    }
}
