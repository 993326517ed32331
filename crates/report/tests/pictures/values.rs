//! Unit tests of `crates/report/src/pictures/values.rs`.

use super::*;

#[test]
fn constant_and_foreign_values_have_a_colour() {
    let values = [3.0, 3.0];
    let field = ShownField {
        title: "",
        values: ShownValues::Cell(&values),
        scale: Scale::Linear,
    };
    let (low, high) = field.range();
    assert!(low < 3.0 && high > 3.0);
    let nothing = [f64::NAN, -1.0];
    assert_eq!(
        ShownField {
            values: ShownValues::Cell(&nothing),
            scale: Scale::Log,
            ..field
        }
        .range(),
        (1.0, 2.0)
    );
}
