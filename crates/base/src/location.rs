//! The place of an error: file, line, key and bodies.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

/// The place of an error, as far as it is known. [`Display`](fmt::Display) writes it as sentences begin with it:
/// `plate.toml:12: `, `bracket.inp, line 12: `; nothing if there is no file. Keys and bodies are named by the sentence
/// itself.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Location {
    file: Option<String>,
    line: Option<usize>,
    /// In binary files, in place of a line.
    byte: Option<usize>,
    /// Whether line or byte are told in words.
    words: bool,
    key: Option<String>,
    bodies: Vec<String>,
}

impl Location {
    /// The file `name` as a whole.
    pub fn file_named(name: impl Into<String>) -> Location {
        Location {
            file: Some(name.into()),
            ..Location::default()
        }
    }

    /// A line, from 1, told as compilers do: `plate.toml:12`.
    pub fn line(file: impl Into<String>, line: usize) -> Location {
        Location {
            line: Some(line),
            ..Location::file_named(file)
        }
    }

    /// A line, from 1, told in words: `bracket.inp, line 12`.
    pub fn line_in_words(file: impl Into<String>, line: usize) -> Location {
        Location {
            words: true,
            ..Location::line(file, line)
        }
    }

    /// A byte, from 0, of a binary file.
    pub fn byte(file: impl Into<String>, byte: usize) -> Location {
        Location {
            byte: Some(byte),
            ..Location::file_named(file)
        }
    }

    /// This place, at the value of `key`.
    pub fn with_key(&self, key: impl Into<String>) -> Location {
        Location {
            key: Some(key.into()),
            ..self.clone()
        }
    }

    /// This place, at the body of this name, beside those that it has.
    pub fn with_body(&self, body: impl Into<String>) -> Location {
        let mut location = self.clone();
        location.bodies.push(body.into());
        location
    }

    /// The name of the file.
    pub fn file(&self) -> Option<&str> {
        self.file.as_deref()
    }

    /// The line, from 1.
    pub fn line_number(&self) -> Option<usize> {
        self.line
    }

    /// The byte of a binary file, from 0.
    pub fn byte_number(&self) -> Option<usize> {
        self.byte
    }

    /// The key of a scene.
    pub fn key(&self) -> Option<&str> {
        self.key.as_deref()
    }

    /// The name of the body; the first one if there are several.
    pub fn body(&self) -> Option<&str> {
        self.bodies.first().map(String::as_str)
    }

    /// The names of the bodies.
    pub fn bodies(&self) -> &[String] {
        &self.bodies
    }

    /// The file with its line or byte, without a colon behind it; `None` without a file.
    pub fn place(&self) -> Option<String> {
        let file = on_one_line(self.file()?);
        Some(match (self.line, self.byte) {
            (Some(line), _) if self.words => format!("{file}, line {line}"),
            (Some(line), _) => format!("{file}:{line}"),
            (None, Some(byte)) => format!("{file}, byte {byte}"),
            (None, None) => file.into_owned(),
        })
    }
}

impl From<&Location> for Location {
    fn from(location: &Location) -> Location {
        location.clone()
    }
}

impl From<Option<&Location>> for Location {
    fn from(location: Option<&Location>) -> Location {
        location.cloned().unwrap_or_default()
    }
}

impl fmt::Display for Location {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = self.place() {
            write!(out, "{place}: ")?;
        }
        Ok(())
    }
}

/// The text with its control characters escaped.
pub fn on_one_line(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return text.into();
    }
    let shown = |c: char| {
        if c.is_control() {
            c.escape_default().to_string()
        } else {
            c.to_string()
        }
    };
    text.chars().map(shown).collect()
}
