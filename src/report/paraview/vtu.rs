//! ParaView's unstructured grids (`.vtu`): XML with arrays in base64, each as little-endian numbers after a UInt64
//! length.

use crate::mesh::Cells;
use crate::report::output;
use crate::{Error, Result};
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use std::io::{self, Write};
use std::path::Path;

/// Numbers of a data array.
#[derive(Debug, Clone, Copy)]
pub enum Values<'a> {
    /// Written as Float64.
    Float(&'a [f64]),
    /// Written as Int32.
    Int(&'a [i32]),
}

impl Values<'_> {
    fn len(&self) -> usize {
        match self {
            Values::Float(v) => v.len(),
            Values::Int(v) => v.len(),
        }
    }
}

impl<'a> From<&'a [f64]> for Values<'a> {
    fn from(v: &'a [f64]) -> Self {
        Values::Float(v)
    }
}

impl<'a> From<&'a [i32]> for Values<'a> {
    fn from(v: &'a [i32]) -> Self {
        Values::Int(v)
    }
}

struct Array<'a> {
    name: String,
    components: usize,
    values: Values<'a>,
}

/// A grid with its data, ready to be written.
pub struct Vtu<'a> {
    points: &'a [[f64; 3]],
    cells: &'a Cells,
    point_data: Vec<Array<'a>>,
    cell_data: Vec<Array<'a>>,
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
        values: impl Into<Values<'a>>,
    ) -> Self {
        self.point_data.push(Array {
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
        values: impl Into<Values<'a>>,
    ) -> Self {
        self.cell_data.push(Array {
            name: name.to_string(),
            components,
            values: values.into(),
        });
        self
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`Error::Input`] when an array does not fit the grid; [`Error::Environment`] with the path.
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
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(
            out,
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
        )?;
        writeln!(out, "<UnstructuredGrid>")?;
        writeln!(
            out,
            "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{n_cells}\">",
            self.points.len()
        )?;
        for (tag, arrays) in [
            ("PointData", &self.point_data),
            ("CellData", &self.cell_data),
        ] {
            writeln!(out, "<{tag}>")?;
            for a in arrays {
                let head = (&a.name[..], a.components);
                match a.values {
                    Values::Float(v) => {
                        array(out, head, "Float64", v.iter().copied(), f64::to_le_bytes)
                    }
                    Values::Int(v) => {
                        array(out, head, "Int32", v.iter().copied(), i32::to_le_bytes)
                    }
                }?;
            }
            writeln!(out, "</{tag}>")?;
        }
        writeln!(out, "<Points>")?;
        let coordinates = self.points.as_flattened().iter().copied();
        array(out, ("Points", 3), "Float64", coordinates, f64::to_le_bytes)?;
        writeln!(out, "</Points>\n<Cells>")?;
        let nodes = connectivity(self.cells);
        array(
            out,
            ("connectivity", 1),
            "Int64",
            nodes.into_iter(),
            i64::to_le_bytes,
        )?;
        let mut end = 0;
        let ends = self.cells.kinds().iter().map(|kind| {
            end += kind.nodes() as i64;
            end
        });
        array(out, ("offsets", 1), "Int64", ends, i64::to_le_bytes)?;
        let kinds = self.cells.kinds().iter().map(|kind| kind.vtk());
        array(out, ("types", 1), "UInt8", kinds, u8::to_le_bytes)?;
        writeln!(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    }
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

/// One DataArray element of numbers of N bytes each.
fn array<T, const N: usize>(
    out: &mut dyn Write,
    (name, components): (&str, usize),
    kind: &str,
    numbers: impl ExactSizeIterator<Item = T>,
    bytes: impl Fn(T) -> [u8; N],
) -> io::Result<()> {
    let name = name
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;");
    let components = if components == 1 {
        String::new()
    } else {
        format!(" NumberOfComponents=\"{components}\"")
    };
    writeln!(
        out,
        "<DataArray type=\"{kind}\" Name=\"{name}\"{components} format=\"binary\">"
    )?;
    // The encoder is a stream: arrays of any length need no second copy.
    let mut base64 = EncoderWriter::new(&mut *out, &STANDARD);
    base64.write_all(&((numbers.len() * N) as u64).to_le_bytes())?;
    for number in numbers {
        base64.write_all(&bytes(number))?;
    }
    base64.finish()?;
    drop(base64);
    writeln!(out, "\n</DataArray>")
}

#[cfg(test)]
#[path = "../../../tests/inside/report/paraview/vtu.rs"]
mod tests;
