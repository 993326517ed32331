//! The entries of a scene that make rows, by their numbers.

use base::Location;
use std::fmt;

/// An entry that makes rows, by its place among those of its kind. Surfaces have been replaced by bodies and sides
/// before, so that a contact between surfaces is as many entries as it has pairs of bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EntryId {
    /// An entry of `[[tie]]`.
    Tie(usize),
    /// An entry of `[[contact]]`, or a pair that `[contact] auto` has found.
    Contact(usize),
    /// An entry of `[[obstacle]]`.
    Obstacle(usize),
    /// An equation between displacements.
    Equation(usize),
}

impl EntryId {
    /// Its name for the middle of a sentence: by the place where it was written, or by its number if a program has
    /// built it.
    pub(crate) fn named(self, location: Option<&Location>) -> String {
        match location.and_then(Location::place) {
            Some(place) => format!("the {} of {place}", self.what()),
            None => self.to_string(),
        }
    }

    /// The word for its kind.
    pub fn what(self) -> &'static str {
        match self {
            EntryId::Tie(_) => "tie",
            EntryId::Contact(_) => "contact",
            EntryId::Obstacle(_) => "obstacle",
            EntryId::Equation(_) => "equation",
        }
    }
}

impl fmt::Display for EntryId {
    /// As in "contact 2", counted from 1.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (EntryId::Tie(k) | EntryId::Contact(k) | EntryId::Obstacle(k) | EntryId::Equation(k)) =
            self;
        write!(out, "{} {}", self.what(), k + 1)
    }
}
