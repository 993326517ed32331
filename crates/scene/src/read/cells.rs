//! Coefficients from files.

use super::document::{Item, TableSection};
use super::fields::FieldSizes;
use super::SceneReader;
use crate::model::cells::{CellGrid, NumberFormat, Tone};
use crate::model::field::Field;
use base::Result;
use std::path::{Path, PathBuf};

/// The value of the key `type`.
#[derive(Clone, Copy)]
enum Type {
    Picture,
    Numbers(NumberFormat),
}

impl SceneReader {
    /// A coefficient: a field in any of its forms, or values by element from a file.
    pub(super) fn coefficient(
        &self,
        item: &Item,
        shape: &FieldSizes,
        otherwise: f64,
    ) -> Result<Field> {
        match item.section("this table") {
            Ok(section) if section.entry("file").is_some() => {
                Ok(Field::Cells(self.cells(section, item, shape)?))
            }
            _ => Ok(self.field(item, shape, otherwise)?.0),
        }
    }

    fn cells(
        &self,
        mut section: TableSection,
        item: &Item,
        shape: &FieldSizes,
    ) -> Result<CellGrid> {
        let file = section.need("file", "the name of a file")?;
        if shape.of_cells {
            return file.error("a `file` of values by element, which only boxes take");
        }
        // A path is relative to the scene's own directory.
        let directory = Path::new(item.file).parent();
        let path = PathBuf::from(file.text("the name of a file")?);
        let path = directory.map_or(path.clone(), |directory| directory.join(path));
        let of = section.read("type", |item| {
            item.choice(&[
                ("png", Type::Picture),
                ("text", Type::Numbers(NumberFormat::Text)),
                ("f32", Type::Numbers(NumberFormat::F32)),
                ("f64", Type::Numbers(NumberFormat::F64)),
            ])
        })?;
        let cells = match of {
            Some(Type::Picture) => self.picture(&mut section, &path)?,
            Some(Type::Numbers(f)) => self.numbers(&mut section, &path, Some(f), shape)?,
            None if CellGrid::is_picture(&path) => self.picture(&mut section, &path)?,
            None => self.numbers(&mut section, &path, None, shape)?,
        };
        section.finish()?;
        cells.or_else(|e| item.error(e))
    }

    /// Reads a picture. The outer error concerns the scene, the inner one the file.
    fn picture(&self, section: &mut TableSection, path: &Path) -> Result<Result<CellGrid>> {
        if let Some(item) = section.entry("shape") {
            return item.error("`shape` for a picture, which has as many cells as pixels");
        }
        let wanted = "a pair of values, for black and for white";
        let values = self.pair(section.need("values", wanted)?, wanted)?;
        let tones = [("linear", Tone::Linear), ("log", Tone::Log)];
        let tone = section.read("scale", |item| item.choice(&tones))?;
        Ok(CellGrid::picture(path, values, tone.unwrap_or_default()))
    }

    /// Reads numbers: one for each element, unless there is a `shape`.
    fn numbers(
        &self,
        section: &mut TableSection,
        path: &Path,
        format: Option<NumberFormat>,
        shape: &FieldSizes,
    ) -> Result<Result<CellGrid>> {
        for key in ["values", "scale"] {
            if let Some(item) = section.entry(key) {
                return item.error(format!(
                    "`{key}` for a file of numbers, where only a picture (`*.png`) has greys"
                ));
            }
        }
        let counts = section.read("shape", |item| self.counts(item, 1))?;
        let each = || {
            let bodies = shape.bodies.unwrap_or([1; 3]);
            [0, 1, 2].map(|d| bodies[d] * shape.mesh.elements[d].max(1))
        };
        Ok(CellGrid::read(path, counts.unwrap_or_else(each), format))
    }
}
