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
    let out = pieces(&k, &[5, 6, 6, 7], [1, 1], Some(2));
    assert_eq!(out.len(), 2);
    assert_eq!(
        (&out[0].dofs[..], &out[1].dofs[..]),
        (&[5, 6][..], &[6, 7][..])
    );
    assert!(out
        .iter()
        .all(|p| p.k.get(1, 1) == 1.0 && p.body == Some(2)));
    // Without repetition they are one piece, and the shared end has both stiffnesses.
    let whole = piece(&k, &[5, 6, 6, 7], 1, None).unwrap();
    assert_eq!(whole.k.get(1, 1), 2.0);
}

#[test]
fn components_of_a_node_are_in_one_piece() {
    // Two nodes of two components; the components are not coupled by the matrix.
    let k = springs(4, &[(0, 2), (1, 3)]);
    assert_eq!(pieces(&k, &[0, 1, 2, 3], [2, 2], None).len(), 1);
    assert_eq!(pieces(&k, &[0, 1, 2, 3], [1, 1], None).len(), 2);
}

#[test]
fn rows_that_are_alone_are_a_piece_of_their_own() {
    let mut triplets = vec![(0, 0, 3.0), (3, 3, 4.0)];
    triplets.extend([(1, 1, 1.0), (2, 2, 1.0), (1, 2, -1.0), (2, 1, -1.0)]);
    let out = pieces(
        &Csr::from_triplets(4, &triplets),
        &[8, 9, 4, 8],
        [1, 1],
        None,
    );
    assert_eq!(out.len(), 2);
    assert_eq!(out[0].dofs, [4, 9]);
    assert_eq!((&out[1].dofs[..], out[1].k.get(0, 0)), (&[8][..], 7.0));
}

/// Two nodes of two components whose blocks are coupled, and a row that is held: zeros between coupled rows stay.
#[test]
fn zeros_in_blocks_that_are_coupled_stay() {
    let mut triplets = vec![
        (4, 4, 1.0),
        (4, 0, 0.0),
        (0, 4, 0.0),
        (5, 5, 1.0),
        (5, 1, 0.0),
    ];
    for (i, j, v) in [
        (0, 2, -1.0),
        (1, 3, -1.0),
        (0, 3, 0.0),
        (1, 2, 0.0),
        (0, 1, 0.0),
    ] {
        triplets.extend([(i, j, v), (j, i, v)]);
    }
    triplets.extend((0..4).map(|i| (i, i, 2.0)));
    let k = Csr::from_triplets(6, &triplets);
    let columns = |block_size: usize| {
        let k = piece(&k, &[0, 1, 2, 3, 4, 5], block_size, None).unwrap().k;
        (0..6).map(|i| k.row(i).0.to_vec()).collect::<Vec<_>>()
    };
    let all = vec![0, 1, 2, 3];
    assert_eq!(columns(2)[..2], [all.clone(), all]);
    // The lower node has no stored zero between its components.
    assert_eq!(
        columns(2)[2..],
        [vec![0, 1, 2], vec![0, 1, 3], vec![4], vec![5]]
    );
    assert_eq!(columns(1)[..2], [vec![0, 2], vec![1, 3]]);
}
