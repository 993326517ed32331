//! Coefficients, loads and boundary values in all their forms.

use super::Reader;
use crate::error::Result;
use crate::fem::Quadrature;
use crate::scene::document::{Item, Section, Value};
use crate::scene::expr::Expr;
use crate::scene::field::{By, Field, Region};
use crate::scene::spec::{held_all_round, Sides, SIDES};

/// What tables of values are checked against.
pub(super) struct Shape {
    /// What a bare list of lists follows.
    pub bare: By,
    /// Bodies of the grid, `None` outside a grid.
    pub bodies: Option<[usize; 2]>,
    /// Subdomains of each body.
    pub subdomains: [usize; 2],
}

impl<'a> Reader<'a> {
    /// A field in any of its forms, with the quadrature if the table form names one.
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
            Some(item) => match &item.value {
                Value::Text(t) if t == "midpoint" => Some(Quadrature::Midpoint),
                Value::Text(t) if t == "gauss" => Some(Quadrature::Gauss),
                _ => return self.expected(item, "\"midpoint\" or \"gauss\""),
            },
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
            let value = self.expression(section.need("value", "a number or an expression")?)?;
            section.finish()?;
            list.push(Region { x, y, value });
        }
        Ok(Field::Regions { list, otherwise })
    }

    /// Rows of numbers, the first at the bottom.
    pub(super) fn table(&self, item: &'a Item, shape: &Shape, by: By) -> Result<Field> {
        let (what, [columns, height]) = match (by, shape.bodies) {
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
        Ok(Field::Table { rows: table, by })
    }

    pub(super) fn sides(&self, item: &'a Item) -> Result<Sides> {
        let mut sides: Sides = [None, None, None, None];
        let wanted =
            "\"all\", a list of sides (left, right, bottom, top) or a table of their values";
        let find = |name: &str| SIDES.iter().position(|s| *s == name);
        match &item.value {
            Value::Text(text) if text == "all" => sides = held_all_round(),
            Value::Text(text) if text == "none" => {}
            Value::List(items) => {
                for item in items {
                    let name = self.text(item, "a side (left, right, bottom, top)")?;
                    match find(&name) {
                        Some(s) => sides[s] = Some(Field::constant(0.0)),
                        None => return self.expected(item, "left, right, bottom or top"),
                    }
                }
            }
            Value::Table(_) => {
                let mut section = Section::new(self.source, "`dirichlet`", item)?;
                for (side, name) in sides.iter_mut().zip(SIDES) {
                    if let Some(value) = section.take(name) {
                        *side = Some(Field::Expression(self.expression(value)?));
                    }
                }
                section.finish()?;
            }
            _ => return self.expected(item, wanted),
        }
        Ok(sides)
    }
}
