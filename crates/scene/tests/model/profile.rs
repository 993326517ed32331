//! Unit tests of `crates/scene/src/model/profile.rs`.

use super::*;

#[test]
fn tables_are_linear_between_their_rows_and_constant_beyond() {
    let table = Profile::Table(vec![[0.25, 1.0], [0.5, 3.0], [0.75, 2.0]]);
    let value = |t| table.eval(t, &Variables::default());
    assert_eq!([0.0, 0.25, 0.375, 0.5].map(value), [1.0, 1.0, 2.0, 3.0]);
    assert_eq!([0.625, 0.75, 1.0].map(value), [2.5, 2.0, 2.0]);
    let single = Profile::Table(vec![[0.5, 7.0]]);
    assert_eq!(single.eval(0.0, &Variables::default()), 7.0);
    assert_eq!(single.eval(1.0, &Variables::default()), 7.0);
}

#[test]
fn a_node_has_the_bounds_of_all_its_entries() {
    let limit = |node, value| Limit {
        node,
        value,
        entry: None,
    };
    let limits = Limits::new(vec![limit(4, 1.0), limit(2, 5.0), limit(4, 0.5)]);
    assert_eq!(limits.at(4), [limit(4, 1.0), limit(4, 0.5)]);
    assert_eq!(limits.at(3), []);
    assert_eq!(limits.all().len(), 3);
}
