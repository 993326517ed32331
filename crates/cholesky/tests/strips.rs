//! Unit tests of `crates/cholesky/src/strips.rs`.

use super::*;

const ORDERS: [usize; 9] = [
    0,
    1,
    7,
    STRIP - 1,
    STRIP,
    STRIP + 1,
    2 * STRIP,
    3 * STRIP,
    3 * STRIP + 5,
];

#[test]
fn strips_follow_each_other_and_cover_the_triangle() {
    for order in ORDERS {
        let all: Vec<Strip> = strips(order).collect();
        let (mut next, mut column) = (0, 0);
        for strip in &all {
            assert_eq!((strip.at, strip.start), (next, column), "{order}");
            assert_eq!(strip.rows, order - strip.start);
            next += strip.rows * strip.columns;
            column += strip.columns;
        }
        assert_eq!((next, column), (length(order), order));
    }
}

#[test]
fn a_column_is_where_it_was_written() {
    let value = |i: usize, j: usize| (1000 * i + j) as f64;
    for order in ORDERS {
        let mut triangle = vec![f64::NAN; length(order)];
        for strip in strips(order) {
            let mut entries = strip.of(&mut triangle);
            for j in 0..strip.columns {
                for i in j..strip.rows {
                    entries[(i, j)] = value(strip.start + i, strip.start + j);
                }
            }
        }
        let strips = SchurUpdate::Strips(triangle);
        let message = SchurUpdate::Packed(strips.packed(order));
        for j in 0..order {
            let expected: Vec<f64> = (j..order).map(|i| value(i, j)).collect();
            assert_eq!(strips.column(order, j), expected, "{order}");
            assert_eq!(message.column(order, j), expected, "{order}");
        }
        assert_eq!(message.into_memory().len(), order * (order + 1) / 2);
        let mut triangle = strips.into_memory();
        for j in 0..order {
            let column = column_mut(&mut triangle, order, j);
            assert_eq!((column[0], column.len()), (value(j, j), order - j));
        }
    }
}
