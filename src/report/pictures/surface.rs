//! The surface of bodies of hexahedra for pictures: outer faces, edges of bodies, lines between subdomains.

use super::mesh::Solid;
use crate::linalg::vec3::{cross, dot, minus, norm};
use rayon::slice::ParallelSliceMut;
use std::collections::HashMap;

/// The face of an element that may touch another body or an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceMark {
    /// Body of the element.
    pub body: u32,
    /// The corners in the undeformed body, in any order.
    pub corners: [[f64; 3]; 4],
    /// Whether the face touches.
    pub closed: bool,
}

/// An outer face.
pub(super) struct Face {
    /// Corners, counter-clockwise seen from outside.
    pub corners: [u32; 4],
    pub cell: u32,
    /// Whether the face touches; `None` if it cannot touch.
    pub mark: Option<bool>,
}

/// A line on the surface, given by the points at its ends.
pub(super) struct Edge {
    pub ends: [u32; 2],
    pub body: u32,
    /// Whether the line is an edge of the body; otherwise it lies between subdomains.
    pub crease: bool,
}

/// The visible surface of a solid.
pub(super) struct Surface {
    pub faces: Vec<Face>,
    pub edges: Vec<Edge>,
}

/// The faces of a hexahedron, counter-clockwise from outside.
const FACES: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

/// The edge between two faces is an edge of the body if the cosine of the angle between their normals is below this.
const CREASE: f64 = 0.8;

/// A position rounded to a millionth of the mesh: equal for all copies of a point.
type Key = [i64; 3];

impl Solid<'_> {
    /// The outer surface: the faces that belong to only one cell of a body.
    pub(super) fn surface(&self, marks: &[FaceMark]) -> Surface {
        let key = self.rounding();
        // Four times the centre of a face.
        let middle = |corners: [[f64; 3]; 4]| {
            let mut sum = [0; 3];
            for corner in corners.map(&key) {
                (0..3).for_each(|d| sum[d] += corner[d]);
            }
            sum
        };
        let position = |p: u32| self.points[p as usize];
        let marked: HashMap<(u32, Key), bool> = marks
            .iter()
            .map(|m| ((m.body, middle(m.corners)), m.closed))
            .collect();

        let mut by_place: HashMap<(u32, Key), (usize, usize)> = HashMap::new(); // a face, how many there are
        let alone = self.faces_of_one_subdomain();
        for (f, face) in alone.iter().enumerate() {
            let at = middle(face.corners.map(position));
            let entry = by_place.entry((self.body[face.cell as usize], at));
            entry.or_insert((f, 0)).1 += 1;
        }
        let mut keep: Vec<(usize, Option<bool>)> = by_place
            .into_iter()
            .filter(|(_, (_, count))| *count == 1)
            .map(|(place, (f, _))| (f, marked.get(&place).copied()))
            .collect();
        keep.sort_unstable();
        let mut faces = Vec::with_capacity(keep.len());
        for (f, mark) in keep {
            let Face { corners, cell, .. } = alone[f];
            faces.push(Face {
                corners,
                cell,
                mark,
            });
        }
        let edges = self.edges(&faces, &|p| key(position(p)));
        Surface { faces, edges }
    }

    /// Faces that occur once in a subdomain, by point numbers; most faces occur twice and lie inside it.
    fn faces_of_one_subdomain(&self) -> Vec<Face> {
        let mut all: Vec<([u32; 4], u32, u8)> = Vec::with_capacity(6 * self.corners.len());
        for (cell, hexahedron) in self.corners.iter().enumerate() {
            for (f, face) in FACES.iter().enumerate() {
                let mut corners = face.map(|a| hexahedron[a]);
                corners.sort_unstable();
                all.push((corners, cell as u32, f as u8));
            }
        }
        all.par_sort_unstable();
        let single = all.chunk_by(|a, b| a.0 == b.0).filter(|g| g.len() == 1);
        let face = |g: &[([u32; 4], u32, u8)]| Face {
            corners: FACES[g[0].2 as usize].map(|a| self.corners[g[0].1 as usize][a]),
            cell: g[0].1,
            mark: None,
        };
        single.map(face).collect()
    }

    fn edges(&self, faces: &[Face], key: &dyn Fn(u32) -> Key) -> Vec<Edge> {
        // (points at the ends of a line, two faces beside it, number of faces beside it).
        type Beside = ([u32; 2], [usize; 2], usize);
        let mut found: HashMap<(u32, Key, Key), Beside> = HashMap::new();
        for (f, face) in faces.iter().enumerate() {
            for k in 0..4 {
                let (a, b) = (face.corners[k], face.corners[(k + 1) % 4]);
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

/// The diagonals of a quadrilateral, and its middle.
pub(super) fn diagonals([a, b, c, d]: [[f64; 3]; 4]) -> ([[f64; 3]; 2], [f64; 3]) {
    let middle = [0, 1, 2].map(|i| 0.25 * (a[i] + b[i] + c[i] + d[i]));
    ([minus(c, a), minus(d, b)], middle)
}

/// The unit vector along a × b; zero if a × b is zero.
pub(super) fn unit_cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let v = cross(a, b);
    let length = norm(v);
    v.map(|x| if length > 0.0 { x / length } else { 0.0 })
}

#[cfg(test)]
#[path = "../../../tests/inside/report/pictures/surface.rs"]
pub(crate) mod tests;
