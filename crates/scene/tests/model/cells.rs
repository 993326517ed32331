//! Unit tests of `crates/scene/src/model/cells/mod.rs`.

use super::*;

#[test]
fn as_many_cells_as_elements_are_one_to_one() {
    for n in [1, 2, 7, 100] {
        assert!((0..n).all(|e| cell(e, n, n) == e));
    }
    // With three elements per cell; then with two cells per element, where the midpoint is their common end and
    // belongs to the right one.
    let coarse: Vec<usize> = (0..6).map(|e| cell(e, 6, 2)).collect();
    assert_eq!(coarse, [0, 0, 0, 1, 1, 1]);
    let fine: Vec<usize> = (0..3).map(|e| cell(e, 3, 6)).collect();
    assert_eq!(fine, [1, 3, 5]);
    assert_eq!(cell(9, 10, 3), 2);
}

#[test]
fn a_grid_of_bodies_shares_the_cells() {
    let values: Vec<f64> = (1..=24).map(f64::from).collect();
    let cells = CellGrid::new("c", [6, 4, 1], values.clone()).unwrap();
    let cells = cells.over([3, 2, 1]);
    let mesh = BoxMesh::plane([0.0; 2], [1.0; 2], [2, 2], [2, 1]);
    let mut seen = vec![0.0; 24];
    for place in mesh::places([3, 2, 1]) {
        for s in 0..2 {
            let block = mesh.block(s);
            let found = cells.sample(place, &mesh, &block).unwrap();
            assert_eq!(found.len(), 2);
            for (j, v) in found.iter().enumerate() {
                seen[(2 * place[1] + j) * 6 + 2 * place[0] + s] = *v;
            }
        }
    }
    assert_eq!(seen, values);
    let message = cells.sample([3, 0, 0], &mesh, &mesh.block(0)).unwrap_err();
    assert!(message.to_string().contains("covers 3 x 2 bodies"));
}

#[test]
fn a_nan_is_not_forgotten() {
    let range = |v: &[f64]| super::range(v.iter().copied());
    assert_eq!(range(&[3.0, -1.0, 2.0]), [-1.0, 3.0]);
    for v in [[f64::NAN, 1.0, 2.0], [1.0, f64::NAN, 2.0]] {
        assert!(range(&v)[0].is_nan() && range(&v)[1].is_nan());
    }
    let cells = CellGrid::new("c", [3, 1, 1], vec![1.0, f64::NAN, 2.0]).unwrap();
    let (value, named) = cells.find(|v| v.is_nan()).unwrap().unwrap();
    assert!(value.is_nan());
    assert_eq!(named, "cell (1, 0) of 3 x 1 in c");
    assert!(cells.find(|v| v == 0.0).unwrap().is_none());
}
