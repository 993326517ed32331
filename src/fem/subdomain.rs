//! The mesh of one subdomain, for assembly, error norms and output.

use super::cell::Material;
use super::Form;
use crate::mesh::places;

/// A grid of nodes with the state of every degree of freedom: free, or prescribed by a Dirichlet condition.
///
/// Nodes and elements are numbered layer by layer and row by row, x running fastest. Degree of freedom c of node k has
/// the index C k + c, with C components of the field.
#[derive(Debug, Clone, PartialEq)]
pub struct SubdomainMesh {
    /// Global index of the subdomain.
    pub index: usize,
    /// Body of the subdomain.
    pub body: usize,
    /// Dimension, 2 or 3.
    pub dim: usize,
    /// The equation and its finite elements.
    pub form: Form,
    /// Elements in x, y and z (0 in the plane).
    pub elements: [usize; 3],
    /// Edge lengths of an element where all of them are the same box; `None` in curved bodies.
    pub step: Option<[f64; 3]>,
    /// Position of every node.
    pub points: Vec<[f64; 3]>,
    /// Local dof of every degree of freedom; [`SubdomainMesh::PRESCRIBED`] where the value is given. Length C × nodes.
    pub dof: Vec<u32>,
    /// The given value of every prescribed degree of freedom; zero at free ones.
    pub prescribed: Vec<f64>,
    /// ρ (Young's modulus in elasticity) of every element, > 0.
    pub rho: Vec<f64>,
    /// Poisson's ratio of every element; empty for a scalar problem.
    pub poisson: Vec<f64>,
    /// ∫ k N_a over sides that stand on springs, by node; empty where there is none.
    pub spring: Vec<f64>,
}

impl SubdomainMesh {
    /// The mark of a prescribed degree of freedom in `dof`.
    pub const PRESCRIBED: u32 = u32::MAX;

    /// Number C of components of the field: 1 for a scalar, the dimension for displacements.
    pub fn components(&self) -> usize {
        self.form.components(self.dim)
    }

    /// Nodes in x, y and z.
    pub fn nodes(&self) -> [usize; 3] {
        self.elements.map(|n| n + 1)
    }

    /// Number of elements.
    pub fn n_elements(&self) -> usize {
        self.elements.iter().map(|&n| n.max(1)).product()
    }

    /// Local dof of degree of freedom `k`, `None` where its value is prescribed.
    pub fn local_dof(&self, k: usize) -> Option<u32> {
        (self.dof[k] != Self::PRESCRIBED).then_some(self.dof[k])
    }

    /// Number of free degrees of freedom n.
    pub fn n_free(&self) -> usize {
        self.dof.iter().filter(|&&d| d != Self::PRESCRIBED).count()
    }

    /// The value of every degree of freedom for the local solution `u` (length n): `u` where free, the given value
    /// elsewhere.
    pub fn nodal(&self, u: &[f64]) -> Vec<f64> {
        self.dof
            .iter()
            .zip(&self.prescribed)
            .map(|(&d, &given)| {
                if d == Self::PRESCRIBED {
                    given
                } else {
                    u[d as usize]
                }
            })
            .collect()
    }

    /// The free entries (length n) of a nodal vector.
    pub fn free(&self, nodal: &[f64]) -> Vec<f64> {
        self.dof
            .iter()
            .zip(nodal)
            .filter(|(&d, _)| d != Self::PRESCRIBED)
            .map(|(_, &v)| v)
            .collect()
    }

    /// Number of corners of an element, 4 or 8.
    pub fn corners(&self) -> usize {
        1 << self.dim
    }

    /// The places of the elements, in order.
    pub fn element_places(&self) -> impl Iterator<Item = [usize; 3]> {
        places(self.elements.map(|n| n.max(1)))
    }

    /// The nodes of the element at a place in lexicographic order: corner a lies at (a, a/2, a/4) mod 2. In the plane
    /// the last four repeat the first.
    pub fn element_nodes(&self, [i, j, k]: [usize; 3]) -> [usize; 8] {
        let [nx, ny, _] = self.nodes();
        let first = (k * ny + j) * nx + i;
        let up = if self.dim == 3 { nx * ny } else { 0 };
        std::array::from_fn(|a| first + (a & 1) + (a >> 1 & 1) * nx + (a >> 2) * up)
    }

    /// The corners of the element at a place, as [`SubdomainMesh::element_nodes`] numbers them.
    pub fn element_points(&self, place: [usize; 3]) -> [[f64; 3]; 8] {
        self.element_nodes(place).map(|n| self.points[n])
    }

    /// The material of element `e`.
    pub fn material(&self, e: usize) -> Material {
        self.form
            .material(self.rho[e], self.poisson.get(e).copied().unwrap_or(0.0))
    }

    /// The corners of every element as VTK numbers a quadrilateral (counter-clockwise) or a hexahedron, one after the
    /// other.
    pub fn cells(&self) -> Vec<usize> {
        const ORDER: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];
        let n = self.corners();
        self.element_places()
            .flat_map(|place| {
                let nodes = self.element_nodes(place);
                ORDER.into_iter().take(n).map(move |a| nodes[a])
            })
            .collect()
    }
}
