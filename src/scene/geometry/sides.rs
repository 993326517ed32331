//! Sides of bodies by element faces: nodal areas and normals.

use std::collections::HashMap;

use crate::fem::cell::{side_weights, Element, Side, SideWeights};
use crate::mesh::places;
use crate::scene::model::spec::BodySpec;

impl BodySpec {
    /// The faces of elements on a side: the nodes of each, in the order of [`Side::corners`].
    pub fn side_cells(&self, side: usize) -> impl Iterator<Item = Vec<[usize; 3]>> + use<'_> {
        let mesh = &self.mesh;
        let (dim, at) = (mesh.dim(), Side::of_index(side));
        let mut counts = mesh.elements.map(|n| n.max(1));
        counts[at.axis] = 1;
        let level = at.level(mesh.elements);
        places(counts).map(move |mut cell| {
            cell[at.axis] = level;
            let corner = |a: usize| [0, 1, 2].map(|d| cell[d] + (a >> d & 1));
            at.corners(dim).map(corner).collect()
        })
    }

    /// Nodal areas and area-weighted normals, out of the body, of one of the [`BodySpec::side_cells`] of a side.
    pub fn side_weights(&self, side: usize, cell: &[[usize; 3]], element: Element) -> SideWeights {
        let dim = self.mesh.dim();
        let points: Vec<[f64; 3]> = cell.iter().map(|&p| self.position(p)).collect();
        side_weights(dim, &points, Side::of_index(side).outward(dim), element)
    }

    /// ∫ N_a n with the unit normal n out of the body, over a side, by node.
    pub fn side_normals(&self, side: usize, element: Element) -> HashMap<usize, [f64; 3]> {
        let mut sums: HashMap<usize, [f64; 3]> = HashMap::new();
        for cell in self.side_cells(side) {
            let weights = self.side_weights(side, &cell, element);
            for (&place, normal) in cell.iter().zip(weights.normal) {
                let sum = sums.entry(self.mesh.node(place)).or_default();
                sum.iter_mut().zip(normal).for_each(|(s, n)| *s += n);
            }
        }
        sums
    }
}
