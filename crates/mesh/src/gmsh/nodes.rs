//! The nodes of a file, found by their numbers.

use super::scan::Scan;
use base::Result;

/// The nodes in the order of the file.
#[derive(Default)]
pub(super) struct Nodes {
    pub ids: Vec<u64>,
    pub points: Vec<[f64; 3]>,
    /// Where each stands in the file.
    at: Vec<usize>,
    find: Find,
}

/// How a number becomes a place in the list.
enum Find {
    /// The numbers from `first` on; [`NONE`] where there is no node.
    Dense { first: u64, places: Vec<u32> },
    /// Numbers and places, by increasing number.
    Sorted(Vec<(u64, u32)>),
}

impl Default for Find {
    fn default() -> Find {
        Find::Sorted(Vec::new())
    }
}

const NONE: u32 = u32::MAX;

impl Nodes {
    /// Room for as many more.
    pub fn reserve(&mut self, n: usize) {
        self.ids.reserve(n);
        self.points.reserve(n);
        self.at.reserve(n);
    }

    /// The number of a node at `at`; its point follows, maybe after other numbers.
    pub fn number(&mut self, at: usize, id: u64) {
        self.ids.push(id);
        self.at.push(at);
    }

    /// Makes ready to find them. No number may occur twice.
    pub fn index(&mut self, scan: &Scan) -> Result<()> {
        self.find = self.sort();
        let twice = match &self.find {
            Find::Dense { first, places } => {
                let place = |id: u64| places[(id - first) as usize] as usize;
                let mut ids = self.ids.iter().enumerate();
                // The last of two nodes has the place.
                ids.find(|&(k, &id)| place(id) != k)
                    .map(|(k, &id)| (k, place(id)))
            }
            Find::Sorted(sorted) => {
                let mut pairs = sorted.windows(2);
                let same = pairs.find(|w| w[0].0 == w[1].0);
                same.map(|w| (w[0].1 as usize, w[1].1 as usize))
            }
        };
        let at = std::mem::take(&mut self.at);
        if let Some((k, again)) = twice {
            let (id, first) = (self.ids[k], scan.place(at[k]));
            let message = format!("node {id} is here a second time, after {first}");
            return Err(scan.fail(at[again], message));
        }
        Ok(())
    }

    /// A table where numbers have few gaps, else a list in order.
    fn sort(&self) -> Find {
        let first = self.ids.iter().copied().min().unwrap_or(0);
        let last = self.ids.iter().copied().max().unwrap_or(0);
        let span = (last - first).saturating_add(1);
        if span <= 4 * self.ids.len() as u64 {
            let mut places = vec![NONE; span as usize];
            for (k, &id) in self.ids.iter().enumerate() {
                places[(id - first) as usize] = k as u32;
            }
            return Find::Dense { first, places };
        }
        let ids = self.ids.iter().enumerate();
        let mut sorted: Vec<(u64, u32)> = ids.map(|(k, &id)| (id, k as u32)).collect();
        sorted.sort_unstable();
        Find::Sorted(sorted)
    }

    /// The place of the node of this number.
    pub fn find(&self, id: u64) -> Option<u32> {
        match &self.find {
            Find::Dense { first, places } => {
                let k = usize::try_from(id.checked_sub(*first)?).ok()?;
                places.get(k).copied().filter(|&place| place != NONE)
            }
            Find::Sorted(sorted) => {
                let k = sorted.binary_search_by_key(&id, |pair| pair.0).ok()?;
                Some(sorted[k].1)
            }
        }
    }
}
