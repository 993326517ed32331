//! Sets by their names.

use crate::deck_line::DeckLine;
use std::collections::HashMap;

/// Named sets with their members in the order of the deck, in which CalculiX prints them.
#[derive(Default)]
pub(super) struct Sets {
    pub by_name: HashMap<String, usize>,
    pub sets: Vec<DeckSet>,
}

/// A set.
pub(super) struct DeckSet {
    pub name: String,
    pub place: DeckLine,
    pub members: Vec<u32>,
}

impl Sets {
    /// The set of that name, a new one or one that is complemented.
    pub fn open(&mut self, name: &str, place: DeckLine) -> usize {
        let next = self.sets.len();
        let set = *self.by_name.entry(name.to_string()).or_insert(next);
        if set == next {
            self.sets.push(DeckSet {
                name: name.to_string(),
                place,
                members: Vec::new(),
            });
        }
        set
    }

    pub fn add(&mut self, set: usize, member: u32) {
        self.sets[set].members.push(member);
    }

    /// The members of the set of that name; sets without members do not exist, as in CalculiX.
    pub fn get(&self, name: &str) -> Option<&DeckSet> {
        let set = &self.sets[*self.by_name.get(name)?];
        (!set.members.is_empty()).then_some(set)
    }
}

/// The groups that are surfaces, by name: of nodes, of sides.
pub(super) struct SurfaceGroups {
    pub nodes: HashMap<String, u32>,
    pub sides: HashMap<String, u32>,
}

/// Without repetitions.
pub(super) fn increasing(members: &[u32]) -> Vec<u32> {
    let mut members = members.to_vec();
    members.sort_unstable();
    members.dedup();
    members
}
