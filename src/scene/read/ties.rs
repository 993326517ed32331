//! [interface] and [[tie]].

use super::Reader;
use crate::error::Result;
use crate::scene::document::{Item, Section, Value};
use crate::scene::spec::{BodySpec, Extent, Pair, TieSpec};

impl<'a> Reader<'a> {
    pub(super) fn interface(&self, item: &'a Item) -> Result<bool> {
        let mut section = Section::new(self.source, "[interface]", item)?;
        let tied = match section.take("default") {
            None => true,
            Some(item) => match &item.value {
                Value::Text(t) if t == "tied" => true,
                Value::Text(t) if t == "free" => false,
                _ => return self.expected(item, "\"tied\" or \"free\""),
            },
        };
        section.finish()?;
        Ok(tied)
    }

    pub(super) fn tie(&self, item: &'a Item, bodies: &[BodySpec]) -> Result<TieSpec> {
        let mut section = Section::new(self.source, "[[tie]]", item)?;
        let wanted = "\"all\" or a pair of names";
        let named = section.need("bodies", wanted)?;
        let pair = match &named.value {
            Value::Text(text) if text == "all" => Pair::All,
            Value::List(items) if items.len() == 2 => {
                let mut names = Vec::with_capacity(2);
                for item in items {
                    names.push(match &item.value {
                        Value::Text(name) => name.clone(),
                        Value::Integer(k) => {
                            match bodies.get(usize::try_from(*k).unwrap_or(usize::MAX)) {
                                Some(body) => body.name.clone(),
                                None => {
                                    return self.error(
                                        item,
                                        format_args!(
                                            "body {k} where a number below {} was expected",
                                            bodies.len()
                                        ),
                                    )
                                }
                            }
                        }
                        _ => return self.expected(item, "the name of a body"),
                    });
                }
                let second = names.pop().unwrap_or_default();
                Pair::Named(names.pop().unwrap_or_default(), second)
            }
            _ => return self.expected(named, wanted),
        };
        let mut extents = Vec::new();
        if let Some(item) = section.take("where") {
            extents.push(match &item.value {
                Value::Text(t) if t == "all" => Extent::All,
                Value::Text(t) if t == "none" => Extent::None,
                _ => {
                    return self.expected(
                        item,
                        "\"all\" or \"none\" (or the key `range`, `points` or `nodes`)",
                    )
                }
            });
        }
        if let Some(item) = section.take("range") {
            let [low, high] = self.pair(item, "a pair of numbers between 0 and 1")?;
            if !(0.0 <= low && low <= high && high <= 1.0) {
                return self.error(
                    item,
                    format_args!("the range [{low}, {high}] where 0 ≤ t0 ≤ t1 ≤ 1 was expected"),
                );
            }
            extents.push(Extent::Range([low, high]));
        }
        if let Some(item) = section.take("points") {
            let list = self.list(item, "a list of numbers between 0 and 1")?;
            let points: Result<Vec<f64>> = list.iter().map(|i| self.number(i)).collect();
            extents.push(Extent::Points(points?));
        }
        if let Some(item) = section.take("nodes") {
            let mut nodes = Vec::new();
            for item in self.list(item, "a list of node numbers")? {
                match item.value {
                    Value::Integer(v) if v >= 0 => nodes.push(v as usize),
                    _ => return self.expected(item, "a node number, counted from 0,"),
                }
            }
            extents.push(Extent::Nodes(nodes));
        }
        section.finish()?;
        let extent = match extents.len() {
            0 => Extent::All,
            1 => extents.remove(0),
            _ => {
                return self.error(
                    item,
                    "[[tie]] has several of `where`, `range`, `points` and `nodes` where one was expected",
                )
            }
        };
        Ok(TieSpec {
            pair,
            extent,
            written: self.written(item),
        })
    }
}
