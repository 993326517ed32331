//! Unit tests of `src/feti/interface/motions.rs`.

use super::*;
use crate::matrices::random;

/// Combinations of the rigid motions about `centre` at these points, and the component of each dof.
fn motions(points: &[[f64; 3]], centre: [f64; 3]) -> (Vec<Vec<f64>>, Vec<usize>) {
    let mix = random(36, 7);
    let mut columns = vec![Vec::new(); 6];
    for x in points {
        let [x, y, z] = [0, 1, 2].map(|d| x[d] - centre[d]);
        let rigid = [
            [1.0, 0.0, 0.0, 0.0, z, -y],
            [0.0, 1.0, 0.0, -z, 0.0, x],
            [0.0, 0.0, 1.0, y, -x, 0.0],
        ];
        for motion in rigid {
            for (c, column) in columns.iter_mut().enumerate() {
                column.push((0..6).map(|a| mix[6 * c + a] * motion[a]).sum());
            }
        }
    }
    (columns, (0..3 * points.len()).map(|i| i % 3).collect())
}

fn face(n: usize, m: usize, corner: [f64; 3]) -> Vec<[f64; 3]> {
    let place = |k: usize| {
        let [x, y, z] = corner;
        [x + (k % n) as f64, y + (k / n) as f64, z]
    };
    (0..n * m).map(place).collect()
}

#[test]
fn a_face_has_three_beyond_its_means_and_an_edge_two() {
    for (points, expected) in [
        (face(5, 4, [3.0, 2.0, 1.0]), 3),
        (face(4, 1, [3.0, 2.0, 1.0]), 2),
        (face(2, 1, [3.0, 2.0, 1.0]), 2),
        (face(1, 1, [3.0, 2.0, 1.0]), 0),
    ] {
        let (columns, component) = motions(&points, [20.0, 0.0, 5.0]);
        let found = beyond_means(columns.clone(), &component);
        assert_eq!(found.len(), expected);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (k, w) in found.iter().enumerate() {
            for c in 0..3 {
                let mean: f64 = w.iter().skip(c).step_by(3).sum();
                assert!(mean.abs() < 1e-12, "{mean}");
            }
            for (l, v) in found.iter().enumerate() {
                let expected = f64::from(u8::from(k == l));
                assert!((product(w, v) - expected).abs() < 1e-12);
            }
        }
        // A motion that neither the means nor the functionals see is none.
        for mut column in columns {
            for c in 0..3 {
                let n = points.len() as f64;
                let mean = column.iter().skip(c).step_by(3).sum::<f64>() / n;
                column
                    .iter_mut()
                    .skip(c)
                    .step_by(3)
                    .for_each(|v| *v -= mean);
            }
            for w in &found {
                let along = product(w, &column);
                column.iter_mut().zip(w).for_each(|(v, w)| *v -= along * w);
            }
            assert!(column.iter().all(|v| v.abs() < 1e-5), "{column:?}");
        }
    }
}

#[test]
fn a_face_elsewhere_has_the_same_weights() {
    let at = |corner: [f64; 3]| {
        let (columns, component) = motions(&face(5, 5, corner), [20.3, 0.1, 5.7]);
        beyond_means(columns, &component)
    };
    let first = at([0.0, 0.0, 0.0]);
    for corner in [[5.0, 0.0, 0.0], [10.0, 35.0, 5.0], [40.0, 5.0, -25.0]] {
        let there = at(corner);
        let pairs = there.iter().flatten().zip(first.iter().flatten());
        assert_eq!(there.len(), first.len());
        assert!(pairs.fold(0.0f64, |far, (a, b)| far.max((a - b).abs())) < 1e-12);
    }
}

#[test]
fn nothing_is_known_without_motions() {
    assert!(beyond_means(Vec::new(), &[0, 1, 2]).is_empty());
}
