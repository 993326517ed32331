//! Rigid obstacles beside bodies: grey shapes.

use super::paint::View;
use crate::drawing::canvas::Colour;
use crate::drawing::raster::Raster;
use base::linalg::vec3::{cross, dot, minus, norm, unit};
use scene::model::rigid::outward;
use scene::Rigid;
use std::f64::consts::PI;

/// Colour of an obstacle.
pub(super) const GREY: Colour = Colour(0xc4, 0xc4, 0xc4);
/// Colour of its outline in the plane.
pub(super) const EDGE: Colour = Colour(0x80, 0x80, 0x80);
/// Beyond the bodies, obstacles are shown on this part of their size.
pub(super) const BEYOND: f64 = 0.06;
/// Steps around a round obstacle, and from its pole to its rim.
const AROUND: usize = 72;
const ALONG: usize = 36;

/// An obstacle as it is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownObstacle {
    /// Its shape.
    pub rigid: Rigid,
    /// The gap in front of it: its surface is where the distance is −gap.
    pub gap: f64,
}

impl ShownObstacle {
    /// Distance from the surface; negative inside.
    fn distance(&self, point: [f64; 3]) -> f64 {
        let inside = match self.rigid {
            Rigid::Round { cavity: true, .. } => 1.0,
            _ => -1.0,
        };
        let found = self.rigid.distance(point);
        found.map_or(inside * f64::INFINITY, |(distance, _)| distance + self.gap)
    }

    /// Paints the part of the plane between two corners.
    pub(super) fn paint(&self, raster: &mut Raster, view: &View, [low, high]: [[f64; 2]; 2]) {
        let s = raster.scale();
        let ((x0, y1), (x1, y0)) = (view.place(low), view.place(high));
        let whole = |v: f64| (v * s).round().max(0.0) as usize;
        let pixel = 1.0 / (s * view.scale);
        for y in whole(y0)..whole(y1) {
            for x in whole(x0)..whole(x1) {
                let right = (x as f64 + 0.5) / s - view.origin.0;
                let up = view.origin.1 - (y as f64 + 0.5) / s;
                let at = [low[0] + right / view.scale, low[1] + up / view.scale, 0.0];
                // Half a pixel on either side of the surface is a blend.
                let depth = -self.distance(at) / pixel;
                let fill = mixed(Colour::WHITE, GREY, depth + 0.5);
                let line = 1.5 - (depth - 1.0).abs();
                if depth > -0.5 {
                    raster.set(x, y, mixed(fill, EDGE, line));
                }
            }
        }
    }

    /// Triangles of its surface near bodies that lie between two corners.
    pub(super) fn triangles(&self, [low, high]: [[f64; 3]; 2]) -> Vec<[[f64; 3]; 3]> {
        let middle = [0, 1, 2].map(|d| 0.5 * (low[d] + high[d]));
        let size = norm(minus(high, low));
        let corners = (0..8).map(|k| [0, 1, 2].map(|d| [low, high][k >> d & 1][d]));
        // The extent of the bodies along a direction, as seen from a point.
        let extent = |from: [f64; 3], along: [f64; 3]| {
            let values = corners.clone().map(|c| dot(minus(c, from), along));
            let [a, b] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| {
                [a.min(v), b.max(v)]
            });
            [a - BEYOND * size, b + BEYOND * size]
        };
        match self.rigid {
            // It has no place of its own.
            Rigid::Behind { .. } => Vec::new(),
            Rigid::Plane { point, normal } => {
                let [u, v] = across(normal);
                let foot = plus(point, normal, -self.gap);
                let (a, b) = (extent(foot, u), extent(foot, v));
                let at = |s: f64, t: f64| plus(plus(foot, u, s), v, t);
                quads(1, 1, |i, j| at(a[i], b[j]))
            }
            Rigid::Round {
                centre,
                axis,
                radius,
                cavity,
            } => {
                let radius = radius + if cavity { self.gap } else { -self.gap };
                let reach = (0.6 * size / radius.abs().max(1e-300)).min(PI);
                let away = outward(centre, axis, middle);
                let pole = unit(away).unwrap_or_else(|| across(axis.unwrap_or([0., 0., 1.]))[0]);
                match axis {
                    Some(axis) => {
                        let side = cross(axis, pole);
                        let ends = extent(centre, axis);
                        let at = |i: usize, j: usize| {
                            let turn = reach * (2.0 * i as f64 / AROUND as f64 - 1.0);
                            let out = plus(pole.map(|x| x * turn.cos()), side, turn.sin());
                            plus(plus(centre, out, radius), axis, ends[j])
                        };
                        let mut all = quads(AROUND, 1, at);
                        // The ends of a whole cylinder.
                        if reach == PI && !cavity {
                            for (j, end) in ends.iter().enumerate() {
                                let hub = plus(centre, axis, *end);
                                all.extend((0..AROUND).map(|i| [hub, at(i, j), at(i + 1, j)]));
                            }
                        }
                        all
                    }
                    None => {
                        let [u, v] = across(pole);
                        quads(AROUND, ALONG, |i, j| {
                            let turn = 2.0 * PI * i as f64 / AROUND as f64;
                            let tilt = reach * j as f64 / ALONG as f64;
                            let flat = plus(u.map(|x| x * turn.cos()), v, turn.sin());
                            let out = plus(pole.map(|x| x * tilt.cos()), flat, tilt.sin());
                            plus(centre, out, radius)
                        })
                    }
                }
            }
        }
    }
}

/// The triangles of a grid of n × m quadrilaterals.
fn quads(n: usize, m: usize, at: impl Fn(usize, usize) -> [f64; 3]) -> Vec<[[f64; 3]; 3]> {
    let mut out = Vec::with_capacity(2 * n * m);
    for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
        let (a, b) = (at(i, j), at(i + 1, j + 1));
        out.push([a, at(i + 1, j), b]);
        out.push([a, b, at(i, j + 1)]);
    }
    out
}

fn plus(a: [f64; 3], b: [f64; 3], factor: f64) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] + factor * b[d])
}

/// Two unit vectors that are orthogonal to a vector and to each other.
fn across(v: [f64; 3]) -> [[f64; 3]; 2] {
    let small = (0..3).min_by(|&a, &b| v[a].abs().total_cmp(&v[b].abs()));
    let mut other = [0.0; 3];
    other[small.unwrap_or(0)] = 1.0;
    let first = unit(cross(v, other)).unwrap_or([1.0, 0.0, 0.0]);
    [first, unit(cross(v, first)).unwrap_or([0.0, 1.0, 0.0])]
}

/// A colour between two, by a share that is cut to 0 … 1.
pub(super) fn mixed(a: Colour, b: Colour, share: f64) -> Colour {
    let share = share.clamp(0.0, 1.0);
    let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    Colour(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

#[cfg(test)]
#[path = "../../tests/pictures/obstacles.rs"]
mod tests;
