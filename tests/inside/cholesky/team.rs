//! Unit tests of `src/cholesky/team.rs`: how fronts are dealt out. What a team computes is tested with many bodies
//! (`tests/contact/many.rs`).

use super::*;
use crate::cholesky::dissection::nested_dissection;
use crate::linalg::csr::Csr;

/// The fronts of a square of n × n points, each coupled with its neighbours.
fn square(n: usize) -> Symbolic {
    let mut entries = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let at = (i * n + j) as u32;
            entries.push((at, at, 4.0));
            let next = [(i + 1 < n, n as u32), (j + 1 < n, 1)];
            for (_, step) in next.iter().filter(|s| s.0) {
                entries.extend([(at, at + step, -1.0), (at + step, at, -1.0)]);
            }
        }
    }
    let k = Csr::from_triplets(n * n, &entries);
    let all: Vec<u32> = (0..(n * n) as u32).collect();
    let sets = nested_dissection(&k, &all, None);
    Symbolic::with_supernodes(&k, &[], &sets)
}

#[test]
fn one_rank_has_all_fronts() {
    let fronts = square(30).fronts;
    assert!(deal(&fronts, 1, &[]).iter().all(|r| *r == Some(0)));
}

#[test]
fn fronts_are_dealt_out_evenly() {
    let fronts = square(60).fronts;
    let total: f64 = fronts.iter().map(Front::flops).sum();
    for ranks in [2, 3, 4, 8] {
        let dealt = deal(&fronts, ranks, &[]);
        let mut loads = vec![0.0; ranks];
        let mut top = 0.0;
        for (front, rank) in fronts.iter().zip(&dealt) {
            match rank {
                Some(r) => loads[*r as usize] += front.flops(),
                None => top += front.flops(),
            }
        }
        // Descendants of a subtree belong to its rank; what is above the top is the top.
        for (front, rank) in fronts.iter().zip(&dealt) {
            let parent = front.parent.and_then(|t| dealt[t]);
            assert!(parent.is_none() || parent == *rank);
            assert!(rank.is_some() || parent.is_none());
        }
        let most = loads.iter().fold(0.0f64, |a, b| a.max(*b));
        let way = (top + most) / total;
        assert!(way < 1.0 / ranks as f64 + 0.45, "{ranks} ranks: {way}");
        // A rank may stay idle where one more separator on top costs more than it saves.
        assert!(loads.iter().filter(|l| **l > 0.0).count() > 1);
    }
}

#[test]
fn subtrees_go_where_their_rows_are_at_home() {
    let fronts = square(60).fronts;
    let plain = deal(&fronts, 2, &[]);
    // Everything is at home with the other rank.
    let other = |r: &Option<u32>| r.map_or(0, |r| 1 - r);
    let homes = fronts.iter().zip(&plain);
    let homes: Vec<u32> = homes.flat_map(|(f, r)| vec![other(r); f.width()]).collect();
    let dealt = deal(&fronts, 2, &homes);
    for (there, here) in plain.iter().zip(&dealt) {
        assert_eq!(*here, there.map(|r| 1 - r));
    }
    assert!(dealt.contains(&Some(0)) && dealt.contains(&Some(1)));
}

#[test]
fn many_ranks_share_many_subtrees() {
    let fronts = square(100).fronts;
    for ranks in [64, 1000] {
        let dealt = deal(&fronts, ranks, &[]);
        let is_root = |f: usize| {
            let parent = fronts[f].parent;
            dealt[f].is_some() && parent.is_none_or(|t| dealt[t].is_none())
        };
        let roots = (0..fronts.len()).filter(|&f| is_root(f)).count();
        assert!(
            roots * roots >= ranks,
            "{ranks} ranks share {roots} subtrees"
        );
        // Lines between squares.
        let top: usize = (fronts.iter().zip(&dealt))
            .filter(|f| f.1.is_none())
            .map(|f| f.0.width())
            .sum();
        assert!(
            top < 10_000 / 4,
            "{ranks} ranks: {top} of 10000 rows are in the top"
        );
    }
}
