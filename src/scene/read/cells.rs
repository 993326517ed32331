//! Coefficients from files.

use super::document::{Item, Section};
use super::fields::Shape;
use super::Reader;
use crate::error::Result;
use crate::scene::model::cells::{Cells, NumberFormat, Tone};
use crate::scene::model::field::Field;
use std::path::{Path, PathBuf};

impl<'a> Reader<'a> {
    /// A coefficient: a field in any of its forms, or values by element from a file.
    pub(super) fn coefficient(
        &self,
        item: &'a Item,
        shape: &Shape,
        otherwise: f64,
    ) -> Result<Field> {
        match Section::new(self.source, "this table", item) {
            Ok(section) if section.entry("file").is_some() => {
                Ok(Field::Cells(self.cells(section, item, shape)?))
            }
            _ => Ok(self.field(item, shape, otherwise)?.0),
        }
    }

    fn cells(&self, mut section: Section<'a>, item: &'a Item, shape: &Shape) -> Result<Cells> {
        let file = section.need("file", "the name of a file")?;
        let path = self.path(&self.text(file, "the name of a file")?);
        let format = match section.take("type") {
            None => None,
            Some(item) => Some(self.choice(item, &["png", "text", "f32", "f64"])?),
        };
        let cells = match format {
            Some(0) => self.picture(&mut section, &path)?,
            None if Cells::is_picture(&path) => self.picture(&mut section, &path)?,
            _ => self.numbers(&mut section, &path, format, shape)?,
        };
        section.finish()?;
        cells.or_else(|e| self.error(item, e))
    }

    /// Reads a picture. The outer error concerns the scene, the inner one the file.
    fn picture(&self, section: &mut Section<'a>, path: &Path) -> Result<Result<Cells>> {
        if let Some(item) = section.entry("shape") {
            return self.error(
                item,
                "`shape` for a picture, which has as many cells as pixels",
            );
        }
        let values = section.need("values", "a pair of values, for black and for white")?;
        let values = self.pair(values, "a pair of values, for black and for white")?;
        let tone = match section.take("scale") {
            None => Tone::Linear,
            Some(item) => match self.choice(item, &["linear", "log"])? {
                0 => Tone::Linear,
                _ => Tone::Log,
            },
        };
        Ok(Cells::picture(path, values, tone))
    }

    /// Reads numbers: one for each element, unless there is a `shape`.
    fn numbers(
        &self,
        section: &mut Section<'a>,
        path: &Path,
        format: Option<usize>,
        shape: &Shape,
    ) -> Result<Result<Cells>> {
        for key in ["values", "scale"] {
            if let Some(item) = section.entry(key) {
                return self.error(
                    item,
                    format_args!(
                        "`{key}` for a file of numbers, where only a picture (`*.png`) has greys"
                    ),
                );
            }
        }
        let counts = match section.take("shape") {
            Some(item) => self.counts(item, 1)?,
            None => {
                let bodies = shape.bodies.unwrap_or([1; 3]);
                [0, 1, 2].map(|d| bodies[d] * shape.elements[d].max(1))
            }
        };
        let formats = [NumberFormat::Text, NumberFormat::F32, NumberFormat::F64];
        let format = format.map(|k| formats[k - 1]);
        Ok(Cells::read(path, counts, format))
    }

    /// Resolves a path in the scene relative to the scene's own directory.
    fn path(&self, written: &str) -> PathBuf {
        match Path::new(self.source.file).parent() {
            Some(directory) => directory.join(written),
            None => PathBuf::from(written),
        }
    }
}
