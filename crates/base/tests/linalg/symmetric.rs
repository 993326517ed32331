//! Unit tests of `crates/base/src/linalg/symmetric.rs`.

use super::*;
use crate::matrices::random;

fn symmetric(n: usize) -> Dense {
    let mut a = Dense {
        rows: n,
        cols: n,
        data: random(n * n, n as u64),
    };
    a.mirror_lower();
    a
}

#[test]
fn products_are_those_of_the_whole_matrix() {
    for n in [0, 1, 3, 4, 5, 31, 32, 33, 64, 70, 101] {
        let a = symmetric(n);
        let packed = Symmetric::new(&a);
        assert_eq!(packed.to_dense().data, a.data, "{n}");
        assert!((0..n).all(|i| (0..n).all(|j| packed.get(i, j) == a.get(i, j))));
        for columns in [1, 3, 9] {
            let of = |seed| Dense {
                rows: n,
                cols: columns + 1,
                data: random(n * (columns + 1), seed),
            };
            let (x, mut y) = (of(7), of(8));
            packed.mul_columns(&x, &mut y, columns);
            for c in 0..columns {
                let mut exact = vec![0.0; n];
                a.add_mul(x.col(c), &mut exact);
                let far = y.col(c).iter().zip(&exact).map(|(a, b)| (a - b).abs());
                assert!(far.fold(0.0, f64::max) < 1e-13 * n.max(1) as f64, "{n}");
            }
        }
    }
}
