//! Pictures of fields on solids: the surface from two viewpoints. In the second picture bodies are moved apart, to show
//! where they touch.
//!
//! The projection is parallel and from a fixed direction, y upwards, so that pictures of different scenes and meshes
//! can be compared. Hidden parts are found pixel by pixel.

use super::apart::shifts;
use super::mesh::bounds;
use super::paint::{colour_bar, legend, sheet, BAR, LABELS, TEXT};
use super::space::Camera;
use super::stage::{pale, Stage, CLOSED};
use super::surface::{diagonals, VisibleSurface};
use super::values::ShownField;
use crate::drawing::canvas::{Anchor, Canvas, Colour, TextStyle};
use crate::drawing::colormap::viridis;
use crate::drawing::raster::Raster;
use base::linalg::vec3::{cross, dot};
use base::Result;
use std::path::Path;

pub use super::mesh::SolidMesh;
pub use super::rigid_faces::Beside;
pub use super::surface::FaceMark;

const SMALL_TEXT: f64 = 11.5;
const MARGIN: f64 = 16.0;
/// Height for the axes below a picture.
const AXES: f64 = 62.0;
/// Another viewpoint is taken only if it shows the marked area by this factor better.
const BETTER: f64 = 1.6;

/// Writes fields as PNG, side by side. The first picture shows the bodies in their places, beside the obstacles. The
/// others show the bodies moved apart, or another side of a single body, from the viewpoint that shows most of the
/// faces in `marks` that may touch.
///
/// # Errors
/// [`base::ErrorKind::Input`] when an array does not fit the mesh; [`base::ErrorKind::Environment`] with the path.
pub fn write_solution(
    solid: &SolidMesh,
    fields: &[ShownField],
    marks: &[FaceMark],
    beside: &Beside,
    title: &str,
    path: &Path,
) -> Result<()> {
    draw(solid, fields, marks, beside, title)?.write_png(path)
}

fn draw(
    solid: &SolidMesh,
    fields: &[ShownField],
    marks: &[FaceMark],
    beside: &Beside,
    title: &str,
) -> Result<Raster> {
    solid.check()?;
    let (points, cells) = (solid.points.len(), solid.cells.len());
    fields.iter().try_for_each(|f| f.check(points, cells))?;
    let surface = solid.surface(marks);
    let shifts = shifts(solid, &surface);
    let several = shifts.len() > 1;
    let none = vec![[0.0; 3]; shifts.len()];
    let second = second_camera(solid, &surface, several);
    let stage = |k: usize| match k {
        0 => Stage::new(solid, &surface, Camera::new(false, false), &none).beside(beside),
        _ => Stage::new(solid, &surface, second, &shifts),
    };
    let scenes: Vec<Stage> = (0..fields.len()).map(stage).collect();
    let note = |k: usize| match (several, second.towards[1] < 0.0) {
        _ if k == 0 => "",
        (true, false) => "bodies moved apart",
        (true, true) => "bodies moved apart, from below",
        (false, _) if second.towards[2] < 0.0 => "from behind, below",
        (false, true) => "from below",
        (false, false) => "",
    };
    let panel_height = scenes.iter().map(|s| s.size().1).fold(90.0, f64::max);
    let width = |s: &Stage| MARGIN + s.size().0.max(150.0) + MARGIN + BAR + LABELS;
    let total: f64 = scenes.iter().map(width).sum();
    let may_touch = marks.iter().any(|m| m.closed.is_some());
    let below = if may_touch { 26.0 } else { 0.0 };
    let content = 2.4 * TEXT + panel_height + AXES + below;
    let (mut raster, total, top) = sheet(title, (total, content));
    let height = top + content;
    let mut left = 0.0;
    for (k, (scene, field)) in scenes.iter().zip(fields).enumerate() {
        let (w, h) = scene.size();
        let at = (left + MARGIN, top + 2.4 * TEXT + 0.5 * (panel_height - h));
        let heading = match note(k) {
            "" => field.title.to_string(),
            note => format!("{} ({note})", field.title),
        };
        let middle = at.0 + 0.5 * w.max(150.0);
        raster.text(
            (middle, top + 1.0 * TEXT),
            &heading,
            &TextStyle::title(TEXT),
        );
        let range = field.range();
        scene.paint(&mut raster, field, range, at);
        let bar = panel_height.min(300.0);
        colour_bar(
            &mut raster,
            (
                at.0 + w.max(150.0) + MARGIN,
                top + 2.4 * TEXT + 0.5 * (panel_height + bar),
            ),
            bar,
            range,
            field.scale,
        );
        let origin = top + 2.4 * TEXT + panel_height + 0.62 * AXES;
        triad(&mut raster, (left + MARGIN + 26.0, origin), &scene.camera);
        left += width(scene);
    }
    extent(&mut raster, solid, (MARGIN + 78.0, height - below - 14.0));
    if may_touch {
        key(&mut raster, marks, (0.5 * total, height - 14.0));
    }
    Ok(raster)
}

/// The viewpoint that shows most of the marked area; the viewpoint of the first picture if no other is clearly better.
fn second_camera(solid: &SolidMesh, surface: &VisibleSurface, several: bool) -> Camera {
    let seen = |camera: &Camera| -> f64 {
        let marked = surface.faces.iter().filter(|f| f.mark.is_some());
        marked
            .map(|f| {
                let ([u, v], _) = diagonals(f.corners.map(|p| solid.points[p as usize]));
                dot(cross(u, v), camera.towards).max(0.0)
                    * if f.mark == Some(true) { 1.0 } else { 0.5 }
            })
            .sum()
    };
    let places = [(false, false), (false, true), (true, false), (true, true)];
    let cameras = places.map(|(behind, below)| Camera::new(behind, below));
    let mut best = cameras[0];
    if !several && surface.faces.iter().all(|f| f.mark.is_none()) {
        return cameras[3];
    }
    for camera in &cameras[1..] {
        if seen(camera) > BETTER * seen(&best) {
            best = *camera;
        }
    }
    best
}

/// Draws the directions of the axes.
fn triad(raster: &mut Raster, at: (f64, f64), camera: &Camera) {
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        let mut along = [0.0; 3];
        along[axis] = 1.0;
        let [x, y, _] = camera.project(along);
        let end = (at.0 + 24.0 * x, at.1 - 24.0 * y);
        raster.line(&[at, end], 1.2, Colour::INK, &[]);
        let beyond = (at.0 + 33.0 * x, at.1 - 33.0 * y);
        raster.text(beyond, name, &TextStyle::new(SMALL_TEXT, Anchor::Middle));
    }
}

/// Prints the extent of the undeformed scene.
fn extent(raster: &mut Raster, solid: &SolidMesh, at: (f64, f64)) {
    let [low, high] = bounds(solid.points.iter().copied());
    let size = (0..3).fold(0.0_f64, |a, d| a.max(high[d] - low[d]));
    let range = |d: usize| {
        // Coordinates of curved bodies contain rounding errors.
        let round = |x: f64| if x.abs() < 1e-9 * size { 0.0 } else { x };
        let number = |x: f64| crate::drawing::ticks::number(round(x));
        format!(
            "{} {} … {}",
            ["x", "y", "z"][d],
            number(low[d]),
            number(high[d])
        )
    };
    let text = [0, 1, 2].map(range).join("    ");
    raster.text(at, &text, &TextStyle::new(SMALL_TEXT, Anchor::Start));
}

/// Draws the legend for the colours of marked faces.
fn key(raster: &mut Raster, marks: &[FaceMark], middle: (f64, f64)) {
    const SAMPLE: f64 = 18.0;
    let mut shown = Vec::new();
    for (closed, colour, label) in [
        (true, CLOSED, "in contact"),
        (false, pale(viridis(0.25)), "may touch, open (pale)"),
    ] {
        if marks.iter().any(|m| m.closed == Some(closed)) {
            shown.push((colour, label));
        }
    }
    legend(raster, &shown, SAMPLE, middle, |raster, (x, y), colour| {
        let (top, bottom, right) = (y - 6.0, y + 6.0, x + SAMPLE);
        let square = [(x, top), (right, top), (right, bottom), (x, bottom)];
        raster.polygon(&square, *colour);
    });
}

#[cfg(test)]
#[path = "../../tests/pictures/solid.rs"]
mod tests;
