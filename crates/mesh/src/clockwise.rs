//! Plane cells whose nodes run clockwise.
//!
//! Programs for plane problems differ in what they accept: shells and surfaces have no right way round. Here the nodes
//! of plane cells run counter-clockwise; a cell that runs the other way is read from its first node backwards. The
//! numbers of sides that a file has given count in its own order, and are numbered anew.

use super::file::{Members, MeshFile};
use elements::kind::CellKind;

impl MeshFile {
    /// This file, with all cells of bodies of dimension `dim` counter-clockwise if they are plane.
    #[must_use]
    pub fn counter_clockwise(mut self, dim: usize) -> MeshFile {
        if dim == 2 {
            self.turn_clockwise();
        }
        self
    }

    /// Makes all plane cells run counter-clockwise in the plane of x and y, and numbers their sides in groups anew.
    /// Returns the cells that ran clockwise, increasing.
    pub fn turn_clockwise(&mut self) -> Vec<u32> {
        let mut turned = Vec::new();
        for c in 0..self.cells.len() {
            let kind = self.cells.kind(c);
            if kind.dim() == 2 && self.area(c) < 0.0 {
                let nodes = self.cells.nodes(c);
                let back: Vec<u32> = backwards(kind).map(|k| nodes[k]).collect();
                self.cells.nodes_mut(c).copy_from_slice(&back);
                turned.push(c as u32);
            }
        }
        for group in &mut self.groups {
            if let Members::Sides(sides) = &mut group.members {
                for (cell, side) in sides {
                    if turned.binary_search(cell).is_ok() {
                        *side = side_backwards(self.cells.kind(*cell as usize), *side);
                    }
                }
            }
        }
        turned
    }

    /// Twice the area inside the corners of a plane cell, negative where they run clockwise.
    fn area(&self, c: usize) -> f64 {
        let corners = &self.cells.nodes(c)[..self.cells.kind(c).corners()];
        let at = |k: usize| self.points[corners[k % corners.len()] as usize];
        let origin = at(0);
        let cross = |k: usize| {
            let (p, q) = (at(k), at(k + 1));
            (p[0] - origin[0]) * (q[1] - origin[1]) - (p[1] - origin[1]) * (q[0] - origin[0])
        };
        (0..corners.len()).map(cross).sum()
    }
}

/// The nodes of a plane cell the other way round, from the same first node: corners, middles of edges, centre.
fn backwards(kind: CellKind) -> impl Iterator<Item = usize> {
    let (n, all) = (kind.corners(), kind.nodes());
    let corners = std::iter::once(0).chain((1..n).rev());
    let middles = (n..all.min(2 * n)).rev();
    corners.chain(middles).chain(2 * n..all)
}

/// The number of a side when the nodes run the other way round.
pub fn side_backwards(kind: CellKind, side: u8) -> u8 {
    kind.corners() as u8 - 1 - side
}

#[cfg(test)]
#[path = "../tests/clockwise.rs"]
mod tests;
