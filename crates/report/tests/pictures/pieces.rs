//! Unit tests of `crates/report/src/pictures/pieces.rs`.

use super::*;

/// Nodes of a cell with corners on a square or triangle, middles in the middle.
fn places(kind: CellKind) -> Vec<[f64; 2]> {
    let corners: &[[f64; 2]] = match kind.corners() {
        3 => &[[0., 0.], [2., 0.], [0., 2.]],
        _ => &[[0., 0.], [2., 0.], [2., 2.], [0., 2.]],
    };
    let mut out = corners.to_vec();
    for &[a, b] in kind.edges().iter().take(kind.nodes() - corners.len()) {
        let [p, q] = [a, b].map(|k| corners[usize::from(k)]);
        out.push([0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]);
    }
    if kind == CellKind::Quad9 {
        out.push([1., 1.]);
    }
    out
}

#[test]
fn pieces_cover_a_cell_once_in_its_orientation() {
    for kind in CellKind::ALL.into_iter().filter(|k| k.dim() == 2) {
        let at = places(kind);
        let mut total = 0.0;
        let mut used = vec![false; kind.nodes()];
        for piece in pieces(kind) {
            let area = edges(*piece).map(|(a, b)| {
                let [p, q] = [a, b].map(|k| at[usize::from(k)]);
                0.5 * (p[0] * q[1] - p[1] * q[0])
            });
            let area: f64 = area.sum();
            assert!(area > 0.4, "{kind:?} {piece:?} {area}");
            total += area;
            piece.iter().for_each(|&k| used[usize::from(k)] = true);
        }
        let expected = if kind.corners() == 3 { 2.0 } else { 4.0 };
        assert!((total - expected).abs() < 1e-14, "{kind:?} {total}");
        assert!(used.iter().all(|u| *u), "{kind:?}");
    }
}

#[test]
fn a_triangle_has_three_edges() {
    assert_eq!(edges([0, 1, 2, 2]).count(), 3);
    assert_eq!(edges([0, 1, 2, 3]).count(), 4);
}
