//! Data over bodies: coefficients, loads and boundary values.

use std::sync::Arc;

use super::cells::CellGrid;
use super::expr::{Expr, Variables};

/// The index of an alternation or a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// The place of the body in its grid.
    Body,
    /// The place of the subdomain in the whole grid of bodies.
    Subdomain,
}

/// A box [x0, x1) × [y0, y1) (× [z0, z1)) with its own value.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// x0 and x1; `None`: all x.
    pub x: Option<[f64; 2]>,
    /// y0 and y1; `None`: all y.
    pub y: Option<[f64; 2]>,
    /// z0 and z1; `None`: all z.
    pub z: Option<[f64; 2]>,
    /// The value inside.
    pub value: Expr,
}

/// A scalar function on the bodies.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// A number or an expression in x, y, z, bi, bj, bk, si, sj, sk.
    Expression(Expr),
    /// `values[0]` and `values[1]` in turns, `values[0]` in the lower left corner.
    Checkerboard {
        /// The two values.
        values: [f64; 2],
        /// The index that they follow.
        by: By,
    },
    /// `layers[k][j][i]` in column i, row j and layer k of bodies or subdomains, j counted upwards; one layer in the
    /// plane.
    Table {
        /// The values, layer by layer and row by row from the lower left corner.
        layers: Vec<Vec<Vec<f64>>>,
        /// The index: the place of the body in its grid, or of the subdomain in its body.
        by: By,
    },
    /// The value of the last region that contains the point; `otherwise` outside all regions.
    Regions {
        /// The regions.
        list: Vec<Region>,
        /// The value outside all of them.
        otherwise: Expr,
    },
    /// Values by element, from a file. Only coefficients of boxes have them.
    Cells(CellGrid),
    /// Values by cell of a mesh of cells. Only coefficients and loads have them.
    ByCell(Arc<Vec<f64>>),
}

/// Where a field is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct At {
    /// Point and places.
    pub variables: Variables,
    /// Subdomains of the body in x, y and z.
    pub subdomains: [usize; 3],
}

impl Field {
    /// The constant `value`.
    pub fn constant(value: f64) -> Field {
        Field::Expression(Expr::constant(value))
    }

    /// The value at `at`; NaN for [`Field::Cells`] and [`Field::ByCell`], which have values by element, not by point.
    pub fn eval(&self, at: &At) -> f64 {
        let v = &at.variables;
        match self {
            Field::Expression(e) => e.eval(v),
            Field::Checkerboard { values, by } => {
                let parity: usize = (0..3)
                    .map(|d| match by {
                        By::Body => v.body[d],
                        By::Subdomain => v.body[d] * at.subdomains[d] + v.subdomain[d],
                    })
                    .sum();
                values[parity % 2]
            }
            Field::Table { layers, by } => {
                let [i, j, k] = match by {
                    By::Body => v.body,
                    By::Subdomain => v.subdomain,
                };
                // The shape was checked against the grid; should the check fail to hold, NaN is reported as a bad
                // value.
                layers
                    .get(k)
                    .and_then(|rows| rows.get(j))
                    .and_then(|row| row.get(i))
                    .copied()
                    .unwrap_or(f64::NAN)
            }
            Field::Regions { list, otherwise } => list
                .iter()
                .rev()
                .find(|r| r.contains(v.point))
                .map_or(otherwise, |r| &r.value)
                .eval(v),
            Field::Cells(_) | Field::ByCell(_) => f64::NAN,
        }
    }

    /// The value, if it is the same constant everywhere.
    pub fn as_constant(&self) -> Option<f64> {
        match self {
            Field::Expression(e) => e.as_constant(),
            _ => None,
        }
    }

    /// Whether the value is constant in each subdomain, such that one evaluation suffices.
    pub fn is_constant_by_subdomain(&self) -> bool {
        match self {
            Field::Expression(e) => e.as_constant().is_some(),
            Field::Checkerboard { .. } | Field::Table { .. } => true,
            Field::Regions { .. } | Field::Cells(_) | Field::ByCell(_) => false,
        }
    }

    /// The values that are known without evaluation, for early checks.
    pub fn known_values(&self) -> Vec<f64> {
        match self {
            Field::Expression(e) => e.as_constant().into_iter().collect(),
            Field::Checkerboard { values, .. } => values.to_vec(),
            Field::Table { layers, .. } => layers.concat().concat(),
            Field::Regions { list, otherwise } => list
                .iter()
                .map(|r| &r.value)
                .chain([otherwise])
                .filter_map(Expr::as_constant)
                .collect(),
            Field::Cells(cells) => cells.range().to_vec(),
            Field::ByCell(values) => values.to_vec(),
        }
    }

    /// This field over a grid of bodies: its cells cover the whole grid.
    pub(crate) fn over(&self, bodies: [usize; 3]) -> Field {
        match self {
            Field::Cells(cells) => Field::Cells(cells.over(bodies)),
            other => other.clone(),
        }
    }
}

impl Region {
    /// Half-open, so that a point on the border of two regions belongs to the right or upper one.
    fn contains(&self, point: [f64; 3]) -> bool {
        let inside = |range: &Option<[f64; 2]>, v: f64| match range {
            Some([low, high]) => *low <= v && v < *high,
            None => true,
        };
        [&self.x, &self.y, &self.z]
            .into_iter()
            .zip(point)
            .all(|(range, v)| inside(range, v))
    }
}

#[cfg(test)]
#[path = "../../tests/model/field.rs"]
mod tests;
