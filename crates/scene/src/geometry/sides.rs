//! Sides of bodies by element faces: nodal areas and normals.

use std::borrow::Borrow;
use std::collections::HashMap;

use arrayvec::ArrayVec;

use crate::model::body::BodySpec;
use base::linalg::vec3::{cross, unit};
use elements::cell::{side_weights, Element, Side};
use elements::element;
use elements::element::face_values;
use elements::form::Form;
use elements::kind::CellKind;
use elements::mortar;
use mesh::{places, BoxMesh, CellMesh, Mesh};

/// Most nodes of a face: quadrilaterals of second order with a node in their middle.
const MOST_NODES: usize = 9;

/// The face of an element on a side of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Its nodes. On boxes they are in lexicographic order ([`Side::corners`]), else in the order of the kind, such
    /// that the normal points out of the body.
    pub nodes: ArrayVec<usize, MOST_NODES>,
    /// Its kind, a segment in the plane; `None` on boxes.
    pub kind: Option<CellKind>,
}

impl Face {
    /// The corners in their order around the face, or along the segment.
    pub fn outline(&self) -> Vec<usize> {
        match (self.kind, &self.nodes[..]) {
            (None, &[a, b, c, d]) => vec![a, b, d, c],
            (None, nodes) => nodes.to_vec(),
            (Some(kind), nodes) => nodes[..kind.corners()].to_vec(),
        }
    }
}

/// The nodal area of a face, ∫ N_a, and its area-weighted normal out of the body, ∫ N_a n.
pub type Weight = (f64, [f64; 3]);

impl BodySpec {
    /// The faces of elements on a side.
    pub fn faces(&self, side: usize) -> impl Iterator<Item = Face> + '_ {
        let of_box = self.mesh.grid().map(|grid| of_grid(grid, side));
        let of_cells = self.mesh.cells().map(|mesh| of_cells(mesh, side));
        of_box
            .into_iter()
            .flatten()
            .chain(of_cells.into_iter().flatten())
    }

    /// The faces of elements on a side that have a node among `nodes`.
    pub fn faces_around(&self, side: usize, nodes: impl Fn(usize) -> bool) -> Vec<Face> {
        let mine = |face: &Face| face.nodes.iter().any(|&n| nodes(n));
        match &self.mesh {
            Mesh::Grid(grid) => of_grid(grid, side).filter(mine).collect(),
            Mesh::Cells(mesh) => {
                // Mostly few of many, which are made for these alone.
                let all = mesh.sides[side].faces.iter();
                let mine = all.filter(|&&(cell, face)| {
                    let mut of_face = mesh.cells.side_nodes(cell as usize, face.into());
                    of_face.any(|n| nodes(n as usize))
                });
                mine.map(|&which| of_cell(mesh, which)).collect()
            }
        }
    }

    /// Nodal areas and area-weighted normals of one of the faces of a side, by node of the face.
    pub fn face_weights(&self, side: usize, face: &Face, element: Element) -> Vec<Weight> {
        let dim = self.mesh.dim();
        let points: Vec<[f64; 3]> = face.nodes.iter().map(|&k| self.position(k)).collect();
        match face.kind {
            Some(kind) => {
                let weights = element::side_weights(kind, dim, &points);
                let each = weights.area.into_iter().zip(weights.normal);
                each.take(points.len()).collect()
            }
            None => {
                let outward = Side::of_index(side).outward(dim);
                let weights = side_weights(dim, &points, outward, element);
                let each = weights.area.into_iter().zip(weights.normal);
                each.take(points.len()).collect()
            }
        }
    }

    /// Nodal areas of one of the faces of a side, by node of the face; around the axis in rings.
    pub fn face_areas(&self, side: usize, face: &Face, form: &Form) -> Vec<f64> {
        match face.kind {
            Some(kind) if form.is_axial() => {
                let points: Vec<[f64; 3]> = face.nodes.iter().map(|&k| self.position(k)).collect();
                let mut out = vec![0.0; points.len()];
                let around = |x, _| [form.around(x), 0.0, 0.0];
                element::side_load(kind, self.mesh.dim(), &points, 1, around, &mut out);
                // A segment of second order has none at its end on the axis, but for rounding.
                let rounding = 1e-12 * out.iter().sum::<f64>();
                out.iter_mut()
                    .filter(|area| area.abs() <= rounding)
                    .for_each(|area| *area = 0.0);
                out
            }
            _ => {
                let weights = self.face_weights(side, face, form.element);
                weights.into_iter().map(|(area, _)| area).collect()
            }
        }
    }

    /// ∫ N_a n with the unit normal n out of the body, by node, over some faces of a side. On triangles of 6 and
    /// quadrilaterals of 8 nodes N_a has the integral zero or less at corners: the normal at the node times the
    /// integral of a positive function stands in its place there.
    pub fn side_normals(
        &self,
        side: usize,
        element: Element,
        faces: impl Iterator<Item = impl Borrow<Face>>,
    ) -> HashMap<usize, [f64; 3]> {
        let mut sums: HashMap<usize, [f64; 3]> = HashMap::new();
        for face in faces {
            let face = face.borrow();
            let normals = self.face_normals(side, face, element);
            for (&node, normal) in face.nodes.iter().zip(normals) {
                let sum = sums.entry(node).or_default();
                sum.iter_mut().zip(normal).for_each(|(s, n)| *s += n);
            }
        }
        sums
    }

    fn face_normals(&self, side: usize, face: &Face, element: Element) -> Vec<[f64; 3]> {
        let weights = self.face_weights(side, face, element);
        let Some(kind) = face.kind.filter(|&k| !mortar::has_positive_integrals(k)) else {
            return weights.into_iter().map(|(_, normal)| normal).collect();
        };
        let mut areas = [0.0; 9];
        areas.iter_mut().zip(&weights).for_each(|(a, w)| *a = w.0);
        let points = || face.nodes.iter().map(|&k| self.position(k));
        let normal = |(at, area): ([f64; 3], f64)| {
            let [s, t] = face_values::at(kind, points(), at).tangents;
            unit(cross(s, t)).unwrap_or_default().map(|v| area * v)
        };
        let places = face_values::nodes(kind).into_iter();
        places
            .zip(mortar::positive(kind, areas))
            .map(normal)
            .collect()
    }
}

fn of_grid(grid: &BoxMesh, side: usize) -> impl Iterator<Item = Face> + use<'_> {
    let (dim, at) = (grid.dim(), Side::of_index(side));
    let mut counts = grid.elements.map(|n| n.max(1));
    counts[at.axis] = 1;
    let level = at.level(grid.elements);
    places(counts).map(move |mut cell| {
        cell[at.axis] = level;
        let corner = |a: usize| grid.node([0, 1, 2].map(|d| cell[d] + (a >> d & 1)));
        Face {
            nodes: at.corners(dim).map(corner).collect(),
            kind: None,
        }
    })
}

fn of_cells(mesh: &CellMesh, side: usize) -> impl Iterator<Item = Face> + use<'_> {
    let all = mesh.sides[side].faces.iter();
    all.map(|&which| of_cell(mesh, which))
}

fn of_cell(mesh: &CellMesh, (cell, face): (u32, u8)) -> Face {
    let (cell, face) = (cell as usize, usize::from(face));
    let nodes = mesh.cells.side_nodes(cell, face);
    Face {
        nodes: nodes.map(|k| k as usize).collect(),
        kind: Some(mesh.cells.kind(cell).sides()[face].kind),
    }
}
