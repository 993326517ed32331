use super::super::testing::{affine, distorted, solid_kinds, straight};
use super::*;

#[test]
fn the_total_of_a_constant_force_is_exact_on_curved_cells() {
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = distorted(kind, 1);
        let mut out = vec![f64::NAN; dim * kind.nodes()];
        body_load(kind, dim, &points, dim, |_| [2.0, -3.0, 5.0], &mut out);
        for i in 0..dim {
            let total: f64 = out.iter().skip(i).step_by(dim).sum();
            let expected = [2.0, -3.0, 5.0][i] * volume(kind, dim, &points);
            assert!((total - expected).abs() < 1e-13, "{kind:?}");
        }
    }
}

#[test]
fn the_moment_of_a_constant_force_is_that_of_the_first_moment_of_the_cell() {
    // Σ x_a ∫ N_a = ∫ x, which for affine cells is the volume times the centroid.
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = affine(kind);
        let mut out = vec![0.0; kind.nodes()];
        body_load(kind, dim, &points, 1, |_| [1.0, 0.0, 0.0], &mut out);
        let middle = middle(kind, &points);
        for i in 0..dim {
            let moment: f64 = out.iter().zip(&points).map(|(f, p)| f * p[i]).sum();
            let expected = volume(kind, dim, &points) * middle[i];
            assert!(
                (moment - expected).abs() < 1e-13,
                "{kind:?} {moment} {expected}"
            );
        }
    }
}

#[test]
fn forces_that_grow_linearly_have_an_exact_total() {
    // The same moment, from the force and not from the shape functions.
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = affine(kind);
        let mut out = vec![0.0; kind.nodes()];
        body_load(kind, dim, &points, 1, |[x, ..]| [x, 0.0, 0.0], &mut out);
        let total: f64 = out.iter().sum();
        let expected = volume(kind, dim, &points) * middle(kind, &points)[0];
        assert!(
            (total - expected).abs() < 1e-13,
            "{kind:?} {total} {expected}"
        );
    }
}

#[test]
fn volumes_are_those_of_subdivided_cells() {
    // The volume under the map, from many small simplices between images of points: only for cells with straight edges
    // and flat sides is the polyhedron of the corners the cell, so that the affine cells are checked by formula.
    for (kind, expected) in [
        (CellKind::Triangle6, 0.5),
        (CellKind::Quad9, 4.0),
        (CellKind::Tet10, 1.0 / 6.0),
        (CellKind::Pyramid5, 4.0 / 3.0),
        (CellKind::Wedge15, 1.0),
        (CellKind::Hex20, 8.0),
    ] {
        // det of the affine map of the tests.
        let det = if kind.dim() == 2 {
            0.8 * 1.2 + 0.1 * 0.2
        } else {
            0.8 * (1.2 * 0.7 + 0.1 * 0.3) - 0.2 * (-0.1 * 0.7 - 0.2 * 0.3)
                + 0.1 * (0.1 * 0.1 - 0.2 * 1.2)
        };
        let found = volume(kind, kind.dim(), &affine(kind));
        assert!((found - det * expected).abs() < 1e-14, "{kind:?}");
    }
}

#[test]
fn an_inverted_cell_has_a_negative_volume() {
    let mut points = straight(CellKind::Tet4, 3);
    let volume = |points: &[[f64; 3]]| volume(CellKind::Tet4, 3, points);
    let before = volume(&points);
    points.swap(1, 2);
    assert!((volume(&points) + before).abs() < 1e-15 && before > 0.0);
}

#[test]
fn a_curved_triangle_has_the_area_of_its_parabolas() {
    // The hypotenuse bulges by h: 2/3 h times its length more.
    let mut points = super::super::shape_functions::reference_nodes(CellKind::Triangle6);
    let h = 0.1;
    points[4][0] += h / 2_f64.sqrt();
    points[4][1] += h / 2_f64.sqrt();
    let found = volume(CellKind::Triangle6, 2, &points);
    assert!(
        (found - 0.5 - 2.0 / 3.0 * h * 2_f64.sqrt()).abs() < 1e-15,
        "{found}"
    );
}
