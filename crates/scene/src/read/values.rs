//! Single values (numbers, texts, counts, sizes), each with a message for a value of the wrong kind.

use super::document::{Item, TableSection, Value};
use super::SceneReader;
use crate::model::body::SIDES;
use crate::model::expr::Expr;
use base::Result;

/// Largest number of elements or subdomains along one side of a body: a typing error must not exhaust the memory before
/// it can be reported.
pub(crate) const MOST: usize = 1 << 22;

impl Item<'_> {
    /// A positive whole number.
    pub(super) fn count(&self, wanted: &str) -> Result<usize> {
        match self.value {
            Value::Integer(v) if v > 0 && v as usize <= MOST => Ok(v as usize),
            Value::Integer(v) if v > 0 => self.error(format!(
                "the number {v} where {wanted} of at most {MOST} was expected"
            )),
            _ => self.expected(wanted),
        }
    }
}

impl SceneReader {
    /// A number, or a constant expression such as "1/3".
    pub(super) fn number(&self, item: &Item) -> Result<f64> {
        match self.expression(item)?.as_constant() {
            Some(v) if v.is_finite() => Ok(v),
            Some(v) => item.error(format!("{v} where a finite number was expected")),
            None => item.expected("a number without variables"),
        }
    }

    pub(super) fn positive(&self, item: &Item) -> Result<f64> {
        match self.number(item)? {
            v if v > 0.0 => Ok(v),
            v => item.error(format!("{v} where a positive number was expected")),
        }
    }

    /// A number or an expression in x, y, bi, bj, si, sj.
    pub(super) fn expression(&self, item: &Item) -> Result<Expr> {
        match &item.value {
            Value::Integer(v) => Ok(Expr::constant(*v as f64)),
            Value::Number(v) => Ok(Expr::constant(*v)),
            Value::Text(text) => match self.dim {
                2 => Expr::parse_plane(text),
                _ => Expr::parse(text),
            }
            .or_else(|message| item.error(format!("bad expression \"{text}\": {message}"))),
            _ => item.expected("a number or an expression"),
        }
    }

    /// An expression for each component.
    pub(super) fn components(&self, item: &Item) -> Result<Vec<Expr>> {
        let c = self.form.components(self.dim);
        match &item.value {
            _ if c == 1 => Ok(vec![self.expression(item)?]),
            Value::List(items) if items.len() == c => {
                items.iter().map(|i| self.expression(i)).collect()
            }
            _ => item.expected(format!("a list of {c} components")),
        }
    }

    pub(super) fn pair(&self, item: &Item, wanted: &str) -> Result<[f64; 2]> {
        match item.list(wanted)? {
            [a, b] => Ok([self.number(a)?, self.number(b)?]),
            _ => item.expected(wanted),
        }
    }

    /// One number for each dimension; the rest is zero.
    pub(super) fn vector(&self, item: &Item, wanted: &str) -> Result<[f64; 3]> {
        let list = item.list(wanted)?;
        if list.len() != self.dim {
            return self.wrong_length(item, wanted, list.len());
        }
        let mut out = [0.0; 3];
        for (value, item) in out.iter_mut().zip(list) {
            *value = self.number(item)?;
        }
        Ok(out)
    }

    /// The error of a list of `n`, with a hint where that fits the other dimension.
    fn wrong_length<T>(&self, item: &Item, wanted: &str, n: usize) -> Result<T> {
        let hint = match (self.dim, n) {
            (2, 3) => " (`dimension = 3` at the top makes the scene solid)",
            _ => "",
        };
        item.error(format!("a list of {n} where {wanted} was expected{hint}"))
    }

    /// A positive whole number for each dimension, or one for all of them; `flat` stands for z in the plane.
    pub(super) fn counts(&self, item: &Item, flat: usize) -> Result<[usize; 3]> {
        let mut out = [flat; 3];
        match &item.value {
            Value::List(items) if items.len() == self.dim => {
                for (count, item) in out.iter_mut().zip(items) {
                    *count = item.count("a positive whole number")?;
                }
            }
            Value::List(items) => {
                let wanted = match self.dim {
                    2 => "a pair of positive whole numbers",
                    _ => "three positive whole numbers",
                };
                return self.wrong_length(item, wanted, items.len());
            }
            _ => {
                let one = item.count("a positive whole number or a pair of them")?;
                out[..self.dim].fill(one);
            }
        }
        Ok(out)
    }

    /// Edge lengths, one for each dimension or one for all.
    pub(super) fn size(&self, item: &Item) -> Result<[f64; 3]> {
        let size = match &item.value {
            Value::List(_) => {
                let wanted = ["a width and a height", "three edge lengths"][self.dim - 2];
                self.vector(item, wanted)?
            }
            _ => {
                let mut size = [0.0; 3];
                size[..self.dim].fill(self.number(item)?);
                size
            }
        };
        match size[..self.dim].iter().find(|s| **s <= 0.0) {
            None => Ok(size),
            Some(s) => item.error(format!("the size {s} where a positive number was expected")),
        }
    }

    /// The index of a side of this scene's bodies.
    pub(super) fn side(&self, item: &Item) -> Result<usize> {
        let found = SIDES[..2 * self.dim].iter().position(|s| item.is(s));
        found.map_or_else(|| item.expected(self.sides_list()), Ok)
    }

    /// "left, right, bottom or top".
    pub(super) fn sides_list(&self) -> String {
        let names = &SIDES[..2 * self.dim];
        format!(
            "{} or {}",
            names[..names.len() - 1].join(", "),
            names[names.len() - 1]
        )
    }

    /// The results of `read` for the values of a table whose keys are sides, each with its side.
    pub(super) fn by_side<T>(
        &self,
        item: &Item,
        what: &str,
        read: impl Fn(&Item) -> Result<T>,
    ) -> Result<Vec<(usize, T)>> {
        let mut section = item.section(what)?;
        let mut out = Vec::new();
        for (side, name) in SIDES.into_iter().enumerate().take(2 * self.dim) {
            out.extend(section.read(name, &read)?.map(|value| (side, value)));
        }
        section.finish()?;
        Ok(out)
    }

    /// The results of `read` for the values of a table with some of the keys x, y (and z), by component.
    pub(super) fn by_axis<T>(
        &self,
        section: &mut TableSection,
        read: impl Fn(&Item) -> Result<T>,
    ) -> Result<[Option<T>; 3]> {
        let mut out = [const { None }; 3];
        for (value, key) in out.iter_mut().zip(["x", "y", "z"]).take(self.dim) {
            *value = section.read(key, &read)?;
        }
        Ok(out)
    }
}
