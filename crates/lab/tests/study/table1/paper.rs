//! Unit tests of `crates/lab/src/study/table1/paper.rs`.

use super::*;

#[test]
fn the_printed_table() {
    let rows = table1();
    assert_eq!(rows.len(), 20);
    let first = &rows[0];
    assert_eq!((first.bodies, first.subdomains, first.elements), (2, 2, 2));
    assert_eq!(
        first.whole_interface,
        PaperSide {
            cond: 2.5536,
            iter: 7
        }
    );
    let last = lookup(2, 2, 128).unwrap();
    assert_eq!(last, rows[19]);
    assert_eq!(
        last.middle_third,
        PaperSide {
            cond: 23.3692,
            iter: 17
        }
    );
    assert_eq!(lookup(3, 3, 3), None);
}
