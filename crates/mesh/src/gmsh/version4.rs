//! Formats 4.0 and 4.1: nodes and elements stand in blocks, one for each entity of the model, and entities are in
//! physical groups.

use super::elements::{ElementHead, GmshElements};
use super::names::PhysicalGroups;
use super::nodes::Nodes;
use super::scan::{Scan, Width};
use crate::gmsh::names;
use base::Result;
use std::collections::HashMap;

const INT: Width = Width::Four;

/// The differences between the formats 4.0 and 4.1.
#[derive(Debug, Clone, Copy)]
pub(super) struct FormatWidths {
    /// 4.0: the number of an entity comes before its dimension, and that of a node before its point.
    pub old: bool,
    /// The width of counts.
    pub counts: Width,
    /// The width of the numbers of nodes and elements.
    pub ids: Width,
}

/// The physical groups of each entity, by dimension and number.
#[derive(Default)]
pub(super) struct Entities(HashMap<(i64, i64), Vec<u64>>);

impl Entities {
    /// Reads the section $Entities or $PartitionedEntities.
    pub fn read(&mut self, scan: &mut Scan, layout: FormatWidths, section: &str) -> Result<()> {
        let partitioned = section == "PartitionedEntities";
        if partitioned {
            scan.whole(layout.counts, "the number of partitions")?;
            let ghosts = scan.count(layout.counts, "the number of ghost entities", 4)?;
            for _ in 0..2 * ghosts {
                scan.whole(INT, "a ghost entity")?;
            }
        }
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = scan.count(layout.counts, "a number of entities", 8)?;
        }
        for (dim, count) in (0..).zip(counts) {
            for _ in 0..count {
                self.entity(scan, layout, partitioned, dim)?;
            }
        }
        scan.end(section)
    }

    fn entity(
        &mut self,
        scan: &mut Scan,
        layout: FormatWidths,
        partitioned: bool,
        dim: i64,
    ) -> Result<()> {
        let at = scan.at();
        let tag = scan.whole(INT, "the number of an entity")?;
        if partitioned {
            // The physical groups of its parent stand at the entity itself, too.
            scan.whole(INT, "the dimension of a parent")?;
            scan.whole(INT, "the number of a parent")?;
            list(scan, layout, "the number of partitions of an entity")?;
        }
        let box_size = if dim > 0 || layout.old { 6 } else { 3 };
        for _ in 0..box_size {
            scan.real("a coordinate of the box around an entity")?;
        }
        let count = scan.count(
            layout.counts,
            "the number of physical groups of an entity",
            least(scan),
        )?;
        let mut groups = Vec::new();
        for _ in 0..count {
            groups.extend(names::tag(scan)?);
        }
        groups.sort_unstable();
        groups.dedup();
        if dim > 0 {
            list(scan, layout, "the number of entities around an entity")?;
        }
        if self.0.insert((dim, tag), groups).is_some() {
            let message = format!("entity {tag} of dimension {dim} is here a second time");
            return Err(scan.fail(at, message));
        }
        Ok(())
    }

    /// The physical groups of an entity; files without $Entities have none.
    fn groups(&self, scan: &Scan, at: usize, dim: i64, tag: i64) -> Result<&[u64]> {
        match self.0.get(&(dim, tag)) {
            Some(groups) => Ok(groups),
            None if self.0.is_empty() => Ok(&[]),
            None => Err(scan.fail(
                at,
                format!("these elements are of entity {tag} of dimension {dim}, which is not in $Entities"),
            )),
        }
    }
}

/// The least bytes of a whole number.
fn least(scan: &Scan) -> usize {
    if scan.is_text() {
        2
    } else {
        4
    }
}

/// Passes over a count and as many numbers.
fn list(scan: &mut Scan, layout: FormatWidths, what: &str) -> Result<()> {
    let count = scan.count(layout.counts, what, least(scan))?;
    for _ in 0..count {
        scan.whole(INT, "the number of an entity")?;
    }
    Ok(())
}

/// The head of $Nodes or $Elements, which stands before the blocks.
struct Head {
    blocks: usize,
    count: usize,
    at: usize,
}

fn head(scan: &mut Scan, layout: FormatWidths, what: &str) -> Result<Head> {
    let blocks = scan.count(layout.counts, "the number of blocks", 8)?;
    let at = scan.at();
    let count = scan.count(layout.counts, what, 4)?;
    if !layout.old {
        scan.whole(layout.counts, "the least number")?;
        scan.whole(layout.counts, "the greatest number")?;
    }
    Ok(Head { blocks, count, at })
}

impl Head {
    /// The blocks have to have as many as the head says.
    fn check(&self, scan: &Scan, found: usize, what: &str) -> Result<()> {
        if found == self.count {
            return Ok(());
        }
        let said = self.count;
        let message =
            format!("the section says that it has {said} {what}, and its blocks have {found}");
        Err(scan.fail(self.at, message))
    }
}

/// The head of a block: the entity, whether nodes are parametric or the type of elements, and their number.
struct BlockHeader {
    at: usize,
    dim: i64,
    entity: i64,
    kind: i64,
    count: usize,
}

fn block(
    scan: &mut Scan,
    layout: FormatWidths,
    kind: &str,
    what: &str,
    least: usize,
) -> Result<BlockHeader> {
    let at = scan.at();
    let first = scan.whole(INT, "an entity")?;
    let second = scan.whole(INT, "an entity")?;
    let (entity, dim) = if layout.old {
        (first, second)
    } else {
        (second, first)
    };
    if !(0..=3).contains(&dim) {
        let message = format!("found {dim} where the dimension of an entity was expected, 0 to 3");
        return Err(scan.fail(at, message));
    }
    Ok(BlockHeader {
        at,
        dim,
        entity,
        kind: scan.whole(INT, kind)?,
        count: scan.count(layout.counts, what, least)?,
    })
}

/// Reads the section $Nodes.
pub(super) fn nodes(scan: &mut Scan, layout: FormatWidths) -> Result<Nodes> {
    let head = head(scan, layout, "the number of nodes")?;
    let least = if scan.is_text() { 7 } else { 28 };
    let mut nodes = Nodes::default();
    for _ in 0..head.blocks {
        let block = block(
            scan,
            layout,
            "whether nodes are parametric",
            "the number of nodes",
            least,
        )?;
        let parameters = match block.kind {
            0 => 0,
            1 => block.dim,
            other => {
                let message = format!(
                    "found {other} where 0 or 1 was expected: whether nodes are parametric"
                );
                return Err(scan.fail(block.at, message));
            }
        };
        nodes.reserve(block.count);
        if !layout.old {
            for _ in 0..block.count {
                let at = scan.at();
                nodes.number(at, scan.number(layout.ids, "the number of a node")?);
            }
        }
        for _ in 0..block.count {
            if layout.old {
                let at = scan.at();
                nodes.number(at, scan.number(layout.ids, "the number of a node")?);
            }
            nodes.points.push(scan.point()?);
            for _ in 0..parameters {
                scan.real("a parametric coordinate")?;
            }
        }
    }
    head.check(scan, nodes.ids.len(), "nodes")?;
    nodes.index(scan)?;
    scan.end("Nodes")?;
    Ok(nodes)
}

/// Reads the section $Elements.
pub(super) fn elements(
    scan: &mut Scan,
    layout: FormatWidths,
    nodes: &Nodes,
    entities: &Entities,
) -> Result<(GmshElements, PhysicalGroups)> {
    let head = head(scan, layout, "the number of elements")?;
    let mut elements = GmshElements::default();
    let mut groups = PhysicalGroups::default();
    // Few bytes can put all elements into many groups.
    let mut most = scan.length();
    for _ in 0..head.blocks {
        let block = block(
            scan,
            layout,
            "the type of elements",
            "the number of elements",
            4,
        )?;
        let of = entities.groups(scan, block.at, block.dim, block.entity)?;
        let first = elements.cells.len() as u32;
        for _ in 0..block.count {
            let at = scan.at();
            let id = scan.number(layout.ids, "the number of an element")?;
            let kind = block.kind;
            let element = ElementHead { at, id, kind };
            let cell = element.nodes(scan, layout.ids, nodes)?;
            if cell.kind.dim() as i64 != block.dim {
                let (name, dim) = (cell.kind.name(), block.dim);
                let message = format!("element {id} is a {name} on an entity of dimension {dim}");
                return Err(scan.fail(at, message));
            }
            elements.push(scan, &element, &cell)?;
        }
        let members = block.count.saturating_mul(of.len());
        most = most.checked_sub(members).ok_or_else(|| {
            let (entity, groups) = (block.entity, of.len());
            let message = format!("entity {entity} is in {groups} physical groups, which is too many for its elements");
            scan.fail(block.at, message)
        })?;
        for &tag in of {
            groups.add(block.dim as usize, tag, first..elements.cells.len() as u32);
        }
    }
    head.check(scan, elements.cells.len(), "elements")?;
    elements.check(scan)?;
    scan.end("Elements")?;
    Ok((elements, groups))
}
