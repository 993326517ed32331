//! Unit tests of `crates/report/src/paraview/contact_fields.rs`.

use super::*;

#[test]
fn candidates_of_one_point_are_joined() {
    let mut fields = ContactFields::new(4);
    fields.add(1, 2.0, 0.0, true).unwrap();
    fields.add(1, 0.0, 0.5, false).unwrap();
    fields.add(2, 0.0, 0.25, false).unwrap();
    fields.add(2, 0.0, 0.125, false).unwrap();
    assert_eq!(fields.multiplier, [0.0, 2.0, 0.0, 0.0]);
    assert_eq!(fields.gap, [0.0, 0.0, 0.125, 0.0]);
    assert_eq!(fields.contact, [0, 1, 0, 0]);
    assert_eq!(fields.candidate, [0, 1, 1, 0]);
}

#[test]
fn pressure_is_force_over_area() {
    let mut fields = ContactFields::new(3);
    assert!(fields.pressure.is_empty());
    for (point, force, area) in [(0, 3.0, 0.5), (0, 1.0, 1.5), (1, 4.0, 0.0)] {
        fields.add(point, force, 0.0, true).unwrap();
        fields.add_area(point, area).unwrap();
    }
    fields.divide();
    assert_eq!(fields.pressure, [2.0, 0.0, 0.0]);
    assert!(fields.add_area(3, 1.0).is_err() && fields.add_area(0, -1.0).is_err());
}

#[test]
fn bad_candidates_are_refused() {
    let mut fields = ContactFields::new(4);
    let message = |e: Result<()>| e.unwrap_err().to_string();
    assert!(message(fields.add(4, 0.0, 0.0, false)).contains("point 4"));
    assert!(message(fields.add(0, f64::NAN, 0.0, false)).contains("NaN"));
    assert_eq!(fields, ContactFields::new(4));
}
