//! The memory that a scene will take, from counts of elements and subdomains alone: nothing is made for it.
//!
//! The coefficients are fitted to measurements (docs/options.md, "Memory"): what they give is 0.9 to 2 times what was
//! measured, and no bound.

use std::collections::HashMap;

use super::model::body::{BodySpec, Cut};
use super::model::field::Field;
use crate::fem::Form;
use crate::mesh::partition::subdomains_for;
use crate::mesh::Mesh;

/// The program with its libraries.
const PROGRAM: f64 = 5.8e7;
/// A subdomain, whatever its size: its lists and tables; with a solver around it.
const SUBDOMAIN: [f64; 2] = [1.5e3, 3.5e3];
/// A node of a subdomain: its numbers and coordinates; and what each of its components takes.
const NODE: [f64; 2] = [80.0, 30.0];
/// An entry of a stiffness matrix, while it is assembled.
const ENTRY: f64 = 14.0;
/// A node on the boundary of a body among others: every rank knows all of them.
const BOUNDARY: f64 = 850.0;
/// A node on the boundary of a body among others: its rows, and what they take in the projector. Ties have a row for
/// each component, and what they take grows with the square of that number.
const ROW: f64 = 950.0;
/// Rigid motions of a body among others, times their number to the power 1.5: columns of G, and their part of the
/// factor of GᵀQG.
const MOTION: f64 = 3.6e3;
/// A node of a mesh of cells, on every rank.
const CELL_NODE: f64 = 400.0;
/// Entries of a factor per unknown and component: times log₂ of the nodes in the plane, times their cube root in space.
const FACTOR: [f64; 2] = [4.0, 15.0];

/// Bytes that a scene will take.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Need {
    /// Elements.
    pub elements: f64,
    /// Subdomains.
    pub subdomains: f64,
    /// On every rank.
    whole: f64,
    /// Over all ranks: matrices and loads; and what a solver adds beside factors.
    parts: [f64; 2],
    /// Factors: bytes of one, how many differ, how many subdomains share them.
    factors: Vec<[f64; 3]>,
}

/// One body in numbers.
struct Counts {
    elements: f64,
    nodes: f64,
    subdomains: f64,
    /// Nodes and entries of a row of nodes in a subdomain.
    each: f64,
    row: f64,
    /// Boundary nodes of a box, in one body among others; all nodes of a mesh of cells.
    boundary: f64,
    cells: bool,
}

impl Need {
    /// What these bodies will take; `tied`: most of them are tied, and not in contact.
    pub fn of<'a>(
        bodies: impl ExactSizeIterator<Item = &'a BodySpec>,
        form: &Form,
        tied: bool,
    ) -> Need {
        let alone = bodies.len() < 2;
        let mut need = Need {
            whole: PROGRAM,
            ..Need::default()
        };
        // Bodies whose subdomains are alike share factors: the number in each group.
        let mut alike: HashMap<[u64; 7], usize> = HashMap::new();
        for body in bodies {
            let dim = body.mesh.dim();
            let c = form.components(dim) as f64;
            let n = Counts::of(body, c as usize);
            need.elements += n.elements;
            need.subdomains += n.subdomains;
            if n.cells {
                need.whole += CELL_NODE * n.nodes;
            } else if !alone {
                need.whole += BOUNDARY * n.boundary;
            }
            if !alone {
                let motions = form.rigid(dim).len() as f64;
                let rows = if tied { c * c } else { 1.0 };
                need.parts[1] += ROW * rows * n.surface(dim) + MOTION * motions.powf(1.5);
            }
            let transient = if n.cells { 2.0 } else { 1.0 };
            let node = NODE[0] + NODE[1] * c + transient * ENTRY * n.row * c * c;
            need.parts[0] += n.subdomains * (SUBDOMAIN[0] + n.each * node);
            need.parts[1] += n.subdomains * (SUBDOMAIN[1] + 24.0 * c * n.each);
            let fill = match dim {
                2 => FACTOR[0] * n.each.log2().max(1.0),
                _ => FACTOR[1] * n.each.cbrt(),
            };
            // The rows of higher order have more entries, and so have their factors.
            let order = (n.row / if dim == 2 { 9.0 } else { 27.0 }).max(1.0);
            let factor = 8.0 * c * c * n.each * fill * order;
            match key(body) {
                None => need.factors.push([factor, n.subdomains, n.subdomains]),
                Some(key) => {
                    let kinds = match body.mesh {
                        Mesh::Grid(_) => n.subdomains.min(3_f64.powi(dim as i32)),
                        Mesh::Cells(_) => n.subdomains,
                    };
                    let at = *alike.entry(key).or_insert(need.factors.len());
                    match need.factors.get_mut(at) {
                        Some(group) => {
                            group[1] = group[1].max(kinds);
                            group[2] += n.subdomains;
                        }
                        None => need.factors.push([factor, kinds, n.subdomains]),
                    }
                }
            }
        }
        need
    }

    /// Bytes on each of `ranks` ranks when everything is assembled.
    pub fn assembled(&self, ranks: usize) -> f64 {
        self.whole + self.parts[0] / ranks as f64
    }

    /// Bytes on each of `ranks` ranks for a solve.
    pub fn solved(&self, ranks: usize) -> f64 {
        let each = |[factor, kinds, subdomains]: &[f64; 3]| {
            factor * kinds.min((subdomains / ranks as f64).ceil())
        };
        self.assembled(ranks)
            + self.parts[1] / ranks as f64
            + self.factors.iter().map(each).sum::<f64>()
    }
}

impl Counts {
    /// Nodes on the boundary of the body; of a mesh of cells, those of a cube with as many nodes.
    fn surface(&self, dim: usize) -> f64 {
        if !self.cells {
            return self.boundary;
        }
        let d = dim as f64;
        (2.0 * d * self.nodes.powf((d - 1.0) / d)).min(self.nodes)
    }

    fn of(body: &BodySpec, components: usize) -> Counts {
        match &body.mesh {
            Mesh::Grid(grid) => {
                let dim = grid.dim();
                let of = |counts: [usize; 3]| -> [f64; 2] {
                    let counts = &counts[..dim];
                    let cells: f64 = counts.iter().map(|&n| n as f64).product();
                    let nodes: f64 = counts.iter().map(|&n| n as f64 + 1.0).product();
                    [cells, nodes]
                };
                // The middles of edges, one along each direction for every element.
                let second = |[cells, nodes]: [f64; 2]| match body.order {
                    2 => nodes + dim as f64 * cells,
                    _ => nodes,
                };
                let all = of(grid.elements);
                let inner: f64 = grid.elements[..dim]
                    .iter()
                    .map(|&n| (n as f64 - 1.0).max(0.0))
                    .product();
                let row = match (dim, body.order) {
                    (2, 2) => 16.0,
                    (2, _) => 9.0,
                    (_, 2) => 58.0,
                    _ => 27.0,
                };
                Counts {
                    elements: all[0],
                    nodes: second(all),
                    subdomains: grid.subdomains[..dim].iter().map(|&n| n as f64).product(),
                    each: second(of(grid.block_elements())),
                    row,
                    boundary: all[1] - inner,
                    cells: body.order == 2,
                }
            }
            Mesh::Cells(mesh) => {
                let nodes = mesh.points.len();
                let subdomains = match body.cut {
                    Cut::AsItIs => mesh.parts.len(),
                    Cut::Auto => subdomains_for(nodes * components, mesh.dim),
                    Cut::Into(n) => n,
                };
                let subdomains = subdomains.max(1) as f64;
                // Cells of second order have at most about as many cells as nodes.
                let row = match (mesh.dim, mesh.cells.len() < nodes) {
                    (2, true) => 12.0,
                    (2, false) => 7.0,
                    (_, true) => 40.0,
                    (_, false) => 15.0,
                };
                Counts {
                    elements: mesh.cells.len() as f64,
                    nodes: nodes as f64,
                    subdomains,
                    each: nodes as f64 / subdomains,
                    row,
                    boundary: nodes as f64,
                    cells: true,
                }
            }
        }
    }
}

/// What is the same in boxes whose subdomains have the same matrices, up to factors, and in copies of one mesh; `None`
/// where they all differ.
fn key(body: &BodySpec) -> Option<[u64; 7]> {
    let steady = |field: &Field| match field {
        Field::Expression(e) => !e.varies_in_space(),
        Field::Checkerboard { .. } | Field::Table { .. } => true,
        _ => false,
    };
    if body.map.is_some() || !steady(&body.rho) || !steady(&body.poisson) {
        return None;
    }
    let grid = match &body.mesh {
        Mesh::Grid(grid) => grid,
        Mesh::Cells(mesh) => {
            let [x, y, z] = mesh.points.first()?.map(f64::to_bits);
            let [cells, points] = [mesh.cells.len(), mesh.points.len()].map(|n| n as u64);
            return Some([cells, points, x, y, z, 0, 0]);
        }
    };
    let (block, step) = (grid.block_elements(), grid.step());
    let [a, b, c] = block.map(|n| n as u64);
    // Sizes in seven digits: copies at other places differ in rounding.
    let [x, y, z] = step.map(|h| f64::from(h as f32).to_bits());
    Some([a, b, c, x, y, z, body.order as u64])
}

#[cfg(test)]
#[path = "../../tests/inside/scene/need.rs"]
mod tests;
