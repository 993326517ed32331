//! Reports as other programs read them: by the names of their keys. The names are written out in the tests, and not
//! taken from the crate.

use serde::de::DeserializeOwned;
use serde_json::Value;

/// Objects of a report, each as its path and its required keys; the path `rows[].seconds` stands for those of every
/// row.
pub type Keys = &'static [(&'static str, &'static str)];

/// Reads a report and checks its keys.
pub fn read<T: DeserializeOwned>(text: &str, keys: Keys) -> T {
    let report: Value = serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"));
    for (place, names) in keys {
        for object in find(&report, place) {
            for name in names.split_whitespace() {
                assert!(
                    object.get(name).is_some(),
                    "{place} has no {name}: {object}"
                );
            }
        }
    }
    serde_json::from_value(report).expect("a report")
}

/// The objects at a path; null and omitted values count as none.
fn find<'a>(report: &'a Value, place: &str) -> Vec<&'a Value> {
    let mut found = vec![report];
    for step in place.split('.').filter(|s| !s.is_empty()) {
        let below = found.into_iter();
        found = match step.strip_suffix("[]") {
            None => below.filter_map(|v| v.get(step)).collect(),
            Some(list) => below
                .filter_map(|v| v.get(list)?.as_array())
                .flatten()
                .collect(),
        };
    }
    found.retain(|v| !v.is_null());
    found
}
