//! Unit tests of `crates/cli/src/picture.rs`.

#[test]
fn displacements_become_visible_and_stay_inside() {
    let factor = |largest, size| super::factor(largest, size, super::VISIBLE[0], f64::INFINITY);
    assert_eq!(factor(0.0, 1.0), 1.0);
    assert_eq!(factor(0.05, 1.0), 1.0);
    assert_eq!(factor(1e-3, 1.0), 100.0);
    assert_eq!(factor(3e-3, 1.0), 20.0);
    assert_eq!(factor(4.0, 1.0), 0.02);
    for k in 1..400 {
        let largest = 0.9_f64.powi(k) * 0.3;
        let part = largest * factor(largest, 2.0) / 2.0;
        assert!((0.03..0.3).contains(&part), "{largest} {part}");
    }
    assert!(factor(1e-320, 1.0).is_finite());
    let beside_contact = |largest, most| super::factor(largest, 1.0, super::VISIBLE_CONTACT, most);
    assert_eq!(beside_contact(0.02, 7.0), 1.0);
    assert_eq!(beside_contact(1e-3, 7.0), 5.0);
    assert_eq!(beside_contact(1e-3, 1.0), 1.0);
}
