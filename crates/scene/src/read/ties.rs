//! [interface], [[tie]] and [[contact]].

use super::document::{Item, TableSection, Value};
use super::groups::sides_of;
use super::SceneReader;
use crate::model::body::BodySpec;
use crate::model::joints::{AutoContact, ContactSpec, Extent, PairSelector, TieSpec};
use crate::model::profile::Profile;
use crate::model::spec::ByDefault;
use base::Result;
use mesh::SideGroup;

impl SceneReader {
    pub(super) fn interface(&self, item: &Item) -> Result<ByDefault> {
        let mut section = item.section("[interface]")?;
        let words = [
            ("tied", ByDefault::Tied),
            ("free", ByDefault::Free),
            ("contact", ByDefault::Contact),
        ];
        let default = section.read("default", |item| item.choice(&words))?;
        section.finish()?;
        Ok(default.unwrap_or_default())
    }

    pub(super) fn tie(&self, item: &Item, bodies: &[BodySpec]) -> Result<TieSpec> {
        let mut section = item.section("[[tie]]")?;
        let pair = self.pair_of(&mut section, bodies)?;
        let sides = section.read("sides", |item| self.pair_of_sides(item, &pair, bodies))?;
        let multipliers = section.read("multipliers", |item| which(item, &pair))?;
        let adjust = section.read("adjust", |item| self.positive(item))?;
        let tolerance = section.read("position_tolerance", |item| self.positive(item))?;
        let mut extent = self.extent(&mut section, item, "[[tie]]")?;
        section.finish()?;
        if let Some(tolerance) = tolerance {
            if sides.is_none() && !matches!(pair, PairSelector::Surfaces(..)) {
                return item.error(
                    "`position_tolerance` without `surfaces` or `sides` (bodies that touch are tied where they touch)",
                );
            }
            if extent != Extent::All {
                return item.error(
                    "`position_tolerance` together with `where`, `range`, `points` or `nodes` where one was expected",
                );
            }
            extent = Extent::Within {
                distance: tolerance,
                singly: false,
            };
        }
        Ok(TieSpec {
            pair,
            sides,
            extent,
            multipliers,
            adjust: adjust.unwrap_or(0.0),
            location: item.location(),
        })
    }

    pub(super) fn contact(&self, item: &Item, bodies: &[BodySpec]) -> Result<ContactSpec> {
        let mut section = item.section("[[contact]]")?;
        let pair = self.pair_of(&mut section, bodies)?;
        let sides = section.read("sides", |item| self.pair_of_sides(item, &pair, bodies))?;
        let multipliers = section.read("multipliers", |item| which(item, &pair))?;
        let adjust = section.read("adjust", |item| self.positive(item))?;
        let distance = section.read("distance", |item| self.positive(item))?;
        let extent = self.extent(&mut section, item, "[[contact]]")?;
        let gap = section.read("gap", |item| self.profile(item))?;
        let law = self.law(&mut section)?;
        let ramp = self.ramp(&mut section)?;
        section.finish()?;
        Ok(ContactSpec {
            pair,
            sides,
            extent,
            gap: gap.unwrap_or_else(|| Profile::constant(0.0)),
            distance,
            multipliers,
            adjust: adjust.unwrap_or(0.0),
            adjusted: Vec::new(),
            opposed: None,
            law,
            ramp,
            location: item.location(),
        })
    }

    /// [contact] with `auto`, or the list [[contact]].
    pub(super) fn contacts(
        &self,
        scene: &mut TableSection,
        bodies: &[BodySpec],
    ) -> Result<(Option<AutoContact>, Vec<ContactSpec>)> {
        match scene.tables("contact")? {
            [one] if one.section("[contact]")?.entry("auto").is_some() => {
                Ok((self.auto(one)?, Vec::new()))
            }
            list => {
                let list: Result<_> = list.iter().map(|item| self.contact(item, bodies)).collect();
                Ok((None, list?))
            }
        }
    }

    fn auto(&self, item: &Item) -> Result<Option<AutoContact>> {
        let mut section = item.section("[contact]")?;
        let auto = section.read("auto", |item| match item.value {
            Value::Truth(v) => Ok(v),
            _ => item.expected("true or false"),
        })?;
        let distance = section.read("distance", |item| self.positive(item))?;
        let adjust = section.read("adjust", |item| self.positive(item))?;
        let law = self.law(&mut section)?;
        section.finish()?;
        Ok((auto == Some(true)).then(|| AutoContact {
            distance,
            adjust: adjust.unwrap_or(0.0),
            law,
            location: item.location(),
        }))
    }

    /// `bodies`, or `surfaces` of meshes.
    fn pair_of(&self, section: &mut TableSection, bodies: &[BodySpec]) -> Result<PairSelector> {
        let Some(item) = section.take("surfaces") else {
            return self.bodies(section, bodies);
        };
        if let Some(both) = section.take("bodies") {
            return both.error("both `surfaces` and `bodies` are given where one was expected");
        }
        let name = |item: &Item| {
            let name = item.text("the name of a boundary group")?;
            let has = |b: &&BodySpec| {
                b.mesh
                    .cells()
                    .is_some_and(|_| b.mesh.side_of_name(&name).is_some())
            };
            if !bodies.iter().any(|b| has(&b)) {
                let of_cells = bodies.iter().filter(|b| b.mesh.cells().is_some());
                return item.error(match of_cells.clone().next() {
                    None => format!("the boundary group `{name}` in a scene without a mesh"),
                    Some(_) => format!(
                        "the boundary group `{name}`, which no body of the mesh has (groups are {})",
                        sides_of(of_cells)
                    ),
                });
            }
            if bodies.iter().any(|b| has_faces(b, &name)) {
                Ok(name)
            } else {
                item.error(self.no_faces(&name))
            }
        };
        match item.list("a pair of boundary groups")? {
            [a, b] => Ok(PairSelector::Surfaces(name(a)?, name(b)?)),
            _ => item.expected("a pair of boundary groups"),
        }
    }

    /// A sentence on a boundary group that is no surface.
    fn no_faces(&self, name: &str) -> String {
        let (faces, others) = match self.dim {
            2 => ("edges", "points"),
            _ => ("faces", "points or edges"),
        };
        format!(
            "the boundary group `{name}` of {others} alone where {faces} of a body were expected"
        )
    }

    /// The sides of two named bodies.
    fn pair_of_sides(
        &self,
        item: &Item,
        pair: &PairSelector,
        bodies: &[BodySpec],
    ) -> Result<[usize; 2]> {
        let PairSelector::Named(first, second) = pair else {
            return item.error("`sides` for all pairs, where two named bodies were expected");
        };
        let side = |item: &Item, name: &String| {
            let body = bodies.iter().find(|b| b.name == *name);
            match body.filter(|b| b.mesh.cells().is_some()) {
                None => self.side(item),
                Some(body) => {
                    let side = item.text("the name of a boundary group")?;
                    match body.mesh.side_of_name(&side) {
                        Some(found) if has_faces(body, &side) => Ok(found),
                        Some(_) => item.error(self.no_faces(&side)),
                        None => item.error(format!(
                            "the boundary group `{side}`, which body `{name}` does not have (groups are {})",
                            sides_of([body])
                        )),
                    }
                }
            }
        };
        match item.list("a pair of sides")? {
            [a, b] => Ok([side(a, first)?, side(b, second)?]),
            _ => item.expected("a pair of sides"),
        }
    }

    /// `bodies`: "all" or a pair.
    fn bodies(&self, section: &mut TableSection, bodies: &[BodySpec]) -> Result<PairSelector> {
        let wanted = "\"all\" or a pair of names";
        let named = section.need("bodies", wanted)?;
        match &named.value {
            _ if named.is("all") => Ok(PairSelector::All),
            Value::List(items) if items.len() == 2 => {
                let name = |k: usize| body_name(&items[k], bodies, "the name of a body");
                Ok(PairSelector::Named(name(0)?, name(1)?))
            }
            _ => named.expected(wanted),
        }
    }

    /// One range of t in the plane; on the face of a solid one for each parameter, or one for the first of them.
    fn range(&self, item: &Item) -> Result<[[f64; 2]; 2]> {
        let one = |item: &Item| -> Result<[f64; 2]> {
            let [low, high] = self.pair(item, "a pair of numbers between 0 and 1")?;
            if !(0.0 <= low && low <= high && high <= 1.0) {
                return item.error(format!(
                    "the range [{low}, {high}] where 0 ≤ t0 ≤ t1 ≤ 1 was expected"
                ));
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

    /// `where`, `range`, `points` or `nodes`.
    pub(super) fn extent(
        &self,
        section: &mut TableSection,
        entry: &Item,
        what: &str,
    ) -> Result<Extent> {
        let mut extents = Vec::new();
        extents.extend(section.read("where", |item| match &item.value {
            _ if item.is("all") => Ok(Extent::All),
            _ if item.is("none") => Ok(Extent::None),
            _ => item.expected("\"all\" or \"none\" (or the key `range`, `points` or `nodes`)"),
        })?);
        extents.extend(section.read("range", |item| Ok(Extent::Range(self.range(item)?)))?);
        extents.extend(section.read("points", |item| {
            let point = |i: &Item| match self.dim {
                2 => Ok([self.number(i)?, 0.0]),
                _ => self.pair(i, "a pair of numbers between 0 and 1"),
            };
            let list = item.list("a list of numbers between 0 and 1")?.iter();
            Ok(Extent::Points(list.map(point).collect::<Result<_>>()?))
        })?);
        extents.extend(section.read("nodes", |item| {
            let node = |item: &Item| match item.value {
                Value::Integer(v) if v >= 0 => Ok(v as usize),
                _ => item.expected("a node number, counted from 0,"),
            };
            let list = item.list("a list of node numbers")?.iter();
            Ok(Extent::Nodes(list.map(node).collect::<Result<_>>()?))
        })?);
        match extents.len() {
            0 => Ok(Extent::All),
            1 => Ok(extents.remove(0)),
            _ => entry.error(format!(
                "{what} has several of `where`, `range`, `points` and `nodes` where one was expected"
            )),
        }
    }
}

/// The pairs of sides that entries name, as far as they can be read.
pub(super) fn named_sides<'a>(entries: impl Iterator<Item = &'a Item<'a>>) -> Vec<[String; 2]> {
    let pair = |entry: &'a Item<'a>| {
        let Value::Table(keys) = &entry.value else {
            return None;
        };
        let named = |k: &&(String, usize, Item<'a>)| k.0 == "surfaces" || k.0 == "sides";
        match &keys.iter().find(named)?.2.value {
            Value::List(list) => match &list[..] {
                [a, b] => Some([a.text("").ok()?, b.text("").ok()?]),
                _ => None,
            },
            _ => None,
        }
    };
    entries.filter_map(pair).collect()
}

/// Whether the boundary group of a body has faces.
fn has_faces(body: &BodySpec, name: &str) -> bool {
    let of_name = |s: &&SideGroup| s.name == name;
    let mesh = body.mesh.cells();
    let group = mesh.and_then(|mesh| mesh.sides.iter().find(of_name));
    group.is_some_and(|group| !group.faces.is_empty())
}

/// `multipliers`: the one of two bodies or surfaces that carries them.
fn which(item: &Item, pair: &PairSelector) -> Result<usize> {
    let (PairSelector::Named(a, b) | PairSelector::Surfaces(a, b)) = pair else {
        return item.error("`multipliers` for all pairs, where two names were expected");
    };
    match [a, b].iter().position(|name| item.is(name)) {
        Some(k) => Ok(k),
        None => item.expected(format!("`{a}` or `{b}`")),
    }
}

/// A body by name or number.
pub(super) fn body_name(item: &Item, bodies: &[BodySpec], wanted: &str) -> Result<String> {
    match &item.value {
        Value::Text(name) => Ok(name.clone()),
        Value::Integer(k) => match bodies.get(usize::try_from(*k).unwrap_or(usize::MAX)) {
            Some(body) => Ok(body.name.clone()),
            None => item.error(format!(
                "body {k} where a number below {} was expected",
                bodies.len()
            )),
        },
        _ => item.expected(wanted),
    }
}
