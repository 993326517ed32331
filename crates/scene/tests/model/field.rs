//! Unit tests of `crates/scene/src/model/field.rs`.

use super::*;

fn at([x, y]: [f64; 2], [bi, bj]: [usize; 2], [si, sj]: [usize; 2]) -> At {
    At {
        variables: Variables {
            point: [x, y, 0.0],
            body: [bi, bj, 0],
            subdomain: [si, sj, 0],
        },
        subdomains: [3, 3, 1],
    }
}

#[test]
fn checkerboards_continue_across_bodies() {
    let board = |by| Field::Checkerboard {
        values: [1.0, 9.0],
        by,
    };
    // With three subdomains a body, the right neighbour of subdomain 2 of body 0 is subdomain 0 of body 1.
    let by = board(By::Subdomain);
    assert_eq!(by.eval(&at([0.0; 2], [0, 0], [2, 0])), 1.0);
    assert_eq!(by.eval(&at([0.0; 2], [1, 0], [0, 0])), 9.0);
    assert_eq!(by.eval(&at([0.0; 2], [1, 1], [0, 0])), 1.0);
    let by = board(By::Body);
    assert_eq!(by.eval(&at([0.0; 2], [1, 0], [2, 1])), 9.0);
}

#[test]
fn the_last_region_wins_and_borders_belong_to_the_right() {
    let number = Expr::constant;
    let field = Field::Regions {
        list: vec![
            Region {
                x: Some([0.0, 0.5]),
                y: None,
                z: None,
                value: number(1.0),
            },
            Region {
                x: Some([0.5, 1.0]),
                y: None,
                z: None,
                value: number(2.0),
            },
            Region {
                x: None,
                y: Some([0.9, 1.0]),
                z: None,
                value: number(3.0),
            },
        ],
        otherwise: number(7.0),
    };
    let value = |p| field.eval(&at(p, [0; 2], [0; 2]));
    assert_eq!(value([0.2, 0.2]), 1.0);
    assert_eq!(value([0.5, 0.2]), 2.0);
    assert_eq!(value([0.5, 0.95]), 3.0);
    assert_eq!(value([2.0, 0.5]), 7.0);
}

#[test]
fn tables_are_read_upwards() {
    let table = Field::Table {
        layers: vec![vec![vec![1.0, 2.0], vec![3.0, 4.0]]],
        by: By::Body,
    };
    assert_eq!(table.eval(&at([0.0; 2], [1, 0], [0, 0])), 2.0);
    assert_eq!(table.eval(&at([0.0; 2], [0, 1], [0, 0])), 3.0);
    assert!(table.eval(&at([0.0; 2], [2, 0], [0, 0])).is_nan());
}
