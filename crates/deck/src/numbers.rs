//! Numbers as Fortran writes them, and fields of data lines.

use super::cards::DataLine;
use super::deck_line::Files;
use base::Result;

/// A finite number: `1`, `-1.5`, `.5`, `1.e5`, `1.D+5`, `1.5+3` (exponents need no letter).
pub(super) fn real(text: &str) -> Option<f64> {
    let mut plain = String::with_capacity(text.len() + 1);
    let mut exponent = false;
    for c in text.chars() {
        match c {
            '0'..='9' | '.' => plain.push(c),
            'e' | 'E' | 'd' | 'D' => {
                exponent = true;
                plain.push('e');
            }
            '+' | '-' => {
                if !exponent && plain.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
                    exponent = true;
                    plain.push('e');
                }
                plain.push(c);
            }
            _ => return None,
        }
    }
    plain.parse().ok().filter(|x: &f64| x.is_finite())
}

/// A whole number that is not negative.
pub(super) fn whole(text: &str) -> Option<u64> {
    let digits = text.strip_prefix('+').unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    digits.parse().ok()
}

/// Whether a field is a number rather than a name.
pub(super) fn is_whole(text: &str) -> bool {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
}

impl DataLine<'_> {
    /// Field `k`, empty if there is none.
    pub fn field(&self, k: usize) -> &str {
        self.fields.get(k).copied().unwrap_or("")
    }

    /// Field `k` as a number; `what` it is says the message.
    pub fn real(&self, files: &Files, k: usize, what: &str) -> Result<f64> {
        real(self.field(k)).ok_or_else(|| {
            let found = self.found(k);
            files.error(self.place, format!("{what} is expected, a number, {found}"))
        })
    }

    /// Field `k` as a number, `default` if it is empty.
    pub fn real_or(&self, files: &Files, k: usize, default: f64, what: &str) -> Result<f64> {
        match self.field(k) {
            "" => Ok(default),
            _ => self.real(files, k, what),
        }
    }

    /// Three numbers from field `k` on.
    pub fn vector(&self, files: &Files, k: usize, what: &str) -> Result<[f64; 3]> {
        Ok([
            self.real(files, k, what)?,
            self.real(files, k + 1, what)?,
            self.real(files, k + 2, what)?,
        ])
    }

    /// Field `k` as a whole number that is not negative.
    pub fn whole(&self, files: &Files, k: usize, what: &str) -> Result<u64> {
        whole(self.field(k)).ok_or_else(|| {
            let found = self.found(k);
            files.error(
                self.place,
                format!("{what} is expected, a whole number, {found}"),
            )
        })
    }

    /// The error if there are more than `most` fields.
    pub fn at_most(&self, files: &Files, most: usize, what: &str) -> Result<()> {
        if self.fields.len() <= most {
            return Ok(());
        }
        let message = format!(
            "{what} has {most} fields at most, but {} stand here",
            self.fields.len()
        );
        Err(files.error(self.place, message))
    }

    fn found(&self, k: usize) -> String {
        match self.field(k) {
            "" => format!("but field {} is empty", k + 1),
            text => format!("but field {} is '{}'", k + 1, clip(text)),
        }
    }
}

/// A text for a message: its beginning, if it is long.
pub(super) fn clip(text: &str) -> String {
    const MOST: usize = 40;
    if text.chars().count() <= MOST {
        return text.to_string();
    }
    text.chars().take(MOST).chain("...".chars()).collect()
}

#[cfg(test)]
#[path = "../tests/numbers.rs"]
mod tests;
