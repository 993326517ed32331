//! Unit tests of `crates/report/src/pictures/surface.rs`.

use super::*;
use elements::kind::CellKind;
use mesh::Cells;

/// Owned arrays of a solid.
#[derive(Default)]
pub(crate) struct Blocks {
    pub points: Vec<[f64; 3]>,
    pub cells: Cells,
    pub body: Vec<u32>,
    pub subdomain: Vec<u32>,
}

impl Blocks {
    /// `bodies` unit cubes on top of each other, each of two subdomains (left and right) with points of their own,
    /// n × n × n cells.
    pub(crate) fn new(bodies: u32, n: u32) -> Blocks {
        let mut out = Blocks::default();
        for (body, half) in (0..bodies).flat_map(|b| [(b, 0), (b, 1)]) {
            let first = out.points.len() as u32;
            let nodes = [n / 2 + 1, n + 1, n + 1];
            for k in 0..nodes[0] * nodes[1] * nodes[2] {
                let at = [
                    k % nodes[0] + half * n / 2,
                    k / nodes[0] % nodes[1],
                    k / nodes[0] / nodes[1],
                ];
                let mut p = at.map(|i| f64::from(i) / f64::from(n));
                p[1] += f64::from(body);
                out.points.push(p);
            }
            let (row, layer) = (nodes[0], nodes[0] * nodes[1]);
            for c in 0..n / 2 * n * n {
                let at = [c % (n / 2), c / (n / 2) % n, c / (n / 2) / n];
                let a = first + at[0] + row * at[1] + layer * at[2];
                let ring = [a, a + 1, a + 1 + row, a + row];
                let [p, q, r, s] = ring.map(|k| k + layer);
                let nodes = [ring[0], ring[1], ring[2], ring[3], p, q, r, s];
                out.cells.push(CellKind::Hex8, &nodes);
                out.body.push(body);
                out.subdomain.push(2 * body + half);
            }
        }
        out
    }

    pub(crate) fn view(&self) -> SolidMesh<'_> {
        SolidMesh {
            points: &self.points,
            shown: &self.points,
            cells: &self.cells,
            body: &self.body,
            subdomain: &self.subdomain,
        }
    }
}

#[test]
fn the_surface_of_two_cubes() {
    let blocks = Blocks::new(2, 4);
    let mark = FaceMark {
        body: 1,
        partner: None,
        corners: [
            [0.0, 1.0, 0.0],
            [0.25, 1.0, 0.0],
            [0.25, 1.0, 0.25],
            [0.0, 1.0, 0.25],
        ],
        closed: Some(true),
    };
    let surface = blocks.view().surface(&[mark]);
    assert_eq!(surface.faces.len(), 2 * 6 * 16);
    // Normals point outwards: the volume by the divergence theorem.
    let volume: f64 = surface
        .faces
        .iter()
        .map(|f| {
            let [a, b, c, d] = f.corners.map(|p| blocks.points[p as usize]);
            let (u, v) = (
                [0, 1, 2].map(|i| c[i] - a[i]),
                [0, 1, 2].map(|i| d[i] - b[i]),
            );
            let n = unit_cross(u, v);
            (0..3)
                .map(|i| n[i] * 0.25 * (a[i] + b[i] + c[i] + d[i]))
                .sum::<f64>()
                / 16.0
                / 3.0
        })
        .sum();
    assert!((volume - 2.0).abs() < 1e-12, "{volume}");
    // Twelve edges of four cells each around a cube; the line between its subdomains runs around four sides.
    let creases = surface.edges.iter().filter(|e| e.crease).count();
    assert_eq!((creases, surface.edges.len() - creases), (2 * 48, 2 * 16));
    let marked: Vec<_> = surface.faces.iter().filter(|f| f.mark.is_some()).collect();
    assert_eq!(marked.len(), 1);
    assert_eq!(
        (marked[0].mark, blocks.body[marked[0].cell as usize]),
        (Some(true), 1)
    );
}

#[test]
fn misfits_are_refused() {
    let blocks = Blocks::new(1, 2);
    let view = blocks.view();
    let short = SolidMesh {
        body: &blocks.body[1..],
        ..view
    };
    assert!(short.check().unwrap_err().to_string().contains("7 bodies"));
    let far = SolidMesh {
        points: &blocks.points[1..],
        shown: &blocks.points[1..],
        ..view
    };
    assert!(far.check().unwrap_err().to_string().contains("names point"));
    view.check().unwrap();
}

/// The volume that some faces enclose, by the divergence theorem.
fn volume(solid: &SolidMesh, surface: &VisibleSurface) -> f64 {
    let triangle = |[a, b, c]: [[f64; 3]; 3]| dot(a, cross(b, c)) / 6.0;
    let face = |f: &OuterFace| {
        let [a, b, c, d] = f.corners.map(|p| solid.points[p as usize]);
        triangle([a, b, c]) + triangle([a, c, d])
    };
    surface.faces.iter().map(face).sum()
}

/// Two tetrahedra of second order with a common side, and a pyramid on a wedge: inner sides are not shown, whatever the
/// kinds of their cells, and normals point outwards.
#[test]
fn the_surface_of_cells_of_other_kinds() {
    let corner = [
        [0., 0., 0.],
        [1., 0., 0.],
        [0., 1., 0.],
        [0., 0., 1.],
        [1., 1., 1.],
    ];
    let mut points: Vec<[f64; 3]> = corner.to_vec();
    let mut cells = Cells::default();
    for tet in [[0, 1, 2, 3], [1, 4, 2, 3]] {
        let mut nodes: Vec<u32> = tet.to_vec();
        for &[a, b] in CellKind::Tet10.edges() {
            let [a, b] = [a, b].map(|k| corner[tet[usize::from(k)] as usize]);
            let middle = [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]));
            let known = points.iter().position(|p| *p == middle);
            nodes.push(known.unwrap_or(points.len()) as u32);
            if known.is_none() {
                points.push(middle);
            }
        }
        cells.push(CellKind::Tet10, &nodes);
    }
    let solid = SolidMesh {
        points: &points,
        shown: &points,
        cells: &cells,
        body: &[0, 0],
        subdomain: &[0, 1],
    };
    let mark = FaceMark {
        body: 0,
        partner: None,
        corners: [corner[0], corner[2], corner[1], corner[1]],
        closed: Some(false),
    };
    let surface = solid.surface(&[mark]);
    assert_eq!(surface.faces.len(), 6 * 4);
    assert!((volume(&solid, &surface) - 0.5).abs() < 1e-14);
    let marked = surface.faces.iter().filter(|f| f.mark == Some(false));
    assert_eq!(marked.count(), 4);
    // Two chords for each edge: nine around the two cells, all of them creases, as no two of the outer sides are flat.
    assert_eq!(surface.edges.len(), 2 * 9);

    let points = [
        [0., 0., 0.],
        [1., 0., 0.],
        [0., 1., 0.],
        [0., 0., 1.],
        [1., 0., 1.],
        [0., 1., 1.],
        [1., 1., 0.5],
    ];
    let mut cells = Cells::default();
    cells.push(CellKind::Wedge6, &[0, 1, 2, 3, 4, 5]);
    cells.push(CellKind::Pyramid5, &[1, 2, 5, 4, 6]);
    let solid = SolidMesh {
        points: &points,
        shown: &points,
        cells: &cells,
        body: &[0, 0],
        subdomain: &[0, 0],
    };
    let surface = solid.surface(&[]);
    assert_eq!(surface.faces.len(), 4 + 4);
    // The wedge has half the unit cube; the pyramid's base is √2 × 1, its height √2/2.
    let expected = 0.5 + 1.0 / 3.0;
    assert!((volume(&solid, &surface) - expected).abs() < 1e-14);
}
