//! Unit tests of `src/report/pictures/surface.rs`.

use super::*;

/// Owned arrays of a solid.
#[derive(Default)]
pub(crate) struct Blocks {
    pub points: Vec<[f64; 3]>,
    pub hexahedra: Vec<[u32; 8]>,
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
                out.hexahedra
                    .push([ring[0], ring[1], ring[2], ring[3], p, q, r, s]);
                out.body.push(body);
                out.subdomain.push(2 * body + half);
            }
        }
        out
    }

    pub(crate) fn view(&self) -> Solid<'_> {
        Solid {
            points: &self.points,
            shown: &self.points,
            corners: &self.hexahedra,
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
        corners: [
            [0.0, 1.0, 0.0],
            [0.25, 1.0, 0.0],
            [0.25, 1.0, 0.25],
            [0.0, 1.0, 0.25],
        ],
        closed: true,
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
    let short = Solid {
        body: &blocks.body[1..],
        ..view
    };
    assert!(short.check().unwrap_err().to_string().contains("7 bodies"));
    let far = Solid {
        points: &blocks.points[1..],
        shown: &blocks.points[1..],
        ..view
    };
    assert!(far.check().unwrap_err().to_string().contains("names point"));
    view.check().unwrap();
}
