//! `solution.png`: u and ρ of a plane scalar problem, the deformed bodies of an elastic one, or the surface of solids;
//! the latter two with the coefficient where it varies inside bodies.

use std::collections::HashMap;
use std::path::Path;

use super::contact::by_source;
use super::fields::Gathered;
use super::friction::FrictionRows;
use super::line_marks;
use base::linalg::vec3::{dot, minus, norm};
use base::Result;
use fetifeti::problem::RowSource;
use fetifeti::solution::SolvedRow;
use report::drawing::ticks::number;
use report::pictures::field::{self, Marked, PlaneMesh, ShownField};
use report::pictures::mesh::bounds;
use report::pictures::obstacles::ShownObstacle;
use report::pictures::pieces::pieces;
use report::pictures::rigid_faces::{Beside, Polygon};
use report::pictures::solid::{self, FaceMark, SolidMesh};
use report::pictures::values::ShownValues;
use scene::{Rigid, Scene};

/// Magnified, bodies may overlap by at most this part of the scene's size: by the width of a line.
const OVERLAP: f64 = 0.001;
/// Displacements are magnified such that the largest is at most this part of the scene's size.
const LARGEST: f64 = 0.1;
/// Displacements are not magnified where the largest is between these parts of the scene's size.
const VISIBLE: [f64; 2] = [0.03, 0.3];
/// Beside contact, the lower bound of [`VISIBLE`]: magnified, bodies that touch overlap.
const VISIBLE_CONTACT: f64 = 0.01;

/// Writes `solution.png` of load step `step` into `dir`.
pub(super) fn write(
    scene: &Scene,
    all: &Gathered,
    (rows, friction): (&[SolvedRow], &FrictionRows),
    step: usize,
    dir: &Path,
) -> Result<()> {
    let path = dir.join("solution.png");
    let elastic = scene.form.is_elastic();
    let moved = Moved::new(scene, all, rows);
    let size = all.u.chunks_exact(scene.components());
    let u: Vec<f64> = size
        .map(|u| match u {
            [u] => *u,
            u => u.iter().map(|v| v * v).sum::<f64>().sqrt(),
        })
        .collect();
    let von_mises: Vec<f64> = all.von_mises();
    let coefficient = ["coefficient ρ", "Young's modulus E"][usize::from(elastic)];
    let coefficient = ShownField::coefficient(coefficient, &all.rho);
    let first = if elastic {
        ShownField::nodal("displacement |u|", &u)
    } else {
        ShownField::nodal("solution u", &u)
    };
    let mut fields = vec![first];
    if elastic {
        fields.push(ShownField::nodal("von Mises stress", &von_mises));
    } else if scene.dim() == 3 {
        // The second picture shows the bodies moved apart.
        fields.push(first);
    }
    if (!elastic && scene.dim() == 2) || varies_inside_bodies(&all.rho, &all.body) {
        fields.push(coefficient);
    }
    let title = if elastic {
        format!("{} (displacements {} ×)", scene.title, number(moved.factor))
    } else {
        scene.title.clone()
    };
    let beside = Beside {
        obstacles: &obstacles(scene, all, rows),
        faces: &faces(scene, step),
    };
    if scene.dim() == 3 {
        let solid = SolidMesh {
            points: &all.points,
            shown: &moved.points,
            cells: &all.cells,
            body: &all.body,
            subdomain: &all.subdomain,
        };
        let marks = face_marks(scene, rows);
        return solid::write_solution(&solid, &fields, &marks, &beside, &title, &path);
    }
    let flat =
        |points: &[[f64; 3]]| -> Vec<[f64; 2]> { points.iter().map(|p| [p[0], p[1]]).collect() };
    let points = flat(&all.points);
    let shown = flat(&moved.points);
    let plane = PlaneCells::new(all);
    let mesh = PlaneMesh {
        points: &points,
        shown: &shown,
        corners: &plane.corners,
        body: &plane.of(&all.body),
        subdomain: &plane.of(&all.subdomain),
    };
    let by_piece = plane.of(&all.rho);
    for field in &mut fields {
        if matches!(field.values, ShownValues::Cell(_)) {
            field.values = ShownValues::Cell(&by_piece);
        }
    }
    let copies = all.copies(rows);
    let at = |row: &SolvedRow, member: usize| {
        let copy = row.label.members[member].and_then(|m| copies.get(&m));
        let point = copy
            .filter(|_| elastic)
            .map_or(row.label.point, |c| moved.points[c[0]]);
        [point[0], point[1]]
    };
    let marked = Marked {
        contact: &line_marks::marks(scene, rows, friction, &at),
        tractions: &line_marks::tractions(scene, rows, friction, &at),
    };
    field::write(&beside, &mesh, &fields, &marked, elastic, &title, &path)
}

/// The rigid bodies of the scene, each once, with the gap of the row that is nearest to contact: rows say
/// n·u ≤ distance + gap.
fn obstacles(scene: &Scene, all: &Gathered, rows: &[SolvedRow]) -> Vec<ShownObstacle> {
    let copies = all.copies(rows);
    let mut out: Vec<ShownObstacle> = Vec::new();
    for rows in by_source(rows) {
        let RowSource::Obstacle(k) = rows[0].label.source else {
            continue;
        };
        let nearest = rows.iter().min_by(|a, b| a.gap.total_cmp(&b.gap));
        let (Some(rigid), Some(row)) = (scene.obstacles[k].rigid, nearest) else {
            continue;
        };
        let point = row.label.members[0].and_then(|m| copies.get(&m)?.first());
        let u = point.map_or([0.0; 3], |&p| all.displacement(scene, p));
        let distance = rigid.distance(row.label.point).map_or(0.0, |d| d.0);
        let gap = row.gap + dot(u, row.normal()) - distance;
        let placed = !matches!(rigid, Rigid::Behind { .. });
        if placed && !out.iter().any(|o| o.rigid == rigid) {
            out.push(ShownObstacle { rigid, gap });
        }
    }
    out
}

/// The faces of rigid surfaces, each once, where they stand at load step `step`.
fn faces(scene: &Scene, step: usize) -> Vec<Polygon> {
    let mut shown: Vec<(&str, [f64; 3], &[Polygon])> = Vec::new();
    for obstacle in &scene.obstacles {
        let Some(surface) = &obstacle.surface else {
            continue;
        };
        let Some(name) = surface.name.as_deref() else {
            continue;
        };
        let this = (name, scene.way_of(obstacle, step), &surface.polygons[..]);
        if !shown.contains(&this) {
            shown.push(this);
        }
    }
    let moved = |(_, way, polygons): (&str, [f64; 3], &[Polygon])| -> Vec<Polygon> {
        let at = |x: &[f64; 3]| [0, 1, 2].map(|d| x[d] + way[d]);
        let polygon = |p: &Polygon| p.iter().map(at).collect();
        polygons.iter().map(polygon).collect()
    };
    shown.into_iter().flat_map(moved).collect()
}

/// The cells of plane bodies, cut into pieces.
struct PlaneCells {
    corners: Vec<[u32; 4]>,
    /// The cell of each piece.
    cell: Vec<usize>,
}

impl PlaneCells {
    fn new(all: &Gathered) -> PlaneCells {
        let (mut corners, mut cell) = (Vec::new(), Vec::new());
        for (c, (kind, nodes)) in all.cells.iter().enumerate() {
            for piece in pieces(kind) {
                corners.push(piece.map(|a| nodes[usize::from(a)]));
                cell.push(c);
            }
        }
        PlaneCells { corners, cell }
    }

    /// Values of cells, piece by piece.
    fn of<T: Copy>(&self, by_cell: &[T]) -> Vec<T> {
        self.cell.iter().map(|&c| by_cell[c]).collect()
    }
}

/// Whether two cells of one body have different values.
fn varies_inside_bodies(values: &[f64], body: &[u32]) -> bool {
    let mut first = HashMap::new();
    let mut cells = values.iter().zip(body);
    cells.any(|(value, body)| *first.entry(body).or_insert(value) != value)
}

/// The points in their displaced positions.
struct Moved {
    points: Vec<[f64; 3]>,
    /// The factor by which displacements are magnified.
    factor: f64,
}

impl Moved {
    fn new(scene: &Scene, all: &Gathered, rows: &[SolvedRow]) -> Moved {
        if !scene.form.is_elastic() {
            return Moved {
                points: all.points.clone(),
                factor: 1.0,
            };
        }
        let each = || (0..all.points.len()).map(|p| all.displacement(scene, p));
        let largest = each()
            .map(norm)
            .filter(|x| x.is_finite())
            .fold(0.0, f64::max);
        let [low, high] = bounds(all.points.iter().copied());
        let size = norm(minus(high, low));
        let contact = rows.iter().any(|r| r.is_inequality());
        let from = if contact { VISIBLE_CONTACT } else { VISIBLE[0] };
        let most = apart(scene, all, rows, OVERLAP * size);
        // Sides touch where renewed contacts pair them, that is, in their own positions.
        let factor = if scene.is_renewed() {
            1.0
        } else {
            factor(largest, size, from, most)
        };
        let moved = |(p, u): (&[f64; 3], [f64; 3])| [0, 1, 2].map(|d| p[d] + factor * u[d]);
        Moved {
            points: all.points.iter().zip(each()).map(moved).collect(),
            factor,
        }
    }
}

/// The largest factor with which no gap is smaller than −`overlap`, at least 1: a gap c − B u becomes c − factor · B u.
fn apart(scene: &Scene, all: &Gathered, rows: &[SolvedRow], overlap: f64) -> f64 {
    let copies = all.copies(rows);
    let contact = rows.iter().filter(|r| r.is_inequality());
    let limit = contact.map(|row| {
        let along = |k: usize| {
            let point = row.label.members[k].and_then(|m| copies.get(&m)?.first());
            point.map_or(0.0, |&p| dot(all.displacement(scene, p), row.normal()))
        };
        let closing = along(0) - along(1);
        let initial = row.gap + closing;
        if closing > 0.0 {
            (initial.max(0.0) + overlap) / closing
        } else {
            f64::INFINITY
        }
    });
    limit.fold(f64::INFINITY, f64::min).max(1.0)
}

/// The factor: 1 where the largest displacement, relative to the scene's size, is visible, that is, at least `from`;
/// else 1, 2 or 5 times a power of ten, at most `most`.
fn factor(largest: f64, size: f64, from: f64, most: f64) -> f64 {
    if largest == 0.0 || (from..=VISIBLE[1]).contains(&(largest / size)) {
        return 1.0;
    }
    let wanted = (LARGEST * size / largest).min(most);
    let power = 10_f64.powi(wanted.log10().floor() as i32);
    let fits = [5.0, 2.0, 1.0].map(|m| m * power);
    let fits = fits.into_iter().find(|f| *f <= wanted).unwrap_or(power);
    // The factor must neither overflow nor vanish, however extreme the displacements are.
    if fits.is_normal() {
        fits
    } else {
        1.0
    }
}

/// The faces of elements all of whose nodes are tied or may touch, on both bodies of an interface.
fn face_marks(scene: &Scene, rows: &[SolvedRow]) -> Vec<FaceMark> {
    let mut out = Vec::new();
    for rows in by_source(rows) {
        let sides = scene.sides_of(rows[0].label.source);
        for (member, (body, side)) in sides.into_iter().enumerate() {
            // The state of each node; `None`: tied.
            let state = |row: &SolvedRow| row.is_inequality().then(|| row.holds());
            let node = |row: &SolvedRow| Some((row.label.members[member]?.node, state(row)));
            let state: HashMap<usize, Option<bool>> = rows.iter().filter_map(node).collect();
            let partner = rows[0].label.members[1 - member].map(|m| m.body as u32);
            let spec = &scene.bodies[body].spec;
            for face in spec.faces(side) {
                let states = face.nodes.iter().map(|node| state.get(node).copied());
                if let Some(states) = states.collect::<Option<Vec<Option<bool>>>>() {
                    let tied = states.iter().all(Option::is_none);
                    let corners = face.outline();
                    let last = corners.len() - 1;
                    out.push(FaceMark {
                        body: body as u32,
                        partner,
                        corners: std::array::from_fn(|a| spec.position(corners[a.min(last)])),
                        closed: (!tied).then(|| states.iter().all(|s| *s != Some(false))),
                    });
                }
            }
        }
    }
    out
}

#[cfg(test)]
#[path = "../tests/picture.rs"]
mod tests;
