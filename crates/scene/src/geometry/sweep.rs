//! Pairs of bodies or sides that may be near each other, without a look at every pair.

use std::rc::Rc;

use super::matching::{FAR, MATCH};
use super::surface::{Surface, OPPOSITE};
use crate::body::Body;
use base::linalg::vec3::{dot, minus, norm};
use elements::mortar::Tree;

/// A box along the axes: its lowest and its highest corner.
type SurfaceBox = [[f64; 3]; 2];

/// Normals of a flat surface differ by less.
pub(super) const SAME: f64 = 1e-6;

/// The pairs of bodies whose bounds are at most `slack` apart along every axis, where `slack` is that of one of them.
/// Each pair is in increasing order, and so are the pairs. A tree of boxes finds them in n log n steps.
pub(crate) fn near(bodies: &[Body], slack: impl Fn(usize) -> f64) -> Vec<[usize; 2]> {
    let boxes: Vec<SurfaceBox> = bodies.iter().map(|b| b.bounds).collect();
    let tree = Tree::new(boxes.clone());
    let mut out = Vec::new();
    for (a, [low, high]) in boxes.iter().enumerate() {
        let slack = slack(a);
        let around = [low.map(|x| x - slack), high.map(|x| x + slack)];
        let found = tree.meet(&around).into_iter().map(|b| b as usize);
        out.extend(found.filter(|&b| b != a).map(|b| [a.min(b), a.max(b)]));
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// Whether the bounds of two bodies are more than `reach` apart along an axis.
pub(crate) fn are_apart([a, b]: [&Body; 2], reach: f64) -> bool {
    are_disjoint(&a.bounds, &b.bounds, reach)
}

/// Whether two surfaces may have nodes opposite each other at a distance of `reach` at most, or a node of one opposite
/// the inside of a face of the other. If not, they are [`Apart`](super::matching::Mismatch::Apart).
pub(crate) fn may_meet(a: &Surface, b: &Surface, reach: f64) -> bool {
    let same_way = match (a.flat, b.flat) {
        (Some(m), Some(n)) => dot(m, n) >= OPPOSITE + SAME,
        _ => false,
    };
    // Nodes have partners a little beside their normals, and faces count as a little larger than they are.
    let slack = reach + 0.1 * size(a.bounds).max(size(b.bounds));
    !same_way && !are_disjoint(&a.bounds, &b.bounds, slack)
}

/// The diagonal of the box around a surface.
pub(crate) fn extent(surface: &Surface) -> f64 {
    size(surface.bounds)
}

/// The pairs of a surface of the first list and one of the second that may have nodes opposite each other at a distance
/// of `reach` at most, or a node of one opposite the inside of a face of the other: their places in the lists, in
/// increasing order. All other pairs are [`Apart`](super::matching::Mismatch::Apart).
pub(crate) fn may_face(
    first: &[Rc<Surface>],
    second: &[Rc<Surface>],
    reach: f64,
) -> Vec<[usize; 2]> {
    let first: Vec<SurfaceOutline> = first
        .iter()
        .map(|s| SurfaceOutline::new(s, reach))
        .collect();
    let second = second.iter().map(|s| SurfaceOutline::new(s, reach));
    let mut second: Vec<(SurfaceOutline, usize)> = second.zip(0..).collect();
    let left = |o: &SurfaceOutline| o.bounds[0][0];
    second.sort_by(|(x, _), (y, _)| left(x).total_cmp(&left(y)));
    let widest = |most: f64, (o, _): &(SurfaceOutline, usize)| most.max(o.bounds[1][0] - left(o));
    let widest = second.iter().fold(0.0, widest);
    let slack = second.iter().fold(0.0_f64, |s, (o, _)| s.max(o.slack));
    let all = first.iter().chain(second.iter().map(|(o, _)| o));
    // No two nodes are farther apart.
    let reach = reach.min(size(all.map(|o| o.bounds).fold(NOTHING, union)));
    let mut out = Vec::new();
    for (k, own) in first.iter().enumerate() {
        let swept = own.swept(reach);
        let around = own.slack.max(slack);
        let start = second.partition_point(|(o, _)| left(o) < swept[0][0] - around - widest);
        let near = second[start..].iter();
        let near = near.take_while(|(o, _)| left(o) <= swept[1][0] + around);
        let near = near.filter(|(o, _)| !are_disjoint(&swept, &o.bounds, own.slack.max(o.slack)));
        let before = out.len();
        out.extend(near.map(|(_, l)| [k, *l]));
        out[before..].sort_unstable();
    }
    out
}

/// The bounds that contain nothing.
const NOTHING: SurfaceBox = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// Where a surface is, and how far around it the search for nodes opposite looks.
struct SurfaceOutline<'a> {
    surface: &'a Surface,
    bounds: SurfaceBox,
    slack: f64,
}

impl SurfaceOutline<'_> {
    fn new(surface: &Surface, reach: f64) -> SurfaceOutline<'_> {
        let bounds = surface.bounds;
        let edge = surface.edges.iter().copied().fold(0.0, f64::max);
        SurfaceOutline {
            surface,
            bounds,
            // Nodes have partners a little beside their normals, and faces count as a little larger than they are.
            slack: reach.min(FAR * edge) + MATCH * edge + 0.1 * size(bounds),
        }
    }

    /// The bounds of what the nodes sweep if they move along their normals by `reach`.
    fn swept(&self, reach: f64) -> SurfaceBox {
        let nodes = self.surface.points.iter().zip(&self.surface.normals);
        let ends = nodes.flat_map(|(p, normals)| {
            let end = |n: &[f64; 3]| [0, 1, 2].map(|d| p[d] + reach * n[d]);
            normals.iter().map(end)
        });
        ends.fold(self.bounds, |b, end| union(b, [end, end]))
    }
}

/// The bounds of points.
pub(super) fn bounds_of(points: &[[f64; 3]]) -> SurfaceBox {
    points.iter().fold(NOTHING, |b, p| union(b, [*p, *p]))
}

fn union(a: SurfaceBox, b: SurfaceBox) -> SurfaceBox {
    [
        [0, 1, 2].map(|d| a[0][d].min(b[0][d])),
        [0, 1, 2].map(|d| a[1][d].max(b[1][d])),
    ]
}

/// The length of the diagonal.
fn size([low, high]: SurfaceBox) -> f64 {
    norm(minus(high, low))
}

/// Whether two boxes are more than `slack` apart along an axis.
pub(super) fn are_disjoint(x: &SurfaceBox, y: &SurfaceBox, slack: f64) -> bool {
    (0..3).any(|d| x[0][d] > y[1][d] + slack || y[0][d] > x[1][d] + slack)
}

#[cfg(test)]
#[path = "../../tests/geometry/sweep.rs"]
mod tests;
