//! Formats 2.0 to 2.2: each node and each element tells all about itself.

use super::elements::{Cell, ElementHead, GmshElements};
use super::names::PhysicalGroups;
use super::nodes::Nodes;
use super::scan::{Scan, Width};
use crate::gmsh::names;
use base::Result;
use std::collections::BTreeSet;

const INT: Width = Width::Four;

/// Reads the section $Nodes, or $ParametricNodes with coordinates on the model, too.
pub(super) fn nodes(scan: &mut Scan, parametric: bool) -> Result<Nodes> {
    let least = if scan.is_text() { 7 } else { 28 };
    let count = scan.count_line("the number of nodes", least)?;
    let mut nodes = Nodes::default();
    nodes.reserve(count);
    for _ in 0..count {
        let at = scan.at();
        nodes.number(at, scan.number(INT, "the number of a node")?);
        nodes.points.push(scan.point()?);
        if parametric {
            let dim = scan.whole(INT, "the dimension of an entity")?;
            scan.whole(INT, "the number of an entity")?;
            // Gmsh has none on points and volumes.
            for _ in 0..if dim < 3 { dim } else { 0 } {
                scan.real("a parametric coordinate")?;
            }
        }
    }
    nodes.index(scan)?;
    scan.end(if parametric {
        "ParametricNodes"
    } else {
        "Nodes"
    })?;
    Ok(nodes)
}

/// Reads the section $Elements.
pub(super) fn elements(scan: &mut Scan, nodes: &Nodes) -> Result<(GmshElements, PhysicalGroups)> {
    let count = scan.count_line("the number of elements", 8)?;
    let mut all = Collected::default();
    let mut seen = 0;
    while seen < count {
        if scan.is_text() {
            let at = scan.at();
            let id = scan.number(INT, "the number of an element")?;
            let kind = scan.whole(INT, "the type of an element")?;
            let tags = scan.count(INT, "the number of tags", 2)?;
            all.element(scan, nodes, ElementHead { at, id, kind }, tags)?;
            seen += 1;
            continue;
        }
        let kind = scan.whole(INT, "the type of elements")?;
        let at = scan.at();
        let block = scan.count(INT, "the number of elements of one type", 8)?;
        let tags = scan.count(INT, "the number of tags", 4)?;
        if block == 0 || block > count - seen {
            let left = count - seen;
            let message = format!("{block} elements follow, where 1 to {left} were expected");
            return Err(scan.fail(at, message));
        }
        for _ in 0..block {
            let at = scan.at();
            let id = scan.number(INT, "the number of an element")?;
            all.element(scan, nodes, ElementHead { at, id, kind }, tags)?;
        }
        seen += block;
    }
    all.elements.check(scan)?;
    scan.end("Elements")?;
    Ok((all.elements, all.groups))
}

#[derive(Default)]
struct Collected {
    elements: GmshElements,
    groups: PhysicalGroups,
    /// The entity of the last cell, and the physical groups that it is in.
    last: (i64, BTreeSet<u64>),
}

impl Collected {
    /// Reads the tags and the nodes of an element.
    fn element(
        &mut self,
        scan: &mut Scan,
        nodes: &Nodes,
        element: ElementHead,
        tags: usize,
    ) -> Result<()> {
        let mut group = None;
        let mut entity = 0;
        for k in 0..tags {
            match k {
                0 => group = names::tag(scan)?,
                1 => entity = scan.whole(INT, "the number of an entity")?,
                _ => {
                    scan.whole(INT, "a tag")?;
                }
            }
        }
        let cell = element.nodes(scan, INT, nodes)?;
        let dim = cell.kind.dim();
        if let (Some(tag), Some(last)) = (group, self.elements.cells.len().checked_sub(1)) {
            if self.is_again(last, entity, tag, &cell) {
                self.last.1.insert(tag);
                self.groups.add(dim, tag, last as u32..last as u32 + 1);
                return Ok(());
            }
        }
        let place = self.elements.push(scan, &element, &cell)?;
        self.last.0 = entity;
        self.last.1.clear();
        if let Some(tag) = group {
            self.last.1.insert(tag);
            self.groups.add(dim, tag, place..place + 1);
        }
        Ok(())
    }

    /// Whether a cell is the last one, for another group. Gmsh writes an element once for each group that it is in,
    /// turned round where the sign of the group says so.
    fn is_again(&self, last: usize, entity: i64, tag: u64, cell: &Cell) -> bool {
        let (last_entity, groups) = &self.last;
        let cells = &self.elements.cells;
        *last_entity == entity
            && !groups.is_empty()
            && !groups.contains(&tag)
            && cells.kind(last) == cell.kind
            && sorted(cells.nodes(last)) == sorted(cell.nodes())
    }
}

fn sorted(nodes: &[u32]) -> Vec<u32> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}
