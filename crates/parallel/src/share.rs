//! How subdomains are dealt out to ranks where nobody asks for another distribution.

use std::ops::Range;

/// The subdomains that rank `rank` of `ranks` holds when `n` of them are dealt out in contiguous blocks whose
/// sizes differ by at most one. Ranks beyond the number of subdomains get an empty range.
pub fn contiguous_share(n: usize, ranks: usize, rank: usize) -> Range<usize> {
    let (each, extra) = (n / ranks, n % ranks);
    let start = rank * each + rank.min(extra);
    start..start + each + usize::from(rank < extra)
}

#[cfg(test)]
#[path = "../tests/share.rs"]
mod tests;
