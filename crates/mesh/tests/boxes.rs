//! Unit tests of `crates/mesh/src/boxes.rs`.

use super::*;

fn mesh() -> BoxMesh {
    BoxMesh::plane([1.0, -1.0], [3.0, 2.0], [6, 4], [3, 2])
}

#[test]
fn owners_and_multiplicities_agree_with_the_blocks() {
    let m = mesh();
    for node in 0..m.n_nodes() {
        let place = m.place(node);
        assert_eq!(m.node(place), node);
        let holders: Vec<usize> = (0..m.n_subdomains())
            .filter(|&s| {
                let b = m.block(s);
                (0..3).all(|d| (b.first[d]..=b.first[d] + b.elements[d]).contains(&place[d]))
            })
            .collect();
        assert_eq!(m.owner(place), holders[0]);
        assert_eq!(m.multiplicity(place), holders.len());
    }
}

#[test]
fn vertices_are_shared_except_at_the_corners_of_the_body() {
    let m = mesh();
    let vertices = |shared: bool| -> Vec<[usize; 3]> {
        (0..m.n_nodes())
            .map(|n| m.place(n))
            .filter(|&p| m.is_vertex(p) && (m.multiplicity(p) > 1) == shared)
            .collect()
    };
    let shared = [
        [2, 0, 0],
        [4, 0, 0],
        [0, 2, 0],
        [2, 2, 0],
        [4, 2, 0],
        [6, 2, 0],
        [2, 4, 0],
        [4, 4, 0],
    ];
    assert_eq!(vertices(true), shared);
    assert_eq!(
        vertices(false),
        [[0, 0, 0], [6, 0, 0], [0, 4, 0], [6, 4, 0]]
    );
}

#[test]
fn the_boundary_is_walked_once_in_order() {
    let m = mesh();
    let walked: Vec<usize> = m.boundary().map(|p| m.node(p)).collect();
    let expected: Vec<usize> = (0..m.n_nodes())
        .filter(|&n| m.sides(m.place(n)).next().is_some())
        .collect();
    assert_eq!(walked, expected);
    assert_eq!(m.position([6, 4, 0]), [4.0, 1.0, 0.0]);
    assert_eq!(m.sides([6, 0, 0]).collect::<Vec<_>>(), vec![1, 2]);
}

#[test]
fn a_solid_is_walked_like_a_plane() {
    let m = BoxMesh {
        origin: [0.0; 3],
        size: [1.0; 3],
        elements: [4, 2, 3],
        subdomains: [2, 2, 1],
    };
    assert_eq!((m.dim(), m.n_nodes(), m.n_elements()), (3, 60, 24));
    for node in 0..m.n_nodes() {
        let place = m.place(node);
        assert_eq!(m.node(place), node);
        let holders: Vec<usize> = (0..m.n_subdomains())
            .filter(|&s| m.block(s).places().any(|p| p == place))
            .collect();
        assert_eq!(
            (m.owner(place), m.multiplicity(place)),
            (holders[0], holders.len())
        );
    }
    let walked: Vec<usize> = m.boundary().map(|p| m.node(p)).collect();
    let expected: Vec<usize> = (0..m.n_nodes())
        .filter(|&n| m.sides(m.place(n)).next().is_some())
        .collect();
    assert_eq!(walked, expected);
    for side in 0..6 {
        let nodes: Vec<usize> = m.side_nodes(side).map(|p| m.node(p)).collect();
        let on = |n: &usize| m.sides(m.place(*n)).any(|s| s == side);
        assert_eq!(nodes, (0..60).filter(on).collect::<Vec<_>>());
    }
    assert_eq!((0..60).filter(|&n| m.is_vertex(m.place(n))).count(), 18);
}
