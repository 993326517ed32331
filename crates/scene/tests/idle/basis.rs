//! Unit tests of `crates/scene/src/idle/basis.rs`.

use super::*;

#[test]
fn a_dual_basis_is_one_at_its_own_place_and_zero_at_those_of_others() {
    let motions = vec![
        vec![(0, 1.0), (1, 0.5)],
        vec![(1, 1.0), (4, -0.25)],
        // The sum of the two: no motion of its own.
        vec![(0, 1.0), (1, 1.5), (4, -0.25)],
        vec![(0, 0.5), (3, 1.0), (4, 1.0)],
    ];
    let basis = dual(motions.clone());
    assert_eq!(basis.len(), 3);
    for (k, (_, motion)) in basis.iter().enumerate() {
        for (l, (hold, _)) in basis.iter().enumerate() {
            let wanted = f64::from(u8::from(k == l));
            assert!((at(motion, *hold) - wanted).abs() < 1e-15, "{k} {l}");
        }
    }
    // The same space.
    for motion in motions {
        assert!(without(motion, &basis).iter().all(|e| e.1.abs() < 1e-14));
    }
    let normal = orthonormal(&basis);
    for (k, a) in normal.iter().enumerate() {
        for (l, b) in normal.iter().enumerate() {
            let product: f64 = a.iter().map(|e| e.1 * at(b, e.0)).sum();
            let wanted = f64::from(u8::from(k == l));
            assert!((product - wanted).abs() < 1e-14, "{k} {l}: {product}");
        }
        assert!(without(a.clone(), &basis).iter().all(|e| e.1.abs() < 1e-14));
    }
}
