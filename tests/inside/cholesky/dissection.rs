//! Unit tests of `src/cholesky/dissection.rs`.

use super::*;
use crate::linalg::testing::grid_laplacian;

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
    let draw = crate::linalg::testing::random(2 * k.n(), 9);
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

#[test]
fn the_parts_of_ranks_are_the_whole() {
    let (k, _) = grid_laplacian(37, 23, 0.0);
    // All of it, and two pieces that do not hang together.
    let all: Vec<u32> = (0..k.n() as u32).collect();
    let apart: Vec<u32> = all.iter().copied().filter(|i| i % 37 != 11).collect();
    for interior in [&all[..], &apart, &all[..20], &all[..1], &[]] {
        let whole = nested_dissection(&k, interior, None);
        for ranks in [1, 2, 3, 7, 64, 500] {
            let parts = (0..ranks).map(|rank| part_of_dissection(&k, interior, rank, ranks));
            assert_eq!(parts.collect::<Vec<_>>().concat(), whole, "{ranks} ranks");
        }
    }
}
