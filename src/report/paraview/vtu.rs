//! ParaView's unstructured grids (`.vtu`): XML with arrays in base64, each as little-endian numbers after a UInt64
//! length.

use crate::report::output;
use crate::{Error, Result};
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use std::io::{self, Write};
use std::path::Path;

/// Shape of all cells of a grid; corners in VTK's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Two points.
    Line,
    /// Three points, counterclockwise.
    Triangle,
    /// Four points, counterclockwise.
    Quad,
    /// Four points.
    Tetrahedron,
    /// Eight points: bottom counterclockwise, then top.
    Hexahedron,
}

impl Shape {
    /// Corners per cell.
    pub fn corners(self) -> usize {
        match self {
            Shape::Line => 2,
            Shape::Triangle => 3,
            Shape::Quad | Shape::Tetrahedron => 4,
            Shape::Hexahedron => 8,
        }
    }

    /// VTK's number for the shape.
    fn vtk(self) -> u8 {
        match self {
            Shape::Line => 3,
            Shape::Triangle => 5,
            Shape::Quad => 9,
            Shape::Tetrahedron => 10,
            Shape::Hexahedron => 12,
        }
    }
}

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
    shape: Shape,
    cells: &'a [u32],
    point_data: Vec<Array<'a>>,
    cell_data: Vec<Array<'a>>,
}

impl<'a> Vtu<'a> {
    /// A grid of n points and of cells of one shape; `cells` lists the corners of one cell after the other.
    pub fn new(points: &'a [[f64; 3]], shape: Shape, cells: &'a [u32]) -> Self {
        Vtu {
            points,
            shape,
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
        self.cells.len() / self.shape.corners()
    }

    fn check(&self) -> Result<()> {
        if self.cells.len() % self.shape.corners() != 0 {
            return Err(Error::input(format!(
                "the grid lists {} corners, expected a multiple of {}",
                self.cells.len(),
                self.shape.corners()
            )));
        }
        if let Some(bad) = self
            .cells
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
                match a.values {
                    Values::Float(v) => {
                        array(
                            out,
                            &a.name,
                            "Float64",
                            a.components,
                            v.len(),
                            v.iter().map(|x| x.to_le_bytes()),
                        )?;
                    }
                    Values::Int(v) => {
                        array(
                            out,
                            &a.name,
                            "Int32",
                            a.components,
                            v.len(),
                            v.iter().map(|x| x.to_le_bytes()),
                        )?;
                    }
                }
            }
            writeln!(out, "</{tag}>")?;
        }
        writeln!(out, "<Points>")?;
        let coordinates = self.points.iter().flatten().map(|x| x.to_le_bytes());
        array(
            out,
            "Points",
            "Float64",
            3,
            3 * self.points.len(),
            coordinates,
        )?;
        writeln!(out, "</Points>\n<Cells>")?;
        let corners = self.shape.corners() as i64;
        let connectivity = self.cells.iter().map(|&c| i64::from(c).to_le_bytes());
        array(
            out,
            "connectivity",
            "Int64",
            1,
            self.cells.len(),
            connectivity,
        )?;
        let offsets = (1..=n_cells as i64).map(|k| (k * corners).to_le_bytes());
        array(out, "offsets", "Int64", 1, n_cells, offsets)?;
        array(
            out,
            "types",
            "UInt8",
            1,
            n_cells,
            (0..n_cells).map(|_| [self.shape.vtk()]),
        )?;
        writeln!(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    }
}

/// One DataArray element of `count` numbers of N bytes.
fn array<const N: usize>(
    out: &mut dyn Write,
    name: &str,
    kind: &str,
    components: usize,
    count: usize,
    numbers: impl Iterator<Item = [u8; N]>,
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
    base64.write_all(&((count * N) as u64).to_le_bytes())?;
    for number in numbers {
        base64.write_all(&number)?;
    }
    base64.finish()?;
    drop(base64);
    writeln!(out, "\n</DataArray>")
}

#[cfg(test)]
#[path = "../../../tests/inside/report/paraview/vtu.rs"]
mod tests;
