//! Files of numbers: text, and little-endian arrays of f32 or f64 without a header.

use super::{product, shape, widen};
use base::{Error, Result};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// The format of numbers in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberFormat {
    /// As text, with blanks, line ends, commas or semicolons between them; `#` begins a comment.
    Text,
    /// Four bytes each, little-endian.
    F32,
    /// Eight bytes each, little-endian.
    F64,
}

/// The format that the name of a file implies.
pub(crate) fn format_of(path: &Path) -> Option<NumberFormat> {
    let text = ["txt", "csv"].iter().any(|e| has_extension(path, e));
    text.then_some(NumberFormat::Text)
}

/// Whether the name of a file has this extension, in upper or lower case.
pub(crate) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// Opens the file; returns it with its length in bytes.
pub(crate) fn open(path: &Path) -> Result<(File, u64)> {
    let file = path.display();
    let fail = |e: std::io::Error| Error::input(format!("{file} cannot be read")).because(e);
    let opened = File::open(path).map_err(fail)?;
    let data = opened.metadata().map_err(fail)?;
    if !data.is_file() {
        return Err(Error::input(format!(
            "{file} is no file, where one with coefficients was expected"
        )));
    }
    Ok((opened, data.len()))
}

/// The numbers of a text file.
pub fn text(path: &Path) -> Result<Vec<f64>> {
    let file = path.display();
    let (mut opened, _) = open(path)?;
    let mut text = String::new();
    opened.read_to_string(&mut text).map_err(|e| {
        Error::input(format!(
            "{file} cannot be read as text: {e} (`type = \"f32\"` or \"f64\" reads binary numbers)"
        ))
    })?;
    let mut out = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let separator = |c: char| c.is_whitespace() || c == ',' || c == ';';
        for word in line.split(separator).filter(|w| !w.is_empty()) {
            out.push(word.parse().map_err(|_| {
                let line = k + 1;
                Error::input(format!(
                    "{file}:{line}: \"{word}\" where a number was expected"
                ))
            })?);
        }
    }
    Ok(out)
}

/// An array in a file.
#[derive(Debug, PartialEq)]
pub(crate) struct ArrayFile {
    path: PathBuf,
    n: usize,
    double: bool,
}

/// Bytes read at a time.
const PIECE: usize = 1 << 16;

impl ArrayFile {
    /// Opens the file and checks its length.
    pub fn open(
        path: &Path,
        counts: [usize; 3],
        format: Option<NumberFormat>,
    ) -> Result<ArrayFile> {
        let (_, bytes) = open(path)?;
        let all = shape(counts);
        let file = path.display();
        let sizes = product(counts).and_then(|n| Some([n.checked_mul(4)?, n.checked_mul(8)?]));
        let Some(sizes) = sizes else {
            return Err(Error::input(format!(
                "{file}: {all} numbers, more than can be counted"
            )));
        };
        let fits = |double: bool| sizes[usize::from(double)] as u64 == bytes;
        let (found, wanted) = match format {
            None => (
                [false, true].into_iter().find(|d| fits(*d)),
                format!("{} (f32) or {} (f64)", sizes[0], sizes[1]),
            ),
            Some(format) => {
                let double = format == NumberFormat::F64;
                let name = ["f32", "f64"][usize::from(double)];
                let wanted = format!("{} ({name})", sizes[usize::from(double)]);
                (fits(double).then_some(double), wanted)
            }
        };
        match found {
            Some(double) if bytes > 0 => Ok(ArrayFile {
                path: path.to_path_buf(),
                n: sizes[0] / 4,
                double,
            }),
            _ => Err(Error::input(format!(
                "{file} has {bytes} bytes where {wanted} were expected for {all} numbers"
            ))),
        }
    }

    /// Least and greatest value.
    pub fn range(&self) -> Result<[f64; 2]> {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let each = |value| range = widen(range, value);
        self.reader()?.read(0, self.n, each)?;
        Ok(range)
    }

    pub fn reader(&self) -> Result<ArrayReader<'_>> {
        Ok(ArrayReader {
            array: self,
            file: open(&self.path)?.0,
            bytes: Vec::new(),
        })
    }
}

/// An array being read.
pub(crate) struct ArrayReader<'a> {
    array: &'a ArrayFile,
    file: File,
    bytes: Vec<u8>,
}

impl ArrayReader<'_> {
    /// Calls `each` with the `n` numbers from number `first` on.
    pub fn read(&mut self, first: usize, n: usize, mut each: impl FnMut(f64)) -> Result<()> {
        let width = if self.array.double { 8 } else { 4 };
        let path = &self.array.path;
        let fail = |e: std::io::Error| {
            let file = path.display();
            Error::input(format!("{file} cannot be read any more")).because(e)
        };
        let start = SeekFrom::Start((first * width) as u64);
        self.file.seek(start).map_err(fail)?;
        let mut left = n * width;
        while left > 0 {
            self.bytes.resize(left.min(PIECE), 0);
            self.file.read_exact(&mut self.bytes).map_err(fail)?;
            left -= self.bytes.len();
            for b in self.bytes.chunks_exact(width) {
                each(match *b {
                    [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
                    _ => f64::from_le_bytes(b.try_into().expect("eight bytes")),
                });
            }
        }
        Ok(())
    }
}
