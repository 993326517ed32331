//! Triangulated regions of the plane with uniform triangles, between closed curves.

use std::f64::consts::TAU;

use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation,
};

/// Triangles in the plane.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Planform {
    /// Points.
    pub points: Vec<[f64; 2]>,
    /// Corners of each triangle, counterclockwise.
    pub triangles: Vec<[usize; 3]>,
}

impl Planform {
    /// Fills what lies within the curves with triangles whose edges are about `edge` long. Curves are lists of points
    /// with segments between consecutive ones; they may meet in common points only. `within` decides by the midpoint
    /// of a triangle whether it belongs to the region.
    pub fn fill(
        curves: &[Vec<[f64; 2]>],
        edge: f64,
        within: impl Fn([f64; 2]) -> bool,
    ) -> Planform {
        Planform::over(curves, &[], Some(edge), within)
    }

    /// As [`Planform::fill`], with further points inside; without `edge`, triangles are only cut where their angles
    /// are small.
    pub(super) fn over(
        curves: &[Vec<[f64; 2]>],
        seeds: &[[f64; 2]],
        edge: Option<f64>,
        within: impl Fn([f64; 2]) -> bool,
    ) -> Planform {
        let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        for curve in curves {
            for pair in curve.windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|[x, y]| Point2::new(x, y));
                cdt.add_constraint_edge(a, b).expect("finite points");
            }
        }
        for &[x, y] in seeds {
            cdt.insert(Point2::new(x, y)).expect("a finite point");
        }
        // An equilateral triangle has area 0.43 edge²; refinement stops at sizes between a half and the whole of the
        // largest area.
        let mut parameters = RefinementParameters::new()
            .with_angle_limit(AngleLimit::from_deg(28.0))
            .with_max_additional_vertices(usize::MAX >> 1)
            .keep_constraint_edges();
        if let Some(edge) = edge {
            parameters = parameters.with_max_allowed_area(0.65 * edge * edge);
        }
        cdt.refine(parameters);
        let mut number = vec![usize::MAX; cdt.num_vertices()];
        let mut out = Planform {
            points: Vec::new(),
            triangles: Vec::new(),
        };
        for face in cdt.inner_faces() {
            let corners = face.vertices();
            let at = corners.map(|v| [v.position().x, v.position().y]);
            let mid = [0, 1].map(|d| (at[0][d] + at[1][d] + at[2][d]) / 3.0);
            if !within(mid) {
                continue;
            }
            let triangle = [0, 1, 2].map(|k| {
                let n = &mut number[corners[k].fix().index()];
                if *n == usize::MAX {
                    *n = out.points.len();
                    out.points.push(at[k]);
                }
                *n
            });
            out.triangles.push(triangle);
        }
        out
    }

    /// The middle of a triangle.
    pub fn middle(&self, triangle: usize) -> [f64; 2] {
        let at = self.triangles[triangle].map(|n| self.points[n]);
        [0, 1].map(|d| (at[0][d] + at[1][d] + at[2][d]) / 3.0)
    }
}

/// A closed circle of `n` segments; a point lies at angle 0.
pub(crate) fn circle(centre: [f64; 2], radius: f64, n: usize) -> Vec<[f64; 2]> {
    arc(centre, radius, [0.0, TAU], n)
}

/// Points on an arc between two angles; on a whole circle the last point is the first to the last bit.
pub(crate) fn arc(centre: [f64; 2], radius: f64, [from, to]: [f64; 2], n: usize) -> Vec<[f64; 2]> {
    let whole = to - from == TAU;
    let at = |k: usize| {
        let k = if whole { k % n } else { k };
        let t = if k == n {
            to
        } else {
            from + (to - from) * k as f64 / n as f64
        };
        // Quarters of a circle get exact zeros: other curves end there.
        let [c, s] = [t.cos(), t.sin()].map(|v| if v.abs() < 1e-15 { 0.0 } else { v });
        [centre[0] + radius * c, centre[1] + radius * s]
    };
    (0..=n).map(at).collect()
}

/// `n` segments from one point to another.
pub(crate) fn polyline(a: [f64; 2], b: [f64; 2], n: usize) -> Vec<[f64; 2]> {
    let at = |k: usize| match k {
        0 => a,
        _ if k == n => b,
        _ => [0, 1].map(|d| a[d] + (b[d] - a[d]) * k as f64 / n as f64),
    };
    (0..=n).map(at).collect()
}
