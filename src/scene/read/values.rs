//! Single values (numbers, texts, counts, sizes), each with a message for a value of the wrong kind.

use super::document::{Item, Value};
use super::Reader;
use crate::error::{Error, Result};
use crate::scene::model::expr::Expr;
use crate::scene::model::spec::SIDES;

/// Largest number of elements or subdomains along one side of a body: a typing error must not exhaust the memory before
/// it can be reported.
pub(super) const MOST: usize = 1 << 22;

impl<'a> Reader<'a> {
    pub(super) fn error<T>(&self, item: &Item, message: impl std::fmt::Display) -> Result<T> {
        Err(Error::Input(format!(
            "{}: {message}",
            self.source.place(item.line)
        )))
    }

    pub(super) fn expected<T>(&self, item: &Item, wanted: &str) -> Result<T> {
        self.error(
            item,
            format_args!("{} where {wanted} was expected", item.value.kind()),
        )
    }

    /// One table or a list of tables.
    pub(super) fn tables(&self, item: Option<&'a Item>) -> Result<Vec<&'a Item>> {
        match item {
            None => Ok(Vec::new()),
            Some(item) => match &item.value {
                Value::Table(_) => Ok(vec![item]),
                Value::List(items) => Ok(items.iter().collect()),
                _ => self.expected(item, "a table"),
            },
        }
    }

    pub(super) fn text(&self, item: &Item, wanted: &str) -> Result<String> {
        match &item.value {
            Value::Text(text) => Ok(text.clone()),
            _ => self.expected(item, wanted),
        }
    }

    pub(super) fn list(&self, item: &'a Item, wanted: &str) -> Result<&'a [Item]> {
        match &item.value {
            Value::List(items) => Ok(items),
            _ => self.expected(item, wanted),
        }
    }

    /// A number, or a constant expression such as "1/3".
    pub(super) fn number(&self, item: &Item) -> Result<f64> {
        let value = self.expression(item)?.as_constant();
        match value {
            Some(v) if v.is_finite() => Ok(v),
            Some(v) => self.error(item, format_args!("{v} where a finite number was expected")),
            None => self.expected(item, "a number without variables"),
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
            .or_else(|message| {
                self.error(item, format_args!("bad expression \"{text}\": {message}"))
            }),
            _ => self.expected(item, "a number or an expression"),
        }
    }

    pub(super) fn pair(&self, item: &'a Item, wanted: &str) -> Result<[f64; 2]> {
        match self.list(item, wanted)? {
            [a, b] => Ok([self.number(a)?, self.number(b)?]),
            _ => self.expected(item, wanted),
        }
    }

    pub(super) fn count(&self, item: &Item, wanted: &str) -> Result<usize> {
        match item.value {
            Value::Integer(v) if v > 0 && v as usize <= MOST => Ok(v as usize),
            Value::Integer(v) if v > 0 => self.error(
                item,
                format_args!("the number {v} where {wanted} of at most {MOST} was expected"),
            ),
            _ => self.expected(item, wanted),
        }
    }

    /// One number for each dimension; the rest is zero.
    pub(super) fn vector(&self, item: &'a Item, wanted: &str) -> Result<[f64; 3]> {
        let list = self.list(item, wanted)?;
        if list.len() != self.dim {
            return self.error(
                item,
                format_args!(
                    "a list of {} where {wanted} was expected{}",
                    list.len(),
                    self.hint(list.len())
                ),
            );
        }
        let mut out = [0.0; 3];
        for (value, item) in out.iter_mut().zip(list) {
            *value = self.number(item)?;
        }
        Ok(out)
    }

    /// A hint for a list whose length fits the other dimension.
    fn hint(&self, n: usize) -> &'static str {
        match (self.dim, n) {
            (2, 3) => " (`dimension = 3` at the top makes the scene solid)",
            _ => "",
        }
    }

    /// A positive whole number for each dimension, or one for all of them; `flat` stands for z in the plane.
    pub(super) fn counts(&self, item: &Item, flat: usize) -> Result<[usize; 3]> {
        let mut out = [flat; 3];
        match &item.value {
            Value::List(items) if items.len() == self.dim => {
                for (count, item) in out.iter_mut().zip(items) {
                    *count = self.count(item, "a positive whole number")?;
                }
            }
            Value::List(items) => {
                let wanted = match self.dim {
                    2 => "a pair of positive whole numbers",
                    _ => "three positive whole numbers",
                };
                return self.error(
                    item,
                    format_args!(
                        "{} where {wanted} was expected{}",
                        item.value.kind(),
                        self.hint(items.len())
                    ),
                );
            }
            _ => {
                let one = self.count(item, "a positive whole number or a pair of them")?;
                out[..self.dim].fill(one);
            }
        }
        Ok(out)
    }

    /// Edge lengths, one for each dimension or one for all.
    pub(super) fn size(&self, item: &'a Item) -> Result<[f64; 3]> {
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
            Some(s) => self.error(
                item,
                format_args!("the size {s} where a positive number was expected"),
            ),
        }
    }

    /// The index of a side of this scene's bodies.
    pub(super) fn side(&self, item: &Item) -> Result<usize> {
        let names = &SIDES[..2 * self.dim];
        let found = match &item.value {
            Value::Text(text) => names.iter().position(|s| s == text),
            _ => None,
        };
        match found {
            Some(s) => Ok(s),
            None => self.expected(item, &self.sides_list()),
        }
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

    pub(super) fn written(&self, item: &Item) -> String {
        format!("{}: ", self.source.place(item.line))
    }
}
