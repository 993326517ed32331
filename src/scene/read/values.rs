//! Single values: numbers, texts, counts, sizes, each with a message for what is found instead.

use super::Reader;
use crate::error::{Error, Result};
use crate::scene::document::{Item, Value};
use crate::scene::expr::Expr;

/// Largest number of elements or subdomains along one side of a body: a slip of the pen must not exhaust the memory
/// before anything can be said about it.
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
            Value::Text(text) => Expr::parse(text).or_else(|message| {
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

    /// One count for both directions, or a pair.
    pub(super) fn counts(&self, item: &Item) -> Result<[usize; 2]> {
        match &item.value {
            Value::List(items) => match items.as_slice() {
                [a, b] => Ok([
                    self.count(a, "a positive whole number")?,
                    self.count(b, "a positive whole number")?,
                ]),
                _ => self.expected(item, "a pair of positive whole numbers"),
            },
            _ => Ok([self.count(item, "a positive whole number or a pair of them")?; 2]),
        }
    }

    /// A positive size, or a pair.
    pub(super) fn size(&self, item: &'a Item) -> Result<[f64; 2]> {
        let size = match &item.value {
            Value::List(_) => self.pair(item, "a width and a height")?,
            _ => [self.number(item)?; 2],
        };
        match size.iter().find(|s| **s <= 0.0) {
            None => Ok(size),
            Some(s) => self.error(
                item,
                format_args!("the size {s} where a positive number was expected"),
            ),
        }
    }

    pub(super) fn written(&self, item: &Item) -> String {
        format!("{}: ", self.source.place(item.line))
    }
}
