//! The elements of a file as cells.

use super::kinds;
use super::nodes::Nodes;
use super::scan::{Scan, Width};
use crate::Cells;
use base::Result;
use elements::kind::CellKind;

/// The cells in the order of the file.
#[derive(Default)]
pub(super) struct GmshElements {
    pub cells: Cells,
    pub ids: Vec<u64>,
    /// Where each stands in the file.
    at: Vec<usize>,
}

/// An element without its nodes.
pub(super) struct ElementHead {
    pub at: usize,
    pub id: u64,
    /// Gmsh's number of its type.
    pub kind: i64,
}

/// The nodes of one element, in our order.
pub(super) struct Cell {
    pub kind: CellKind,
    nodes: [u32; CellKind::MOST_NODES],
}

impl Cell {
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.kind.nodes()]
    }
}

impl ElementHead {
    /// Reads its nodes.
    pub fn nodes(&self, scan: &mut Scan, width: Width, nodes: &Nodes) -> Result<Cell> {
        let (kind, order) = self.known(scan)?;
        let mut found = [0; CellKind::MOST_NODES];
        for place in &mut found[..kind.nodes()] {
            let at = scan.at();
            let id = scan.number(width, "the number of a node")?;
            *place = nodes.find(id).ok_or_else(|| {
                let message = format!(
                    "element {} has the node {id}, which is not in $Nodes",
                    self.id
                );
                scan.fail(at, message)
            })?;
        }
        let mut ours = found;
        for (node, &k) in ours.iter_mut().zip(order.unwrap_or_default()) {
            *node = found[usize::from(k)];
        }
        Ok(Cell { kind, nodes: ours })
    }

    /// Its kind, where we have it.
    fn known(&self, scan: &Scan) -> Result<(CellKind, Option<&'static [u8]>)> {
        kinds::known(self.kind).ok_or_else(|| {
            let (id, kind) = (self.id, self.kind);
            let name = kinds::foreign(kind);
            scan.fail(
                self.at,
                format!(
                    "element {id} is of type {kind} ({name}), where points, segments, triangles, quadrilaterals, \
                     tetrahedra, hexahedra and wedges of order 1 or 2 and pyramids of 5 nodes were expected"
                ),
            )
        })
    }
}

impl GmshElements {
    /// Adds a cell; returns its place.
    pub fn push(&mut self, scan: &Scan, element: &ElementHead, cell: &Cell) -> Result<u32> {
        let place = u32::try_from(self.cells.len())
            .map_err(|_| scan.fail(element.at, "more than four billion elements"))?;
        self.cells.push(cell.kind, cell.nodes());
        self.ids.push(element.id);
        self.at.push(element.at);
        Ok(place)
    }

    /// No number may occur twice.
    pub fn check(&self, scan: &Scan) -> Result<()> {
        if self.ids.is_sorted_by(|a, b| a < b) {
            return Ok(());
        }
        let mut order: Vec<usize> = (0..self.ids.len()).collect();
        order.sort_unstable_by_key(|&k| (self.ids[k], k));
        let twice = order.windows(2).find(|w| self.ids[w[0]] == self.ids[w[1]]);
        let Some(&[first, again]) = twice else {
            return Ok(());
        };
        let (id, first) = (self.ids[first], scan.place(self.at[first]));
        let message = format!("element {id} is here a second time, after {first}");
        Err(scan.fail(self.at[again], message))
    }
}
