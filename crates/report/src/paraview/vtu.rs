//! ParaView's unstructured grids (`.vtu`): XML with arrays in base64, compressed by zlib.
//!
//! An array is cut into blocks of [`BLOCK`] bytes of little-endian numbers, each compressed on its own. Before them
//! stand, as UInt64: the number of blocks, their size, the size of the last one if it is smaller (else 0), and the
//! compressed size of each. Header and blocks are two streams of base64.
//!
//! A grid may be one of several pieces; a `.pvtu` file names them.

use crate::output;
use base::{Error, Result};
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::{write::ZlibEncoder, Compression};
use mesh::Cells;
use rayon::iter::ParallelIterator;
use rayon::slice::ParallelSlice;
use std::io::{self, Write};
use std::path::Path;

/// Bytes of a block before compression.
const BLOCK: usize = 1 << 18;

/// Numbers of a data array.
#[derive(Debug, Clone, Copy)]
pub enum ArrayValues<'a> {
    /// Written as Float64.
    Float(&'a [f64]),
    /// Written as Int32.
    Int(&'a [i32]),
}

impl ArrayValues<'_> {
    fn len(&self) -> usize {
        match self {
            ArrayValues::Float(v) => v.len(),
            ArrayValues::Int(v) => v.len(),
        }
    }

    /// The name of the type in the file.
    fn kind(&self) -> &'static str {
        match self {
            ArrayValues::Float(_) => "Float64",
            ArrayValues::Int(_) => "Int32",
        }
    }

    fn bytes(&self) -> Vec<u8> {
        match self {
            ArrayValues::Float(v) => v.iter().flat_map(|x| x.to_le_bytes()).collect(),
            ArrayValues::Int(v) => v.iter().flat_map(|x| x.to_le_bytes()).collect(),
        }
    }
}

impl<'a> From<&'a [f64]> for ArrayValues<'a> {
    fn from(v: &'a [f64]) -> Self {
        ArrayValues::Float(v)
    }
}

impl<'a> From<&'a [i32]> for ArrayValues<'a> {
    fn from(v: &'a [i32]) -> Self {
        ArrayValues::Int(v)
    }
}

struct VtuArray<'a> {
    name: String,
    components: usize,
    values: ArrayValues<'a>,
}

impl VtuArray<'_> {
    fn attributes(&self) -> String {
        attributes(&self.name, self.components, self.values.kind())
    }
}

/// A grid with its data, ready to be written.
pub struct Vtu<'a> {
    points: &'a [[f64; 3]],
    cells: &'a Cells,
    point_data: Vec<VtuArray<'a>>,
    cell_data: Vec<VtuArray<'a>>,
}

impl<'a> Vtu<'a> {
    /// A grid of points and cells.
    pub fn new(points: &'a [[f64; 3]], cells: &'a Cells) -> Self {
        Vtu {
            points,
            cells,
            point_data: Vec::new(),
            cell_data: Vec::new(),
        }
    }

    /// Adds an array with `components` numbers per point (1 for a scalar, 3 for a vector), point by point.
    #[must_use]
    pub fn point_data(
        mut self,
        name: &str,
        components: usize,
        values: impl Into<ArrayValues<'a>>,
    ) -> Self {
        self.point_data.push(VtuArray {
            name: name.to_string(),
            components,
            values: values.into(),
        });
        self
    }

    /// Adds an array with `components` numbers per cell, cell by cell.
    #[must_use]
    pub fn cell_data(
        mut self,
        name: &str,
        components: usize,
        values: impl Into<ArrayValues<'a>>,
    ) -> Self {
        self.cell_data.push(VtuArray {
            name: name.to_string(),
            components,
            values: values.into(),
        });
        self
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) when an array does not fit the grid;
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the path.
    pub fn write(&self, path: &Path) -> Result<()> {
        self.check()?;
        output::write_file(path, |out| self.fill(out))
    }

    fn n_cells(&self) -> usize {
        self.cells.len()
    }

    fn check(&self) -> Result<()> {
        if let Some(bad) = self
            .cells
            .all_nodes()
            .iter()
            .find(|&&c| c as usize >= self.points.len())
        {
            return Err(Error::input(format!(
                "a cell names point {bad}, but the grid has {} points",
                self.points.len()
            )));
        }
        for (arrays, count, what) in [
            (&self.point_data, self.points.len(), "points"),
            (&self.cell_data, self.n_cells(), "cells"),
        ] {
            for a in arrays {
                if a.values.len() != count * a.components {
                    return Err(Error::input(format!(
                        "the array '{}' has {} numbers, expected {} for each of {count} {what}",
                        a.name,
                        a.values.len(),
                        a.components
                    )));
                }
            }
        }
        Ok(())
    }

    fn fill(&self, out: &mut dyn Write) -> io::Result<()> {
        let n_cells = self.n_cells();
        head(out, "UnstructuredGrid")?;
        writeln!(out, "<UnstructuredGrid>")?;
        writeln!(
            out,
            "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{n_cells}\">",
            self.points.len()
        )?;
        for (tag, arrays) in self.data() {
            writeln!(out, "<{tag}>")?;
            for a in arrays {
                array(out, &a.attributes(), a.values.bytes())?;
            }
            writeln!(out, "</{tag}>")?;
        }
        writeln!(out, "<Points>")?;
        array(
            out,
            POINTS,
            ArrayValues::Float(self.points.as_flattened()).bytes(),
        )?;
        writeln!(out, "</Points>\n<Cells>")?;
        let nodes = connectivity(self.cells);
        let int = |name: &str| attributes(name, 1, "Int64");
        array(out, &int("connectivity"), wide(nodes.into_iter()))?;
        let mut end = 0;
        let ends = self.cells.kinds().iter().map(|kind| {
            end += kind.nodes() as i64;
            end
        });
        array(out, &int("offsets"), wide(ends))?;
        let kinds = self.cells.kinds().iter().map(|kind| kind.vtk());
        array(out, &attributes("types", 1, "UInt8"), kinds.collect())?;
        writeln!(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    }

    fn data(&self) -> [(&'static str, &[VtuArray<'a>]); 2] {
        [
            ("PointData", &self.point_data),
            ("CellData", &self.cell_data),
        ]
    }

    /// Writes the file that names the pieces of a grid; this grid is one of them, and all have its arrays.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the path.
    pub fn write_index(&self, path: &Path, pieces: &[String]) -> Result<()> {
        output::write_file(path, |out| self.fill_index(out, pieces))
    }

    fn fill_index(&self, out: &mut dyn Write, pieces: &[String]) -> io::Result<()> {
        head(out, "PUnstructuredGrid")?;
        writeln!(out, "<PUnstructuredGrid GhostLevel=\"0\">")?;
        for (tag, arrays) in self.data() {
            writeln!(out, "<P{tag}>")?;
            for a in arrays {
                writeln!(out, "<PDataArray {}/>", a.attributes())?;
            }
            writeln!(out, "</P{tag}>")?;
        }
        writeln!(out, "<PPoints>\n<PDataArray {POINTS}/>\n</PPoints>")?;
        for piece in pieces {
            writeln!(out, "<Piece Source=\"{}\"/>", escaped(piece))?;
        }
        writeln!(out, "</PUnstructuredGrid>\n</VTKFile>")
    }
}

/// The attributes of the array of positions.
const POINTS: &str = "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"";

fn head(out: &mut dyn Write, kind: &str) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" \
         compressor=\"vtkZLibDataCompressor\">"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

fn attributes(name: &str, components: usize, kind: &str) -> String {
    let name = escaped(name);
    let components = match components {
        1 => String::new(),
        n => format!(" NumberOfComponents=\"{n}\""),
    };
    format!("type=\"{kind}\" Name=\"{name}\"{components}")
}

/// The nodes of all cells in VTK's order.
fn connectivity(cells: &Cells) -> Vec<i64> {
    let mut out = Vec::with_capacity(cells.all_nodes().len());
    for (kind, nodes) in cells.iter() {
        match kind.vtk_order() {
            None => out.extend(nodes.iter().map(|&k| i64::from(k))),
            Some(order) => out.extend(order.iter().map(|&a| i64::from(nodes[usize::from(a)]))),
        }
    }
    out
}

fn wide(numbers: impl Iterator<Item = i64>) -> Vec<u8> {
    numbers.flat_map(i64::to_le_bytes).collect()
}

/// One DataArray element.
fn array(out: &mut dyn Write, attributes: &str, bytes: Vec<u8>) -> io::Result<()> {
    let compressed = |block: &[u8]| {
        // Numbers of simulations shrink hardly further at higher levels.
        let mut stream = ZlibEncoder::new(Vec::new(), Compression::fast());
        stream.write_all(block)?;
        stream.finish()
    };
    let blocks = bytes.par_chunks(BLOCK).map(compressed);
    let blocks = blocks.collect::<io::Result<Vec<Vec<u8>>>>()?;
    let mut header = vec![blocks.len() as u64, BLOCK as u64];
    header.push((bytes.len() % BLOCK) as u64);
    header.extend(blocks.iter().map(|b| b.len() as u64));
    writeln!(out, "<DataArray {attributes} format=\"binary\">")?;
    let header: Vec<u8> = header.into_iter().flat_map(u64::to_le_bytes).collect();
    for part in [&[header][..], &blocks] {
        let mut base64 = EncoderWriter::new(&mut *out, &STANDARD);
        for block in part {
            base64.write_all(block)?;
        }
        base64.finish()?;
    }
    writeln!(out, "\n</DataArray>")
}

#[cfg(test)]
#[path = "../../tests/paraview/vtu.rs"]
mod tests;
