//! [interface], [[tie]], [[contact]] and [[obstacle]].

use super::document::{Item, Section, Value};
use super::Reader;
use crate::error::Result;
use crate::scene::model::profile::Profile;
use crate::scene::model::spec::{
    BodySpec, ByDefault, ContactSpec, Extent, ObstacleSpec, Pair, TieSpec,
};

impl<'a> Reader<'a> {
    pub(super) fn interface(&self, item: &'a Item) -> Result<ByDefault> {
        let mut section = Section::new(self.source, "[interface]", item)?;
        let default = match section.take("default") {
            None => ByDefault::Tied,
            Some(item) => match &item.value {
                Value::Text(t) if t == "tied" => ByDefault::Tied,
                Value::Text(t) if t == "free" => ByDefault::Free,
                Value::Text(t) if t == "contact" => ByDefault::Contact,
                _ => return self.expected(item, "\"tied\", \"free\" or \"contact\""),
            },
        };
        section.finish()?;
        Ok(default)
    }

    pub(super) fn tie(&self, item: &'a Item, bodies: &[BodySpec]) -> Result<TieSpec> {
        let mut section = Section::new(self.source, "[[tie]]", item)?;
        let pair = self.bodies(&mut section, bodies)?;
        let extent = self.extent(&mut section, item, "[[tie]]")?;
        section.finish()?;
        Ok(TieSpec {
            pair,
            extent,
            written: self.written(item),
        })
    }

    pub(super) fn contact(&self, item: &'a Item, bodies: &[BodySpec]) -> Result<ContactSpec> {
        let mut section = Section::new(self.source, "[[contact]]", item)?;
        let pair = self.bodies(&mut section, bodies)?;
        let sides = match section.take("sides") {
            None => None,
            Some(item) => match (self.list(item, "a pair of sides")?, &pair) {
                (_, Pair::All) => {
                    return self.error(
                        item,
                        "`sides` for all pairs, where two named bodies were expected",
                    )
                }
                ([a, b], _) => Some([self.side(a)?, self.side(b)?]),
                _ => return self.expected(item, "a pair of sides"),
            },
        };
        let extent = self.extent(&mut section, item, "[[contact]]")?;
        let gap = match section.take("gap") {
            Some(item) => self.profile(item)?,
            None => Profile::constant(0.0),
        };
        let ramp = self.ramp(&mut section)?;
        section.finish()?;
        Ok(ContactSpec {
            pair,
            sides,
            extent,
            gap,
            ramp,
            written: self.written(item),
        })
    }

    pub(super) fn obstacle(&self, item: &'a Item, bodies: &[BodySpec]) -> Result<ObstacleSpec> {
        let mut section = Section::new(self.source, "[[obstacle]]", item)?;
        let wanted = "\"all\" or the name of a body";
        let named = section.need("body", wanted)?;
        let body = match &named.value {
            Value::Text(text) if text == "all" => None,
            _ => Some(self.body_name(named, bodies, wanted)?),
        };
        let sides =
            self.obstacle_sides(section.need("side", "a side, a list of them or \"all\"")?)?;
        let extent = self.extent(&mut section, item, "[[obstacle]]")?;
        let mut bound = |key| section.take(key).map(|item| self.profile(item)).transpose();
        let elastic = self.form.is_elastic();
        let (below, above, gap, rigid) = if elastic {
            (None, None, bound("gap")?, self.rigid(&mut section, item)?)
        } else {
            (bound("below")?, bound("above")?, None, None)
        };
        let ramp = self.ramp(&mut section)?;
        section.finish()?;
        if below.is_none() && above.is_none() && rigid.is_none() {
            return self.error(
                item,
                if elastic {
                    "[[obstacle]] without a rigid body (`plane`, `cylinder` or `sphere` was expected)"
                } else {
                    "[[obstacle]] without a bound (`below`, `above` or both were expected)"
                },
            );
        }
        Ok(ObstacleSpec {
            body,
            sides,
            extent,
            below,
            above,
            rigid,
            gap: gap.unwrap_or_else(|| Profile::constant(0.0)),
            ramp,
            written: self.written(item),
        })
    }

    fn obstacle_sides(&self, item: &'a Item) -> Result<Vec<usize>> {
        let names = self.sides_list().replace(" or ", ", ");
        let wanted = format!("{names}, a list of them or \"all\"");
        let side = |item: &Item| self.side(item).or_else(|_| self.expected(item, &wanted));
        match &item.value {
            Value::Text(text) if text == "all" => Ok((0..2 * self.dim).collect()),
            Value::List(items) if !items.is_empty() => {
                let mut sides = items.iter().map(side).collect::<Result<Vec<usize>>>()?;
                sides.sort_unstable();
                sides.dedup();
                Ok(sides)
            }
            _ => Ok(vec![side(item)?]),
        }
    }

    /// `bodies`: "all" or a pair.
    fn bodies(&self, section: &mut Section<'a>, bodies: &[BodySpec]) -> Result<Pair> {
        let wanted = "\"all\" or a pair of names";
        let named = section.need("bodies", wanted)?;
        match &named.value {
            Value::Text(text) if text == "all" => Ok(Pair::All),
            Value::List(items) => match items.as_slice() {
                [first, second] => {
                    let name = |item| self.body_name(item, bodies, "the name of a body");
                    Ok(Pair::Named(name(first)?, name(second)?))
                }
                _ => self.expected(named, wanted),
            },
            _ => self.expected(named, wanted),
        }
    }

    /// A body by name or number.
    fn body_name(&self, item: &Item, bodies: &[BodySpec], wanted: &str) -> Result<String> {
        match &item.value {
            Value::Text(name) => Ok(name.clone()),
            Value::Integer(k) => match bodies.get(usize::try_from(*k).unwrap_or(usize::MAX)) {
                Some(body) => Ok(body.name.clone()),
                None => self.error(
                    item,
                    format_args!(
                        "body {k} where a number below {} was expected",
                        bodies.len()
                    ),
                ),
            },
            _ => self.expected(item, wanted),
        }
    }

    /// `where`, `range`, `points` or `nodes`.
    /// One range of t in the plane; on the face of a solid one for each parameter, or one for the first of them.
    fn range(&self, item: &'a Item) -> Result<[[f64; 2]; 2]> {
        let one = |item: &'a Item| -> Result<[f64; 2]> {
            let [low, high] = self.pair(item, "a pair of numbers between 0 and 1")?;
            if !(0.0 <= low && low <= high && high <= 1.0) {
                return self.error(
                    item,
                    format_args!("the range [{low}, {high}] where 0 ≤ t0 ≤ t1 ≤ 1 was expected"),
                );
            }
            Ok([low, high])
        };
        match &item.value {
            Value::List(list) if self.dim == 3 => match list.as_slice() {
                [a, b] if matches!(a.value, Value::List(_)) => Ok([one(a)?, one(b)?]),
                _ => Ok([one(item)?, [0.0, 1.0]]),
            },
            _ => Ok([one(item)?, [0.0, 1.0]]),
        }
    }

    fn extent(&self, section: &mut Section<'a>, entry: &Item, what: &str) -> Result<Extent> {
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
            extents.push(Extent::Range(self.range(item)?));
        }
        if let Some(item) = section.take("points") {
            let list = self.list(item, "a list of numbers between 0 and 1")?;
            let point = |i: &'a Item| match self.dim {
                2 => Ok([self.number(i)?, 0.0]),
                _ => self.pair(i, "a pair of numbers between 0 and 1"),
            };
            let points: Result<Vec<[f64; 2]>> = list.iter().map(point).collect();
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
        match extents.len() {
            0 => Ok(Extent::All),
            1 => Ok(extents.remove(0)),
            _ => self.error(
                entry,
                format_args!(
                    "{what} has several of `where`, `range`, `points` and `nodes` where one was expected"
                ),
            ),
        }
    }
}
