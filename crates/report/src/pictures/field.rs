//! Pictures of fields on plane meshes: u and ρ side by side with colour bars, bodies outlined.
//!
//! Cells are painted pixel by pixel, so that a million of them cost a fraction of a second. Points may be listed once
//! per body or once per subdomain: lines between bodies and subdomains are found from the coordinates.

use super::arrows;
use super::marks;
use super::mesh::bounds;
use super::obstacles::BEYOND;
use super::paint::{axes, colour_bar, paint, sheet, View, BAR, LABELS, TEXT};
use super::rigid_faces;
use crate::drawing::canvas::{Canvas, Colour, TextStyle};
use crate::drawing::raster::Raster;
use crate::drawing::ticks;
use base::Result;
use std::path::Path;

pub use super::arrows::Arrow;
pub use super::marks::{ContactMark, Marked, Touch};
pub use super::mesh::PlaneMesh;
pub use super::rigid_faces::Beside;
pub use super::values::ShownField;

/// Writes fields of one mesh as PNG: side by side, or one below the other where the mesh is wide. `marked` is drawn on
/// the first field. If the bodies are `displaced`, every body has its own outline, with a thin outline of its
/// undeformed shape.
///
/// # Errors
/// [`base::ErrorKind::Input`] when an array does not fit the mesh; [`base::ErrorKind::Environment`] with the path.
pub fn write(
    beside: &Beside,
    mesh: &PlaneMesh,
    fields: &[ShownField],
    marked: &Marked,
    displaced: bool,
    title: &str,
    path: &Path,
) -> Result<()> {
    mesh.check()?;
    let (points, cells) = (mesh.points.len(), mesh.corners.len());
    fields.iter().try_for_each(|f| f.check(points, cells))?;
    draw(beside, mesh, fields, marked, displaced, title).write_png(path)
}

const LEFT: f64 = 52.0;
const BAR_GAP: f64 = 12.0;
/// Length of the longest arrow in logical pixels; shorter where bodies are small.
const LONGEST: f64 = 40.0;
/// Room beyond the tip of the longest arrow, for its border.
const TIP: f64 = 3.0;
/// Colour of the outlines of undeformed bodies.
const BEFORE: Colour = Colour(0x9a, 0x9a, 0x9a);

fn draw(
    beside: &Beside,
    mesh: &PlaneMesh,
    fields: &[ShownField],
    marked: &Marked,
    displaced: bool,
    title: &str,
) -> Raster {
    let lines = mesh.lines(mesh.shown, displaced);
    // The outlines of undeformed bodies, below the fields.
    let before = if displaced {
        mesh.lines(mesh.points, true).bodies
    } else {
        Vec::new()
    };
    let ends = before.iter().flatten();
    let [mut low, mut high] = bounds(mesh.shown.iter().chain(ends).copied());
    if !beside.is_empty() {
        let margin = BEYOND * (high[0] - low[0]).max(high[1] - low[1]);
        low = low.map(|x| x - margin);
        high = high.map(|x| x + margin);
    }
    let size = [
        (high[0] - low[0]).max(1e-300),
        (high[1] - low[1]).max(1e-300),
    ];
    let aspect = size[0] / size[1];
    let wide = aspect > 1.7;
    let scale = if wide {
        860.0 / size[0]
    } else {
        (400.0 / size[0]).min(520.0 / size[1])
    };
    let extent =
        |[low, high]: [[f64; 2]; 2]| (scale * (high[0] - low[0]), scale * (high[1] - low[1]));
    let (w, h) = extent([low, high]);
    let body_width = (w * h / mesh.count(mesh.body).max(1) as f64).sqrt();
    let longest = f64::min(LONGEST, 0.3 * body_width);
    let largest = arrows::largest(marked.tractions, longest);
    if let Some(largest) = largest {
        // The scale stays, and the picture grows: an arrow would cross a title or an axis.
        let unit = (longest + TIP) / (largest * scale);
        [low, high] = arrows::room(marked.tractions, [low, high], unit);
    }
    let (w, h) = extent([low, high]);
    // A colour bar needs a certain height, a title a certain width, for any shape of the mesh.
    let cell = (
        LEFT + w.max(120.0) + BAR_GAP + BAR + LABELS,
        h.max(90.0) + 2.4 * TEXT + 34.0,
    );
    let n = fields.len().max(1) as f64;
    let (columns, rows) = if wide { (1.0, n) } else { (n, 1.0) };
    let traction = largest.map(|t| format!("traction, at most {}", ticks::number(t)));
    let (wide_legend, below) = marks::legend_size(marked.contact, traction.as_deref());
    let content = ((columns * cell.0).max(wide_legend), rows * cell.1 + below);
    let (mut raster, width, top) = sheet(title, content);
    for (k, field) in fields.iter().enumerate() {
        let at = if wide {
            (0.0, top + k as f64 * cell.1)
        } else {
            (k as f64 * cell.0, top)
        };
        let view = View {
            low,
            scale,
            origin: (at.0 + LEFT, at.1 + 2.4 * TEXT + h),
        };
        let middle = (view.origin.0 + 0.5 * w.max(60.0), at.1 + 1.2 * TEXT);
        raster.text(middle, field.title, &TextStyle::title(TEXT));
        let range = field.range();
        for obstacle in beside.obstacles {
            obstacle.paint(&mut raster, &view, [low, high]);
        }
        rigid_faces::paint(beside.faces, &mut raster, &view, [low, high]);
        for line in &before {
            view.line(&mut raster, line, 0.7, BEFORE);
        }
        paint(&mut raster, mesh, field, range, &view);

        // Where subdomains are only a few pixels wide their lines would hide the field.
        let spacing = |count: usize| (w * h / count.max(1) as f64).sqrt();
        let between_subdomains = spacing(mesh.count(mesh.subdomain));
        if between_subdomains > 7.0 {
            for line in &lines.subdomains {
                let width = (0.02 * between_subdomains).clamp(0.35, 0.7);
                view.line(&mut raster, line, width, Colour::WHITE);
            }
        }
        let between_bodies = spacing(mesh.count(mesh.body));
        let body_line = (0.02 * between_bodies).clamp(f64::min(0.4, 0.06 * between_bodies), 1.5);
        for line in &lines.bodies {
            view.line(&mut raster, line, body_line, Colour(0, 0, 0));
        }
        if k == 0 {
            let spacing = spacing(mesh.count(mesh.body));
            marks::draw(&mut raster, marked.contact, &view, spacing);
            if let Some(largest) = largest {
                arrows::draw(&mut raster, marked.tractions, &view, longest / largest);
            }
        }
        axes(&mut raster, &view, low, high);
        colour_bar(
            &mut raster,
            (view.origin.0 + w + BAR_GAP, view.origin.1),
            h.max(90.0),
            range,
            field.scale,
        );
    }
    let middle = top + rows * cell.1 + 0.5 * below - 4.0;
    marks::legend(
        &mut raster,
        marked.contact,
        traction.as_deref(),
        (0.5 * width, middle),
    );
    raster
}

#[cfg(test)]
#[path = "../../tests/pictures/field.rs"]
mod tests;
