//! The surface of solid bodies for pictures: outer faces, edges of bodies, lines between subdomains.

use super::mesh::SolidMesh;
use super::pieces::{edges, pieces};
use base::linalg::vec3::{cross, dot, minus, unit};
use rayon::slice::ParallelSliceMut;
use std::collections::HashMap;

/// The face of an element that is tied to another body, or that may touch another body or an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceMark {
    /// Body of the element.
    pub body: u32,
    /// The other body; `None` beside an obstacle.
    pub partner: Option<u32>,
    /// The corners in the undeformed body, in any order; a triangle repeats its last one.
    pub corners: [[f64; 3]; 4],
    /// Whether the face touches; `None` if it is tied.
    pub closed: Option<bool>,
}

/// An outer face, or a part of one.
pub(super) struct OuterFace {
    /// Corners, counter-clockwise seen from outside; a triangle repeats its last one.
    pub corners: [u32; 4],
    pub cell: u32,
    /// Whether the face touches; `None` if it is tied, or cannot touch.
    pub mark: Option<bool>,
    /// The body on the other side, if there may be one.
    pub partner: Option<u32>,
}

/// A line on the surface, given by the points at its ends.
pub(super) struct Edge {
    pub ends: [u32; 2],
    pub body: u32,
    /// Whether the line is an edge of the body; otherwise it lies between subdomains.
    pub crease: bool,
}

/// The visible surface of a solid.
pub(super) struct VisibleSurface {
    pub faces: Vec<OuterFace>,
    pub edges: Vec<Edge>,
}

/// The edge between two faces is an edge of the body if the cosine of the angle between their normals is below this.
const CREASE: f64 = 0.8;

/// A position rounded to a millionth of the mesh: equal for all copies of a point.
type PositionKey = [i64; 3];

/// Places of corners of sides of cells, in increasing order; those of a triangle end with `u32::MAX`.
type CellCorners = [u32; 4];

/// A side of a cell: the cell, and the number of the side.
type CellFaceIndex = (u32, u8);

impl SolidMesh<'_> {
    /// The outer surface: the sides that belong to only one cell of a body.
    pub(super) fn surface(&self, marks: &[FaceMark]) -> VisibleSurface {
        let key = self.rounding();
        let position = |p: u32| self.points[p as usize];
        let marked: HashMap<(u32, PositionKey), &FaceMark> = marks
            .iter()
            .map(|m| ((m.body, middle(&key, &m.corners)), m))
            .collect();

        let mut by_place: HashMap<(u32, PositionKey), (usize, usize)> = HashMap::new(); // a side, how many there are
        let alone = self.sides_of_one_cell();
        for (f, &(cell, side)) in alone.iter().enumerate() {
            let corners = self.corners(cell, side);
            let corners = corners.into_iter().filter(|&k| k != u32::MAX).map(position);
            let at = middle(&key, &corners.collect::<Vec<_>>());
            let entry = by_place.entry((self.body[cell as usize], at));
            entry.or_insert((f, 0)).1 += 1;
        }
        let mut keep: Vec<(usize, Option<&FaceMark>)> = by_place
            .into_iter()
            .filter(|(_, (_, count))| *count == 1)
            .map(|(place, (f, _))| (f, marked.get(&place).copied()))
            .collect();
        keep.sort_unstable_by_key(|(f, _)| *f);
        let mut faces = Vec::with_capacity(keep.len());
        for (f, mark) in keep {
            let (cell, side) = alone[f];
            let (c, side) = (cell as usize, usize::from(side));
            let nodes: Vec<u32> = self.cells.side_nodes(c, side).collect();
            let kind = self.cells.kind(c).sides()[side].kind;
            faces.extend(pieces(kind).iter().map(|piece| OuterFace {
                corners: piece.map(|a| nodes[usize::from(a)]),
                cell,
                mark: mark.and_then(|m| m.closed),
                partner: mark.and_then(|m| m.partner),
            }));
        }
        let edges = self.edges(&faces, &|p| key(position(p)));
        VisibleSurface { faces, edges }
    }

    fn corners(&self, cell: u32, side: u8) -> CellCorners {
        let (cell, side) = (cell as usize, usize::from(side));
        let n = self.cells.kind(cell).sides()[side].kind.corners();
        let mut out = [u32::MAX; 4];
        for (place, k) in out
            .iter_mut()
            .zip(self.cells.side_nodes(cell, side).take(n))
        {
            *place = k;
        }
        out.sort_unstable();
        out
    }

    /// Sides whose points only one cell has; most sides have two cells and lie inside a body.
    fn sides_of_one_cell(&self) -> Vec<CellFaceIndex> {
        let mut all: Vec<(CellCorners, CellFaceIndex)> = Vec::with_capacity(6 * self.cells.len());
        for (cell, kind) in self.cells.kinds().iter().enumerate() {
            let sides = 0..kind.sides().len() as u8;
            let place = |side| (cell as u32, side);
            all.extend(sides.map(|side| (self.corners(cell as u32, side), place(side))));
        }
        all.par_sort_unstable();
        let groups = all.chunk_by(|a, b| a.0 == b.0);
        groups.filter(|g| g.len() == 1).map(|g| g[0].1).collect()
    }

    fn edges(&self, faces: &[OuterFace], key: &dyn Fn(u32) -> PositionKey) -> Vec<Edge> {
        // (points at the ends of a line, two faces beside it, number of faces beside it).
        type Beside = ([u32; 2], [usize; 2], usize);
        let mut found: HashMap<(u32, PositionKey, PositionKey), Beside> = HashMap::new();
        for (f, face) in faces.iter().enumerate() {
            for (a, b) in edges(face.corners) {
                let body = self.body[face.cell as usize];
                let place = (body, key(a).min(key(b)), key(a).max(key(b)));
                let entry = found.entry(place).or_insert(([a, b], [f, f], 0));
                entry.1[entry.2.min(1)] = f;
                entry.2 += 1;
            }
        }
        let normal = |f: usize| {
            let ([u, v], _) = diagonals(faces[f].corners.map(|p| self.points[p as usize]));
            unit_cross(u, v)
        };
        let mut out = Vec::new();
        for ((body, ..), (ends, [f, g], count)) in found {
            let (m, n) = (normal(f), normal(g));
            let crease = count != 2 || dot(m, n) < CREASE;
            let subdomain = |f: usize| self.subdomain[faces[f].cell as usize];
            if crease || subdomain(f) != subdomain(g) {
                out.push(Edge { ends, body, crease });
            }
        }
        // Creases come last: they are drawn over the other lines. The order is fixed, so that a picture is the same in
        // every run.
        out.sort_unstable_by_key(|e| (e.crease, e.ends));
        out
    }
}

/// Twelve times the centre of a side, from its corners; a triangle may repeat its last one.
fn middle(key: &dyn Fn([f64; 3]) -> PositionKey, corners: &[[f64; 3]]) -> PositionKey {
    let n = match corners {
        [_, _, a, b] if a != b => 4,
        _ => 3.min(corners.len()),
    };
    let mut sum = [0; 3];
    for corner in &corners[..n] {
        let at = key(*corner);
        (0..3).for_each(|d| sum[d] += at[d] * (12 / n as i64));
    }
    sum
}

/// The diagonals of a quadrilateral, and its middle; of a triangle two edges, and a point inside.
pub(super) fn diagonals([a, b, c, d]: [[f64; 3]; 4]) -> ([[f64; 3]; 2], [f64; 3]) {
    let middle = [0, 1, 2].map(|i| 0.25 * (a[i] + b[i] + c[i] + d[i]));
    ([minus(c, a), minus(d, b)], middle)
}

/// The unit vector along a × b; zero if a × b is zero.
pub(super) fn unit_cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    unit(cross(a, b)).unwrap_or_default()
}

#[cfg(test)]
#[path = "../../tests/pictures/surface.rs"]
pub(crate) mod tests;
