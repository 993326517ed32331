//! Tables of placements: where the copies of a body stand, as a list in the scene or as lines of a file.

use super::document::{Item, Value};
use super::SceneReader;
use crate::model::motion::Isometry;
use base::{Error, Location, Result};
use mesh::bytes;
use std::path::{Path, PathBuf};

/// Where a copy of a body stands.
#[derive(Debug)]
pub(super) struct Placement {
    pub motion: Isometry,
    /// Its name, if it has one of its own.
    pub name: Option<String>,
    /// The place where it was written, as messages begin with it.
    pub location: Location,
}

impl SceneReader {
    /// `instances` of a body: a list, or the name of a file beside the scene.
    pub(super) fn placements(&self, item: &Item) -> Result<Vec<Placement>> {
        let list: Vec<Placement> = match &item.value {
            Value::Text(file) => self.placement_file(item, file)?,
            Value::List(items) => {
                let each = items.iter().map(|item| self.placement(item));
                each.collect::<Result<_>>()?
            }
            _ => return item.expected("a list of placements or the name of a file"),
        };
        if list.is_empty() {
            item.error("no placements where one at least was expected")
        } else {
            Ok(list)
        }
    }

    /// One placement: a list of numbers, or a table.
    fn placement(&self, item: &Item) -> Result<Placement> {
        let (motion, name) = match &item.value {
            Value::List(numbers) => {
                let numbers: Result<Vec<f64>> = numbers.iter().map(|i| self.number(i)).collect();
                let motion = self.motion(&numbers?);
                (motion.or_else(|message| item.error(message))?, None)
            }
            Value::Table(_) => self.placement_table(item)?,
            _ => return item.expected("a placement, as a list of numbers or a table with `at`,"),
        };
        Ok(Placement {
            motion,
            name,
            location: item.location(),
        })
    }

    fn placement_table(&self, item: &Item) -> Result<(Isometry, Option<String>)> {
        let mut section = item.section("a placement")?;
        let at = ["a point [x, y]", "a point [x, y, z]"][self.dim - 2];
        let shift = self.vector(section.need("at", at)?, at)?;
        let name = section.read("name", |item| item.text("a name"))?;
        let angle = section.read("angle", |item| self.number(item))?;
        let vector = |item: &Item| self.vector(item, "a vector [x, y, z]");
        let (axis, rotation) = match self.dim {
            2 => (None, None),
            _ => (
                section.read("axis", vector)?,
                section.read("rotation", vector)?,
            ),
        };
        section.finish()?;
        let mut numbers = shift[..self.dim].to_vec();
        match (self.dim, axis, angle, rotation) {
            (_, None, None, None) => {}
            (2, None, Some(angle), None) => numbers.push(angle),
            (_, None, None, Some(rotation)) => numbers.extend(rotation),
            (3, Some(axis), Some(angle), None) => {
                numbers.extend(axis);
                numbers.push(angle);
            }
            _ => {
                return item.error("`axis` and `angle`, or `rotation` alone, turn a copy in space")
            }
        }
        let motion = self.motion(&numbers);
        Ok((motion.or_else(|message| item.error(message))?, name))
    }

    /// The lines of a file: numbers, and a name at the end.
    fn placement_file(&self, item: &Item, file: &str) -> Result<Vec<Placement>> {
        let directory = Path::new(item.file).parent();
        let path = directory.map_or(PathBuf::from(file), |directory| directory.join(file));
        let shown = path.display();
        let refused = |e: Error| item.error(e.to_string());
        let read = bytes(&path, "list of placements").or_else(refused)?;
        let text = String::from_utf8(read)
            .or_else(|e| item.error(format!("{shown}: the placements cannot be read: {e}")))?;
        let mut out = Vec::new();
        for (line, number) in text.lines().zip(1..) {
            let line = line.split('#').next().unwrap_or_default();
            let is_gap = |c: char| c.is_whitespace() || c == ',' || c == ';';
            let mut words: Vec<&str> = line.split(is_gap).filter(|w| !w.is_empty()).collect();
            let location = Location::line(shown.to_string(), number);
            let Some(last) = words.last() else { continue };
            let name = match last.parse::<f64>() {
                Ok(_) => None,
                Err(_) => words.pop().map(String::from),
            };
            let read = |word: &&str| match word.parse::<f64>() {
                Ok(v) if v.is_finite() => Ok(v),
                _ => Err(format!("`{word}` where a finite number was expected")),
            };
            let numbers: std::result::Result<Vec<f64>, String> = words.iter().map(read).collect();
            let motion = numbers.and_then(|numbers| self.motion(&numbers));
            let motion = motion.map_err(|message| Error::input(message).at(&location))?;
            out.push(Placement {
                motion,
                name,
                location,
            });
        }
        Ok(out)
    }

    /// The motion that some numbers describe.
    fn motion(&self, numbers: &[f64]) -> std::result::Result<Isometry, String> {
        const STILL: [f64; 3] = [0.0, 0.0, 1.0];
        let motion = match (self.dim, numbers) {
            (2, &[x, y]) => Some(Isometry::shift([x, y, 0.0])),
            (2, &[x, y, angle]) => Isometry::about(STILL, angle, [x, y, 0.0]),
            (3, &[x, y, z]) => Some(Isometry::shift([x, y, z])),
            (3, &[x, y, z, 0.0, 0.0, 0.0]) => Some(Isometry::shift([x, y, z])),
            (3, &[x, y, z, a, b, c]) => {
                Isometry::about([a, b, c], (a * a + b * b + c * c).sqrt(), [x, y, z])
            }
            (3, &[x, y, z, a, b, c, angle]) => Isometry::about([a, b, c], angle, [x, y, z]),
            _ => {
                let wanted = [
                    "x y, and an angle if it is turned",
                    "x y z, and a rotation vector, or an axis and an angle, if it is turned",
                ];
                return Err(format!(
                    "a placement of {} numbers where {} were expected",
                    numbers.len(),
                    wanted[self.dim - 2]
                ));
            }
        };
        motion.ok_or_else(|| "an axis 0 where a direction was expected".into())
    }
}
