//! Meshes: boxes of rectangles, their partition into subdomains, the classification of their nodes.

mod boxes;

pub use boxes::{places, Block, BoxMesh};

use std::ops::Range;

/// The subdomains that rank `rank` of `ranks` holds when `n` of them are dealt out in contiguous blocks whose
/// sizes differ by at most one. Ranks beyond the number of subdomains get an empty range.
pub fn contiguous_share(n: usize, ranks: usize, rank: usize) -> Range<usize> {
    let (each, extra) = (n / ranks, n % ranks);
    let start = rank * each + rank.min(extra);
    start..start + each + usize::from(rank < extra)
}

#[cfg(test)]
mod tests {
    use super::contiguous_share;

    #[test]
    fn shares_cover_everything_once() {
        for n in 0..12 {
            for ranks in 1..6 {
                let mut next = 0;
                for rank in 0..ranks {
                    let share = contiguous_share(n, ranks, rank);
                    assert_eq!(share.start, next);
                    assert!(share.len() == n / ranks || share.len() == n / ranks + 1);
                    next = share.end;
                }
                assert_eq!(next, n);
            }
        }
    }
}
