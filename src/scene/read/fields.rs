//! Coefficients, loads and boundary values in all their forms.

use super::document::{Item, Section, Value};
use super::Reader;
use crate::error::Result;
use crate::fem::Quadrature;
use crate::scene::model::expr::Expr;
use crate::scene::model::field::{By, Field, Region};

/// The sizes against which tables of values are checked.
pub(super) struct Shape {
    /// The index of a bare list of lists.
    pub bare: By,
    /// Bodies of the grid, `None` outside a grid.
    pub bodies: Option<[usize; 3]>,
    /// Elements of each body, 0 in z in the plane.
    pub elements: [usize; 3],
    /// Subdomains of each body.
    pub subdomains: [usize; 3],
}

impl<'a> Reader<'a> {
    /// A field in any of its forms, and the quadrature if a table names one.
    pub(super) fn field(
        &self,
        item: &'a Item,
        shape: &Shape,
        otherwise: f64,
    ) -> Result<(Field, Option<Quadrature>)> {
        match &item.value {
            Value::List(items) => match items.first().map(|i| &i.value) {
                Some(Value::List(_)) => Ok((self.table(item, shape, shape.bare)?, None)),
                _ => Ok((self.regions(item, Expr::constant(otherwise))?, None)),
            },
            Value::Table(_) => self.field_table(item, shape, otherwise),
            _ => Ok((Field::Expression(self.expression(item)?), None)),
        }
    }

    pub(super) fn field_table(
        &self,
        item: &'a Item,
        shape: &Shape,
        otherwise: f64,
    ) -> Result<(Field, Option<Quadrature>)> {
        const FORMS: &str = "`value`, `regions`, `checkerboard`, `per_body` or `per_subdomain`";
        let mut section = Section::new(self.source, "this table", item)?;
        if let Some(file) = section.entry("file") {
            return self.error(
                file,
                "a `file`, which only `rho`, `young` and `poisson` take",
            );
        }
        let mut found = Vec::new();
        if let Some(value) = section.take("value") {
            found.push(Field::Expression(self.expression(value)?));
        }
        let regions = section.take("regions");
        if let Some(list) = regions {
            let otherwise = match section.take("default") {
                Some(item) => self.expression(item)?,
                None => Expr::constant(otherwise),
            };
            found.push(self.regions(list, otherwise)?);
        }
        if let Some(values) = section.take("checkerboard") {
            let by = match section.take("by") {
                None => By::Body,
                Some(item) => match &item.value {
                    Value::Text(t) if t == "body" => By::Body,
                    Value::Text(t) if t == "subdomain" => By::Subdomain,
                    _ => return self.expected(item, "\"body\" or \"subdomain\""),
                },
            };
            let values = self.pair(values, "a pair of numbers")?;
            found.push(Field::Checkerboard { values, by });
        }
        if let Some(rows) = section.take("per_body") {
            found.push(self.table(rows, shape, By::Body)?);
        }
        if let Some(rows) = section.take("per_subdomain") {
            found.push(self.table(rows, shape, By::Subdomain)?);
        }
        let quadrature = match section.take("quadrature") {
            None => None,
            Some(item) => Some(self.quadrature(item)?),
        };
        section.finish()?;
        match found.len() {
            1 => Ok((found.remove(0), quadrature)),
            0 => self.error(item, format_args!("a table without {FORMS}")),
            n => self.error(
                item,
                format_args!("{n} values where one of {FORMS} was expected"),
            ),
        }
    }

    pub(super) fn regions(&self, item: &'a Item, otherwise: Expr) -> Result<Field> {
        let mut list = Vec::new();
        for item in self.list(item, "a list of regions")? {
            let mut section = Section::new(self.source, "a region", item)?;
            let mut range = |key| match section.take(key) {
                None => Ok(None),
                Some(item) => match self.pair(item, "a pair of numbers")? {
                    [low, high] if low < high => Ok(Some([low, high])),
                    [low, high] => self.error(
                        item,
                        format_args!("the empty range [{low}, {high}] in a region"),
                    ),
                },
            };
            let (x, y) = (range("x")?, range("y")?);
            let z = if self.dim == 3 { range("z")? } else { None };
            let value = self.expression(section.need("value", "a number or an expression")?)?;
            section.finish()?;
            list.push(Region { x, y, z, value });
        }
        Ok(Field::Regions { list, otherwise })
    }

    /// Rows of numbers, the first at the bottom.
    pub(super) fn table(&self, item: &'a Item, shape: &Shape, by: By) -> Result<Field> {
        let (what, [columns, height, depth]) = match (by, shape.bodies) {
            (By::Body, Some(bodies)) => ("bodies", bodies),
            (By::Body, None) => {
                return self.error(item, "`per_body` outside a [grid], where one number serves")
            }
            (By::Subdomain, _) => ("subdomains", shape.subdomains),
        };
        let count = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
        let wanted = format!(
            "{} of {} (one for each of the {what})",
            count(height, "row"),
            count(columns, "number")
        );
        let rows = |item: &'a Item| -> Result<Vec<Vec<f64>>> {
            let rows = self.list(item, &wanted)?;
            if rows.len() != height {
                return self.error(
                    item,
                    format_args!("{} where {wanted} were expected", count(rows.len(), "row")),
                );
            }
            let mut table = Vec::with_capacity(height);
            for row in rows {
                let entries = self.list(row, &wanted)?;
                if entries.len() != columns {
                    return self.error(
                        row,
                        format_args!("a row of {} where {wanted} were expected", entries.len()),
                    );
                }
                let numbers: Result<Vec<f64>> = entries.iter().map(|i| self.number(i)).collect();
                table.push(numbers?);
            }
            Ok(table)
        };
        if self.dim == 2 {
            let layers = vec![rows(item)?];
            return Ok(Field::Table { layers, by });
        }
        let list = self.list(item, "a list of layers")?;
        if list.len() != depth {
            return self.error(
                item,
                format_args!(
                    "{} where {} of {wanted} were expected",
                    count(list.len(), "layer"),
                    count(depth, "layer")
                ),
            );
        }
        let layers: Result<Vec<Vec<Vec<f64>>>> = list.iter().map(rows).collect();
        Ok(Field::Table {
            layers: layers?,
            by,
        })
    }

    /// One field for each component. A scalar problem has one field; elasticity has a list, or a table with the keys x,
    /// y (and z).
    pub(super) fn vector_field(
        &self,
        item: &'a Item,
        shape: &Shape,
    ) -> Result<(Vec<Field>, Option<Quadrature>)> {
        let c = self.form.components(self.dim);
        if c == 1 {
            let (field, quadrature) = self.field(item, shape, 0.0)?;
            return Ok((vec![field], quadrature));
        }
        let wanted = format!(
            "a list of {c} components or a table of x, y{}",
            ["", " and z"][c - 2]
        );
        match &item.value {
            Value::List(items) if items.len() == c => {
                let each = |i| Ok(Field::Expression(self.expression(i)?));
                Ok((items.iter().map(each).collect::<Result<_>>()?, None))
            }
            Value::Table(_) => {
                let mut section = Section::new(self.source, "this table", item)?;
                let mut out = vec![Field::constant(0.0); c];
                let mut rule = None;
                for (field, key) in out.iter_mut().zip(["x", "y", "z"]) {
                    if let Some(item) = section.take(key) {
                        let (value, quadrature) = self.field(item, shape, 0.0)?;
                        *field = value;
                        rule = rule.or(quadrature);
                    }
                }
                if let Some(item) = section.take("quadrature") {
                    rule = Some(self.quadrature(item)?);
                }
                section.finish()?;
                Ok((out, rule))
            }
            _ => self.expected(item, &wanted),
        }
    }

    pub(super) fn quadrature(&self, item: &Item) -> Result<Quadrature> {
        match &item.value {
            Value::Text(t) if t == "midpoint" => Ok(Quadrature::Midpoint),
            Value::Text(t) if t == "gauss" => Ok(Quadrature::Gauss),
            _ => self.expected(item, "\"midpoint\" or \"gauss\""),
        }
    }
}
