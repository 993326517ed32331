//! Sides in space: polygons in which pieces of both sides lie opposite each other.
//!
//! A piece of the multiplier side has a plane through its centre, across its normal. Pieces of the other side are
//! projected onto it along the normal and cut by it (Puso and Laursen 2004); the polygons are divided into triangles
//! with a rule each. The points go back to both faces along the normal, so that shape functions are those of the faces,
//! whatever their kind, and areas are those of the curved multiplier side.

use super::plane::OPPOSITE;
use super::sample::MortarSample;
use super::side::{MortarSide, Piece};
use super::tree::bounds;
use crate::element::triangle_rule;
use base::linalg::vec3::{cross, dot, minus, norm, unit};

/// Degrees for which the rule of a triangle is exact: products of the shape functions of faces of first order, and of
/// faces of second order that are affine; where a face is not affine, shape functions are no polynomials in the plane.
const DEGREES: [usize; 3] = [4, 8, 14];

/// Polygons smaller than this fraction of the piece are left out.
const SMALL: f64 = 1e-10;

pub(super) fn samples(side: &MortarSide, other: &MortarSide, reach: f64) -> Vec<MortarSample> {
    let rules = DEGREES.map(triangle_rule);
    let mut out = Vec::new();
    for piece in &side.pieces {
        let plane = PiecePlane::new(side, piece);
        let around =
            bounds(side.corners(piece).into_iter().flat_map(|x| {
                [-reach, reach].map(|r| [0, 1, 2].map(|d| x[d] + r * plane.axes[2][d]))
            }));
        let near = other.near(&around);
        if near.is_empty() {
            continue;
        }
        let own: Vec<[f64; 2]> = side.corners(piece).iter().map(|x| plane.flat(*x)).collect();
        let whole = area(&own);
        let mut found = Vec::new();
        for k in near {
            let facing = &other.pieces[k as usize];
            if dot(facing.normal, piece.normal) >= OPPOSITE {
                continue;
            }
            let corners: Vec<[f64; 2]> = other
                .corners(facing)
                .iter()
                .map(|x| plane.flat(*x))
                .collect();
            let polygon = cut(&own, &corners);
            if area(&polygon) <= SMALL * whole {
                continue;
            }
            let x = plane.back(middle(&polygon));
            let far = dot(
                minus(other.points()[facing.corners[0] as usize], x),
                facing.normal,
            );
            let gap = far / dot(plane.axes[2], facing.normal);
            if side.meets(piece, other, facing, gap, reach) {
                found.push((gap.abs(), facing, polygon));
            }
        }
        if found.is_empty() {
            continue;
        }
        // Behind the nearest layer there may be another one, as the far side of a thin body.
        let least = found.iter().map(|f| f.0).fold(f64::INFINITY, f64::min);
        let mine = degree(side, piece);
        for (gap, facing, polygon) in &found {
            if *gap > least + 2.0 * (side.size(piece) + other.size(facing)) {
                continue;
            }
            let rule = &rules[mine.max(degree(other, facing))];
            for k in 1..polygon.len() - 1 {
                let corners = [polygon[0], polygon[k], polygon[k + 1]];
                let double = 2.0 * area(&corners);
                for &([r, s], w) in rule {
                    let y = [0, 1].map(|d| {
                        corners[0][d]
                            + r * (corners[1][d] - corners[0][d])
                            + s * (corners[2][d] - corners[0][d])
                    });
                    let x = plane.back(y);
                    let at = plane.meet(side, piece, x);
                    let here = side.values(piece.face, at);
                    let vector = cross(here.tangents[0], here.tangents[1]);
                    let stretch = norm(vector) / dot(vector, plane.axes[2]).abs();
                    out.push(MortarSample {
                        face: piece.face,
                        at,
                        other: facing.face,
                        opposite: plane.meet(other, facing, x),
                        weight: w * double * stretch,
                    });
                }
            }
        }
    }
    out
}

/// The plane of a piece: its centre, two axes along it and the normal.
struct PiecePlane {
    origin: [f64; 3],
    axes: [[f64; 3]; 3],
}

impl PiecePlane {
    fn new(side: &MortarSide, piece: &Piece) -> PiecePlane {
        let x = side.corners(piece);
        let origin = [0, 1, 2].map(|d| x.iter().map(|x| x[d]).sum::<f64>() / x.len() as f64);
        let normal = piece.normal;
        let along = minus(x[1], x[0]);
        let part = dot(along, normal);
        let first = unit([0, 1, 2].map(|d| along[d] - part * normal[d])).unwrap_or_default();
        PiecePlane {
            origin,
            axes: [first, cross(normal, first), normal],
        }
    }

    fn flat(&self, x: [f64; 3]) -> [f64; 2] {
        let from = minus(x, self.origin);
        [dot(from, self.axes[0]), dot(from, self.axes[1])]
    }

    fn back(&self, y: [f64; 2]) -> [f64; 3] {
        [0, 1, 2].map(|d| self.origin[d] + y[0] * self.axes[0][d] + y[1] * self.axes[1][d])
    }

    /// Where the normal at `x` meets the face of a piece, in the face's reference cell.
    fn meet(&self, side: &MortarSide, piece: &Piece, x: [f64; 3]) -> [f64; 3] {
        let target = self.flat(x);
        let n = piece.at.len() as f64;
        let mut at = [0, 1, 2].map(|d| piece.at.iter().map(|a| a[d]).sum::<f64>() / n);
        // Newton's method: one step on affine faces, a few on others.
        for _ in 0..20 {
            let here = side.values(piece.face, at);
            let now = self.flat(here.x);
            let away = [target[0] - now[0], target[1] - now[1]];
            let slope = |j: usize| [0, 1].map(|d: usize| dot(here.tangents[j], self.axes[d]));
            let [a, b] = [slope(0), slope(1)];
            let det = a[0] * b[1] - a[1] * b[0];
            let step = [
                (away[0] * b[1] - away[1] * b[0]) / det,
                (a[0] * away[1] - a[1] * away[0]) / det,
            ];
            at[0] += step[0];
            at[1] += step[1];
            if step[0].abs().max(step[1].abs()) < 1e-14 {
                break;
            }
        }
        at
    }
}

/// Which of the rules a face needs.
fn degree(side: &MortarSide, piece: &Piece) -> usize {
    let tangents = |k: usize| side.values(piece.face, piece.at[k]).tangents;
    let [a, b, c] = [0, 1, 2].map(tangents);
    let differ = |x: [[f64; 3]; 2]| (0..2).map(|j| norm(minus(a[j], x[j]))).fold(0.0, f64::max);
    let affine = differ(b).max(differ(c)) <= 1e-12 * (norm(a[0]) + norm(a[1]));
    if affine {
        side.faces()[piece.face as usize].kind.order() - 1
    } else {
        2
    }
}

/// The common part of two convex polygons in any order around: Sutherland and Hodgman's algorithm.
fn cut(a: &[[f64; 2]], b: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let sign = |p: &[[f64; 2]]| signed(p).signum();
    let turn = sign(a);
    let mut out: Vec<[f64; 2]> = if sign(b) == turn {
        b.to_vec()
    } else {
        b.iter().rev().copied().collect()
    };
    for k in 0..a.len() {
        let (p, q) = (a[k], a[(k + 1) % a.len()]);
        let side =
            |x: [f64; 2]| turn * ((q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0]));
        let old = std::mem::take(&mut out);
        for (i, &x) in old.iter().enumerate() {
            let before = old[(i + old.len() - 1) % old.len()];
            let [u, v] = [side(before), side(x)];
            if (u < 0.0) != (v < 0.0) {
                let t = u / (u - v);
                out.push([0, 1].map(|d| before[d] + t * (x[d] - before[d])));
            }
            if v >= 0.0 {
                out.push(x);
            }
        }
    }
    out
}

fn signed(p: &[[f64; 2]]) -> f64 {
    let Some(&o) = p.first() else {
        return 0.0;
    };
    let n = p.len();
    let cross = |k: usize| {
        let [a, b] = [p[k], p[(k + 1) % n]].map(|x| [x[0] - o[0], x[1] - o[1]]);
        a[0] * b[1] - a[1] * b[0]
    };
    0.5 * (0..n).map(cross).sum::<f64>()
}

fn area(p: &[[f64; 2]]) -> f64 {
    signed(p).abs()
}

fn middle(p: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|d| p.iter().map(|x| x[d]).sum::<f64>() / p.len() as f64)
}

#[cfg(test)]
#[path = "../../tests/mortar/space.rs"]
mod tests;
