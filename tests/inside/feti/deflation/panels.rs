//! Unit tests of `src/feti/deflation/panels.rs`.

use super::*;

fn column(entries: &[(u32, f64)], reach: &[u32]) -> MultiplierColumn {
    MultiplierColumn {
        entries: entries.to_vec(),
        reach: reach.to_vec(),
    }
}

/// The same matrix, entry by entry.
fn dense(n: usize, columns: &[MultiplierColumn]) -> Dense {
    let mut out = Dense::zeros(n, columns.len());
    for (c, column) in columns.iter().enumerate() {
        for &(row, value) in &column.entries {
            out.data[row as usize + c * n] += value;
        }
    }
    out
}

#[test]
fn products_are_those_of_the_whole_matrix() {
    let n = 6;
    let a = [
        column(&[(0, 1.0), (2, -2.0)], &[0, 1]),
        column(&[(2, 0.5), (3, 4.0)], &[0, 1]),
        column(&[(3, 3.0), (5, 1.5)], &[1]),
        column(&[], &[2]),
    ];
    let b = [
        column(&[(5, 2.0)], &[3]),
        column(&[(0, 1.0), (3, -1.0), (4, 7.0)], &[0]),
    ];
    let (pa, pb) = (Panels::new(&a), Panels::new(&b));
    let (da, db) = (dense(n, &a), dense(n, &b));
    let v: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
    let mut out = vec![1.0; 4];
    pa.add_transpose(&v, &mut out);
    for (c, o) in out.iter().enumerate() {
        let sum: f64 = da.col(c).iter().zip(&v).map(|(a, v)| a * v).sum();
        assert_eq!(*o, 1.0 + sum);
    }
    let c = [1.0, -2.0, 3.0, 10.0];
    let mut w = v.clone();
    pa.add(-0.5, &c, &mut w);
    let mut expected = vec![0.0; n];
    da.add_mul(&c, &mut expected);
    for i in 0..n {
        assert_eq!(w[i], v[i] - 0.5 * expected[i]);
    }
    let mut product = Dense::zeros(5, 3);
    pa.add_product(&pb, &mut product, (1, 1));
    for i in 0..5 {
        for j in 0..3 {
            let entry = match (i, j) {
                (0, _) | (_, 0) => 0.0,
                _ => (0..n).map(|k| da.get(k, i - 1) * db.get(k, j - 1)).sum(),
            };
            assert_eq!(product.get(i, j), entry);
        }
    }
}
