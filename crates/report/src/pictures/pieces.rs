//! Plane cells and sides cut into quadrilaterals and triangles with corners at their nodes, to paint them: a curved
//! edge of three nodes becomes two chords.

use elements::kind::CellKind;

/// The pieces of a plane cell as places among its nodes, in its orientation; a triangle repeats its last corner.
pub fn pieces(kind: CellKind) -> &'static [[u8; 4]] {
    match kind {
        CellKind::Triangle3 => &[[0, 1, 2, 2]],
        CellKind::Triangle6 => &[[0, 3, 5, 5], [3, 1, 4, 4], [5, 4, 2, 2], [3, 4, 5, 5]],
        CellKind::Quad4 => &[[0, 1, 2, 3]],
        CellKind::Quad8 => &[
            [0, 4, 7, 7],
            [4, 1, 5, 5],
            [5, 2, 6, 6],
            [6, 3, 7, 7],
            [4, 5, 6, 7],
        ],
        CellKind::Quad9 => &[[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]],
        _ => &[],
    }
}

/// The four edges of a piece; those of no length are left out.
pub(crate) fn edges<T: Copy + PartialEq>(piece: [T; 4]) -> impl Iterator<Item = (T, T)> {
    let edges = (0..4).map(move |k| (piece[k], piece[(k + 1) % 4]));
    edges.filter(|(a, b)| a != b)
}

#[cfg(test)]
#[path = "../../tests/pictures/pieces.rs"]
mod tests;
