//! Where the subdomains of a rank have the entries of B_gl: switched rows find theirs again.

/// The place of an entry of a row.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct EntryLocation {
    /// Local subdomain.
    pub subdomain: u32,
    /// Its dof.
    pub dof: u32,
    /// The entry in the lists of the subdomain.
    pub entry: u32,
}

/// The places of all entries, by ghost row.
#[derive(Debug, Clone, Default)]
pub(super) struct EntryPlaces {
    /// Where the places of each row begin, and the end.
    start: Vec<u32>,
    places: Vec<EntryLocation>,
}

impl EntryPlaces {
    /// Sorts places of `n` rows, given with their rows.
    pub fn new(n: usize, given: &[(u32, EntryLocation)]) -> EntryPlaces {
        let mut start = vec![0u32; n + 1];
        for (row, _) in given {
            start[*row as usize + 1] += 1;
        }
        for row in 0..n {
            start[row + 1] += start[row];
        }
        let mut next = start.clone();
        let mut places = vec![EntryLocation::default(); given.len()];
        for (row, place) in given {
            let at = &mut next[*row as usize];
            places[*at as usize] = *place;
            *at += 1;
        }
        EntryPlaces { start, places }
    }

    /// The entry of a ghost row at a dof of a local subdomain, in the lists of the subdomain.
    ///
    /// # Panics
    /// If there is none.
    pub fn entry(&self, row: usize, subdomain: u32, dof: u32) -> usize {
        let of_row = self.start[row] as usize..self.start[row + 1] as usize;
        let mut of_row = self.places[of_row].iter();
        let found = of_row.find(|p| (p.subdomain, p.dof) == (subdomain, dof));
        found.expect("the entry was there before").entry as usize
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/jump/entry_locations.rs"]
mod tests;
