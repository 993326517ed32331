//! Unit tests of `src/feti/jump/scaling.rs`.

use super::*;

fn incidence(pairs: &[(usize, usize)], n: usize) -> Dense {
    let mut b = Dense::zeros(pairs.len(), n);
    for (r, &(i, j)) in pairs.iter().enumerate() {
        b.set(r, i, 1.0);
        b.set(r, j, -1.0);
    }
    b
}

const CROSS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

#[test]
fn cross_point_reproduces_the_papers_weights_on_jumps() {
    // On λ = B v the entries ±δ† of [Lee] and those of this code both give v minus its weighted average.
    let weights = [1e6, 1e-6, 2.0, 1e-6];
    let b = incidence(&CROSS, 4);
    let bd = block(&b, &weights, &[true; 6]);
    let v = [0.3, -1.0, 0.7, 2.0];
    let total: f64 = weights.iter().sum();
    let mean: f64 = v.iter().zip(&weights).map(|(v, w)| v * w).sum::<f64>() / total;
    for i in 0..4 {
        let ours: f64 = (0..6)
            .map(|r| bd.get(r, i) * (v[CROSS[r].0] - v[CROSS[r].1]))
            .sum();
        let paper: f64 = (0..6)
            .map(|r| {
                let (a, c) = CROSS[r];
                let entry = if i == a {
                    weights[c] / total
                } else if i == c {
                    -weights[a] / total
                } else {
                    0.0
                };
                entry * (v[a] - v[c])
            })
            .sum();
        assert!((ours - (v[i] - mean)).abs() < 1e-14);
        assert!((ours - paper).abs() < 1e-14);
    }
}

#[test]
fn b_bd_transpose_b_is_b_for_any_active_set() {
    let weights = [1e4, 1.0, 1e-4, 3.0];
    let b = incidence(&CROSS, 4);
    for mask in 1u32..64 {
        let active: Vec<bool> = (0..6).map(|r| mask >> r & 1 == 1).collect();
        let bd = block(&b, &weights, &active);
        for (r, &on) in active.iter().enumerate() {
            for j in 0..4 {
                // (Z B B_Dᵀ Z B)(r, j)
                let mut sum = 0.0;
                for q in (0..6).filter(|&q| active[q]) {
                    let x: f64 = (0..4).map(|i| b.get(r, i) * bd.get(q, i)).sum();
                    sum += x * b.get(q, j);
                }
                if on {
                    assert!((sum - b.get(r, j)).abs() < 1e-13, "mask {mask}");
                } else {
                    assert_eq!(bd.get(r, j), 0.0);
                }
            }
        }
    }
}

#[test]
fn redundant_pairs_and_the_general_block_agree() {
    let weights = [5.0, 0.25, 1.0];
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let bd = block(&incidence(&pairs, 3), &weights, &[true; 3]);
    for (r, &pair) in pairs.iter().enumerate() {
        for c in 0..3 {
            assert!((pair_entry(&weights, pair, c) - bd.get(r, c)).abs() < 1e-14);
        }
    }
}

#[test]
fn blocks_that_are_alike_have_one_scaling() {
    let rows = [[1.0, -1.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.0, -1.0]];
    let b = Dense::from_fn(3, 3, |i, j| rows[i][j]);
    let mut known = ScalingCache::default();
    for (weights, active) in [
        ([1.0, 2.0, 3.0], [true, true, true]),
        ([1.0, 2.0, 3.0], [true, false, true]),
        ([1.0, 2.0, 4.0], [true, true, true]),
        ([1.0, 2.0, 3.0], [false, true, false]),
        ([1.0, 2.0, 3.0], [true, true, true]),
    ] {
        let expected = block(&b, &weights, &active);
        let found = known.block(&b, &weights, &active);
        assert_eq!(found.data, expected.data);
    }
    assert_eq!(known.0.len(), 3);
    // Many that differ do not add up.
    for k in 0..ScalingCache::MOST + 10 {
        known.block(&b, &[1.0, 2.0, 5.0 + k as f64], &[true; 3]);
    }
    assert!(known.0.len() <= ScalingCache::MOST);
}

/// A jump of 1 between a copy of weight 3 and one of weight 1 moves them by 1/4 and 3/4, as a pair and as a row.
#[test]
fn heavy_copies_move_less() {
    let weights = [3.0, 1.0];
    let expected = [0.25, -0.75];
    let of_row = block(&incidence(&[(0, 1)], 2), &weights, &[true]);
    for (c, expected) in expected.into_iter().enumerate() {
        assert_eq!(pair_entry(&weights, (0, 1), c), expected);
        assert!((of_row.get(0, c) - expected).abs() < 1e-15);
    }
    // Coefficients b: D⁻¹ bᵀ / (b D⁻¹ bᵀ) with D = (4, 1).
    let row = Dense::from_fn(1, 2, |_, j| [2.0, -1.0][j]);
    let found = block(&row, &[4.0, 1.0], &[true]);
    assert_eq!([found.get(0, 0), found.get(0, 1)], [0.25, -0.5]);
}

/// Small values of heavy copies have all their digits: those of pairs, which nothing cancels in.
#[test]
fn values_of_heavy_copies_keep_their_digits() {
    let weights = [1e15, 1.0, 3.0];
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let bd = block(&incidence(&pairs, 3), &weights, &[true; 3]);
    for (r, &pair) in pairs.iter().enumerate() {
        for c in 0..3 {
            let expected = pair_entry(&weights, pair, c);
            let apart = (bd.get(r, c) - expected).abs();
            assert!(apart <= 1e-12 * expected.abs(), "{pair:?} {c}: {apart:e}");
        }
    }
}

/// Rows at an edge of four bodies, two of them turned to be parallel but for 2e-10: the SVD of faer does not come to
/// its end in this order.
#[test]
fn rows_that_are_nearly_parallel_have_a_scaling() {
    let (c, s, t) = (
        0.9997041277018103,
        0.024324001643669556,
        0.024324001833189147,
    );
    let rows = [
        [0.0, 1.0, 0.0, 0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        [0.9999999999999987, 0.0, 0.0, -0.9999999999999987, 0.0, 0.0],
        [c, s, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.99970412769719, t, 0.0],
    ];
    let b = Dense::from_fn(6, 6, |i, j| rows[i][j]);
    let bd = block(&b, &[1.0; 6], &[true; 6]);
    // B B_Dᵀ B = B.
    for i in 0..6 {
        for j in 0..6 {
            let through = |k: usize| -> f64 { (0..6).map(|l| b.get(i, l) * bd.get(k, l)).sum() };
            let product: f64 = (0..6).map(|k| through(k) * b.get(k, j)).sum();
            assert!((product - b.get(i, j)).abs() < 1e-8, "{i} {j}: {product}");
        }
    }
}
