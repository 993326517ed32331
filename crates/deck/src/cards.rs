//! A deck as cards: keyword lines with their parameters, and the data lines below them.
//!
//! Blanks count nowhere, the case of letters only in names of files. Lines that begin with `**` are comments. A
//! keyword line that ends with a comma goes on in the next line if that line has a parameter.

use super::deck_line::{DeckLine, Files};
use base::{Error, Result};
use std::ops::Range;

/// How deep files may include each other, as in CalculiX.
const MOST_LEVELS: usize = 9;
/// How many files may be included. More is a mistake, and files that include others twice grow exponentially.
const MOST_FILES: usize = 1000;

/// A parameter of a keyword line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Param {
    /// In capitals, without blanks.
    pub name: String,
    /// In capitals, without blanks and quotes; empty if there is none.
    pub value: String,
}

/// A keyword line with its data lines.
#[derive(Debug, Clone)]
pub(super) struct Card {
    /// In capitals, without the asterisk and without blanks.
    pub keyword: String,
    pub place: DeckLine,
    pub params: Vec<Param>,
    /// Its data lines, as places among the lines of the deck.
    data: Range<usize>,
}

impl Card {
    pub fn new(keyword: &str, place: DeckLine, params: Vec<Param>, data: Range<usize>) -> Card {
        Card {
            keyword: keyword.into(),
            place,
            params,
            data,
        }
    }

    /// This card with other parameters and other lines.
    pub fn with(&self, params: Vec<Param>, data: Range<usize>) -> Card {
        Card::new(&self.keyword, self.place, params, data)
    }

    /// Its data lines, as places among the lines of the deck.
    pub fn lines(&self) -> Range<usize> {
        self.data.clone()
    }
}

/// A line that is neither empty nor a comment.
#[derive(Debug, Clone)]
pub(super) struct SourceLine {
    place: DeckLine,
    /// The text in which it is: that of its file, or one that was made of it.
    text: u32,
    bytes: Range<usize>,
}

/// The text of a deck with everything that it includes.
#[derive(Debug)]
pub(super) struct Cards {
    pub files: Files,
    texts: Vec<String>,
    lines: Vec<SourceLine>,
    pub cards: Vec<Card>,
    /// One unit in the last digit of coordinates that were written otherwise than they stand here; 0 if there are none.
    pub resolution: f64,
}

/// The cards and lines that take the place of the cards of a deck.
pub(super) struct Flattened {
    pub lines: Vec<SourceLine>,
    /// The text in which the lines are.
    pub text: String,
    pub cards: Vec<Card>,
    pub resolution: f64,
}

/// A data line, cut at its commas.
#[derive(Debug, Clone)]
pub(super) struct DataLine<'a> {
    pub place: DeckLine,
    pub fields: Vec<&'a str>,
}

impl Cards {
    /// Cuts the deck `text` into cards; `include` reads the files that it includes.
    pub fn new(
        name: &str,
        text: &[u8],
        include: &dyn Fn(&str) -> Result<Vec<u8>>,
    ) -> Result<Cards> {
        let mut cards = Cards {
            files: Files(vec![name.to_string()]),
            texts: vec![decode(name, text)?],
            lines: Vec::new(),
            cards: Vec::new(),
            resolution: 0.0,
        };
        cards.read_lines(include)?;
        cards.group()?;
        Ok(cards)
    }

    /// Number of lines that count.
    pub fn lines(&self) -> usize {
        self.lines.len()
    }

    /// The data lines of `card`.
    pub fn rows<'a>(&'a self, card: &Card) -> impl Iterator<Item = DataLine<'a>> + 'a {
        card.data.clone().map(|l| self.row(l))
    }

    /// Line `l`, for cards that are [`rewritten`](Self::rewritten).
    pub fn line_of(&self, l: usize) -> SourceLine {
        self.lines[l].clone()
    }

    /// A line of the text of cards that are rewritten, in the place of one at `place`.
    pub fn new_line(&self, place: DeckLine, bytes: Range<usize>) -> SourceLine {
        let text = self.texts.len() as u32;
        SourceLine { place, text, bytes }
    }

    /// Other cards in the place of these, with their lines, and the text of those that are new.
    pub fn rewritten(mut self, flat: Flattened) -> Cards {
        self.texts.push(flat.text);
        (self.lines, self.cards) = (flat.lines, flat.cards);
        self.resolution = flat.resolution;
        self
    }

    /// Collects the lines that count, those of included files where these are included.
    fn read_lines(&mut self, include: &dyn Fn(&str) -> Result<Vec<u8>>) -> Result<()> {
        // The files that are open: which, the bytes that are read, the lines that are read.
        let mut open = vec![(0, 0, 0_u32)];
        let mut heading = false;
        while let Some((file, start, number)) = open.last_mut() {
            let text = &self.texts[*file];
            if *start >= text.len() {
                open.pop();
                continue;
            }
            let end = text[*start..].find('\n').map_or(text.len(), |n| *start + n);
            let line = &text[*start..end];
            let trimmed = line.trim();
            let from = *start + (line.len() - line.trim_start().len());
            *start = end + 1;
            *number = number.checked_add(1).ok_or_else(|| {
                Error::input(format!("{} has too many lines", self.files.0[*file]))
            })?;
            let place = DeckLine {
                file: *file as u32,
                line: *number,
            };
            let keyword = trimmed.starts_with('*');
            if trimmed.is_empty() || trimmed.starts_with("**") || (heading && !keyword) {
                continue;
            }
            if keyword {
                let word = squeeze(trimmed[1..].split(',').next().unwrap_or_default());
                heading = word == "HEADING";
                if word == "INCLUDE" {
                    let wanted = self.included(trimmed, place)?;
                    let cyclic = open.iter().any(|o| self.files.0[o.0] == wanted);
                    if cyclic {
                        let message = format!("{wanted} includes itself");
                        return Err(self.files.error(place, message));
                    }
                    if open.len() > MOST_LEVELS || self.texts.len() > MOST_FILES {
                        let message = format!(
                            "too many included files: at most {MOST_LEVELS} within each other, {MOST_FILES} in all"
                        );
                        return Err(self.files.error(place, message));
                    }
                    let bytes = include(&wanted).map_err(|e| {
                        self.files
                            .error(place, format!("{wanted} cannot be included: {e}"))
                    })?;
                    self.texts.push(decode(&wanted, &bytes)?);
                    self.files.0.push(wanted);
                    open.push((self.texts.len() - 1, 0, 0));
                    continue;
                }
            }
            self.lines.push(SourceLine {
                place,
                text: place.file,
                bytes: from..from + trimmed.len(),
            });
        }
        Ok(())
    }

    /// The file that an *INCLUDE line names.
    fn included(&self, line: &str, place: DeckLine) -> Result<String> {
        let value = line
            .split(',')
            .skip(1)
            .filter_map(|p| p.split_once('='))
            .find(|(name, _)| squeeze(name) == "INPUT")
            .map(|(_, value)| value.trim().trim_matches('"').trim().to_string());
        match value {
            Some(value) if !value.is_empty() => Ok(value),
            _ => Err(self
                .files
                .error(place, "*INCLUDE needs INPUT=, the name of a file")),
        }
    }

    /// Groups the lines to cards.
    fn group(&mut self) -> Result<()> {
        let mut l = 0;
        while l < self.lines.len() {
            let place = self.lines[l].place;
            let mut keyword_line = self.line(l).to_string();
            if !keyword_line.starts_with('*') {
                let message =
                    "a line of data that belongs to no keyword; decks begin with a keyword such as *NODE";
                return Err(self.files.error(place, message));
            }
            l += 1;
            while keyword_line.ends_with(',') && l < self.lines.len() && continues(self.line(l)) {
                keyword_line.push_str(self.line(l));
                l += 1;
            }
            let start = l;
            while l < self.lines.len() && !self.line(l).starts_with('*') {
                l += 1;
            }
            let mut parts = split_outside_quotes(&keyword_line[1..]).into_iter();
            let keyword = squeeze(parts.next().unwrap_or_default());
            let params = parts.filter(|p| !p.trim().is_empty()).map(param).collect();
            self.cards.push(Card {
                keyword,
                place,
                params,
                data: start..l,
            });
        }
        Ok(())
    }

    fn line(&self, l: usize) -> &str {
        let line = &self.lines[l];
        &self.texts[line.text as usize][line.bytes.clone()]
    }

    /// Data line `l`, without the empty fields at its end.
    pub fn row(&self, l: usize) -> DataLine<'_> {
        let mut fields: Vec<&str> = self.line(l).split(',').map(str::trim).collect();
        while fields.last().is_some_and(|f| f.is_empty()) {
            fields.pop();
        }
        DataLine {
            place: self.lines[l].place,
            fields,
        }
    }
}

/// The text of a file. What is not UTF-8 is read as Latin-1: such letters stand in comments, as a rule.
fn decode(name: &str, bytes: &[u8]) -> Result<String> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.contains(&0) {
        let message =
            format!("{name} is no deck of Abaqus or CalculiX: it has bytes that no text has");
        return Err(Error::input(message));
    }
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => text.to_string(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    })
}

/// Whether a line goes on with the parameters of the keyword line before it.
fn continues(line: &str) -> bool {
    !line.starts_with('*') && (line.contains('=') || squeeze(line) == "GENERATE")
}

/// In capitals and without blanks, as names are compared.
pub(super) fn squeeze(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_whitespace())
        .map(|c| c.to_ascii_uppercase())
        .collect()
}

/// The parts between the commas that are not within quotes.
fn split_outside_quotes(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut start, mut quoted) = (0, false);
    for (k, c) in text.char_indices() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => {
                parts.push(&text[start..k]);
                start = k + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

fn param(part: &str) -> Param {
    let (name, value) = part.split_once('=').unwrap_or((part, ""));
    Param {
        name: squeeze(name),
        value: squeeze(value).replace('"', ""),
    }
}

#[cfg(test)]
#[path = "../tests/cards.rs"]
mod tests;
