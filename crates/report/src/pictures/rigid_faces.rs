//! Rigid surfaces of meshes beside bodies: grey faces, and in the plane a grey band behind a line.

use std::collections::HashMap;

use super::obstacles::{ShownObstacle, EDGE, GREY};
use super::paint::View;
use crate::drawing::canvas::Canvas;
use crate::drawing::raster::Raster;
use base::linalg::vec3::{minus, norm, unit};

/// A face by its corners: a segment in the plane, its normal to the right of the way, or a polygon in space.
pub type Polygon = Vec<[f64; 3]>;

/// The rigid surfaces beside the bodies.
#[derive(Debug, Clone, Copy, Default)]
pub struct Beside<'a> {
    /// Planes, cylinders and spheres.
    pub obstacles: &'a [ShownObstacle],
    /// The faces of rigid surfaces.
    pub faces: &'a [Polygon],
}

/// Beyond the bodies, surfaces are shown on this part of their size.
const AROUND: f64 = 0.12;
/// Width of the band behind a surface in the plane, in logical pixels.
const BAND: f64 = 7.0;

impl Beside<'_> {
    pub(super) fn is_empty(&self) -> bool {
        self.obstacles.is_empty() && self.faces.is_empty()
    }
}

/// Paints the segments between two corners of the plane.
pub(super) fn paint(
    faces: &[Polygon],
    raster: &mut Raster,
    view: &View,
    [low, high]: [[f64; 2]; 2],
) {
    let within = [[low[0], low[1], -1.0], [high[0], high[1], 1.0]];
    let width = BAND / view.scale;
    // Against the mean normal at each point, so that there are no wedges between bands.
    let key = |x: &[f64; 3]| x.map(f64::to_bits);
    let mut behind: HashMap<[u64; 3], [f64; 3]> = HashMap::new();
    for face in faces {
        let along = minus(face[1], face[0]);
        let back = unit([0.0 - along[1], along[0], 0.0]).unwrap_or_default();
        for x in face {
            let sum = behind.entry(key(x)).or_default();
            *sum = plus(*sum, back);
        }
    }
    let shifted = |x: &[f64; 3]| {
        let back = unit(behind[&key(x)]).unwrap_or_default();
        plus(*x, back.map(|v| width * v))
    };
    let flat = |x: &[f64; 3]| [x[0], x[1]];
    for face in faces {
        let (a, b) = (face[0], face[1]);
        let band = clip(&[a, b, shifted(&b), shifted(&a)], within);
        let band: Vec<_> = band.iter().map(|x| view.place(flat(x))).collect();
        if band.len() > 2 {
            raster.polygon(&band, GREY);
        }
    }
    for face in faces {
        let line = clip(face, within);
        let far = |x: &&[f64; 3]| norm(minus(**x, line[0]));
        let end = line.iter().max_by(|x, y| far(x).total_cmp(&far(y)));
        if let Some(end) = end {
            view.line(raster, &[flat(&line[0]), flat(end)], 1.2, EDGE);
        }
    }
}

/// Triangles of the faces near bodies that lie between two corners.
pub(super) fn triangles(faces: &[Polygon], [low, high]: [[f64; 3]; 2]) -> Vec<[[f64; 3]; 3]> {
    let margin = AROUND * norm(minus(high, low));
    let within = [low.map(|x| x - margin), high.map(|x| x + margin)];
    let mut out = Vec::new();
    for face in faces {
        let part = clip(face, within);
        out.extend((2..part.len()).map(|k| [part[0], part[k - 1], part[k]]));
    }
    out
}

/// The part of a polygon inside a box.
fn clip(polygon: &[[f64; 3]], [low, high]: [[f64; 3]; 2]) -> Vec<[f64; 3]> {
    let mut out = polygon.to_vec();
    for (d, sign, bound) in (0..3).flat_map(|d| [(d, 1.0, high[d]), (d, -1.0, -low[d])]) {
        // Inside where this is not positive.
        let beyond = |x: &[f64; 3]| sign * x[d] - bound;
        let old = std::mem::take(&mut out);
        for (k, x) in old.iter().enumerate() {
            let before = old[(k + old.len() - 1) % old.len()];
            let [u, v] = [beyond(&before), beyond(x)];
            if (u > 0.0) != (v > 0.0) {
                let t = u / (u - v);
                out.push([0, 1, 2].map(|c| before[c] + t * (x[c] - before[c])));
            }
            if v <= 0.0 {
                out.push(*x);
            }
        }
    }
    out
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] + b[d])
}

#[cfg(test)]
#[path = "../../tests/pictures/rigid_faces.rs"]
mod tests;
