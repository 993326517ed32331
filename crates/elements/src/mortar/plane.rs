//! Sides in the plane: segments of both sides that lie opposite each other.
//!
//! A point of the multiplier side moves along the normal there, which is interpolated between the means at the nodes
//! and so is continuous where the side is smooth: every point has one point opposite. A segment is cut where nodes of
//! the other side lie opposite it.

use super::sample::MortarSample;
use super::side::{MortarSide, Piece};
use super::tree::bounds;
use crate::element::gauss;
use base::linalg::vec3::{dot, minus, norm, unit};

/// Points on each part of a segment: exact for products of quadratic functions on straight sides.
const POINTS: usize = 4;

/// Parts of a segment that are shorter than this fraction of it are left out.
const SHORT: f64 = 1e-9;

/// Two pieces face each other where the cosine of the angle between their normals is below this.
pub(super) const OPPOSITE: f64 = -0.5;

pub(super) fn samples(side: &MortarSide, other: &MortarSide, reach: f64) -> Vec<MortarSample> {
    let rule = gauss(POINTS);
    let mut out = Vec::new();
    for piece in &side.pieces {
        let ray = Ray::new(side, piece);
        let around = bounds([0.0, 0.5, 1.0].into_iter().flat_map(|t| {
            let (x, n) = ray.at(t);
            [-reach, 0.0, reach].map(|r| [0, 1, 2].map(|d| x[d] + r * n[d]))
        }));
        let near = other
            .near(&around)
            .into_iter()
            .map(|k| &other.pieces[k as usize]);
        let near: Vec<&Piece> = near
            .filter(|p| dot(p.normal, piece.normal) < OPPOSITE)
            .collect();
        let mut cuts = vec![0.0, 1.0];
        for &corner in near.iter().flat_map(|p| &p.corners) {
            cuts.extend(ray.parameter(other.points()[corner as usize]));
        }
        cuts.sort_by(f64::total_cmp);
        for part in cuts.windows(2) {
            let (start, length) = (part[0], part[1] - part[0]);
            if length <= SHORT {
                continue;
            }
            let Some(facing) =
                ray.nearest(start + 0.5 * length, (side, piece), (other, &near), reach)
            else {
                continue;
            };
            for &(s, w) in &rule {
                let t = start + 0.5 * length * (1.0 + s);
                let at = [0, 1, 2].map(|d| piece.at[0][d] + t * (piece.at[1][d] - piece.at[0][d]));
                let here = side.values(piece.face, at);
                let speed = norm(here.tangents[0]) * 0.5 * (piece.at[1][0] - piece.at[0][0]).abs();
                let opposite = opposite(other, facing, here.x, ray.normal(t));
                out.push(MortarSample {
                    face: piece.face,
                    at,
                    other: facing.face,
                    opposite,
                    weight: w * length * speed,
                });
            }
        }
    }
    out
}

/// A segment of the multiplier side with the normals at its ends.
struct Ray {
    x: [[f64; 3]; 2],
    n: [[f64; 3]; 2],
}

impl Ray {
    fn new(side: &MortarSide, piece: &Piece) -> Ray {
        let x = side.corners(piece);
        Ray {
            x: [x[0], x[1]],
            n: [0, 1].map(|k| side.normal(piece, k)),
        }
    }

    fn between(ends: &[[f64; 3]; 2], t: f64) -> [f64; 3] {
        [0, 1, 2].map(|d| ends[0][d] + t * (ends[1][d] - ends[0][d]))
    }

    fn normal(&self, t: f64) -> [f64; 3] {
        unit(Ray::between(&self.n, t)).unwrap_or_default()
    }

    fn at(&self, t: f64) -> ([f64; 3], [f64; 3]) {
        (Ray::between(&self.x, t), self.normal(t))
    }

    /// The parameter 0 < t < 1 of the point whose normal meets `y`; `None` if there is none.
    fn parameter(&self, y: [f64; 3]) -> Option<f64> {
        // (y − x(t)) × n(t) = 0 is quadratic in t.
        let (p, q) = (minus(y, self.x[0]), minus(self.x[1], self.x[0]));
        let (n, m) = (self.n[0], minus(self.n[1], self.n[0]));
        let times = |a: [f64; 3], b: [f64; 3]| a[0] * b[1] - a[1] * b[0];
        let (c, b, a) = (times(p, n), times(p, m) - times(q, n), -times(q, m));
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        // The root that stays finite as the normals become parallel.
        let t = -2.0 * c / (b + root.copysign(b));
        (t > 0.0 && t < 1.0).then_some(t)
    }

    /// The nearest of some pieces that the normal at t meets, at a distance of `reach` at most.
    fn nearest<'p>(
        &self,
        t: f64,
        (side, own): (&MortarSide, &Piece),
        (other, near): (&MortarSide, &[&'p Piece]),
        reach: f64,
    ) -> Option<&'p Piece> {
        let (x, n) = self.at(t);
        let mut best: Option<(f64, &Piece)> = None;
        for &piece in near {
            let y = other.corners(piece);
            let along = minus(y[1], y[0]);
            let times = |a: [f64; 3], b: [f64; 3]| a[0] * b[1] - a[1] * b[0];
            let s = times(minus(x, y[0]), n) / times(along, n);
            // The middle of a part lies inside a segment, up to rounding.
            if !(-SHORT..=1.0 + SHORT).contains(&s) {
                continue;
            }
            let foot = [0, 1, 2].map(|d| y[0][d] + s * along[d]);
            let gap = dot(minus(foot, x), n);
            let near = side.meets(own, other, piece, gap, reach);
            if near && best.is_none_or(|(least, _)| gap.abs() < least) {
                best = Some((gap.abs(), piece));
            }
        }
        best.map(|b| b.1)
    }
}

/// Where the normal `n` at `x` meets the face of a piece, in the face's reference cell.
fn opposite(other: &MortarSide, piece: &Piece, x: [f64; 3], n: [f64; 3]) -> [f64; 3] {
    let times = |a: [f64; 3], b: [f64; 3]| a[0] * b[1] - a[1] * b[0];
    let mut s = 0.5 * (piece.at[0][0] + piece.at[1][0]);
    // Newton's method: one step for segments of first order, a few for curved ones.
    for _ in 0..10 {
        let there = other.values(piece.face, [s, 0.0, 0.0]);
        let step = times(minus(x, there.x), n) / times(there.tangents[0], n);
        s += step;
        if step.abs() < 1e-14 {
            break;
        }
    }
    [s, 0.0, 0.0]
}

#[cfg(test)]
#[path = "../../tests/mortar/plane.rs"]
mod tests;
