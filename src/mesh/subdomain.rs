//! The mesh of one subdomain as assembly, error norms and output see it.

/// A grid of (nx + 1) × (ny + 1) nodes with the state of every node: free, or prescribed by a Dirichlet condition.
///
/// Nodes and elements are numbered row by row, x running fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct SubdomainMesh {
    /// Global index of the subdomain.
    pub index: usize,
    /// Body of the subdomain.
    pub body: usize,
    /// Elements in x and y.
    pub elements: [usize; 2],
    /// Width and height of an element.
    pub step: [f64; 2],
    /// Position of every node, length (nx + 1)(ny + 1).
    pub points: Vec<[f64; 2]>,
    /// Local dof of every node; [`SubdomainMesh::PRESCRIBED`] where the value is given.
    pub dof: Vec<u32>,
    /// The given value at every prescribed node; zero at free ones.
    pub prescribed: Vec<f64>,
    /// ρ of every element, length nx·ny, > 0.
    pub rho: Vec<f64>,
}

impl SubdomainMesh {
    /// The mark of a prescribed node in `dof`.
    pub const PRESCRIBED: u32 = u32::MAX;

    /// Local dof of node `k`, `None` where its value is prescribed.
    pub fn local_dof(&self, k: usize) -> Option<u32> {
        (self.dof[k] != Self::PRESCRIBED).then_some(self.dof[k])
    }

    /// Number of free degrees of freedom n.
    pub fn n_free(&self) -> usize {
        self.dof.iter().filter(|&&d| d != Self::PRESCRIBED).count()
    }

    /// The value at every node for the local solution `u` (length n): `u` where free, the given value elsewhere.
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

    /// The four nodes of element (i, j): lower left, lower right, upper left, upper right.
    pub fn element_nodes(&self, [i, j]: [usize; 2]) -> [usize; 4] {
        let width = self.elements[0] + 1;
        let first = j * width + i;
        [first, first + 1, first + width, first + width + 1]
    }

    /// The corners of every element, counter-clockwise, as VTK numbers a quadrilateral.
    pub fn quads(&self) -> Vec<[usize; 4]> {
        let [nx, ny] = self.elements;
        (0..ny)
            .flat_map(|j| (0..nx).map(move |i| [i, j]))
            .map(|place| {
                let [a, b, c, d] = self.element_nodes(place);
                [a, b, d, c]
            })
            .collect()
    }
}
