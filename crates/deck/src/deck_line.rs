//! Where something stands in the files of a deck, and what stood there and was not taken as it is.

use base::{Error, Location};

/// A line of a deck, or of a file that it includes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct DeckLine {
    /// The file, as a place in [`Deck::files`](super::Deck::files).
    pub file: u32,
    /// The line, from 1.
    pub line: u32,
}

/// A keyword that does not do here what it does in CalculiX.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// The keyword, such as "*EL PRINT".
    pub keyword: String,
    /// Where it stands.
    pub place: DeckLine,
    /// Why it is ignored, or by what it is replaced.
    pub reason: String,
}

/// The names of the files of a deck.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Files(pub Vec<String>);

impl Files {
    /// The place in words, such as "bracket.inp, line 12".
    pub fn at(&self, place: DeckLine) -> String {
        self.location(place).place().unwrap_or_default()
    }

    /// The place as errors carry it.
    pub fn location(&self, place: DeckLine) -> Location {
        let name = self.0.get(place.file as usize).map_or("", String::as_str);
        Location::line_in_words(name, place.line as usize)
    }

    /// The error at this place.
    pub fn error(&self, place: DeckLine, message: impl AsRef<str>) -> Error {
        Error::input(message.as_ref()).at(self.location(place))
    }
}
