//! The memory that a scene will take, from counts of elements and subdomains alone: nothing is made for it.
//!
//! The coefficients are fitted to measurements (docs/options.md, "Memory"): what they give is 0.8 to 2 times what was
//! measured, and no bound.

use std::collections::HashMap;

use super::model::body::{BodySpec, Cut};
use super::model::field::Field;
use super::model::law::LawSpec;
use elements::form::Form;
use mesh::partition::subdomains_for;
use mesh::Mesh;

/// The program with its libraries.
const PROGRAM: f64 = 5.8e7;
/// A subdomain, whatever its size: its lists and tables; with a solver around it.
const SUBDOMAIN: [f64; 2] = [1.5e3, 3.5e3];
/// A node of a subdomain; what each of its components takes: its numbers and coordinates; and its entry of each rigid
/// motion.
const NODE: [f64; 3] = [60.0, 40.0, 8.0];
/// An entry of a stiffness matrix, while it is assembled.
const ENTRY: f64 = 14.0;
/// A node on the boundary of a body among others: every rank knows all of them.
const BOUNDARY: f64 = 850.0;
/// A node on the boundary of a body among others: its rows, and what they take in the projector. In space a row touches
/// twice as much as in the plane. Ties have a row for each component, and what they take grows with this power of their
/// number.
const ROW: f64 = 950.0;
const TIED: f64 = 2.3;
/// Rigid motions of a body among others, times their number to the power 1.5: columns of G, and their part of the
/// factor of GᵀQG.
const MOTION: f64 = 3.6e3;
/// A node of a mesh of cells, on every rank.
const CELL_NODE: f64 = 400.0;
/// Entries of a factor per unknown and component: times log₂ of the nodes in the plane, times their cube root in space.
const FACTOR: [f64; 2] = [4.0, 15.0];

/// Bytes that a scene will take.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Need {
    /// Elements.
    pub elements: f64,
    /// Subdomains.
    pub subdomains: f64,
    /// On every rank.
    whole: f64,
    /// Over all ranks: matrices and loads; and what a solver adds beside factors.
    parts: [f64; 2],
    /// Stiffness matrices, and factors.
    matrices: CongruentMemory,
    factors: CongruentMemory,
}

/// The memory of matrices or factors that subdomains share if they are alike.
#[derive(Debug, Clone, PartialEq, Default)]
struct CongruentMemory {
    /// Bytes of one, how many differ, how many subdomains share them.
    groups: Vec<[f64; 3]>,
    /// The group of each key.
    known: HashMap<[u64; 14], usize>,
}

impl CongruentMemory {
    /// Adds a body's subdomains, of which `kinds` differ, to the group of those with the same key. Without a key all
    /// differ.
    fn add(&mut self, key: Option<[u64; 14]>, bytes: f64, kinds: f64, subdomains: f64) {
        let kinds = if key.is_some() { kinds } else { subdomains };
        let next = self.groups.len();
        let at = key.map_or(next, |key| *self.known.entry(key).or_insert(next));
        match self.groups.get_mut(at) {
            Some(group) => {
                group[1] = group[1].max(kinds);
                group[2] += subdomains;
            }
            None => self.groups.push([bytes, kinds, subdomains]),
        }
    }

    /// Bytes on each of `ranks` ranks.
    fn on_each(&self, ranks: usize) -> f64 {
        let each = |[bytes, kinds, subdomains]: &[f64; 3]| {
            bytes * kinds.min((subdomains / ranks as f64).ceil())
        };
        self.groups.iter().map(each).sum()
    }
}

/// One body in numbers.
struct BodyCounts {
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
    /// The memory that these bodies will take; `tied`: most of them are tied, and not in contact.
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
        for body in bodies {
            let dim = body.mesh.dim();
            let c = form.components(dim) as f64;
            let n = BodyCounts::of(body, c as usize);
            need.elements += n.elements;
            need.subdomains += n.subdomains;
            if n.cells {
                need.whole += CELL_NODE * n.nodes;
            } else if !alone {
                need.whole += BOUNDARY * n.boundary;
            }
            let motions = form.rigid(dim).len() as f64;
            if !alone {
                let rows = if tied { c.powf(TIED) } else { dim as f64 - 1.0 };
                need.parts[1] += ROW * rows * n.surface(dim) + MOTION * motions.powf(1.5);
            }
            let transient = if n.cells { 2.0 } else { 1.0 };
            let node = NODE[0] + (NODE[1] + NODE[2] * motions) * c;
            need.parts[0] += n.subdomains * (SUBDOMAIN[0] + n.each * node);
            let matrix = transient * ENTRY * n.row * c * c * n.each;
            need.parts[1] += n.subdomains * (SUBDOMAIN[1] + 24.0 * c * n.each);
            let fill = match dim {
                2 => FACTOR[0] * n.each.log2().max(1.0),
                _ => FACTOR[1] * n.each.cbrt(),
            };
            // The rows of higher order have more entries, and so have their factors.
            let order = (n.row / if dim == 2 { 9.0 } else { 27.0 }).max(1.0);
            let factor = 8.0 * c * c * n.each * fill * order;
            let kinds = match body.mesh {
                // Inside, at a side, at an edge, ….
                Mesh::Grid(_) => n.subdomains.min(3_f64.powi(dim as i32)),
                Mesh::Cells(_) => n.subdomains,
            };
            (need.factors).add(key(body), factor, kinds, n.subdomains);
            (need.matrices).add(exact_key(body), matrix, kinds, n.subdomains);
        }
        need
    }

    /// Bytes on each of `ranks` ranks when everything is assembled.
    pub fn assembled(&self, ranks: usize) -> f64 {
        self.whole + self.parts[0] / ranks as f64 + self.matrices.on_each(ranks)
    }

    /// Bytes on each of `ranks` ranks for a solve.
    pub fn solved(&self, ranks: usize) -> f64 {
        self.assembled(ranks) + self.parts[1] / ranks as f64 + self.factors.on_each(ranks)
    }
}

impl BodyCounts {
    /// Nodes on the boundary of the body; of a mesh of cells, those of a cube with as many nodes.
    fn surface(&self, dim: usize) -> f64 {
        if !self.cells {
            return self.boundary;
        }
        let d = dim as f64;
        (2.0 * d * self.nodes.powf((d - 1.0) / d)).min(self.nodes)
    }

    fn of(body: &BodySpec, components: usize) -> BodyCounts {
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
                BodyCounts {
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
                BodyCounts {
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

/// A key that is equal for boxes whose subdomains have the same factors, up to multiples and turns, and for copies of
/// one mesh; `None` where all subdomains differ.
fn key(body: &BodySpec) -> Option<[u64; 14]> {
    let steady = |field: &Field| match field {
        Field::Expression(e) => !e.varies_in_space(),
        Field::Checkerboard { .. } | Field::Table { .. } => true,
        _ => false,
    };
    let fixed = |law: &LawSpec| law.laws.iter().all(|law| law.axes.is_fixed());
    let steady_law = body.law.as_ref().is_none_or(fixed);
    if body.map.is_some() || !steady(&body.rho) || !steady(&body.poisson) || !steady_law {
        return None;
    }
    let mut out = [0; 14];
    let first = match &body.mesh {
        Mesh::Grid(grid) => {
            let [a, b, c] = grid.block_elements().map(|n| n as u64);
            // Sizes in seven digits: copies at other places differ in rounding.
            let [x, y, z] = grid.step().map(|h| f64::from(h as f32).to_bits());
            [a, b, c, x, y, z, body.order as u64]
        }
        Mesh::Cells(mesh) => {
            let [x, y, z] = mesh.points.first()?.map(f64::to_bits);
            let [cells, points] = [mesh.cells.len(), mesh.points.len()].map(|n| n as u64);
            [cells, points, x, y, z, 0, 0]
        }
    };
    out[..7].copy_from_slice(&first);
    out[13] = body.law.as_ref().map_or(0, LawSpec::key);
    Some(out)
}

/// A key that is equal for bodies whose subdomains have the same matrices: it has coefficients and directions, too.
fn exact_key(body: &BodySpec) -> Option<[u64; 14]> {
    let number = |field: &Field| match field {
        Field::Expression(e) => e.as_constant().map(f64::to_bits),
        _ => None,
    };
    let mut out = key(body)?;
    (out[7], out[8]) = (number(&body.rho)?, number(&body.poisson)?);
    if let Some(motion) = &body.motion {
        // A row of R and an entry of another one tell turns apart.
        let [[x, y, z], [w, ..], _] = motion.turn.map(|row| row.map(f64::to_bits));
        out[9..13].copy_from_slice(&[x, y, z, w]);
    }
    Some(out)
}

#[cfg(test)]
#[path = "../tests/need.rs"]
mod tests;
