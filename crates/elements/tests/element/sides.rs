use super::super::testing::{affine, distorted, solid_kinds};
use super::super::volume;
use super::*;

/// Calls `f` with the points of every side.
fn for_each_side(kind: CellKind, points: &[[f64; 3]], mut f: impl FnMut(CellKind, &[[f64; 3]])) {
    for side in kind.sides() {
        let points: Vec<_> = side.nodes.iter().map(|&a| points[usize::from(a)]).collect();
        f(side.kind, &points);
    }
}

#[test]
fn normals_of_a_closed_surface_sum_to_zero_and_give_the_volume() {
    for kind in solid_kinds() {
        for seed in 0..5 {
            let dim = kind.dim();
            let points = distorted(kind, seed);
            let (mut sum, mut flux) = ([0.0; 3], 0.0);
            for_each_side(kind, &points, |side, points| {
                let weights = side_weights(side, dim, points);
                for (point, normal) in points.iter().zip(weights.normal) {
                    for i in 0..3 {
                        sum[i] += normal[i];
                        flux += point[i] * normal[i]; // ∫ x·n
                    }
                }
            });
            assert!(sum.iter().all(|s| s.abs() < 1e-13), "{kind:?}: {sum:?}");
            let volume = volume(kind, dim, &points);
            assert!(volume > 0.0);
            assert!(
                (flux / dim as f64 - volume).abs() < 1e-13,
                "{kind:?}: {flux} {volume}"
            );
        }
    }
}

#[test]
fn areas_of_flat_sides_are_exact() {
    // Sides of affine cells are flat: the area is the length of the summed normal.
    for kind in solid_kinds() {
        let dim = kind.dim();
        for_each_side(kind, &affine(kind), |side, points| {
            let weights = side_weights(side, dim, points);
            let area: f64 = weights.area.iter().sum();
            let mut normal = [0.0; 3];
            for n in weights.normal {
                for i in 0..3 {
                    normal[i] += n[i];
                }
            }
            assert!((area - norm(normal)).abs() < 1e-14 && area > 0.0);
            // And each node's share of the normal is that of the area.
            for (share, n) in weights.area.iter().zip(weights.normal) {
                for i in 0..3 {
                    assert!((n[i] * area - share * normal[i]).abs() < 1e-14);
                }
            }
            assert!(weights.area[points.len()..].iter().all(|&a| a == 0.0));
        });
    }
}

#[test]
fn shares_of_nodes_are_those_of_textbooks() {
    let unit = |kind| {
        let points = super::super::shape_functions::reference_nodes(kind);
        side_weights(kind, kind.dim() + 1, &points).area
    };
    let close = |kind, expected: &[f64]| {
        let found = unit(kind);
        for (a, share) in expected.iter().enumerate() {
            assert!((found[a] - share).abs() < 1e-15, "{kind:?}: {found:?}");
        }
    };
    close(CellKind::Line2, &[1.0, 1.0]);
    close(CellKind::Line3, &[1.0 / 3.0, 1.0 / 3.0, 4.0 / 3.0]);
    close(CellKind::Triangle3, &[1.0 / 6.0; 3]);
    close(
        CellKind::Triangle6,
        &[0.0, 0.0, 0.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0],
    );
    close(CellKind::Quad4, &[1.0; 4]);
    let third = 1.0 / 3.0;
    close(
        CellKind::Quad8,
        &[
            -third,
            -third,
            -third,
            -third,
            4.0 * third,
            4.0 * third,
            4.0 * third,
            4.0 * third,
        ],
    );
    let ninth = 1.0 / 9.0;
    close(
        CellKind::Quad9,
        &[
            ninth,
            ninth,
            ninth,
            ninth,
            4.0 * ninth,
            4.0 * ninth,
            4.0 * ninth,
            4.0 * ninth,
            16.0 * ninth,
        ],
    );
}

#[test]
fn a_constant_pressure_on_a_closed_surface_has_total_zero() {
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = distorted(kind, 7);
        let mut total = [0.0; 3];
        for_each_side(kind, &points, |side, points| {
            let mut out = vec![f64::NAN; dim * points.len()];
            side_load(side, dim, points, dim, |_, n| n.map(|n| -3.0 * n), &mut out);
            // The forces are those of the weights.
            let weights = side_weights(side, dim, points);
            for (a, node) in out.chunks_exact(dim).enumerate() {
                for i in 0..dim {
                    assert!((node[i] + 3.0 * weights.normal[a][i]).abs() < 1e-14);
                    total[i] += node[i];
                }
            }
        });
        assert!(total.iter().all(|t| t.abs() < 1e-13), "{kind:?}");
    }
}

#[test]
fn a_traction_that_grows_linearly_has_the_moments_of_the_side() {
    // On the flat sides of affine cells: total and first moment of t = x, by the divergence theorem of the whole cell
    // for the function x²/2: ∫ x n_x over the surface is the volume.
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = affine(kind);
        let mut sum = 0.0;
        for_each_side(kind, &points, |side, points| {
            let mut out = vec![0.0; points.len()];
            side_load(
                side,
                dim,
                points,
                1,
                |x, n| [x[0] * n[0], 0.0, 0.0],
                &mut out,
            );
            sum += out.iter().sum::<f64>();
        });
        assert!((sum - volume(kind, dim, &points)).abs() < 1e-13, "{kind:?}");
    }
}
