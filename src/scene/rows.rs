//! B_gl: ties, contacts and obstacles row by row, and what they are called.

use super::bounds::limits;
use super::points::{Member, Point, PointBound, PointRow};
use super::steps::Factors;
use super::Scene;
use crate::error::Result;
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
    pub point: [f64; 2],
    /// Parameter along the common face or the side, 0 ≤ t ≤ 1.
    pub t: f64,
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
            let dof = |m: usize| point.members[m].dof(&self.bodies);
            let (terms, holds, inequality) = match row {
                Row::Pair(r) => {
                    let signs = r.members.into_iter().zip([1.0, -1.0]);
                    let free =
                        signs.filter(|&(m, _)| point.members[m].given(&self.bodies).is_none());
                    (free.map(|(m, c)| (dof(m), c)).collect(), r.holds, r.contact)
                }
                Row::Bound(b) => {
                    let sign = if self.obstacles[b.obstacle].upper {
                        1.0
                    } else {
                        -1.0
                    };
                    (vec![(dof(b.member), sign)], b.holds, true)
                }
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
                    let mesh = self.bodies[member.body].mesh();
                    (
                        RowSource::Obstacle(b.obstacle),
                        [Some(member), None],
                        self.obstacles[b.obstacle].t(mesh, member.node),
                    )
                }
            };
            RowLabel {
                source,
                members,
                point: point.members[0].position(&self.bodies),
                t,
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
        let bound = match row {
            Row::Pair(r) if !r.contact => return 0.0,
            Row::Pair(r) => factors.tightest(self.interfaces[r.interface].limits.at(r.node)),
            Row::Bound(b) => factors.tightest(limits(&self.obstacles, point, b)),
        };
        let (mut g, _) = bound.expect("a row of an inequality has a bound");
        if let Row::Pair(r) = row {
            // u_a ≤ g + u_b, −u_b ≤ g − u_a
            let [a, b] = r.members.map(|m| point.members[m].given(&self.bodies));
            let d = factors.dirichlet();
            g -= a.map_or(0.0, |v| v * d);
            g += b.map_or(0.0, |v| v * d);
        }
        g
    }
}
