//! Physical groups: their names and their cells.

use super::scan::{quoted, Scan, Width};
use crate::{Members, MeshGroup};
use base::Result;
use std::collections::HashMap;

/// The names that the file gives to physical groups.
#[derive(Default)]
pub(super) struct GroupNames(Vec<Name>);

struct Name {
    at: usize,
    /// The dimension of the cells; format 2.0 does not tell.
    dim: Option<usize>,
    tag: u64,
    name: String,
}

impl GroupNames {
    /// Reads the section $PhysicalNames, which is text in binary files, too.
    pub fn read(scan: &mut Scan, with_dim: bool) -> Result<GroupNames> {
        let count = scan.count_line("the number of physical names", 4)?;
        let mut names = GroupNames::default();
        let mut seen = HashMap::new();
        for _ in 0..count {
            let (at, line) = scan.line();
            let Some(name) = parse(at, line, with_dim) else {
                let form = if with_dim {
                    "dimension, number"
                } else {
                    "number"
                };
                return Err(scan.fail(
                    at,
                    format!(
                        "found {} where a physical group was expected: {form} and a name of UTF-8, such as \"steel\"",
                        quoted(line)
                    ),
                ));
            };
            if let Some(first) = seen.insert((name.dim, name.tag), at) {
                let (tag, first) = (name.tag, scan.place(first));
                let message = format!("physical group {tag} has a second name here, after {first}");
                return Err(scan.fail(at, message));
            }
            names.0.push(name);
        }
        scan.end("PhysicalNames")?;
        Ok(names)
    }
}

/// A line such as `2 5 "steel"`. Some programs write the name without quotes.
fn parse(at: usize, line: &[u8], with_dim: bool) -> Option<Name> {
    let line = std::str::from_utf8(line).ok()?;
    let (numbers, name) = match line.split_once('"') {
        Some((numbers, rest)) => {
            let (name, after) = rest.split_once('"')?;
            if !after.trim().is_empty() {
                return None;
            }
            (numbers.split_whitespace().collect(), name)
        }
        None => bare(line, with_dim)?,
    };
    let (dim, tag) = match numbers[..] {
        [dim, tag] => (Some(dim.parse().ok().filter(|&d: &usize| d <= 3)?), tag),
        [tag] if !with_dim => (None, tag),
        _ => return None,
    };
    let tag = tag.parse().ok().filter(|&t: &u64| t > 0)?;
    let name = name.to_string();
    Some(Name { at, dim, tag, name })
}

/// The numbers before a name without quotes, and the name. Where the dimension may be missing, two numbers before a
/// word are dimension and number.
fn bare(line: &str, with_dim: bool) -> Option<(Vec<&str>, &str)> {
    let mut rest = line.trim();
    let mut numbers = Vec::new();
    while let Some((word, after)) = rest.split_once(char::is_whitespace) {
        if numbers.len() == 2 || word.parse::<u64>().is_err() {
            break;
        }
        numbers.push(word);
        rest = after.trim_start();
    }
    let enough = if with_dim { 2 } else { 1 };
    (numbers.len() >= enough && !rest.is_empty()).then_some((numbers, rest))
}

/// The cells of each physical group, by dimension and number.
#[derive(Default)]
pub(super) struct PhysicalGroups {
    places: HashMap<(usize, u64), usize>,
    list: Vec<((usize, u64), Vec<u32>)>,
}

impl PhysicalGroups {
    /// Adds cells behind those that the group has.
    pub fn add(&mut self, dim: usize, tag: u64, cells: std::ops::Range<u32>) {
        self.of(dim, tag).extend(cells);
    }

    fn of(&mut self, dim: usize, tag: u64) -> &mut Vec<u32> {
        let key = (dim, tag);
        let place = *self.places.entry(key).or_insert(self.list.len());
        if place == self.list.len() {
            self.list.push((key, Vec::new()));
        }
        &mut self.list[place].1
    }

    /// The groups under their names: first those that have one, in the order of the names, also where they are empty;
    /// then the others. Groups of one dimension and one name are one group.
    pub fn name(mut self, scan: &Scan, names: &GroupNames) -> Result<Vec<MeshGroup>> {
        let mut groups: Vec<MeshGroup> = Vec::new();
        let mut named: HashMap<(usize, String), usize> = HashMap::new();
        for name in names.0.iter().filter(|n| !n.name.is_empty()) {
            let dims = name.dim.map_or(0..4, |d| d..d + 1);
            for dim in dims {
                let key = (dim, name.tag);
                if name.dim.is_none() && !self.places.contains_key(&key) {
                    continue;
                }
                let cells = std::mem::take(self.of(dim, name.tag));
                self.places.remove(&key);
                match named.entry((dim, name.name.clone())) {
                    std::collections::hash_map::Entry::Vacant(entry) => {
                        entry.insert(groups.len());
                        groups.push(group(name.name.clone(), dim, cells));
                    }
                    std::collections::hash_map::Entry::Occupied(entry) => {
                        join(&mut groups[*entry.get()], cells);
                    }
                }
            }
        }
        for ((dim, tag), cells) in self.list {
            if !self.places.contains_key(&(dim, tag)) {
                continue;
            }
            let number = tag.to_string();
            if named.contains_key(&(dim, number.clone())) {
                let at = names.0.iter().find(|n| n.name == number).map(|n| n.at);
                let message =
                    format!("\"{tag}\" names one physical group and is the number of another");
                return Err(scan.fail(at.unwrap_or(0), message));
            }
            groups.push(group(number, dim, cells));
        }
        Ok(groups)
    }
}

fn group(name: String, dim: usize, cells: Vec<u32>) -> MeshGroup {
    let members = Members::Cells { dim, cells };
    MeshGroup { name, members }
}

/// Adds cells to a group, which stays in increasing order.
fn join(group: &mut MeshGroup, more: Vec<u32>) {
    if let Members::Cells { cells, .. } = &mut group.members {
        cells.extend(more);
        cells.sort_unstable();
        cells.dedup();
    }
}

/// Reads the number of a physical group; the sign is the orientation of its cells, and 0 is no group.
pub(super) fn tag(scan: &mut Scan) -> Result<Option<u64>> {
    let tag = scan.whole(Width::Four, "the number of a physical group")?;
    Ok(Some(tag.unsigned_abs()).filter(|&t| t > 0))
}
