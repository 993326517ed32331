//! Unit tests of `src/feti/projector/blocks.rs`.

use super::*;
use crate::feti::projector::pattern::meeting;
use crate::testing::with_session;
use base::linalg::csr::Csr;
use cholesky::dissection::{part_of_dissection, Vertices};
use cholesky::symbolic::Symbolic;

/// Bodies along each side of a cube.
const SIDE: usize = 6;
const BODIES: usize = SIDE * SIDE * SIDE;

fn starts() -> Vec<usize> {
    (0..=BODIES).map(|b| 6 * b).collect()
}

/// Four rows at the corners of each face between two cubes of a grid: flat without friction, or with a normal that
/// turns from row to row.
fn rows(flat: bool) -> KernelRows {
    let (mut entries, mut row) = (Vec::new(), 0);
    let steps = [1, SIDE, SIDE * SIDE];
    for a in 0..BODIES {
        for (d, step) in steps.into_iter().enumerate() {
            if a / step % SIDE + 1 == SIDE {
                continue;
            }
            for corner in 0..4 {
                let mut at = [0.5; 3];
                at[(d + 1) % 3] = [-0.5, 0.4][corner % 2];
                at[(d + 2) % 3] = [-0.4, 0.5][corner / 2];
                let mut normal = [0.0; 3];
                normal[d] = 1.0;
                if !flat {
                    normal = [0, 1, 2].map(|e| 1.0 + (1.0 + (a + corner + e) as f64).sin());
                }
                for (body, sign) in [(a, 1.0), (a + step, -1.0)] {
                    let mut x = at;
                    x[d] *= sign;
                    let turn = |e: usize| {
                        let (p, q) = ((e + 1) % 3, (e + 2) % 3);
                        x[p] * normal[q] - x[q] * normal[p]
                    };
                    let motions = [normal, [turn(0), turn(1), turn(2)]].concat();
                    for (c, v) in motions.into_iter().enumerate().filter(|e| e.1 != 0.0) {
                        entries.push((row, (6 * body + c) as u32, sign * v));
                    }
                }
                row += 1;
            }
        }
    }
    KernelRows::from_triplets(row as usize, entries)
}

/// Entries and operations of a factor in the order of these blocks.
fn factor(blocks: &ColumnBlocks, at: Option<&[[f64; 3]]>) -> [f64; 2] {
    let mut graph = Csr {
        row_ptr: vec![0],
        ..Csr::default()
    };
    for list in &blocks.near {
        graph.col.extend(list);
        graph.row_ptr.push(graph.col.len());
    }
    graph.val = vec![0.0; graph.col.len()];
    let all: Vec<u32> = (0..blocks.n() as u32).collect();
    let position = |b: &u32| at.map(|at| at[blocks.body[*b as usize] as usize]);
    let vertices = Vertices {
        sizes: all.iter().map(|&b| blocks.columns(b).len()).collect(),
        at: all.iter().map(position).collect(),
    };
    let sets = part_of_dissection(&graph, &all, &vertices, (0, 1));
    let columns = |b| blocks.columns(b);
    let symbolic = Symbolic::with_blocks(&graph, &sets, 6 * BODIES, columns);
    [symbolic.storage as f64, symbolic.flops()]
}

#[test]
fn flat_faces_couple_half_the_motions_and_make_the_factor_smaller() {
    with_session(|session| {
        let (comm, start) = (session.comm(), starts());
        let g = rows(true);
        let blocks = ColumnBlocks::of_rows(comm, &g, &start);
        assert_eq!(blocks.n(), 6 * BODIES);
        // A body inside: each translation meets the one of two neighbours and two rotations of all three; each
        // rotation meets a translation and two rotations of four, two of each pair of faces.
        let inside = 6 * (1 + SIDE + SIDE * SIDE);
        let counts: Vec<usize> = (inside..inside + 6).map(|c| blocks.near[c].len()).collect();
        assert_eq!(counts, [9, 9, 9, 17, 17, 17]);
        let product = g.product(comm, &g, 6 * BODIES, |_| true);
        for i in 0..6 * BODIES {
            for j in (0..6 * BODIES).filter(|&j| product.get(i, j) != 0.0) {
                assert!(blocks.near[i].binary_search(&(j as u32)).is_ok(), "{i} {j}");
            }
        }
        let bodies = ColumnBlocks::of_bodies(&meeting(comm, &g, &g, &start), &start);
        let place = |b: usize| [b % SIDE, b / SIDE % SIDE, b / SIDE / SIDE].map(|x| x as f64);
        let at: Vec<[f64; 3]> = (0..BODIES).map(place).collect();
        let [entries, flops] = factor(&blocks, Some(&at));
        let [all, all_flops] = factor(&bodies, Some(&at));
        assert!(2.0 * entries < all, "{entries} of {all}");
        assert!(3.0 * flops < all_flops, "{flops} of {all_flops}");
        // Without positions less is gained.
        let [entries, flops] = factor(&blocks, None);
        let [all, all_flops] = factor(&bodies, None);
        assert!(entries < all && flops < all_flops);
    });
}

#[test]
fn curved_faces_couple_whole_bodies() {
    with_session(|session| {
        let (comm, start) = (session.comm(), starts());
        let g = rows(false);
        let lists = meeting(comm, &g, &g, &start);
        let blocks = ColumnBlocks::of_rows(comm, &g, &start);
        assert_eq!(blocks.n(), BODIES);
        assert_eq!(blocks.near, lists);
        assert_eq!(blocks.columns(7), 42..48);
    });
}

#[test]
fn parts_of_sets_are_left_out_and_columns_without_rows_are_blocks() {
    with_session(|session| {
        // Three bodies with 3, 0, 4 and 2 columns; the second has none.
        let start = [0, 3, 3, 7, 9];
        let sets: [&[u32]; 6] = [&[0, 3], &[0, 1, 3], &[1, 3], &[3, 4], &[0, 1, 3], &[3]];
        let entries = (0..).zip(sets).flat_map(|(i, set)| {
            let entry = move |&c: &u32| (i, c, 1.0 + f64::from(c));
            set.iter().map(entry)
        });
        let rows = KernelRows::from_triplets(sets.len(), entries.collect());
        assert_eq!(largest_sets(&rows, &start), [&[0, 1, 3][..], &[3, 4]]);
        let blocks = ColumnBlocks::of_rows(session.comm(), &rows, &start);
        let columns: Vec<_> = (0..blocks.n() as u32).map(|b| blocks.columns(b)).collect();
        assert_eq!(columns, [0..2, 2..3, 3..4, 4..5, 5..7, 7..9]);
        assert_eq!(blocks.body, [0, 0, 2, 2, 2, 3]);
        let near: [&[u32]; 6] = [&[0, 2], &[1], &[0, 2, 3], &[2, 3], &[4], &[5]];
        assert_eq!(blocks.near, near);
    });
}
