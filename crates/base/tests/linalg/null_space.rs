//! Unit tests of `crates/base/src/linalg/null_space.rs`.

use super::*;

/// Columns 0 and 1 are alike, column 2 is their sum, column 3 is zero.
#[test]
fn a_basis_has_a_vector_for_each_free_column() {
    let rows = vec![vec![1.0, 1.0, 2.0, 0.0], vec![0.5, 0.5, 1.0, 0.0]];
    let found = null_space(rows.clone(), std::slice::from_ref(&(0..4)), 1e-12);
    assert_eq!(found.len(), 3);
    for (free, x) in &found {
        assert_eq!(x[*free], 1.0);
        for row in &rows {
            let product: f64 = row.iter().zip(x).map(|(a, b)| a * b).sum();
            assert!(product.abs() < 1e-15);
        }
    }
}

/// The first group is eliminated first, although later columns have larger entries.
#[test]
fn earlier_groups_are_eliminated_before_later_ones() {
    let rows = vec![vec![1e-3, 5.0], vec![1e-3, 5.0]];
    let found = null_space(rows.clone(), &[0..1, 1..2], 1e-12);
    assert_eq!(found, vec![(1, vec![-5e3, 1.0])]);
    let found = null_space(rows, std::slice::from_ref(&(0..2)), 1e-12);
    assert_eq!(found, vec![(0, vec![1.0, -2e-4])]);
}

#[test]
fn a_regular_matrix_has_none_and_no_rows_leave_all() {
    let rows = vec![vec![0.0, 2.0], vec![1.0, 0.0]];
    assert!(null_space(rows, std::slice::from_ref(&(0..2)), 1e-12).is_empty());
    let all = null_space(Vec::new(), std::slice::from_ref(&(0..2)), 1e-12);
    assert_eq!(all, vec![(0, vec![1.0, 0.0]), (1, vec![0.0, 1.0])]);
}
