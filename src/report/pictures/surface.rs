//! The surface of bodies of hexahedra for pictures: outer faces, edges of bodies, lines between subdomains.

use crate::linalg::vec3::{cross, norm};
use crate::{Error, Result};
use rayon::slice::ParallelSliceMut;
use std::collections::HashMap;

/// Hexahedra with the body and the subdomain of each.
#[derive(Debug, Clone, Copy)]
pub struct Solid<'a> {
    /// Positions in the undeformed bodies. A position may be listed several times: once per body, or once per
    /// subdomain.
    pub points: &'a [[f64; 3]],
    /// Positions of the points in the picture: as `points`, or displaced.
    pub shown: &'a [[f64; 3]],
    /// Corners of every cell in VTK's order, x, y, z right-handed.
    pub hexahedra: &'a [[u32; 8]],
    /// Body of every cell.
    pub body: &'a [u32],
    /// Subdomain of every cell; numbers continue from body to body.
    pub subdomain: &'a [u32],
}

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
    /// Checks that the sizes of the arrays agree.
    pub(super) fn check(&self) -> Result<()> {
        let (cells, points) = (self.hexahedra.len(), self.points.len());
        for (found, expected, what) in [
            (self.body.len(), cells, "bodies of cells"),
            (self.subdomain.len(), cells, "subdomains of cells"),
            (self.shown.len(), points, "displaced points"),
        ] {
            if found != expected {
                return Err(Error::input(format!(
                    "the picture's mesh lists {found} {what}, expected {expected}"
                )));
            }
        }
        match self
            .hexahedra
            .iter()
            .flatten()
            .find(|&&p| p as usize >= points)
        {
            Some(bad) => Err(Error::input(format!(
                "a cell names point {bad}, but the picture's mesh has {points} points"
            ))),
            None => Ok(()),
        }
    }

    /// Least and greatest coordinates of `points`; those of the unit cube if there are no points.
    pub(super) fn bounds(points: &[[f64; 3]]) -> [[f64; 3]; 2] {
        let mut out = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for p in points {
            for d in 0..3 {
                out[0][d] = out[0][d].min(p[d]);
                out[1][d] = out[1][d].max(p[d]);
            }
        }
        if out[0][0] <= out[1][0] {
            out
        } else {
            [[0.0; 3], [1.0; 3]]
        }
    }

    /// The outer surface: the faces that belong to only one cell of a body.
    pub(super) fn surface(&self, marks: &[FaceMark]) -> Surface {
        let [low, high] = Self::bounds(self.points);
        let size = (0..3).fold(1e-300_f64, |a, d| a.max(high[d] - low[d]));
        let grid = f64::from(1 << 20) / size;
        let key =
            |p: [f64; 3]| -> Key { [0, 1, 2].map(|d| ((p[d] - low[d]) * grid).round() as i64) };
        // Four times the centre of a face.
        let middle = |corners: [[f64; 3]; 4]| {
            let mut sum = [0; 3];
            for corner in corners.map(key) {
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
        let mut all: Vec<([u32; 4], u32, u8)> = Vec::with_capacity(6 * self.hexahedra.len());
        for (cell, hexahedron) in self.hexahedra.iter().enumerate() {
            for (f, face) in FACES.iter().enumerate() {
                let mut corners = face.map(|a| hexahedron[a]);
                corners.sort_unstable();
                all.push((corners, cell as u32, f as u8));
            }
        }
        all.par_sort_unstable();
        let single = all.chunk_by(|a, b| a.0 == b.0).filter(|g| g.len() == 1);
        let face = |g: &[([u32; 4], u32, u8)]| Face {
            corners: FACES[g[0].2 as usize].map(|a| self.hexahedra[g[0].1 as usize][a]),
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
            let [a, b, c, d] = faces[f].corners.map(|p| self.points[p as usize]);
            let (u, v) = (
                [0, 1, 2].map(|i| c[i] - a[i]),
                [0, 1, 2].map(|i| d[i] - b[i]),
            );
            unit_cross(u, v)
        };
        let mut out = Vec::new();
        for ((body, ..), (ends, [f, g], count)) in found {
            let (m, n) = (normal(f), normal(g));
            let crease = count != 2 || m[0] * n[0] + m[1] * n[1] + m[2] * n[2] < CREASE;
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

/// The unit vector along a × b; zero if a × b is zero.
pub(super) fn unit_cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let v = cross(a, b);
    let length = norm(v);
    v.map(|x| if length > 0.0 { x / length } else { 0.0 })
}

#[cfg(test)]
#[path = "../../../tests/inside/report/pictures/surface.rs"]
pub(crate) mod tests;
