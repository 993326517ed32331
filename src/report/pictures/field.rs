//! Pictures of fields on meshes of quadrilaterals: u and ρ side by side with colour bars, bodies outlined.
//!
//! Cells are painted pixel by pixel, so that a million of them cost a fraction of a second. Points may be listed once
//! per body or once per subdomain: lines between bodies and subdomains are found from the coordinates.

use super::marks;
use super::outline::Lines;
use super::paint::{axes, colour_bar, paint, sheet, View, BAR, LABELS, TEXT};
use crate::report::drawing::canvas::{Canvas, Colour, TextStyle};
use crate::report::drawing::raster::Raster;
use crate::report::drawing::ticks::Scale;
use crate::{Error, Result};
use std::path::Path;

pub use super::marks::ContactMark;
pub use super::outline::Mesh;
pub use super::values::{coefficient_scale, Field, Values};

/// Writes u (nodal) and ρ (per cell) side by side as PNG; ρ on a logarithmic scale where it varies by more than 100.
/// `contact` lists the parts of sides that may touch another body or an obstacle; they are marked on u.
///
/// # Errors
/// [`Error::Input`] when an array does not fit the mesh; [`Error::Environment`] with the path.
pub fn write_solution(
    mesh: &Mesh,
    u: &[f64],
    rho: &[f64],
    contact: &[ContactMark],
    title: &str,
    path: &Path,
) -> Result<()> {
    let fields = [
        Field {
            title: "solution u",
            values: Values::Nodal(u),
            scale: Scale::Linear,
        },
        Field {
            title: "coefficient ρ",
            values: Values::Cell(rho),
            scale: coefficient_scale(rho),
        },
    ];
    check(mesh, &fields)?;
    draw(mesh, &fields, contact, title).write_png(path)
}

/// Writes any fields of one mesh as PNG: side by side, or one below the other where the mesh is wide.
///
/// # Errors
/// [`Error::Input`] when an array does not fit the mesh; [`Error::Environment`] with the path.
pub fn write(mesh: &Mesh, fields: &[Field], title: &str, path: &Path) -> Result<()> {
    check(mesh, fields)?;
    draw(mesh, fields, &[], title).write_png(path)
}

/// As [`write()`] for displaced bodies: `mesh` is undeformed, `shown` are the displaced points. Every body has its own
/// outline, with a thin outline of its undeformed shape. `contact` is in displaced coordinates.
///
/// # Errors
/// [`Error::Input`] when an array does not fit the mesh; [`Error::Environment`] with the path.
pub fn write_displaced(
    mesh: &Mesh,
    shown: &[[f64; 2]],
    fields: &[Field],
    contact: &[ContactMark],
    title: &str,
    path: &Path,
) -> Result<()> {
    check(mesh, fields)?;
    if shown.len() != mesh.points.len() {
        return Err(Error::input(format!(
            "the picture's mesh lists {} displaced points, expected {}",
            shown.len(),
            mesh.points.len()
        )));
    }
    let moved = Mesh {
        points: shown,
        ..*mesh
    };
    let before = mesh.lines_at(mesh.points, true).bodies;
    let lines = mesh.lines_at(shown, true);
    draw_lines(&moved, fields, contact, title, &lines, &before).write_png(path)
}

fn check(mesh: &Mesh, fields: &[Field]) -> Result<()> {
    mesh.check()?;
    let (points, cells) = (mesh.points.len(), mesh.quads.len());
    fields.iter().try_for_each(|f| f.check(points, cells))
}

const LEFT: f64 = 52.0;
const BAR_GAP: f64 = 12.0;
/// Colour of the outlines of undeformed bodies.
const BEFORE: Colour = Colour(0x9a, 0x9a, 0x9a);

fn draw(mesh: &Mesh, fields: &[Field], contact: &[ContactMark], title: &str) -> Raster {
    draw_lines(mesh, fields, contact, title, &mesh.lines(), &[])
}

/// Draws the fields, with `before`, the outlines of undeformed bodies, below them and `lines` above.
fn draw_lines(
    mesh: &Mesh,
    fields: &[Field],
    contact: &[ContactMark],
    title: &str,
    lines: &Lines,
    before: &[Vec<[f64; 2]>],
) -> Raster {
    let (mut low, mut high) = mesh.bounds();
    for p in before.iter().flatten() {
        for d in 0..2 {
            low[d] = low[d].min(p[d]);
            high[d] = high[d].max(p[d]);
        }
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
    let (w, h) = (scale * size[0], scale * size[1]);
    // A colour bar needs a certain height, a title a certain width, for any shape of the mesh.
    let cell = (
        LEFT + w.max(120.0) + BAR_GAP + BAR + LABELS,
        h.max(90.0) + 2.4 * TEXT + 34.0,
    );
    let n = fields.len().max(1) as f64;
    let (columns, rows) = if wide { (1.0, n) } else { (n, 1.0) };
    let below = marks::legend_height(contact);
    let content = (columns * cell.0, rows * cell.1 + below);
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
        for line in before {
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
        let body_line = (0.02 * spacing(mesh.count(mesh.body))).clamp(0.4, 1.5);
        for line in &lines.bodies {
            view.line(&mut raster, line, body_line, Colour(0, 0, 0));
        }
        if k == 0 {
            let spacing = spacing(mesh.count(mesh.body));
            marks::draw(&mut raster, contact, &view, spacing);
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
    marks::legend(&mut raster, contact, (0.5 * width, middle));
    raster
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::drawing::colormap::viridis;
    use crate::report::pictures::outline::tests::grid;

    #[test]
    fn colours_stand_for_values() {
        // u = x on the unit square: the left end is dark violet, the right end yellow, the middle teal.
        let mesh = grid(2, 2, 4, false);
        let u: Vec<f64> = mesh.points.iter().map(|p| p[0]).collect();
        let picture = draw(
            &mesh.view(),
            &[Field {
                title: "u",
                values: Values::Nodal(&u),
                scale: Scale::Linear,
            }],
            &[],
            "",
        );
        let (_, origin) = (0, (LEFT, 6.0 + 2.4 * TEXT + 400.0));
        let at = |x: f64, y: f64| {
            let p = ((origin.0 + 400.0 * x) * 2.0, (origin.1 - 400.0 * y) * 2.0);
            picture.get(p.0 as usize, p.1 as usize)
        };
        let near = |a: Colour, b: Colour| {
            [(a.0, b.0), (a.1, b.1), (a.2, b.2)]
                .iter()
                .all(|(x, y)| x.abs_diff(*y) <= 3)
        };
        for (x, y) in [(0.06, 0.3), (0.31, 0.8), (0.45, 0.45), (0.9, 0.1)] {
            assert!(
                near(at(x, y), viridis(x)),
                "{:?} at {x}, {y}, expected {:?}",
                at(x, y),
                viridis(x)
            );
        }
        // The line between the bodies.
        assert_eq!(at(0.5, 0.3), Colour(0, 0, 0));
    }

    #[test]
    fn the_contact_zone_is_marked_on_u() {
        // Two bodies that touch along x = 1/2 in its lower half; the upper half is open.
        let mesh = grid(2, 2, 4, false);
        let u = vec![0.5; mesh.points.len()];
        let field = [Field {
            title: "u",
            values: Values::Nodal(&u),
            scale: Scale::Linear,
        }; 2];
        let marks: Vec<ContactMark> = (0..16)
            .map(|k| ContactMark {
                from: [0.5, f64::from(k) / 16.0],
                to: [0.5, f64::from(k + 1) / 16.0],
                closed: k < 8,
            })
            .collect();
        let plain = draw(&mesh.view(), &field, &[], "");
        let marked = draw(&mesh.view(), &field, &marks, "");
        let (w, h) = plain.size();
        assert_eq!(marked.size().0, w);
        assert!(marked.size().1 > h, "room for the legend");
        let red = |x: usize, y: usize| {
            let c = marked.get(x, y);
            c.0 > 200 && c.1 < 60
        };
        let rows =
            |xs: std::ops::Range<usize>| (0..h).filter(move |&y| xs.clone().any(|x| red(x, y)));
        // The lower half of the first picture, 400 logical pixels high, and nothing on the second.
        let count = rows(0..w / 2).count();
        assert!(count.abs_diff(400) < 12, "{count}");
        assert_eq!(rows(w / 2..w).count(), 0);
        // Dashes, in the upper half: black and white in turn.
        let x = ((LEFT + 200.0) * 2.0) as usize;
        let y0 = ((6.0 + 2.4 * TEXT) * 2.0) as usize;
        let dark: Vec<bool> = (y0 + 8..y0 + 380)
            .map(|y| marked.get(x, y).0 < 100)
            .collect();
        let changes = dark.windows(2).filter(|p| p[0] != p[1]).count();
        assert!((30..80).contains(&changes), "{changes}");
    }

    #[test]
    fn arrays_of_the_wrong_length_are_refused() {
        let mesh = grid(1, 1, 2, false);
        let (u, rho) = (
            vec![0.0; mesh.points.len()],
            vec![1.0; mesh.quads.len() + 1],
        );
        let message = write_solution(&mesh.view(), &u, &rho, &[], "", Path::new("/dev/null"))
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("'coefficient ρ' has 5 numbers"),
            "{message}"
        );
    }

    #[test]
    fn a_million_cells_are_painted() {
        let mesh = grid(2, 2, 256, false); // 2×2 bodies of 2×2 subdomains of 256²: 1024² cells
        let u: Vec<f64> = mesh.points.iter().map(|p| p[0] * p[1]).collect();
        let rho = vec![1.0; mesh.quads.len()];
        let dir = crate::report::output::tests::Scratch::new("field");
        write_solution(&mesh.view(), &u, &rho, &[], "", &dir.0.join("u.png")).unwrap();
    }
}
