//! Unit tests of `crates/report/src/paraview/contact_fields.rs`.

use super::*;
use crate::paraview::friction_fields::ContactState;

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
fn friction_is_stress_slip_and_state() {
    let mut fields = ContactFields::new(4).with_areas().with_friction();
    let at = |force: f64, slip: f64, state| PointFriction {
        force: [force, 0.0, -force],
        slip: [0.0, slip, 0.0],
        state,
    };
    let nodes = [
        (0, 0.5, at(3.0, 0.1, ContactState::Slip)),
        (0, 1.5, at(1.0, -0.2, ContactState::Stick)),
        (1, 0.0, at(4.0, 0.0, ContactState::Stick)),
        (2, 1.0, at(0.0, 0.3, ContactState::Open)),
    ];
    for (point, area, at) in nodes {
        fields.add(point, 1.0, 0.0, true).unwrap();
        fields.add_area(point, area).unwrap();
        fields.add_friction(point, &at);
    }
    fields.divide();
    let points = vec![[0.0; 3]; 4];
    let cells = mesh::Cells::default();
    let path = crate::scratch::Scratch::new("friction-fields");
    let file = path.0.join("a.vtu");
    fields.on(Vtu::new(&points, &cells)).write(&file).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    for name in ["shear", "slip", "contact_state"] {
        assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
    }
    let friction = fields.friction.unwrap();
    assert_eq!(friction.shear[..6], [2.0, 0.0, -2.0, 0.0, 0.0, 0.0]);
    assert_eq!(
        friction.slip,
        [0.0, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0]
    );
    assert_eq!(friction.state, [2, 1, 0, 0]);
}

#[test]
fn bad_candidates_are_refused() {
    let mut fields = ContactFields::new(4);
    let message = |e: Result<()>| e.unwrap_err().to_string();
    assert!(message(fields.add(4, 0.0, 0.0, false)).contains("point 4"));
    assert!(message(fields.add(0, f64::NAN, 0.0, false)).contains("NaN"));
    assert_eq!(fields, ContactFields::new(4));
}
