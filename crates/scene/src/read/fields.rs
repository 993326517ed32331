//! Coefficients, loads and boundary values in all their forms.

use super::document::{Item, Value};
use super::SceneReader;
use crate::model::expr::Expr;
use crate::model::field::{By, Field, Region};
use base::Result;
use elements::q1::Quadrature;
use mesh::BoxMesh;

/// The sizes against which tables of values are checked.
pub(super) struct FieldSizes {
    /// The mesh of the body; of a grid the elements and subdomains of each body.
    pub mesh: BoxMesh,
    /// Bodies of the grid, `None` outside a grid.
    pub bodies: Option<[usize; 3]>,
    /// Whether the body is a mesh of cells: it has no table of subdomains.
    pub of_cells: bool,
}

impl SceneReader {
    /// A field in any of its forms, and the quadrature if a table names one.
    pub(super) fn field(
        &self,
        item: &Item,
        shape: &FieldSizes,
        otherwise: f64,
    ) -> Result<(Field, Option<Quadrature>)> {
        match &item.value {
            Value::List(items) => match (items.first().map(|i| &i.value), shape.bodies) {
                // A bare list of lists follows the bodies of a grid, the subdomains of a body.
                (Some(Value::List(_)), Some(_)) => Ok((self.table(item, shape, By::Body)?, None)),
                (Some(Value::List(_)), None) => Ok((self.table(item, shape, By::Subdomain)?, None)),
                _ => Ok((self.regions(item, Expr::constant(otherwise))?, None)),
            },
            Value::Table(_) => self.field_table(item, shape, otherwise),
            _ => Ok((self.formula(item)?, None)),
        }
    }

    fn field_table(
        &self,
        item: &Item,
        shape: &FieldSizes,
        otherwise: f64,
    ) -> Result<(Field, Option<Quadrature>)> {
        const FORMS: &str = "`value`, `regions`, `checkerboard`, `per_body` or `per_subdomain`";
        let mut section = item.section("this table")?;
        if let Some(file) = section.entry("file") {
            return file.error("a `file`, which only `rho`, `young` and `poisson` take");
        }
        let mut found = Vec::new();
        found.extend(section.read("value", |value| self.formula(value))?);
        if let Some(list) = section.take("regions") {
            let default = section.read("default", |item| self.expression(item))?;
            let otherwise = default.unwrap_or_else(|| Expr::constant(otherwise));
            found.push(self.regions(list, otherwise)?);
        }
        if let Some(values) = section.take("checkerboard") {
            let words = [("body", By::Body), ("subdomain", By::Subdomain)];
            let by = section.read("by", |item| item.choice(&words))?;
            let (values, by) = (
                self.pair(values, "a pair of numbers")?,
                by.unwrap_or(By::Body),
            );
            found.push(Field::Checkerboard { values, by });
        }
        for (key, by) in [("per_body", By::Body), ("per_subdomain", By::Subdomain)] {
            found.extend(section.read(key, |rows| self.table(rows, shape, by))?);
        }
        let quadrature = section.read("quadrature", quadrature)?;
        section.finish()?;
        let field = item.only(found, "a table", "values", FORMS)?;
        Ok((field, quadrature))
    }

    fn regions(&self, item: &Item, otherwise: Expr) -> Result<Field> {
        let region = |item: &Item| {
            let mut section = item.section("a region")?;
            let range = |item: &Item| match self.pair(item, "a pair of numbers")? {
                [low, high] if low < high => Ok([low, high]),
                [low, high] => item.error(format!("the empty range [{low}, {high}] in a region")),
            };
            let [x, y, z] = self.by_axis(&mut section, range)?;
            let value = self.expression(section.need("value", "a number or an expression")?)?;
            section.finish()?;
            Ok(Region { x, y, z, value })
        };
        let list = item.list("a list of regions")?.iter().map(region);
        Ok(Field::Regions {
            list: list.collect::<Result<_>>()?,
            otherwise,
        })
    }

    /// Rows of numbers, the first at the bottom; in three dimensions a list of such layers.
    fn table(&self, item: &Item, shape: &FieldSizes, by: By) -> Result<Field> {
        let (what, [columns, height, depth]) = match (by, shape.bodies) {
            (By::Body, Some(bodies)) => ("bodies", bodies),
            (By::Body, None) => {
                return item.error("`per_body` outside a [grid], where one number serves")
            }
            (By::Subdomain, _) if shape.of_cells => {
                return item.error("values by subdomain on a mesh, whose subdomains have no rows")
            }
            (By::Subdomain, _) => ("subdomains", shape.mesh.subdomains),
        };
        let count = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
        let wanted = format!(
            "{} of {} (one for each of the {what})",
            count(height, "row"),
            count(columns, "number")
        );
        let row = |row: &Item| {
            let entries = row.list(&wanted)?;
            if entries.len() != columns {
                let found = entries.len();
                return row.error(format!("a row of {found} where {wanted} were expected"));
            }
            entries.iter().map(|i| self.number(i)).collect()
        };
        let layer = |item: &Item| -> Result<Vec<Vec<f64>>> {
            let rows = item.list(&wanted)?;
            if rows.len() != height {
                let found = count(rows.len(), "row");
                return item.error(format!("{found} where {wanted} were expected"));
            }
            rows.iter().map(row).collect()
        };
        if self.dim == 2 {
            let layers = vec![layer(item)?];
            return Ok(Field::Table { layers, by });
        }
        let list = item.list("a list of layers")?;
        if list.len() != depth {
            let [found, all] = [list.len(), depth].map(|n| count(n, "layer"));
            return item.error(format!("{found} where {all} of {wanted} were expected"));
        }
        let layers: Result<_> = list.iter().map(layer).collect();
        Ok(Field::Table {
            layers: layers?,
            by,
        })
    }

    /// One field for each component. A scalar problem has one field; elasticity has a list, or a table with the keys x,
    /// y (and z).
    pub(super) fn vector_field(
        &self,
        item: &Item,
        shape: &FieldSizes,
    ) -> Result<(Vec<Field>, Option<Quadrature>)> {
        let c = self.form.components(self.dim);
        if c == 1 {
            let (field, quadrature) = self.field(item, shape, 0.0)?;
            return Ok((vec![field], quadrature));
        }
        match &item.value {
            Value::List(items) if items.len() == c => {
                let fields: Result<_> = items.iter().map(|i| self.formula(i)).collect();
                Ok((fields?, None))
            }
            Value::Table(_) => {
                let mut section = item.section("this table")?;
                let found = self.by_axis(&mut section, |item| self.field(item, shape, 0.0))?;
                let rule = section.read("quadrature", quadrature)?;
                section.finish()?;
                let first = found.iter().flatten().find_map(|(_, rule)| *rule);
                let field = |found: Option<(Field, _)>| found.map(|(field, _)| field);
                let zero = || Field::constant(0.0);
                let fields = found.map(|f| field(f).unwrap_or_else(zero));
                Ok((fields[..c].to_vec(), rule.or(first)))
            }
            _ => item.expected(format!(
                "a list of {c} components or a table of x, y{}",
                ["", " and z"][c - 2]
            )),
        }
    }
}

fn quadrature(item: &Item) -> Result<Quadrature> {
    item.choice(&[
        ("midpoint", Quadrature::Midpoint),
        ("gauss", Quadrature::Gauss),
    ])
}
