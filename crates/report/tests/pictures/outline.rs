//! Unit tests of `crates/report/src/pictures/outline.rs`.

use super::*;

/// Owned arrays of a mesh.
pub(crate) struct Grid {
    pub points: Vec<[f64; 2]>,
    pub quads: Vec<[u32; 4]>,
    pub body: Vec<u32>,
    pub subdomain: Vec<u32>,
}

impl Grid {
    pub(crate) fn view(&self) -> PlaneMesh<'_> {
        PlaneMesh {
            points: &self.points,
            shown: &self.points,
            corners: &self.quads,
            body: &self.body,
            subdomain: &self.subdomain,
        }
    }
}

/// bodies² bodies of subdomains² subdomains of elements² cells on the unit square; points listed once per body, or
/// once per subdomain.
pub(crate) fn grid(bodies: usize, subdomains: usize, elements: usize, per_subdomain: bool) -> Grid {
    let mut out = Grid {
        points: vec![],
        quads: vec![],
        body: vec![],
        subdomain: vec![],
    };
    let (patches, cells) = if per_subdomain {
        (bodies * subdomains, elements)
    } else {
        (bodies, subdomains * elements)
    };
    let total = patches * cells;
    for patch in 0..patches * patches {
        let (px, py) = (patch % patches, patch / patches);
        let first = out.points.len() as u32;
        let row = cells as u32 + 1;
        for j in 0..=cells {
            for i in 0..=cells {
                let at = |p: usize, k: usize| (p * cells + k) as f64 / total as f64;
                out.points.push([at(px, i), at(py, j)]);
            }
        }
        for j in 0..cells {
            for i in 0..cells {
                let a = first + j as u32 * row + i as u32;
                out.quads.push([a, a + 1, a + row + 1, a + row]);
                let (x, y) = (px * cells + i, py * cells + j);
                let per_body = subdomains * elements;
                out.body.push((y / per_body * bodies + x / per_body) as u32);
                out.subdomain
                    .push((y / elements * bodies * subdomains + x / elements) as u32);
            }
        }
    }
    out
}

fn length(lines: &[Vec<[f64; 2]>]) -> f64 {
    lines
        .iter()
        .flat_map(|l| l.windows(2))
        .map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1]))
        .sum()
}

#[test]
fn lines_have_the_right_length_however_points_are_listed() {
    for per_subdomain in [false, true] {
        let mesh = grid(3, 2, 5, per_subdomain);
        let lines = mesh.view().lines(&mesh.points, false);
        // 4 + 4 lines of length 1 around 3×3 bodies; 3 + 3 between their subdomains.
        assert!((length(&lines.bodies) - 8.0).abs() < 1e-12);
        assert!((length(&lines.subdomains) - 6.0).abs() < 1e-12);
        // Straight lines are joined across crossings.
        assert!(
            lines.bodies.len() <= 8 && lines.subdomains.len() == 6,
            "{}",
            lines.bodies.len()
        );
    }
}

#[test]
fn segments_become_long_lines() {
    let at = |k: i32| [1.0, 0.1 * f64::from(k)];
    // Ten segments in any direction, the fourth missing, the sixth twice.
    let segments = (0..10).filter(|&k| k != 3).map(|k| {
        if k % 2 == 0 {
            (at(k), at(k + 1))
        } else {
            (at(k + 1), at(k))
        }
    });
    let mut lines = joined(segments.chain([(at(5), at(6))]));
    lines.sort_by_key(Vec::len);
    let ends = |line: &[[f64; 2]]| {
        let (a, b) = (line[0][1], line[line.len() - 1][1]);
        (a.min(b), a.max(b))
    };
    assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [4, 7]);
    assert_eq!(ends(&lines[0]), (at(0)[1], at(3)[1]));
    assert_eq!(ends(&lines[1]), (at(4)[1], at(10)[1]));
    assert!(joined(std::iter::empty()).is_empty());
}

#[test]
fn misfits_are_refused() {
    let mesh = grid(1, 1, 2, false);
    let short = PlaneMesh {
        body: &mesh.body[..3],
        ..mesh.view()
    };
    assert!(short.check().unwrap_err().to_string().contains("3 bodies"));
    let far = PlaneMesh {
        points: &mesh.points[..8],
        shown: &mesh.points[..8],
        ..mesh.view()
    };
    assert!(far.check().unwrap_err().to_string().contains("point 8"));
}
