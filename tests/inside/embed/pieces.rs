//! Unit tests of `src/embed/pieces.rs`.

use super::*;

/// Springs of stiffness one between rows, two components a node: the first rows of the nodes are coupled, and so
/// are the second ones.
fn springs(n: usize, pairs: &[(u32, u32)]) -> Csr {
    let mut triplets = Vec::new();
    for &(a, b) in pairs {
        triplets.extend([(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)]);
    }
    Csr::from_triplets(n, &triplets)
}

#[test]
fn two_bars_that_share_an_end() {
    // Rows 0, 1 | 2, 3: the dofs 5, 6 | 6, 7.
    let k = springs(4, &[(0, 1), (2, 3)]);
    let out = pieces(&k, &[5, 6, 6, 7], 1, Some(2));
    assert_eq!(out.len(), 2);
    assert_eq!(
        (&out[0].dofs[..], &out[1].dofs[..]),
        (&[5, 6][..], &[6, 7][..])
    );
    assert!(out
        .iter()
        .all(|p| p.k.get(1, 1) == 1.0 && p.body == Some(2)));
    // Without repetition they are one piece, and the shared end has both stiffnesses.
    let whole = piece(&k, &[5, 6, 6, 7], None).unwrap();
    assert_eq!(whole.k.get(1, 1), 2.0);
}

#[test]
fn components_of_a_node_are_in_one_piece() {
    // Two nodes of two components; the components are not coupled by the matrix.
    let k = springs(4, &[(0, 2), (1, 3)]);
    assert_eq!(pieces(&k, &[0, 1, 2, 3], 2, None).len(), 1);
    assert_eq!(pieces(&k, &[0, 1, 2, 3], 1, None).len(), 2);
}

#[test]
fn rows_that_are_alone_are_a_piece_of_their_own() {
    let mut triplets = vec![(0, 0, 3.0), (3, 3, 4.0)];
    triplets.extend([(1, 1, 1.0), (2, 2, 1.0), (1, 2, -1.0), (2, 1, -1.0)]);
    let out = pieces(&Csr::from_triplets(4, &triplets), &[8, 9, 4, 8], 1, None);
    assert_eq!(out.len(), 2);
    assert_eq!(out[0].dofs, [4, 9]);
    assert_eq!((&out[1].dofs[..], out[1].k.get(0, 0)), (&[8][..], 7.0));
}
