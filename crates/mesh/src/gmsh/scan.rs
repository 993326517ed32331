//! The bytes of a file as numbers, words and sections; messages name the place.

use crate::file::FARTHEST;
use crate::Digits;
use base::{Error, Location, Result};

/// How numbers stand in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// As words.
    Text,
    /// As bytes, the least significant first.
    Little,
    /// As bytes, the most significant first.
    Big,
}

/// The bytes that a whole number takes in a binary file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Width {
    Four,
    Eight,
}

/// A file, read from its beginning to its end.
pub(super) struct Scan<'a> {
    name: &'a str,
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
    /// The digits of the coordinates so far.
    pub digits: Digits,
}

impl<'a> Scan<'a> {
    pub fn new(name: &'a str, bytes: &'a [u8]) -> Scan<'a> {
        Scan {
            name,
            bytes,
            at: 0,
            encoding: Encoding::Text,
            digits: Digits::default(),
        }
    }

    /// How numbers stand from here on.
    pub fn encode(&mut self, encoding: Encoding) {
        self.encoding = encoding;
    }

    /// Whether numbers are words.
    pub fn is_text(&self) -> bool {
        self.encoding == Encoding::Text
    }

    /// The place of the next number, for [`Scan::fail`]: that of the next word in a text, of the next byte elsewhere.
    pub fn at(&self) -> usize {
        let white = match self.encoding {
            Encoding::Text => self.white(),
            _ => 0,
        };
        self.at + white
    }

    /// An error at a place: the message begins with the file and the line, or the byte in a binary file.
    pub fn fail(&self, at: usize, message: impl std::fmt::Display) -> Error {
        Error::input(message.to_string()).at(self.location(at))
    }

    /// An error of the file as a whole.
    pub fn fail_whole(&self, message: impl std::fmt::Display) -> Error {
        Error::input(message.to_string()).at(Location::file_named(self.name))
    }

    /// A place as errors carry it.
    pub fn location(&self, at: usize) -> Location {
        match self.encoding {
            Encoding::Text => Location::line_in_words(self.name, self.line_number(at)),
            _ => Location::byte(self.name, at),
        }
    }

    /// A place in words.
    pub fn place(&self, at: usize) -> String {
        match self.encoding {
            Encoding::Text => format!("line {}", self.line_number(at)),
            _ => format!("byte {at}"),
        }
    }

    fn line_number(&self, at: usize) -> usize {
        let before = &self.bytes[..at.min(self.bytes.len())];
        1 + before.iter().filter(|&&b| b == b'\n').count()
    }

    /// All bytes of the file.
    pub fn length(&self) -> usize {
        self.bytes.len()
    }

    /// The bytes that are left.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// A whole number.
    pub fn whole(&mut self, width: Width, what: &str) -> Result<i64> {
        let big = match self.encoding {
            Encoding::Text => return self.word_as(what, "a whole number"),
            encoding => encoding == Encoding::Big,
        };
        Ok(match width {
            Width::Four => {
                let bytes = self.take::<4>(what)?;
                i64::from(if big {
                    i32::from_be_bytes(bytes)
                } else {
                    i32::from_le_bytes(bytes)
                })
            }
            Width::Eight => {
                let bytes = self.take::<8>(what)?;
                if big {
                    i64::from_be_bytes(bytes)
                } else {
                    i64::from_le_bytes(bytes)
                }
            }
        })
    }

    /// A whole number that is not negative, such as that of a node.
    pub fn number(&mut self, width: Width, what: &str) -> Result<u64> {
        let at = self.at();
        let number = self.whole(width, what)?;
        u64::try_from(number).map_err(|_| {
            self.fail(
                at,
                format!("found {number} where {what} was expected, which is not negative"),
            )
        })
    }

    /// A number of things that follow, each of at least `least` bytes; not more than the file can hold.
    pub fn count(&mut self, width: Width, what: &str, least: usize) -> Result<usize> {
        let at = self.at();
        let number = self.number(width, what)?;
        self.plausible(at, number, what, least)
    }

    /// As [`Scan::count`], from a line of its own, which is text in binary files, too.
    pub fn count_line(&mut self, what: &str, least: usize) -> Result<usize> {
        let (at, line) = self.line();
        let number = parse(line).ok_or_else(|| {
            self.fail(
                at,
                format!("found {} where {what} was expected", quoted(line)),
            )
        })?;
        self.plausible(at, number, what, least)
    }

    fn plausible(&self, at: usize, number: u64, what: &str, least: usize) -> Result<usize> {
        let fits = usize::try_from(number).ok().filter(|&n| {
            n < u32::MAX as usize && n.checked_mul(least).is_some_and(|b| b <= self.left())
        });
        fits.ok_or_else(|| {
            let left = self.left();
            self.fail(
                at,
                format!(
                    "{what} is {number}, but the {left} bytes that are left cannot hold as many"
                ),
            )
        })
    }

    /// A real number, which need not be finite.
    pub fn real(&mut self, what: &str) -> Result<f64> {
        match self.encoding {
            Encoding::Text => self.word_as(what, "a number"),
            Encoding::Little => Ok(f64::from_le_bytes(self.take::<8>(what)?)),
            Encoding::Big => Ok(f64::from_be_bytes(self.take::<8>(what)?)),
        }
    }

    /// The coordinates of a point; all are finite, and none is beyond all units.
    pub fn point(&mut self) -> Result<[f64; 3]> {
        let mut point = [0.0; 3];
        for (x, axis) in point.iter_mut().zip(["x", "y", "z"]) {
            let at = self.at();
            *x = self.real("a coordinate")?;
            if self.is_text() {
                self.digits.see(&self.bytes[at..self.at]);
            }
            let expected = match *x {
                x if !x.is_finite() => "which is finite".into(),
                x if x.abs() > FARTHEST => format!("at most {FARTHEST:e} (take other units)"),
                _ => continue,
            };
            return Err(self.fail(
                at,
                format!(
                    "found {x:e} where the coordinate {axis} of a node was expected, {expected}"
                ),
            ));
        }
        Ok(point)
    }

    /// The next word as a number.
    fn word_as<T: std::str::FromStr>(&mut self, what: &str, kind: &str) -> Result<T> {
        self.at += self.white();
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let word = &rest[..end.unwrap_or(rest.len())];
        if word.is_empty() {
            return Err(self.ends(what));
        }
        let number = parse(word).ok_or_else(|| {
            self.fail(
                self.at,
                format!("found {} where {what} was expected, {kind}", quoted(word)),
            )
        })?;
        self.at += word.len();
        Ok(number)
    }

    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N]> {
        let found = self.bytes[self.at..].first_chunk::<N>();
        let bytes = *found.ok_or_else(|| self.ends(what))?;
        self.at += N;
        Ok(bytes)
    }

    fn ends(&self, what: &str) -> Error {
        self.fail(
            self.bytes.len(),
            format!("the file ends where {what} was expected"),
        )
    }

    /// How many white bytes follow.
    fn white(&self) -> usize {
        let rest = &self.bytes[self.at..];
        rest.iter()
            .position(|b| !b.is_ascii_whitespace())
            .unwrap_or(rest.len())
    }

    /// The rest of the line without the space at its ends, and where it begins. The next is read after the line.
    pub fn line(&mut self) -> (usize, &'a [u8]) {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&b| b == b'\n');
        let line = rest[..end.unwrap_or(rest.len())].trim_ascii_start();
        let at = end.unwrap_or(rest.len()) - line.len() + self.at;
        self.at += end.map_or(rest.len(), |n| n + 1);
        (at, line.trim_ascii_end())
    }

    /// The name of the section that begins here and its place; `None` at the end of the file.
    pub fn section(&mut self) -> Result<Option<(usize, &'a str)>> {
        self.at += self.white();
        if self.left() == 0 {
            return Ok(None);
        }
        let (at, line) = self.line();
        let name = line.strip_prefix(b"$").filter(|n| !n.starts_with(b"End"));
        let name = name.and_then(|n| std::str::from_utf8(n).ok());
        match name.filter(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_graphic())) {
            Some(name) => Ok(Some((at, name))),
            None => Err(self.fail(
                at,
                format!(
                    "found {} where a section such as $Nodes was expected",
                    quoted(line)
                ),
            )),
        }
    }

    /// The end of a section that was read.
    pub fn end(&mut self, section: &str) -> Result<()> {
        self.at += self.white();
        let (at, line) = self.line();
        let (start, name) = line.split_at(line.len().min(4));
        if start == b"$End" && name == section.as_bytes() {
            return Ok(());
        }
        Err(if line.is_empty() {
            self.ends(&format!("$End{section}"))
        } else {
            self.fail(
                at,
                format!("found {} where $End{section} was expected", quoted(line)),
            )
        })
    }

    /// Passes over the rest of a section that is not read.
    pub fn skip(&mut self, at: usize, section: &str) -> Result<()> {
        let end = format!("$End{section}");
        let rest = &self.bytes[self.at..];
        let found = (0..rest.len()).find(|&k| {
            // Numbers of a binary section may end without a new line.
            rest[k] == b'$' && rest[k..].starts_with(end.as_bytes()) && {
                let after = rest.get(k + end.len());
                after.is_none_or(u8::is_ascii_whitespace)
            }
        });
        let Some(k) = found else {
            let message = format!("the section ${section} begins here, and {end} is missing");
            return Err(self.fail(at, message));
        };
        self.at += k + end.len();
        Ok(())
    }
}

/// The number that a word is.
fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The bytes that were found, in a form that can be printed: their beginning, in quotes.
pub(super) fn quoted(found: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(&found[..found.len().min(4 * MOST)]);
    let start: String = text.chars().take(MOST).collect();
    let dots = if start.len() < text.len() { "…" } else { "" };
    format!("\"{}{dots}\"", start.escape_debug())
}
