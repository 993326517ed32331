//! Columns of GᵀG that are coupled with the same others: the vertices of the graph by which it is ordered.
//!
//! Rows of G couple the columns in which they have entries, and not all columns of two bodies that meet. Where a flat
//! face of a body meets another one without friction, rows have entries for one translation and two rotations of each:
//! half the motions of the body. To cut such a face takes these alone out of the graph, so that separators are half as
//! wide, and a factorisation has a quarter of the operations (docs/theory.md, section 6).

use std::ops::Range;

use mpi::topology::SimpleCommunicator;
use rustc_hash::FxHashMap;

use super::rows::KernelRows;
use crate::substructures::Problem;
use base::linalg::sorted::distinct;
use parallel::exchange::{highest, sum_all};
use parallel::parcels::Parcels;

/// Columns in blocks: those of a block follow each other, and belong to one body.
pub struct ColumnBlocks {
    /// First column of each block, and the end.
    start: Vec<usize>,
    /// The body of each block.
    pub body: Vec<u32>,
    /// For each block those with which it has common entries, and itself, increasing.
    pub near: Vec<Vec<u32>>,
}

impl ColumnBlocks {
    /// Whole bodies: each has entries for those in its list. `start` has the first column of each body.
    pub fn of_bodies(lists: &[Vec<u32>], start: &[usize]) -> ColumnBlocks {
        ColumnBlocks {
            start: start.to_vec(),
            body: (0..lists.len() as u32).collect(),
            near: lists.to_vec(),
        }
    }

    /// The blocks of AᵀA for these rows. The same on every rank. Collective.
    pub fn of_rows(comm: &SimpleCommunicator, rows: &KernelRows, start: &[usize]) -> ColumnBlocks {
        let r = *start.last().expect("there is an end");
        let mut largest = Parcels::default();
        for set in largest_sets(rows, start) {
            largest.push((), set.iter().copied());
        }
        let all = largest.gather_all(comm);
        let sets: Vec<&[u32]> = all.iter().flat_map(Parcels::iter).map(|s| s.1).collect();
        // The sets in which a column is: columns of a body that are in the same ones make a block.
        let mut sets_of: Vec<Vec<u32>> = vec![Vec::new(); r];
        for (k, set) in (0..).zip(&sets) {
            set.iter().for_each(|&c| sets_of[c as usize].push(k));
        }
        let mut blocks = ColumnBlocks {
            start: Vec::new(),
            body: Vec::new(),
            near: Vec::new(),
        };
        let mut block_of = vec![0u32; r];
        for (body, columns) in (0..).zip(start.windows(2)) {
            for c in columns[0]..columns[1] {
                if c == columns[0] || sets_of[c] != sets_of[c - 1] {
                    blocks.start.push(c);
                    blocks.body.push(body);
                }
                block_of[c] = blocks.body.len() as u32 - 1;
            }
        }
        blocks.start.push(r);
        let mut near: Vec<Vec<u32>> = (0..blocks.body.len() as u32).map(|b| vec![b]).collect();
        let mut of_set: Vec<u32> = Vec::new();
        for set in sets {
            of_set.clear();
            of_set.extend(set.iter().map(|&c| block_of[c as usize]));
            of_set.dedup();
            of_set
                .iter()
                .for_each(|&b| near[b as usize].extend(&of_set));
        }
        blocks.near = near.into_iter().map(distinct).collect();
        blocks
    }

    /// The columns of a block.
    pub fn columns(&self, block: u32) -> Range<usize> {
        self.start[block as usize]..self.start[block as usize + 1]
    }

    /// Number of blocks.
    pub fn n(&self) -> usize {
        self.body.len()
    }
}

/// The sets of columns of rows, each increasing, without those that are a part of another one between the same bodies.
fn largest_sets<'a>(rows: &'a KernelRows, start: &[usize]) -> Vec<&'a [u32]> {
    let body = |c: &u32| start.partition_point(|&s| s <= *c as usize) as u32;
    let mut between: FxHashMap<Vec<u32>, Vec<&[u32]>> = FxHashMap::default();
    let mut bodies: Vec<u32> = Vec::new();
    for set in rows.sets() {
        bodies.clear();
        bodies.extend(set.iter().map(body));
        bodies.dedup();
        let known = match between.get_mut(&bodies) {
            Some(known) => known,
            None => between.entry(bodies.clone()).or_default(),
        };
        if !known.iter().any(|other| is_part(set, other)) {
            known.retain(|other| !is_part(other, set));
            known.push(set);
        }
    }
    let mut sets: Vec<&[u32]> = between.into_values().flatten().collect();
    sets.sort_unstable();
    sets
}

/// Whether all of `a` is in `b`; both increase.
fn is_part(a: &[u32], b: &[u32]) -> bool {
    a.len() <= b.len() && a.iter().all(|c| b.binary_search(c).is_ok())
}

/// Where the bodies are: the mean of their dofs' positions. `None` if a subdomain does not know them. Collective.
pub fn positions(comm: &SimpleCommunicator, problem: &Problem) -> Option<Vec<[f64; 3]>> {
    let subs = &problem.local;
    let unknown = subs.iter().any(|s| s.coordinates.is_none());
    if highest(comm, f64::from(u8::from(unknown))) > 0.0 {
        return None;
    }
    // The sums of the positions of each body, and the number of dofs.
    let mut sums = vec![0.0; 4 * problem.n_bodies];
    for (sub, points) in subs.iter().zip(subs.iter().flat_map(|s| &s.coordinates)) {
        let sum = &mut sums[4 * sub.body..][..4];
        for x in points {
            (0..3).for_each(|d| sum[d] += x[d]);
        }
        sum[3] += points.len() as f64;
    }
    sum_all(comm, &mut sums);
    let mean = |s: &[f64]| [0, 1, 2].map(|d| s[d] / s[3].max(1.0));
    Some(sums.chunks_exact(4).map(mean).collect())
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/blocks.rs"]
mod tests;
