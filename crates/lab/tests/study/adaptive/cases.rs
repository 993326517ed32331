//! Unit tests of `crates/lab/src/study/adaptive/cases.rs`.

use super::*;

#[test]
fn names_are_unique_and_quick_cases_exist() {
    let all = cases(Meshes::Small);
    let mut names: Vec<&str> = all.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names.len(), 40);
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 40);
    assert_eq!(cases(Meshes::Quick).len(), QUICK.len());
}
