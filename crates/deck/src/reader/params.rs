//! The parameters of a keyword line: each is asked for, and those that nobody asked for are an error.

use super::base::title;
use crate::cards::Card;
use crate::deck_line::Files;
use crate::numbers::{clip, real, whole};
use base::Result;

/// Names have at most that many letters.
const LONGEST_NAME: usize = 80;

pub(super) struct Params<'a> {
    card: &'a Card,
    files: &'a Files,
    used: Vec<bool>,
}

impl<'a> Params<'a> {
    pub fn new(card: &'a Card, files: &'a Files) -> Params<'a> {
        Params {
            card,
            files,
            used: vec![false; card.params.len()],
        }
    }

    /// The value of the parameter, empty if it has none.
    pub fn value(&mut self, name: &str) -> Option<&'a str> {
        let mut found = None;
        for (p, used) in self.card.params.iter().zip(&mut self.used) {
            if p.name == name {
                *used = true;
                found = found.or(Some(p.value.as_str()));
            }
        }
        found
    }

    /// Whether the parameter is there.
    pub fn flag(&mut self, name: &str) -> bool {
        self.value(name).is_some()
    }

    /// Parameters that change nothing here.
    pub fn skip(&mut self, names: &[&str]) {
        for name in names {
            self.value(name);
        }
    }

    /// Parameters that are not supported.
    pub fn refuse(&mut self, names: &[&str], reason: &str) -> Result<()> {
        for name in names {
            if self.flag(name) {
                return self.error(format!("{name}: {reason}"));
            }
        }
        Ok(())
    }

    /// The value of the parameter, a name.
    pub fn name(&mut self, name: &str) -> Result<Option<&'a str>> {
        match self.value(name) {
            Some("") => self.error(format!("{name}= needs a name")),
            // Of a set of an instance both names are as long.
            Some(value) if value.split('.').any(|v| v.chars().count() > LONGEST_NAME) => self
                .error(format!(
                    "the name '{}' is longer than {LONGEST_NAME} letters",
                    clip(value)
                )),
            value => Ok(value),
        }
    }

    /// The value of the parameter, a name that must be there.
    pub fn required(&mut self, name: &str) -> Result<&'a str> {
        match self.name(name)? {
            Some(value) => Ok(value),
            None => self.error(format!("the parameter {name}= is missing")),
        }
    }

    /// The value of the parameter, a number.
    pub fn real(&mut self, name: &str) -> Result<Option<f64>> {
        match self.value(name) {
            None => Ok(None),
            Some(value) => match real(value) {
                Some(x) => Ok(Some(x)),
                None => self.error(format!("{name}= needs a number, not '{}'", clip(value))),
            },
        }
    }

    /// The value of the parameter, a whole number.
    pub fn whole(&mut self, name: &str) -> Result<Option<u64>> {
        match self.value(name) {
            None => Ok(None),
            Some(value) => match whole(value) {
                Some(x) => Ok(Some(x)),
                None => self.error(format!(
                    "{name}= needs a whole number, not '{}'",
                    clip(value)
                )),
            },
        }
    }

    /// The error if there are parameters that nobody asked for.
    pub fn done(self) -> Result<()> {
        match self.used.iter().position(|used| !used) {
            Some(k) => {
                let name = clip(&self.card.params[k].name);
                self.error(format!("the parameter {name} is not supported"))
            }
            None => Ok(()),
        }
    }

    /// The error at the keyword line.
    pub fn error<T>(&self, message: impl AsRef<str>) -> Result<T> {
        let message = format!("{}: {}", title(self.card), message.as_ref());
        Err(self.files.error(self.card.place, message))
    }
}
