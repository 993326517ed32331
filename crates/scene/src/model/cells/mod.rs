//! Coefficients from data: values on a grid of equal cells that covers a body, or a whole grid of bodies.
//!
//! An element takes the value of the cell in which its midpoint lies. The cell follows from element and cell numbers,
//! not from coordinates: with as many cells as elements each element has its own, whatever the shape of the body. A
//! midpoint between two cells belongs to the right or upper one.
//!
//! Arrays of numbers stay on disk. Each rank reads only the part of its own subdomains, which bounds the memory for
//! large fields. Pictures and text files are small, and are kept in memory.

mod numbers;
mod picture;

use base::{Error, Result};
use mesh::{BoxMesh, ElementBlock};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use numbers::ArrayFile;
pub use numbers::NumberFormat;
use picture::Picture;
pub use picture::Tone;

/// Values on a grid of cells. Copies share them.
#[derive(Debug, Clone, PartialEq)]
pub struct CellGrid {
    data: Arc<Data>,
    /// Number of bodies in x, y and z that the cells cover.
    bodies: [usize; 3],
}

#[derive(Debug, PartialEq)]
struct Data {
    /// The name in messages: the file, or another description.
    name: String,
    /// The file that the values are from, if they are from one.
    file: Option<PathBuf>,
    /// Cells in x, y and z.
    counts: [usize; 3],
    /// Least and greatest value; NaN where one of them is.
    range: [f64; 2],
    values: GridValues,
}

/// The values; the lowest row comes first, x runs fastest.
#[derive(Debug, PartialEq)]
enum GridValues {
    Listed(Vec<f64>),
    Painted(Picture),
    Stored(ArrayFile),
}

impl CellGrid {
    /// `counts[0]` × `counts[1]` (× `counts[2]`, 1 in the plane) cells with these values. x runs fastest; the lowest
    /// row and layer come first.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) when the number of values is another one.
    pub fn new(name: impl Into<String>, counts: [usize; 3], values: Vec<f64>) -> Result<CellGrid> {
        CellGrid::listed(name.into(), None, counts, values)
    }

    fn listed(
        name: String,
        file: Option<&Path>,
        counts: [usize; 3],
        values: Vec<f64>,
    ) -> Result<CellGrid> {
        if product(counts) != Some(values.len()) || values.is_empty() {
            let shape = shape(counts);
            let found = values.len();
            return Err(Error::input(format!(
                "{name}: {found} numbers where {shape} were expected"
            )));
        }
        let range = range(values.iter().copied());
        Ok(CellGrid::of(
            name,
            file,
            counts,
            range,
            GridValues::Listed(values),
        ))
    }

    /// The numbers in the file `path`, in the order of [`CellGrid::new`]. With `format: None`, files `*.txt` and
    /// `*.csv` are text; other files are f32 or f64, depending on their size.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) when the file cannot be read, or holds another number of numbers.
    pub fn read(path: &Path, counts: [usize; 3], format: Option<NumberFormat>) -> Result<CellGrid> {
        let name = path.display().to_string();
        let format = format.or_else(|| numbers::format_of(path));
        if format == Some(NumberFormat::Text) {
            return CellGrid::listed(name, Some(path), counts, numbers::text(path)?);
        }
        let array = ArrayFile::open(path, counts, format)?;
        let range = array.range()?;
        let values = GridValues::Stored(array);
        Ok(CellGrid::of(name, Some(path), counts, range, values))
    }

    /// The grey values of a PNG picture, its top row at the top of the body: `values[0]` where it is black, `values[1]`
    /// where it is white, and in between as `tone` says. In space the picture is the same in all layers.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) when the file is no PNG picture, has colours or transparent pixels,
    /// or for values that the tone does not fit.
    pub fn picture(path: &Path, values: [f64; 2], tone: Tone) -> Result<CellGrid> {
        let (picture, counts) = Picture::read(path, values, tone)?;
        let range = range(picture.values());
        let name = path.display().to_string();
        let values = GridValues::Painted(picture);
        Ok(CellGrid::of(name, Some(path), counts, range, values))
    }

    fn of(
        name: String,
        file: Option<&Path>,
        counts: [usize; 3],
        range: [f64; 2],
        values: GridValues,
    ) -> CellGrid {
        CellGrid {
            data: Arc::new(Data {
                name,
                file: file.map(Path::to_path_buf),
                counts,
                range,
                values,
            }),
            bodies: [1; 3],
        }
    }

    /// Whether the name of a file says that it is a picture.
    pub(crate) fn is_picture(path: &Path) -> bool {
        numbers::has_extension(path, "png")
    }

    /// The name in messages: the file, or another description.
    pub fn name(&self) -> &str {
        &self.data.name
    }

    /// The file that the values are from, if they are from one.
    pub fn file(&self) -> Option<&Path> {
        self.data.file.as_deref()
    }

    /// Cells in x, y and z; 1 in z in the plane.
    pub fn counts(&self) -> [usize; 3] {
        self.data.counts
    }

    /// Least and greatest value; both NaN where a value is.
    pub fn range(&self) -> [f64; 2] {
        self.data.range
    }

    /// These cells, which cover a whole grid of bodies instead of one body.
    pub(crate) fn over(&self, bodies: [usize; 3]) -> CellGrid {
        CellGrid {
            data: Arc::clone(&self.data),
            bodies,
        }
    }

    /// The values of the elements of a subdomain; `place` is the place of the body in its grid.
    pub(crate) fn sample(
        &self,
        place: [usize; 3],
        mesh: &BoxMesh,
        block: &ElementBlock,
    ) -> Result<Vec<f64>> {
        let Data { counts, name, .. } = &*self.data;
        if (0..3).any(|d| place[d] >= self.bodies[d]) {
            let bodies = shape(self.bodies);
            return Err(Error::input(format!(
                "{name} covers {bodies} bodies, and the body at {place:?} is none of them"
            )));
        }
        let cells = [0, 1, 2].map(|d| {
            let each = mesh.elements[d].max(1);
            let first = place[d] * each + block.first[d];
            let all = each * self.bodies[d];
            let elements = first..first + block.elements[d].max(1);
            let cells: Vec<usize> = elements.map(|e| cell(e, all, counts[d])).collect();
            cells
        });
        let [columns, rows, layers] = &cells;
        let left = columns[0];
        let width = columns[columns.len() - 1] + 1 - left;
        let mut reader = self.data.reader()?;
        let (mut row, mut held) = (Vec::new(), None);
        let mut out = Vec::with_capacity(columns.len() * rows.len() * layers.len());
        for &k in layers {
            for &j in rows {
                if held != Some((j, k)) {
                    reader.row((k * counts[1] + j) * counts[0] + left, width, &mut row)?;
                    held = Some((j, k));
                }
                out.extend(columns.iter().map(|i| row[i - left]));
            }
        }
        Ok(out)
    }

    /// The first cell whose value is `wrong`: the value, and the name of the cell in messages.
    pub fn find(&self, wrong: impl Fn(f64) -> bool) -> Result<Option<(f64, String)>> {
        let [nx, ny, nz] = self.data.counts;
        let mut reader = self.data.reader()?;
        let mut row = Vec::new();
        for line in 0..ny * nz {
            reader.row(line * nx, nx, &mut row)?;
            let Some(i) = row.iter().position(|v| wrong(*v)) else {
                continue;
            };
            let (j, k) = (line % ny, line / ny);
            let cell = match &self.data.values {
                GridValues::Painted(_) => format!("the pixel ({i}, {})", ny - 1 - j),
                _ if nz == 1 => format!("cell ({i}, {j})"),
                _ => format!("cell ({i}, {j}, {k})"),
            };
            let all = shape(self.data.counts);
            let named = format!("{cell} of {all} in {}", self.data.name);
            return Ok(Some((row[i], named)));
        }
        Ok(None)
    }
}

/// The cell of `cells` in which the midpoint of element `e` of `elements` lies.
fn cell(e: usize, elements: usize, cells: usize) -> usize {
    ((2 * e as u128 + 1) * cells as u128 / (2 * elements as u128)) as usize
}

impl Data {
    fn reader(&self) -> Result<GridReader<'_>> {
        Ok(match &self.values {
            GridValues::Listed(values) => GridReader::Listed(values),
            GridValues::Painted(picture) => GridReader::Painted(picture),
            GridValues::Stored(array) => GridReader::Stored(array.reader()?),
        })
    }
}

/// Reads parts of rows.
enum GridReader<'a> {
    Listed(&'a [f64]),
    Painted(&'a Picture),
    Stored(numbers::ArrayReader<'a>),
}

impl GridReader<'_> {
    /// Appends the `n` values from number `first` on to `out`.
    fn row(&mut self, first: usize, n: usize, out: &mut Vec<f64>) -> Result<()> {
        out.clear();
        match self {
            GridReader::Listed(values) => out.extend(&values[first..first + n]),
            GridReader::Painted(picture) => out.extend(picture.part(first..first + n)),
            GridReader::Stored(reader) => reader.read(first, n, |value| out.push(value))?,
        }
        Ok(())
    }
}

/// Least and greatest of some values, NaN if one of them is.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], widen)
}

fn widen([low, high]: [f64; 2], value: f64) -> [f64; 2] {
    // `min` and `max` ignore a NaN.
    if value.is_nan() || low.is_nan() {
        [f64::NAN; 2]
    } else {
        [low.min(value), high.max(value)]
    }
}

fn product(counts: [usize; 3]) -> Option<usize> {
    counts.iter().try_fold(1_usize, |n, c| n.checked_mul(*c))
}

/// "24 x 24", or "24 x 24 x 12".
pub(crate) fn shape([nx, ny, nz]: [usize; 3]) -> String {
    match nz {
        1 => format!("{nx} x {ny}"),
        _ => format!("{nx} x {ny} x {nz}"),
    }
}

#[cfg(test)]
#[path = "../../../tests/model/cells.rs"]
mod tests;
