//! Unit tests of `crates/cholesky/src/dissection.rs`.

use super::*;
use crate::matrices::grid_laplacian;

fn covers_once(d: &[Vec<u32>], n: usize) {
    let mut seen: Vec<u32> = d.iter().flatten().copied().collect();
    seen.sort_unstable();
    assert_eq!(seen, (0..n as u32).collect::<Vec<_>>());
}

#[test]
fn every_dof_is_eliminated_once_with_and_without_coordinates() {
    let (k, x) = grid_laplacian(17, 9, 0.0);
    let all: Vec<u32> = (0..k.n() as u32).collect();
    covers_once(&nested_dissection(&k, &all, Some(&x)), k.n());
    covers_once(&nested_dissection(&k, &all, None), k.n());
}

#[test]
fn moved_nodes_do_not_make_separators_larger() {
    let (k, x) = grid_laplacian(40, 40, 0.0);
    let draw = crate::matrices::random(2 * k.n(), 9);
    let moved = |(x, d): (&[f64; 3], &[f64])| [x[0] + 0.2 * d[0], x[1] + 0.2 * d[1], 0.0];
    let x: Vec<[f64; 3]> = x.iter().zip(draw.chunks(2)).map(moved).collect();
    let all: Vec<u32> = (0..k.n() as u32).collect();
    let d = nested_dissection(&k, &all, Some(&x));
    covers_once(&d, k.n());
    assert_eq!(d.last().expect("not empty").len(), 40);
}

#[test]
fn the_top_separator_of_a_strip_is_its_short_side() {
    let (k, x) = grid_laplacian(40, 5, 0.0);
    let all: Vec<u32> = (0..k.n() as u32).collect();
    for coordinates in [Some(&x[..]), None] {
        let d = nested_dissection(&k, &all, coordinates);
        assert!(d.last().expect("not empty").len() <= 6);
    }
}

/// Vertices of one dof each.
fn vertices(n: usize, at: Option<&[[f64; 3]]>) -> Vertices {
    Vertices {
        sizes: vec![1; n],
        at: at.map(<[[f64; 3]]>::to_vec),
    }
}

#[test]
fn the_parts_of_ranks_are_the_whole() {
    let (k, x) = grid_laplacian(37, 23, 0.0);
    // All of it, and two pieces that do not hang together.
    let all: Vec<u32> = (0..k.n() as u32).collect();
    let apart: Vec<u32> = all.iter().copied().filter(|i| i % 37 != 11).collect();
    for at in [None, Some(&x[..])] {
        let vertices = vertices(k.n(), at);
        for interior in [&all[..], &apart, &all[..20], &all[..1], &[]] {
            let part = |of| part_of_dissection(&k, interior, &vertices, of);
            let whole = part((0, 1));
            let mut seen = whole.concat();
            seen.sort_unstable();
            assert_eq!(seen, interior);
            for ranks in [1, 2, 3, 7, 64, 500] {
                let parts = (0..ranks).map(|rank| part((rank, ranks)));
                assert_eq!(parts.collect::<Vec<_>>().concat(), whole, "{ranks} ranks");
            }
        }
    }
}

#[test]
fn the_better_of_two_cuts_is_kept() {
    // A strip whose positions are turned by 45 degrees: cut by position, its separator is oblique.
    let (k, x) = grid_laplacian(60, 8, 0.0);
    let turned = |p: &[f64; 3]| [p[0] - p[1], p[0] + p[1], 0.0];
    let x: Vec<[f64; 3]> = x.iter().map(turned).collect();
    let all: Vec<u32> = (0..k.n() as u32).collect();
    let last = |at| {
        let sets = part_of_dissection(&k, &all, &vertices(k.n(), at), (0, 1));
        sets.last().expect("not empty").len()
    };
    assert!(last(Some(&x)) <= last(None));
    assert!(last(None) <= 8);
}

#[test]
fn components_are_dealt_out_to_both_sides() {
    // 20,000 dofs of which no two are coupled: to part them one by one would take 10⁸ steps and as many levels.
    let n = 20_000u32;
    let alone = Csr {
        row_ptr: (0..=n as usize).collect(),
        col: (0..n).collect(),
        val: vec![1.0; n as usize],
    };
    let all: Vec<u32> = (0..n).collect();
    let sets = part_of_dissection(&alone, &all, &vertices(n as usize, None), (0, 1));
    assert!(sets
        .iter()
        .all(|s| (LEAF..=LEAF_OF_BLOCKS).contains(&s.len())));
    covers_once(&sets, n as usize);
    // Small components and a large one, wherever it comes.
    let (k, _) = grid_laplacian(30, 30, 0.0);
    for single in [vec![0, 2, 4, 60, 62, 64], vec![805, 895, 897, 899]] {
        let around = |i: u32| [i.wrapping_sub(30), i.wrapping_sub(1), i + 1, i + 30];
        let removed: Vec<u32> = single.iter().flat_map(|&i| around(i)).collect();
        let stays = |i: &u32| !removed.contains(i);
        let set: Vec<u32> = (0..900).filter(stays).collect();
        let mut work = Cutting::new(&k, None, None);
        let (lower, upper) = work.cut_by_distance(&set).expect("it has components");
        assert_eq!(lower.len() + upper.len(), set.len());
        let small = lower.len().min(upper.len());
        assert!((1..=single.len()).contains(&small), "{small}");
    }
}
