//! Small checks that many tests use.

use fetifeti::FetiFeti;
use serde_json::Value;

/// A value of a report that must be a plain number.
pub fn number(v: &Value) -> f64 {
    v.as_f64()
        .unwrap_or_else(|| panic!("{v} is no plain number"))
}

/// Whether `a` is `b` up to `tolerance`, relative.
pub fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b.abs()
}

/// Checks that there are identities of the operators, and that they hold up to `limit`.
pub fn identities(solver: &FetiFeti, limit: f64, what: &str) {
    let found = solver.check().expect("checks run");
    assert!(!found.is_empty(), "{what}: nothing was checked");
    for (name, defect) in found {
        assert!(defect < limit, "{what}: {name} {defect:.1e}");
    }
}
