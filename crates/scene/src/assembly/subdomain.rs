//! The mesh of one subdomain, for assembly, error norms and output.

use crate::model::law::LawSpec;
use elements::cell::Material;
use elements::element::{cell_temperatures, Integration};
use elements::form::Form;
use elements::kind::CellKind;
use elements::law::{Law, Tangent};
use mesh::{places, Cells};
use std::borrow::Cow;

/// The elements of a subdomain.
#[derive(Debug, Clone, PartialEq)]
pub enum SubdomainElements {
    /// A grid of quadrilaterals or hexahedra.
    Grid(Grid),
    /// Cells of any kind.
    Cells(Cells),
}

/// A grid of elements; nodes and elements are numbered layer by layer and row by row, x running fastest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Elements in x, y and z (0 in the plane).
    pub elements: [usize; 3],
    /// Edge lengths of an element where all of them are the same box; `None` in curved bodies.
    pub step: Option<[f64; 3]>,
}

impl Grid {
    /// The dimension, 2 or 3.
    pub fn dim(&self) -> usize {
        match self.elements[2] {
            0 => 2,
            _ => 3,
        }
    }

    /// Nodes in x, y and z.
    pub fn nodes(&self) -> [usize; 3] {
        self.elements.map(|n| n + 1)
    }

    /// Elements in x, y and z, 1 in z in the plane.
    pub fn counts(&self) -> [usize; 3] {
        self.elements.map(|n| n.max(1))
    }

    /// Number of elements.
    pub fn n_elements(&self) -> usize {
        self.counts().iter().product()
    }

    /// Number of corners of an element, 4 or 8.
    pub fn corners(&self) -> usize {
        1 << self.dim()
    }

    /// The places of the elements, in order.
    pub fn element_places(&self) -> impl Iterator<Item = [usize; 3]> {
        places(self.counts())
    }

    /// The nodes of the element at a place in lexicographic order: corner a lies at (a, a/2, a/4) mod 2. In the plane
    /// the last four repeat the first.
    pub fn element_nodes(&self, [i, j, k]: [usize; 3]) -> [usize; 8] {
        let [nx, ny, _] = self.nodes();
        let first = (k * ny + j) * nx + i;
        let up = if self.dim() == 3 { nx * ny } else { 0 };
        std::array::from_fn(|a| first + (a & 1) + (a >> 1 & 1) * nx + (a >> 2) * up)
    }
}

/// Elastic laws by element, along the axes of space.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ElementLaws {
    /// The different laws.
    pub tangents: Vec<Tangent>,
    /// (the number of the law in its body, its place in `tangents`) of every element; empty: all are isotropic.
    pub of: Vec<[u32; 2]>,
}

impl ElementLaws {
    /// The place in `tangents` of an element's law; `None` if it is isotropic.
    pub fn place(&self, e: usize) -> Option<usize> {
        let [law, place] = *self.of.get(e)?;
        (law != LawSpec::ISOTROPIC).then_some(place as usize)
    }
}

/// The strain α ΔT by element.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementHeat {
    /// α of every element per degree, the components xx, yy, zz, 2xy, 2yz, 2xz.
    pub expansion: Vec<[f64; 6]>,
    /// ΔT of every node, without the factor of the load step.
    pub change: Vec<f64>,
    /// The factor of the load step.
    pub factor: f64,
}

impl ElementHeat {
    /// ΔT at the nodes of a cell as its strain takes it, into `out`.
    pub fn of(&self, kind: CellKind, nodes: &[u32], out: &mut Vec<f64>) {
        out.clear();
        out.extend(nodes.iter().map(|&k| self.factor * self.change[k as usize]));
        cell_temperatures(kind, out);
    }
}

/// Nodes and elements with the state of every degree of freedom: free, or prescribed by a Dirichlet condition.
///
/// Degree of freedom c of node k has the index C k + c, with C components of the field.
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
    /// The elements; nodes are places in `points`.
    pub elements: SubdomainElements,
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
    /// The laws of elements that are not isotropic.
    pub laws: ElementLaws,
    /// Expansion by heat; `None`: there is none.
    pub heat: Option<ElementHeat>,
    /// How the stiffness of every cell is integrated; empty: in full.
    pub integration: Vec<Integration>,
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

    /// The grid of elements, if they form one.
    pub fn grid(&self) -> Option<&Grid> {
        match &self.elements {
            SubdomainElements::Grid(grid) => Some(grid),
            SubdomainElements::Cells(_) => None,
        }
    }

    /// Number of elements.
    pub fn n_elements(&self) -> usize {
        match &self.elements {
            SubdomainElements::Grid(grid) => grid.n_elements(),
            SubdomainElements::Cells(cells) => cells.len(),
        }
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

    /// The positions of the corners of the element at a place of a grid, as [`Grid::element_nodes`] numbers them.
    pub fn element_points(&self, grid: &Grid, place: [usize; 3]) -> [[f64; 3]; 8] {
        grid.element_nodes(place).map(|n| self.points[n])
    }

    /// The material of element `e`.
    pub fn material(&self, e: usize) -> Material {
        match self.laws.place(e) {
            Some(k) => self.form.elastic(Law::General(self.laws.tangents[k])),
            None => {
                let poisson = self.poisson.get(e).copied().unwrap_or(0.0);
                self.form.material(self.rho[e], poisson)
            }
        }
    }

    /// How the stiffness of element `e` is integrated.
    pub fn integration(&self, e: usize) -> Integration {
        self.integration
            .get(e)
            .copied()
            .unwrap_or(Integration::Full)
    }

    /// The elements as cells with their nodes.
    pub fn cells(&self) -> Cow<'_, Cells> {
        // Corners in the order of a quadrilateral (counter-clockwise) or a hexahedron.
        const ORDER: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];
        match &self.elements {
            SubdomainElements::Cells(cells) => Cow::Borrowed(cells),
            SubdomainElements::Grid(grid) => {
                let kind = [CellKind::Quad4, CellKind::Hex8][grid.dim() - 2];
                let mut cells = Cells::default();
                for place in grid.element_places() {
                    let nodes = grid.element_nodes(place);
                    let corners = ORDER.map(|a| nodes[a] as u32);
                    cells.push(kind, &corners[..grid.corners()]);
                }
                Cow::Owned(cells)
            }
        }
    }
}
