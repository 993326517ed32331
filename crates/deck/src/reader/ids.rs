//! The numbers of nodes and elements in the file.

use std::collections::HashMap;

/// The places of nodes or cells by their numbers in the file.
#[derive(Default)]
pub(super) struct Ids {
    pub places: HashMap<u64, u32>,
    /// Numbers and places, by increasing numbers.
    sorted: Vec<(u64, u32)>,
}

impl Ids {
    pub fn place(&self, id: u64) -> Option<u32> {
        self.places.get(&id).copied()
    }

    /// Sorts the numbers, for [`range`](Ids::range).
    pub fn sort(&mut self) {
        self.sorted = self.places.iter().map(|(&id, &p)| (id, p)).collect();
        self.sorted.sort_unstable();
    }

    /// Numbers and places of those from `first` to `last`.
    pub fn range(&self, first: u64, last: u64) -> &[(u64, u32)] {
        let start = self.sorted.partition_point(|s| s.0 < first);
        let end = self.sorted.partition_point(|s| s.0 <= last);
        &self.sorted[start..end.max(start)]
    }
}
