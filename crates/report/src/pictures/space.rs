//! Drawing in space: a parallel projection and a buffer of pixels with depths.

use super::obstacles::mixed;
use crate::drawing::canvas::Colour;
use crate::drawing::raster::{self, Raster};

/// A viewpoint for pictures with y upwards and z towards the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Camera {
    right: [f64; 3],
    up: [f64; 3],
    /// Unit vector towards the viewer.
    pub towards: [f64; 3],
}

impl Camera {
    /// The viewpoint at the front and right (`behind`: at the back and left), above or below.
    pub fn new(behind: bool, below: bool) -> Camera {
        let turn = 34_f64.to_radians() + if behind { std::f64::consts::PI } else { 0.0 };
        let tilt = if below { -38_f64 } else { 27.0 }.to_radians();
        let ((s, c), (t, d)) = (turn.sin_cos(), tilt.sin_cos());
        Camera {
            right: [c, 0.0, -s],
            up: [-s * t, d, -c * t],
            towards: [s * d, t, c * d],
        }
    }

    /// The coordinates of a point in the picture: right, up, and towards the viewer.
    pub fn project(&self, p: [f64; 3]) -> [f64; 3] {
        [self.right, self.up, self.towards].map(|e| e[0] * p[0] + e[1] * p[1] + e[2] * p[2])
    }
}

/// A rectangle of pixels with depths, at a finer resolution than the final picture.
pub(super) struct Buffer {
    width: usize,
    height: usize,
    depth: Vec<f64>,
    colour: Vec<Colour>,
}

/// Fine pixels per pixel of the picture, in each direction.
const FINE: usize = 2;

impl Buffer {
    /// An empty buffer of width × height logical pixels, and the number of fine pixels per logical one.
    pub fn new(width: f64, height: f64, raster: &Raster) -> (Buffer, f64) {
        let scale = raster.scale() * FINE as f64;
        let whole = |x: f64| (x * raster.scale()).ceil() as usize * FINE;
        let (width, height) = (whole(width), whole(height));
        let buffer = Buffer {
            width,
            height,
            depth: vec![f64::NEG_INFINITY; width * height],
            colour: vec![Colour::WHITE; width * height],
        };
        (buffer, scale)
    }

    /// Paints the pixels of a triangle (x to the right, y downwards, depth towards the viewer) that nothing nearer
    /// covers; `shade` maps the interpolated value to a colour.
    pub fn triangle(&mut self, p: [[f64; 3]; 3], v: [f64; 3], shade: &impl Fn(f64) -> Colour) {
        let (size, flat) = ((self.width, self.height), p.map(|[x, y, _]| [x, y]));
        raster::triangle(flat, size, |x, y, a, b| {
            let between = |v: [f64; 3]| v[0] + a * (v[1] - v[0]) + b * (v[2] - v[0]);
            let (depth, at) = (between(p.map(|p| p[2])), y * self.width + x);
            if depth > self.depth[at] {
                self.depth[at] = depth;
                self.colour[at] = shade(between(v));
            }
        });
    }

    /// Draws a line of a width in fine pixels. It is hidden where something is nearer by more than `slack`; its ends
    /// are round.
    pub fn line(&mut self, ends: [[f64; 3]; 2], width: f64, slack: f64, colour: Colour) {
        let [a, b] = ends;
        let half = 0.5 * width;
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let bound = |d: usize, limit: usize| {
            let low = a[d].min(b[d]) - half;
            let high = (a[d].max(b[d]) + half + 1.0).min(limit as f64);
            (low.max(0.0) as usize, high.max(0.0) as usize)
        };
        let ((x0, x1), (y0, y1)) = (bound(0, self.width), bound(1, self.height));
        for y in y0..y1 {
            for x in x0..x1 {
                let (dx, dy) = (x as f64 + 0.5 - a[0], y as f64 + 0.5 - a[1]);
                let t = if square > 0.0 {
                    ((dx * along[0] + dy * along[1]) / square).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let (ex, ey) = (dx - t * along[0], dy - t * along[1]);
                if ex * ex + ey * ey > half * half {
                    continue;
                }
                let at = y * self.width + x;
                if a[2] + t * (b[2] - a[2]) + slack > self.depth[at] {
                    self.colour[at] = colour;
                }
            }
        }
    }

    /// An empty buffer of the same size.
    pub fn empty(&self) -> Buffer {
        Buffer {
            width: self.width,
            height: self.height,
            depth: vec![f64::NEG_INFINITY; self.depth.len()],
            colour: vec![Colour::WHITE; self.colour.len()],
        }
    }

    /// Lays another picture of the same size over this one: what is nearer there covers by a share, and where nothing
    /// is here, whole.
    pub fn lay(&mut self, over: &Buffer, share: f64) {
        for (k, &depth) in over.depth.iter().enumerate() {
            if depth > self.depth[k] {
                let nothing = self.depth[k] == f64::NEG_INFINITY;
                let share = if nothing { 1.0 } else { share };
                self.colour[k] = mixed(self.colour[k], over.colour[k], share);
            }
        }
    }

    /// Copies the buffer into a picture, with its upper left corner at a logical position.
    pub fn copy(&self, raster: &mut Raster, at: (f64, f64)) {
        let corner = [at.0, at.1].map(|v| (v * raster.scale()).round().max(0.0) as usize);
        for y in 0..self.height / FINE {
            for x in 0..self.width / FINE {
                let mut sum = [0_u32; 3];
                for k in 0..FINE * FINE {
                    let fine = (y * FINE + k / FINE) * self.width + x * FINE + k % FINE;
                    let Colour(r, g, b) = self.colour[fine];
                    sum[0] += u32::from(r);
                    sum[1] += u32::from(g);
                    sum[2] += u32::from(b);
                }
                let [r, g, b] = sum.map(|s| (s / (FINE * FINE) as u32) as u8);
                raster.set(corner[0] + x, corner[1] + y, Colour(r, g, b));
            }
        }
    }
}

#[cfg(test)]
#[path = "../../tests/pictures/space.rs"]
mod tests;
