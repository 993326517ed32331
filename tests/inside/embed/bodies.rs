//! Unit tests of `src/embed/bodies.rs`.

use super::*;

fn bond(low: usize, high: usize, holds: bool) -> Bond {
    Bond {
        low,
        high,
        shared: 9,
        holds,
    }
}

#[test]
fn a_group_in_two_pieces_is_two_bodies() {
    let row = [bond(0, 1, true), bond(1, 2, true)];
    assert_eq!(bodies(&[7, 3, 7], &row), [0, 1, 2]);
    assert_eq!(bodies(&[7, 7, 7], &row), [0, 0, 0]);
}

#[test]
fn what_does_not_hold_makes_no_body() {
    let row = [bond(0, 1, true), bond(1, 2, false)];
    assert_eq!(bodies(&[0, 0, 0], &row), [0, 0, 1]);
}

#[test]
fn all_are_named_or_none() {
    assert!(named_groups(&[Some(1), None]).is_err());
    assert_eq!(named_groups(&[None, None]).unwrap(), None);
    assert_eq!(named_groups(&[Some(4), Some(1)]).unwrap(), Some(vec![4, 1]));
}

#[test]
fn fragments_make_no_more_bodies() {
    // Eight local matrices in 663 fragments.
    assert_eq!(number(0, 8, 663), 1);
    assert_eq!(number(0, 9, 663), 2);
    assert_eq!(number(0, 24, 24), 3);
    assert_eq!(number(0, 24, 2), 2);
    assert_eq!(number(0, 0, 0), 1);
    assert_eq!((number(5, 8, 663), number(5, 8, 3)), (5, 3));
}
