//! Unit tests of `crates/lab/src/baselines/table.rs`.

use super::*;

#[test]
fn names_select_rows_in_the_order_of_the_table() {
    let names = |list: &[&str]| -> Vec<&'static str> {
        let list: Vec<String> = list.iter().map(|s| s.to_string()).collect();
        select(&list)
            .expect("known names")
            .iter()
            .map(|b| b.name)
            .collect()
    };
    assert_eq!(names(&[]), ["bddc", "fetidp", "gamg", "hypre", "mumps"]);
    assert_eq!(names(&["mumps", "bddc", "mumps"]), ["bddc", "mumps"]);
    let error = select(&["bdcc".to_string()]).expect_err("a typo");
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("bdcc"), "{error}");
}
