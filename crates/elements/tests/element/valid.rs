use super::super::shape_functions::reference_nodes;
use super::super::testing::{distorted, solid_kinds, straight, Random};
use super::*;

fn check(kind: CellKind, points: &[[f64; 3]]) -> Result<Option<Doubt>, BadCell> {
    check_jacobian(kind, kind.dim(), points, Integration::Full)
}

/// det J at the worst node of a cell that is sound where it is integrated, and the node.
fn doubt(kind: CellKind, points: &[[f64; 3]]) -> (f64, Option<usize>) {
    let found = check(kind, points).expect("sound where it is integrated");
    let doubt = found.expect("a doubtful cell");
    (doubt.jacobian, doubt.node)
}

#[test]
fn sound_cells_pass_curved_or_not() {
    for kind in solid_kinds() {
        assert_eq!(check(kind, &reference_nodes(kind)), Ok(None), "{kind:?}");
        for seed in 0..20 {
            assert_eq!(check(kind, &distorted(kind, seed)), Ok(None), "{kind:?}");
            assert_eq!(check(kind, &straight(kind, seed)), Ok(None), "{kind:?}");
        }
    }
}

#[test]
fn needles_and_tiny_cells_pass() {
    for kind in solid_kinds() {
        for (stretch, size) in [(1e-6, 1.0), (1.0, 1e-9), (1e-4, 1e12)] {
            let map = |[x, y, z]: [f64; 3]| [size * x, size * stretch * y, size * z];
            let points: Vec<_> = straight(kind, 1).into_iter().map(map).collect();
            assert_eq!(check(kind, &points), Ok(None), "{kind:?} {stretch} {size}");
        }
    }
}

#[test]
fn mirrored_cells_are_inverted() {
    for kind in solid_kinds() {
        for points in [distorted(kind, 2), straight(kind, 2)] {
            let points: Vec<_> = points.iter().map(|p| [-p[0], p[1], p[2]]).collect();
            assert_eq!(check(kind, &points), Err(BadCell::Inverted), "{kind:?}");
        }
    }
}

#[test]
fn flat_cells_are_degenerate() {
    for kind in solid_kinds() {
        let last = kind.dim() - 1;
        let mut points = distorted(kind, 3);
        for p in &mut points {
            p[last] = 0.3 * p[0] + if last == 2 { 0.1 * p[1] } else { 0.0 };
        }
        assert_eq!(check(kind, &points), Err(BadCell::Degenerate), "{kind:?}");
        let point = vec![[1.0, 2.0, 0.0]; kind.nodes()];
        assert_eq!(check(kind, &point), Err(BadCell::Degenerate), "{kind:?}");
    }
}

#[test]
fn coordinates_have_to_be_finite() {
    for kind in solid_kinds() {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut points = distorted(kind, 3);
            points[1][0] = bad;
            assert_eq!(check(kind, &points), Err(BadCell::NotFinite), "{kind:?}");
        }
    }
}

#[test]
fn crossed_quadrilaterals_are_folded() {
    let mut points = reference_nodes(CellKind::Quad4);
    points.swap(2, 3);
    assert_eq!(check(CellKind::Quad4, &points), Err(BadCell::Folded));
    // A corner that lies inside the triangle of the others.
    let dart = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.3, 0.3, 0.0],
        [0.0, 1.0, 0.0],
    ];
    assert_eq!(check(CellKind::Quad4, &dart), Err(BadCell::Folded));
    let mut cube = reference_nodes(CellKind::Hex8);
    cube.swap(4, 5);
    cube.swap(6, 7);
    assert_eq!(check(CellKind::Hex8, &cube), Err(BadCell::Folded));
}

#[test]
fn a_middle_node_beyond_a_quarter_is_doubtful() {
    for kind in [
        CellKind::Triangle6,
        CellKind::Quad8,
        CellKind::Quad9,
        CellKind::Tet10,
        CellKind::Wedge15,
        CellKind::Hex20,
    ] {
        let corners = kind.corners();
        let at = |part: f64| {
            let mut points = reference_nodes(kind);
            let [p, q] = kind.edges()[0].map(usize::from);
            points[corners] =
                [0, 1, 2].map(|d| points[p][d] + part * (points[q][d] - points[p][d]));
            points
        };
        assert_eq!(check(kind, &at(0.26)), Ok(None), "{kind:?}");
        // Quarter points, as at the tip of a crack: no volume at the corner, and none of it is integrated there.
        let first = usize::from(kind.edges()[0][0]);
        assert_eq!(doubt(kind, &at(0.25)), (0.0, Some(first)), "{kind:?}");
        let (folded, node) = doubt(kind, &at(0.24));
        assert!(folded < 0.0 && node == Some(first), "{kind:?}");
        // Far enough inside, a point of integration is folded, too.
        assert_eq!(check(kind, &at(-0.6)), Err(BadCell::Folded), "{kind:?}");
    }
}

#[test]
fn collapsed_hexahedra_have_no_volume_at_corners() {
    // An edge of the bottom and of the top shrinks to a point: a wedge.
    let mut points = reference_nodes(CellKind::Hex8);
    points[3] = points[2];
    points[7] = points[6];
    assert_eq!(doubt(CellKind::Hex8, &points).0, 0.0);
    let mut triangle = reference_nodes(CellKind::Quad4);
    triangle[3] = triangle[2];
    assert_eq!(doubt(CellKind::Quad4, &triangle).0, 0.0);
}

#[test]
fn edges_that_bulge_through_the_cell_are_folded() {
    let mut points = reference_nodes(CellKind::Triangle6);
    points[3] = [0.45, 0.45, 0.0];
    assert_eq!(check(CellKind::Triangle6, &points), Err(BadCell::Folded));
    let mut points = reference_nodes(CellKind::Tet10);
    points[4] = [0.5, 0.3, 0.3];
    assert_eq!(check(CellKind::Tet10, &points), Err(BadCell::Folded));
}

#[test]
fn quadrilaterals_are_judged_by_the_signs_at_their_corners() {
    // det J is linear in s and t: it is positive inside if it is at the corners.
    let mut random = Random::new(5);
    let mut seen = [0; 2];
    for _ in 0..500 {
        let points: Vec<[f64; 3]> = reference_nodes(CellKind::Quad4)
            .iter()
            .map(|p| [p[0] + 1.2 * random.next(), p[1] + 1.2 * random.next(), 0.0])
            .collect();
        let turn = |a: usize| {
            let [p, q, r] = [3, 4, 5].map(|k| points[(a + k) % 4]);
            (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0])
        };
        let sound = (0..4).all(|a| turn(a) > 0.0);
        assert_eq!(check(CellKind::Quad4, &points) == Ok(None), sound);
        seen[usize::from(sound)] += 1;
    }
    assert!(seen[0] > 20 && seen[1] > 20);
}

#[test]
fn messages_are_clauses() {
    for bad in [
        BadCell::NotFinite,
        BadCell::Inverted,
        BadCell::Degenerate,
        BadCell::Folded,
    ] {
        let clause = bad.to_string();
        assert!(
            !clause.ends_with('.') && (clause.starts_with("is ") || clause.starts_with("has "))
        );
    }
}

/// The points of the cell's own rule decide: one in the middle, four or eight, nine or 27.
#[test]
fn fewer_points_refuse_less() {
    // A corner that is pulled far into the cell: the points near it fold first.
    let at = |kind: CellKind, part: f64| {
        let mut points = reference_nodes(kind);
        for x in &mut points[2][..kind.dim()] {
            *x -= part * x.signum();
        }
        points
    };
    for kind in [CellKind::Quad4, CellKind::Hex8] {
        let deep = at(kind, 1.7);
        let full = check_jacobian(kind, kind.dim(), &deep, Integration::Full);
        assert_eq!(full, Err(BadCell::Folded), "{kind:?}");
        let reduced = check_jacobian(kind, kind.dim(), &deep, Integration::Reduced);
        assert!(reduced.expect("sound in the middle").is_some(), "{kind:?}");
    }
}

/// Mirrored where one corner is folded: most of it is inside out.
#[test]
fn a_mirrored_cell_with_a_folded_corner_is_inverted() {
    let mut points = reference_nodes(CellKind::Quad8);
    points[4] = [0.0, -1.505, 0.0];
    points[5] = [1.505, 0.0, 0.0];
    let (folded, node) = doubt(CellKind::Quad8, &points);
    assert!(folded < 0.0 && node == Some(1), "{folded} {node:?}");
    let mirrored: Vec<_> = points.iter().map(|p| [-p[0], p[1], 0.0]).collect();
    assert_eq!(check(CellKind::Quad8, &mirrored), Err(BadCell::Inverted));
}
