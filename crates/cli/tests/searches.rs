//! Unit tests of `crates/cli/src/searches.rs`.

use std::time::Duration;

use super::*;

#[test]
fn the_line_says_how_much_is_left() {
    let search = EigenSearch {
        largest: false,
        restarts: 12,
        residual: 1e-2,
        tolerance: 1e-6,
        elapsed: Duration::from_secs(10),
    };
    assert_eq!(
        line(&search),
        "exact spectrum: smallest eigenvalue, restart 12, residual 1.0e-2 of 1.0e-6, about 20 s left"
    );
    // Nothing is known before the residual falls.
    for residual in [1.0, 7.0, f64::NAN, 0.0] {
        let early = EigenSearch { residual, ..search };
        assert!(!line(&early).contains("left"), "{}", line(&early));
    }
}
