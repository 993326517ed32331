//! Gaps and bounds along a face or a side.

use super::entry::EntryId;
use super::expr::{Expr, Variables};

/// A function on a face or side.
#[derive(Debug, Clone, PartialEq)]
pub enum Profile {
    /// A number or an expression in x, y, bi, bj.
    Expression(Expr),
    /// (t, value) by increasing t: linear in between, constant beyond the ends. t is the parameter of the face or side.
    Table(Vec<[f64; 2]>),
}

impl Profile {
    /// The constant `value`.
    pub fn constant(value: f64) -> Profile {
        Profile::Expression(Expr::constant(value))
    }

    /// The value at parameter `t` and position `at`.
    pub fn eval(&self, t: f64, at: &Variables) -> f64 {
        let rows = match self {
            Profile::Expression(e) => return e.eval(at),
            Profile::Table(rows) => rows,
        };
        let next = rows.partition_point(|row| row[0] <= t);
        match (next.checked_sub(1).map(|k| rows[k]), rows.get(next)) {
            (Some([t0, v0]), Some([t1, v1])) => v0 + (v1 - v0) * ((t - t0) / (t1 - t0)),
            (Some([_, v]), None) | (None, Some(&[_, v])) => v,
            // An empty table is refused when it is read; NaN is reported as a bad value if a program builds one.
            (None, None) => f64::NAN,
        }
    }
}

/// Bounds g of the rows at the nodes of a face or side. Each entry of the scene that selects a node adds a bound, and
/// all bounds hold.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Limits(Vec<Limit>);

/// One bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The node: for a face the index into [`BodyInterface::shared`](crate::BodyInterface::shared), for a side the node
    /// of the body.
    pub node: usize,
    /// g without the factors of load steps.
    pub value: f64,
    /// Its entry; `None`: the default.
    pub entry: Option<EntryId>,
}

impl Limits {
    pub(crate) fn new(mut list: Vec<Limit>) -> Limits {
        list.sort_by_key(|l| l.node);
        Limits(list)
    }

    /// All bounds, by increasing node.
    pub fn all(&self) -> &[Limit] {
        &self.0
    }

    /// The bounds at `node`.
    pub fn at(&self, node: usize) -> &[Limit] {
        let first = self.0.partition_point(|l| l.node < node);
        let count = self.0[first..].partition_point(|l| l.node == node);
        &self.0[first..first + count]
    }
}

#[cfg(test)]
#[path = "../../tests/model/profile.rs"]
mod tests;
