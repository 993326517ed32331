//! Unit tests of `crates/cholesky/src/deal.rs`: how fronts are dealt out. What a team computes is tested with many
//! bodies (`tests/contact/many.rs`, `tests/ranks/coarse.rs`).

use super::*;
use crate::dissection::nested_dissection;
use crate::symbolic::Symbolic;
use base::linalg::csr::Csr;

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
    assert!(deal(&fronts, 1, &[]).iter().all(|s| s.rank == 0));
}

#[test]
fn fronts_are_dealt_out_evenly() {
    let symbolic = square(60);
    let fronts = &symbolic.fronts;
    let total = symbolic.flops();
    for ranks in [2, 3, 4, 8] {
        let dealt = deal(fronts, ranks, &[]);
        let mut loads = vec![0.0; ranks];
        for (front, share) in fronts.iter().zip(&dealt) {
            loads[share.rank as usize] += front.flops();
            let Some(t) = front.parent else { continue };
            // Descendants of a subtree belong to its rank.
            assert!(dealt[t].above || dealt[t] == *share);
            assert!(!share.above || dealt[t].above);
        }
        // A front above the subtrees belongs to a rank that has a child of it.
        for (f, share) in dealt.iter().enumerate().filter(|s| s.1.above) {
            let children = (0..f).filter(|&c| fronts[c].parent == Some(f));
            let ranks: Vec<u32> = children.map(|c| dealt[c].rank).collect();
            assert!(ranks.contains(&share.rank), "{ranks:?} and {share:?}");
        }
        // Nobody has more than its part and the way to the root.
        let most = loads.iter().fold(0.0f64, |a, b| a.max(*b)) / total;
        assert!(most < 1.0 / ranks as f64 + 0.25, "{ranks} ranks: {most}");
        assert!(loads.iter().all(|l| *l > 0.0));
    }
}

#[test]
fn subtrees_go_where_their_rows_are_at_home() {
    let fronts = square(60).fronts;
    let plain = deal(&fronts, 2, &[]);
    // Everything is at home with the other rank.
    let homes = fronts.iter().zip(&plain);
    let homes: Vec<u32> = homes
        .flat_map(|(f, s)| vec![1 - s.rank; f.width()])
        .collect();
    let dealt = deal(&fronts, 2, &homes);
    let rows = |of: &dyn Fn(usize) -> bool| -> usize {
        let these = (0..fronts.len()).filter(|&f| of(f));
        these.map(|f| fronts[f].width()).sum()
    };
    let below = |f: usize| !plain[f].above && !dealt[f].above;
    let home = |f: usize| dealt[f].rank == 1 - plain[f].rank;
    let (all, at_home) = (rows(&below), rows(&|f| below(f) && home(f)));
    assert!(
        10 * at_home > 9 * all && 2 * all > 60 * 60,
        "{at_home} of {all} rows"
    );
}

#[test]
fn many_ranks_share_many_subtrees() {
    let fronts = square(100).fronts;
    for ranks in [64, 400] {
        let dealt = deal(&fronts, ranks, &[]);
        let is_root = |f: &usize| {
            let parent = fronts[*f].parent;
            !dealt[*f].above && parent.is_none_or(|t| dealt[t].above)
        };
        let roots = (0..fronts.len()).filter(is_root).count();
        assert!(roots >= ranks, "{ranks} ranks share {roots} subtrees");
        let has_one = |r: u32| dealt.iter().any(|s| s.rank == r);
        let idle = (0..ranks as u32).filter(|&r| !has_one(r)).count();
        assert!(10 * idle < ranks, "{idle} of {ranks} ranks have nothing");
    }
}
