//! Copies of a body, and what only some of them have.

use super::document::{Item, TableSection, Value};
use super::placements::Placement;
use super::SceneReader;
use crate::model::body::BodySpec;
use base::Result;
use std::collections::HashMap;

/// The copies that an entry [[body.only]] means.
struct Selector {
    /// Numbers, by first and last, and names, in which `*` stands for any text.
    numbers: Vec<[usize; 2]>,
    names: Vec<String>,
    /// Whether neither numbers nor names are given.
    all: bool,
    /// Where they stand, by coordinate.
    ranges: [Option<[f64; 2]>; 3],
}

impl Selector {
    fn selects(&self, number: usize, placement: &Placement, full: &str) -> bool {
        let named = |pattern: &String| {
            let own = placement.name.as_deref();
            fits(pattern, full) || own.is_some_and(|own| fits(pattern, own))
        };
        let numbered = |[first, last]: &[usize; 2]| (*first..=*last).contains(&number);
        let within = |range: &Option<[f64; 2]>, v: f64| {
            range.is_none_or(|[low, high]| low <= v && v <= high)
        };
        let mut places = self.ranges.iter().zip(placement.motion.shift);
        (self.all || self.numbers.iter().any(numbered) || self.names.iter().any(named))
            && places.all(|(range, v)| within(range, v))
    }
}

/// Whether a text is a name with `*` in the place of any text.
pub(super) fn fits(pattern: &str, text: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = text.strip_prefix(first) else {
        return false;
    };
    let parts: Vec<&str> = parts.collect();
    let Some((last, between)) = parts.split_last() else {
        return rest.is_empty();
    };
    for part in between {
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => return false,
        }
    }
    rest.ends_with(last)
}

impl SceneReader {
    /// The copies of a body, named `name[k]`, or as their placements say. `read` changes a body by the conditions of an
    /// entry `only`.
    pub(super) fn copies(
        &self,
        body: &BodySpec,
        placements: &[Placement],
        only: &[Item],
        read: impl Fn(&mut TableSection, &mut BodySpec) -> Result<()>,
    ) -> Result<Vec<BodySpec>> {
        let selectors: Vec<Selector> = only
            .iter()
            .map(|item| {
                let selector = self.selector(&mut item.section(ONLY)?)?;
                let mut numbers = selector.numbers.iter();
                match numbers.find(|range| range[1] >= placements.len()) {
                    Some([_, last]) => item.error(format!(
                        "copy {last} of body `{}` where a number below {} was expected",
                        body.name,
                        placements.len()
                    )),
                    None => Ok(selector),
                }
            })
            .collect::<Result<_>>()?;
        let mut used = vec![false; only.len()];
        // Copies that the same entries mean have the same conditions, which are read once.
        let mut known: HashMap<Vec<usize>, BodySpec> = HashMap::new();
        let mut out = Vec::with_capacity(placements.len());
        for (number, placement) in placements.iter().enumerate() {
            let own = placement.name.clone();
            let name = own.unwrap_or_else(|| format!("{}[{number}]", body.name));
            let means = |&k: &usize| selectors[k].selects(number, placement, &name);
            let entries: Vec<usize> = (0..only.len()).filter(means).collect();
            entries.iter().for_each(|&k| used[k] = true);
            if !known.contains_key(&entries) {
                let mut changed = body.clone();
                for &k in &entries {
                    let mut section = only[k].section(ONLY)?;
                    self.selector(&mut section)?;
                    read(&mut section, &mut changed)?;
                    section.finish()?;
                }
                known.insert(entries.clone(), changed);
            }
            let mut copy = known[&entries].placed(name, &placement.motion);
            copy.location = placement.location.clone();
            out.push(copy);
        }
        match used.iter().position(|used| !used) {
            Some(k) => only[k].error(format!(
                "{ONLY} means no copy of body `{}` (one at least was expected)",
                body.name
            )),
            None => Ok(out),
        }
    }

    /// The keys that say which copies are meant.
    fn selector(&self, section: &mut TableSection) -> Result<Selector> {
        let mut selector = Selector {
            numbers: Vec::new(),
            names: Vec::new(),
            all: true,
            ranges: [None; 3],
        };
        if let Some(item) = section.take("instances") {
            selector.all = false;
            match &item.value {
                Value::List(items) => {
                    let mut each = items.iter();
                    each.try_for_each(|item| selected(item, &mut selector))?;
                }
                _ => selected(item, &mut selector)?,
            }
        }
        selector.ranges = self.by_axis(section, |item| {
            match self.pair(item, "a pair of numbers")? {
                [low, high] if low <= high => Ok([low, high]),
                [low, high] => item.error(format!("the empty range [{low}, {high}]")),
            }
        })?;
        Ok(selector)
    }
}

/// The name of an entry in messages.
const ONLY: &str = "[[body.only]]";

/// A number, a range of numbers "3..7" with both ends, or a name with `*` for any text.
fn selected(item: &Item, selector: &mut Selector) -> Result<()> {
    const WANTED: &str = "the number of a copy, a range \"first..last\" or a name";
    match &item.value {
        Value::Integer(k) if *k >= 0 => selector.numbers.push([*k as usize; 2]),
        Value::Text(text) => match text.split_once("..") {
            Some((first, last)) => match (first.trim().parse(), last.trim().parse()) {
                (Ok(first), Ok(last)) if first <= last => selector.numbers.push([first, last]),
                _ => return item.expected(WANTED),
            },
            None => selector.names.push(text.clone()),
        },
        _ => return item.expected(WANTED),
    }
    Ok(())
}

/// The error of `only` without copies.
pub(super) fn none_to_select<T>(only: &[Item]) -> Result<T> {
    only[0].error(format!(
        "{ONLY} in a body without `instances`, where there are no copies to select from"
    ))
}
