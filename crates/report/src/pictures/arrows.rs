//! Stresses at nodes of contact as arrows: few enough to be told apart, the longest one of a given length.

use super::paint::View;
use crate::drawing::canvas::{Canvas, CanvasPoint, Colour};
use crate::drawing::raster::Raster;
use std::collections::HashMap;

/// A stress at a point of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// The point where the arrow begins.
    pub at: [f64; 2],
    /// The stress in the directions of the picture.
    pub stress: [f64; 2],
}

/// Arrows of more than this number are thinned out further.
const SHOWN: usize = 150;
/// Arrows begin at least this far from each other, in logical pixels.
const APART: f64 = 15.0;
/// Arrows are not drawn where even the longest one would be shorter than this, in logical pixels.
const SHORTEST: f64 = 9.0;
/// An arrow below this length would be a dot.
const DOT: f64 = 2.5;
const WIDTH: f64 = 1.1;
/// Length of a head and half its width.
const HEAD: [f64; 2] = [6.0, 2.6];
/// Width of the white border on each side, which makes arrows visible on every colour.
const BORDER: f64 = 0.9;

fn size(arrow: &Arrow) -> f64 {
    arrow.stress[0].hypot(arrow.stress[1])
}

/// The largest stress; `None` where there is none to draw with arrows of this length in logical pixels.
pub(super) fn largest(arrows: &[Arrow], longest: f64) -> Option<f64> {
    let sizes = arrows.iter().map(size).filter(|s| s.is_finite());
    let largest = sizes.fold(0.0, f64::max);
    (largest > 0.0 && longest >= SHORTEST).then_some(largest)
}

/// The corners of a picture with room for arrows in it; a stress of 1 is `unit` long.
pub(super) fn room(
    arrows: &[Arrow],
    [mut low, mut high]: [[f64; 2]; 2],
    unit: f64,
) -> [[f64; 2]; 2] {
    for arrow in arrows.iter().filter(|a| size(a).is_finite()) {
        for d in 0..2 {
            let tip = arrow.at[d] + unit * arrow.stress[d];
            low[d] = low[d].min(tip);
            high[d] = high[d].max(tip);
        }
    }
    [low, high]
}

/// Draws arrows, the longest one in any case; a stress of 1 is `unit` logical pixels long.
pub(super) fn draw(raster: &mut Raster, arrows: &[Arrow], view: &View, unit: f64) {
    let long = |a: &&Arrow| unit * size(a) >= DOT && size(a).is_finite();
    let mut all: Vec<Arrow> = arrows.iter().filter(long).copied().collect();
    let longest = (0..all.len()).max_by(|&a, &b| size(&all[a]).total_cmp(&size(&all[b])));
    if let Some(longest) = longest {
        all.swap(0, longest);
    }
    for arrow in thinned(&all, view) {
        let from = view.place(arrow.at);
        let [x, y] = arrow.stress;
        stroke(raster, from, (from.0 + unit * x, from.1 - unit * y));
    }
}

/// As many of the arrows as have room, with the first one.
fn thinned(arrows: &[Arrow], view: &View) -> Vec<Arrow> {
    let mut apart = APART;
    loop {
        let mut taken: HashMap<[i64; 2], CanvasPoint> = HashMap::new();
        let free = |arrow: &&Arrow| {
            let (x, y) = view.place(arrow.at);
            // No two points that are shown are in one cell: its diagonal is as long as their least distance.
            let [i, j] = [x, y].map(|v| (v * 2_f64.sqrt() / apart).floor() as i64);
            let mut around = (-2..=2).flat_map(|di| (-2..=2).map(move |dj| [i + di, j + dj]));
            let near = |p: &CanvasPoint| (p.0 - x).hypot(p.1 - y) < apart;
            let free = !around.any(|cell| taken.get(&cell).is_some_and(near));
            if free {
                taken.insert([i, j], (x, y));
            }
            free
        };
        let shown: Vec<Arrow> = arrows.iter().filter(free).copied().collect();
        if shown.len() <= SHOWN {
            return shown;
        }
        apart *= 1.4;
    }
}

/// Draws one arrow.
pub(super) fn stroke(raster: &mut Raster, from: CanvasPoint, to: CanvasPoint) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let (dx, dy) = (dx / length, dy / length);
    // A short arrow has a small head.
    let head = HEAD.map(|h| h * (length / (1.6 * HEAD[0])).min(1.0));
    let neck = (to.0 - head[0] * dx, to.1 - head[0] * dy);
    for (border, ink) in [(BORDER, Colour::WHITE), (0.0, Colour(0, 0, 0))] {
        raster.line(&[from, neck], WIDTH + 2.0 * border, ink, &[]);
        let tip = (to.0 + 2.0 * border * dx, to.1 + 2.0 * border * dy);
        let (back, wide) = (head[0] + border, head[1] + 1.4 * border);
        let corner = |side: f64| {
            (
                to.0 - back * dx - side * wide * dy,
                to.1 - back * dy + side * wide * dx,
            )
        };
        raster.polygon(&[tip, corner(1.0), corner(-1.0)], ink);
    }
}

#[cfg(test)]
#[path = "../../tests/pictures/arrows.rs"]
mod tests;
