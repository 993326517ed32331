//! A mesh as a file has it: cells of every dimension, and named groups of cells, nodes or sides of cells.

use super::cells::Cells;
use base::{Error, Location, Result};
use std::io::Read;
use std::path::Path;

/// The bytes of the file `path`, which has a `what`. A device or a pipe may have no end, and is refused.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) with the path.
pub fn bytes(path: &Path, what: &str) -> Result<Vec<u8>> {
    let name = path.display();
    let fail = |e| unreadable(path, what).because(e);
    if !std::fs::metadata(path).map_err(fail)?.is_file() {
        return Err(Error::input(format!(
            "{name} is no file, where one with a {what} was expected"
        )));
    }
    std::fs::read(path).map_err(fail)
}

/// Bytes of the longest text: many times what the largest scenes have.
const MOST: u64 = 1 << 28;

/// The text of `path`, which has a `what`; it may be a pipe.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) with the path; a text that is too long may have no end.
pub fn text(path: &Path, what: &str) -> Result<String> {
    let fail = |e: std::io::Error| unreadable(path, what).because(e);
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(fail)?;
    file.take(MOST + 1).read_to_end(&mut bytes).map_err(fail)?;
    if bytes.len() as u64 > MOST {
        return Err(Error::input(format!(
            "the {what} has more than {} MB, or no end, where a {what} of less was expected",
            MOST >> 20
        ))
        .at(Location::file_named(path.display().to_string())));
    }
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        unreadable(path, what)
            .retold(|so_far| format!("{so_far}: byte {} is no text in UTF-8", at + 1))
    })
}

fn unreadable(path: &Path, what: &str) -> Error {
    Error::input(format!("the {what} cannot be read"))
        .at(Location::file_named(path.display().to_string()))
}

/// Largest coordinate: volumes and their products must be numbers.
pub const FARTHEST: f64 = 1e50;

/// The contents of a mesh file, whatever the format.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshFile {
    /// The name of the file, for messages.
    pub name: String,
    /// The points; z is 0 in plane meshes.
    pub points: Vec<[f64; 3]>,
    /// The number of each point in the file.
    pub node_ids: Vec<u64>,
    /// The length that one unit in the last digit of a coordinate stands for, as the file writes them; 0 where they
    /// are exact.
    pub resolution: f64,
    /// All cells, of every dimension; nodes are places in `points`.
    pub cells: Cells,
    /// The number of each cell in the file.
    pub cell_ids: Vec<u64>,
    /// The named groups, in the order of the file.
    pub groups: Vec<MeshGroup>,
}

impl MeshFile {
    /// A sentence on the points that no cell of dimension `dim` has, nor one of the groups `kept`, if there are any but
    /// those of `used`: they are left out.
    pub fn unused(&self, dim: usize, kept: &[String], used: &[u32]) -> Option<String> {
        let mut has = vec![false; self.points.len()];
        used.iter().for_each(|&k| has[k as usize] = true);
        let named = self.groups.iter().filter(|g| kept.contains(&g.name));
        let named = named.flat_map(|g| match &g.members {
            Members::Cells { cells, .. } => cells.clone(),
            Members::Sides(_) | Members::Nodes(_) => Vec::new(),
        });
        let whole = (0..self.cells.len()).filter(|&c| self.cells.kind(c).dim() == dim);
        for c in whole.chain(named.map(|c| c as usize)) {
            self.cells
                .nodes(c)
                .iter()
                .for_each(|&k| has[k as usize] = true);
        }
        let first = has.iter().position(|has| !has)?;
        let text = match has.iter().filter(|has| !**has).count() {
            1 => "1 node that no cell has is left out:".to_string(),
            n => format!("{n} nodes that no cell has are left out, the first is"),
        };
        Some(format!(
            "{}: {text} node {} at {:?}",
            self.name, self.node_ids[first], self.points[first]
        ))
    }
}

/// A named group of a mesh file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshGroup {
    /// Its name; where the file numbers a group and does not name it, the number.
    pub name: String,
    /// The members of the group.
    pub members: Members,
}

/// The members of a [`MeshGroup`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Members {
    /// Cells of one dimension, as places in [`MeshFile::cells`]: a physical group, an ELSET.
    Cells {
        /// The dimension of the cells, 0 to 3.
        dim: usize,
        /// The cells, in increasing order.
        cells: Vec<u32>,
    },
    /// Points, as places in [`MeshFile::points`], in increasing order: an NSET.
    Nodes(Vec<u32>),
    /// Sides of cells: the cell, and the side of its kind ([`CellKind::sides`](elements::kind::CellKind::sides)): a
    /// SURFACE.
    Sides(Vec<(u32, u8)>),
}
