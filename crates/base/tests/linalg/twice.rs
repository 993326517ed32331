//! Unit tests of `crates/base/src/linalg/twice.rs`.

use super::*;

#[test]
fn what_cancels_leaves_what_rounding_took() {
    let mut sum = Twice::default();
    let third = 1.0 / 3.0;
    // 3·fl(1/3) − 1 = −2⁻⁵⁴, which the working precision rounds to 0.
    sum.add_product(3.0, third);
    sum.add(1e9);
    sum.add(-1e9);
    sum.add(-1.0);
    assert_eq!(sum.value(), -(0.5_f64.powi(54)));
}
