//! *NSET, *ELSET, *SURFACE, and the groups that they become.

use super::base::{title, DeckReader};
use super::gaps;
use super::ids::Ids;
use super::named::{increasing, DeckSet, Sets, SurfaceGroups};
use super::params::Params;
use crate::cards::{squeeze, Card, DataLine};
use crate::deck_line::{DeckLine, Files, Note};
use crate::numbers::{clip, is_whole};
use base::Result;
use mesh::{Members, MeshGroup};
use std::collections::HashMap;

impl<'a> DeckReader<'a> {
    pub(super) fn nset(&mut self, card: &'a Card) -> Result<()> {
        let (name, generate) = self.set_params(card, "NSET")?;
        let set = self.nsets.open(name, card.place);
        let (files, nodes) = (self.files, std::mem::take(&mut self.nodes));
        let what = ("node", "a node", "node set", "nodes");
        for row in self.cards.rows(card) {
            let found = if generate {
                generated(files, &nodes, &row, what.3)?
            } else {
                listed(files, &nodes, &self.nsets, (set, self.entries), &row, what)?
            };
            self.spend(found.len(), row.place)?;
            self.nsets.sets[set].members.extend(found);
        }
        self.nodes = nodes;
        Ok(())
    }

    pub(super) fn elset(&mut self, card: &'a Card) -> Result<()> {
        let (name, generate) = self.set_params(card, "ELSET")?;
        let set = self.elsets.open(name, card.place);
        let (files, cells) = (self.files, std::mem::take(&mut self.cells));
        let what = ("element", "an element", "element set", "elements");
        for row in self.cards.rows(card) {
            let found = if generate {
                generated(files, &cells, &row, what.3)?
            } else {
                listed(files, &cells, &self.elsets, (set, self.entries), &row, what)?
            };
            self.spend(found.len(), row.place)?;
            self.elsets.sets[set].members.extend(found);
        }
        self.cells = cells;
        Ok(())
    }

    /// The name of a set, and whether its members are generated.
    fn set_params(&self, card: &'a Card, key: &str) -> Result<(&'a str, bool)> {
        let mut params = Params::new(card, self.files);
        let name = params.required(key)?;
        let generate = params.flag("GENERATE");
        params.skip(&["INTERNAL", "UNSORTED"]);
        params.done()?;
        Ok((name, generate))
    }

    pub(super) fn surface(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let name = params.required("NAME")?;
        let of_nodes = match params.value("TYPE") {
            None | Some("ELEMENT") => false,
            Some("NODE") => true,
            Some(other) => {
                return params.error(format!("TYPE={} is neither ELEMENT nor NODE", clip(other)))
            }
        };
        params.skip(&["INTERNAL"]);
        params.done()?;
        if of_nodes {
            let set = self.node_surfaces.open(name, card.place);
            for row in self.cards.rows(card) {
                // Abaqus writes an area behind each set of nodes, which contact with normals does not need.
                row.at_most(self.files, 2, "a surface of nodes")?;
                let found = self.target_nodes(&row, 0)?;
                self.spend(found.len(), row.place)?;
                self.node_surfaces.sets[set].members.extend(found);
            }
        } else {
            let set = self.side_surfaces.open(name, card.place);
            for row in self.cards.rows(card) {
                row.at_most(self.files, 2, "a surface of sides of elements")?;
                let cells = self.target_cells(&row, 0)?;
                let side = self.side(&row, 1, 'S', &cells)?;
                self.spend(cells.len(), row.place)?;
                let sides = cells.into_iter().map(|c| c * 8 + u32::from(side));
                self.side_surfaces.sets[set].members.extend(sides);
            }
        }
        Ok(())
    }

    /// The side that a label such as S3 or P3 in field `k` names, which all `cells` must have.
    pub(super) fn side(&self, row: &DataLine, k: usize, letter: char, cells: &[u32]) -> Result<u8> {
        let label = squeeze(row.field(k));
        let number = label
            .strip_prefix(letter)
            .and_then(|n| n.parse::<u8>().ok());
        let Some(number @ 1..=6) = number else {
            let message = format!(
                "a side is expected in field {}, {letter}1 to {letter}6, but it is '{}'",
                k + 1,
                clip(row.field(k))
            );
            return Err(self.files.error(row.place, message));
        };
        for &cell in cells {
            let kind = self.kind(cell);
            if usize::from(number) > kind.sides().len() {
                let id = self.cell_id(cell);
                let message = format!("element {id}, a {}, has no side {number}", kind.name());
                return Err(self.files.error(row.place, message));
            }
        }
        Ok(number - 1)
    }

    /// The nodes that field `k` names by number or as a set.
    pub(super) fn target_nodes(&self, row: &DataLine, k: usize) -> Result<Vec<u32>> {
        target(
            self.files,
            &self.nodes,
            &self.nsets,
            row,
            k,
            ("node", "a node", "node set"),
        )
    }

    /// The cells that field `k` names by number or as a set.
    pub(super) fn target_cells(&self, row: &DataLine, k: usize) -> Result<Vec<u32>> {
        let what = ("element", "an element", "element set");
        let found = target(self.files, &self.cells, &self.elsets, row, k, what)?;
        self.cells_among(found, row.place)
    }

    /// Makes groups of sets and surfaces, in the order of the file.
    pub(super) fn make_groups(&mut self) {
        let sides = |s: &DeckSet| {
            let mut sides: Vec<(u32, u8)> =
                s.members.iter().map(|m| (m / 8, (m % 8) as u8)).collect();
            sides.sort_unstable();
            sides.dedup();
            vec![Members::Sides(sides)]
        };
        let nodes = |s: &DeckSet| vec![Members::Nodes(increasing(&s.members))];
        let mut groups: Vec<(DeckLine, MeshGroup)> = Vec::new();
        let mut empty: Vec<Note> = Vec::new();
        let mut add = |keyword: &str, sets: &Sets, members: &dyn Fn(&DeckSet) -> Vec<Members>| {
            for set in &sets.sets {
                if set.members.is_empty() {
                    empty.push(Note {
                        keyword: keyword.to_string(),
                        place: set.place,
                        reason: format!("the set {} has no members", set.name),
                    });
                    continue;
                }
                groups.extend(members(set).into_iter().map(|members| {
                    let name = set.name.clone();
                    (set.place, MeshGroup { name, members })
                }));
            }
        };
        let cells = &self.deck.mesh.cells;
        add("*NSET", &self.nsets, &nodes);
        add("*ELSET", &self.elsets, &|s| {
            let mut all = increasing(&s.members);
            all.retain(|&c| c < gaps::FIRST);
            let by_dim = (0..=3).map(|dim| Members::Cells {
                dim,
                cells: (all.iter().copied())
                    .filter(|&c| cells.kind(c as usize).dim() == dim)
                    .collect(),
            });
            let filled =
                |m: &Members| matches!(m, Members::Cells { cells, .. } if !cells.is_empty());
            by_dim.filter(filled).collect()
        });
        add("*SURFACE", &self.node_surfaces, &nodes);
        add("*SURFACE", &self.side_surfaces, &sides);
        groups.sort_by_key(|g| g.0);
        self.deck.mesh.groups = groups.into_iter().map(|g| g.1).collect();
        self.deck.ignored.extend(empty);
    }

    /// The groups that are surfaces.
    pub(super) fn surface_groups(&self) -> SurfaceGroups {
        let mut surfaces = SurfaceGroups {
            nodes: HashMap::new(),
            sides: HashMap::new(),
        };
        for (g, group) in self.deck.mesh.groups.iter().enumerate() {
            match group.members {
                Members::Sides(_) => surfaces.sides.insert(group.name.clone(), g as u32),
                // A node set may have the same name; the surface stands where the reader has it.
                Members::Nodes(ref nodes) => match self.node_surfaces.get(&group.name) {
                    Some(s) if increasing(&s.members) == *nodes => {
                        surfaces.nodes.insert(group.name.clone(), g as u32)
                    }
                    _ => None,
                },
                Members::Cells { .. } => None,
            };
        }
        surfaces
    }

    /// The message about a set that there is not.
    pub(super) fn no_nset<T>(&self, card: &Card, name: &str) -> Result<T> {
        let message = format!("{}: there is no node set {}", title(card), clip(name));
        Err(self.files.error(card.place, message))
    }
}

/// The members from the first number to the last, by steps.
fn generated(files: &Files, ids: &Ids, row: &DataLine, what: &str) -> Result<Vec<u32>> {
    row.at_most(files, 3, "a line of GENERATE")?;
    let first = row.whole(files, 0, "the first number")?;
    let last = row.whole(files, 1, "the last number")?;
    let by = match row.field(2) {
        "" => 1,
        _ => row.whole(files, 2, "the step")?,
    };
    if by == 0 || last < first {
        let message = format!("{what} from {first} to {last} by steps of {by} are none");
        return Err(files.error(row.place, message));
    }
    let range = ids.range(first, last).iter();
    let found: Vec<u32> = range
        .filter(|s| (s.0 - first) % by == 0)
        .map(|s| s.1)
        .collect();
    if found.is_empty() {
        let message = format!("there are no {what} from {first} to {last} by steps of {by}");
        return Err(files.error(row.place, message));
    }
    Ok(found)
}

/// The members that a line lists: numbers, and sets that are defined before. They go into set `into`; a little more
/// than `most` is enough.
fn listed(
    files: &Files,
    ids: &Ids,
    sets: &Sets,
    (into, most): (usize, usize),
    row: &DataLine,
    (one, a_one, set, _): (&str, &str, &str, &str),
) -> Result<Vec<u32>> {
    let mut found = Vec::new();
    for k in 0..row.fields.len() {
        if row.field(k).is_empty() {
            continue;
        }
        let itself = sets.by_name.get(&squeeze(row.field(k))) == Some(&into);
        if !itself && found.len() <= most {
            found.extend(target(files, ids, sets, row, k, (one, a_one, set))?);
        }
    }
    Ok(found)
}

/// The nodes or elements that field `k` names by number or as a set.
fn target(
    files: &Files,
    ids: &Ids,
    sets: &Sets,
    row: &DataLine,
    k: usize,
    (one, a_one, set): (&str, &str, &str),
) -> Result<Vec<u32>> {
    let text = row.field(k);
    if text.is_empty() {
        let message = format!("{a_one} or {set} is expected, but field {} is empty", k + 1);
        return Err(files.error(row.place, message));
    }
    if is_whole(text) {
        let id = row.whole(files, k, &format!("the number of {a_one}"))?;
        return match ids.place(id) {
            Some(place) => Ok(vec![place]),
            None => Err(files.error(row.place, format!("there is no {one} {id}"))),
        };
    }
    match sets.get(&squeeze(text)) {
        Some(found) => Ok(found.members.clone()),
        None => Err(files.error(row.place, format!("there is no {set} {}", clip(text)))),
    }
}
