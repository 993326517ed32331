//! Unit tests of `crates/base/src/linalg/single.rs`.

use super::*;

#[test]
fn products_have_seven_digits_whatever_the_size_of_the_vector() {
    let n = 37;
    let mut a = Dense::zeros(n, n);
    for j in 0..n {
        for i in 0..n {
            a.set(i, j, 1.0 / (1.0 + i as f64 + j as f64));
        }
    }
    let single = Single::new(&a);
    for size in [1.0, 1e-60, 1e60] {
        let x: Vec<f64> = (0..n).map(|i| size * ((i * 7 % 5) as f64 - 2.0)).collect();
        let (mut y, mut exact) = (vec![0.0; n], vec![0.0; n]);
        single.mul(1.0, &x, &mut y);
        a.add_mul(&x, &mut exact);
        let far = y.iter().zip(&exact).map(|(a, b)| (a - b).abs());
        assert!(far.fold(0.0, f64::max) < 2e-6 * size);
    }
}
