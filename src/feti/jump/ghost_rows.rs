//! The rows that a rank sees: its own, and those of other ranks that touch its subdomains.

use super::blocks::JumpBlockEntry;
use base::linalg::sorted::distinct;

/// The rows that have entries, numbered upwards: a table for the rank's own rows, a list for the few others.
pub(super) struct GhostRows {
    first: u32,
    /// For each owned row, its place among the owned rows that are seen and whether it is a row of B_gl; `None` if it
    /// has no entry.
    own: Vec<Option<(u32, bool)>>,
    n_own: u32,
    /// The other rows, increasing, and the number of them before the owned ones.
    others: Vec<(u32, bool)>,
    before: u32,
}

impl GhostRows {
    pub fn new(first: usize, n_owned: usize, entries: &[JumpBlockEntry]) -> GhostRows {
        let first = first as u32;
        let mut own = vec![None; n_owned];
        let mut others = Vec::new();
        for e in entries {
            match own.get_mut(e.row.wrapping_sub(first) as usize) {
                Some(seen) => *seen = Some((0, e.is_contact())),
                None => others.push((e.row, e.is_contact())),
            }
        }
        let others = distinct(others);
        let before = others.partition_point(|o| o.0 < first) as u32;
        let mut n_own = 0;
        for seen in own.iter_mut().flatten() {
            seen.0 = n_own;
            n_own += 1;
        }
        GhostRows {
            first,
            own,
            n_own,
            others,
            before,
        }
    }

    /// (row, whether it is a row of B_gl), increasing.
    pub fn all(&self) -> impl Iterator<Item = (u32, bool)> + '_ {
        let (below, above) = self.others.split_at(self.before as usize);
        let own = (self.first..).zip(&self.own);
        let own = own.filter_map(|(row, seen)| Some((row, (*seen)?.1)));
        below
            .iter()
            .copied()
            .chain(own)
            .chain(above.iter().copied())
    }

    /// The place of a row among all of them.
    ///
    /// # Panics
    /// If the row has no entry.
    pub fn place(&self, row: u32) -> u32 {
        let here = self.own.get(row.wrapping_sub(self.first) as usize);
        if let Some(seen) = here {
            return self.before + seen.expect("an entry is in the row").0;
        }
        let at = self.others.binary_search_by_key(&row, |o| o.0);
        let at = at.expect("an entry is in the row") as u32;
        at + if row < self.first { 0 } else { self.n_own }
    }
}
