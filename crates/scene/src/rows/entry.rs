//! An entry of [[tie]] or [[contact]], and its name in messages.

use crate::body::Body;
use crate::model::joints::{ContactSpec, Extent, PairSelector, TieSpec};
use crate::model::profile::Profile;
use base::Location;

/// One entry, a tie or a contact.
#[derive(Clone, Copy)]
pub(crate) struct Entry<'a> {
    pub pair: &'a PairSelector,
    pub extent: &'a Extent,
    pub location: Option<&'a Location>,
    /// The data of a contact; `None`: a tie.
    pub contact: Option<ContactData<'a>>,
    /// Its number, ties before contacts, if it names the sides: it applies to the interface of these sides only.
    pub own: Option<usize>,
}

/// The data of a contact beyond its nodes.
#[derive(Clone, Copy)]
pub(crate) struct ContactData<'a> {
    pub gap: &'a Profile,
    /// Number of the entry, `None` for the default.
    pub number: Option<usize>,
}

impl<'a> Entry<'a> {
    pub fn tie(number: usize, spec: &'a TieSpec) -> Entry<'a> {
        Entry {
            pair: &spec.pair,
            extent: &spec.extent,
            location: Some(&spec.location),
            contact: None,
            own: spec.sides.map(|_| number),
        }
    }

    /// Contact `number`, after `ties` ties.
    pub fn contact(ties: usize, number: usize, spec: &'a ContactSpec) -> Entry<'a> {
        Entry {
            pair: &spec.pair,
            extent: &spec.extent,
            location: Some(&spec.location),
            contact: Some(ContactData {
                gap: &spec.gap,
                number: Some(number),
            }),
            own: spec.sides.map(|_| ties + number),
        }
    }

    /// "tie" or "contact".
    pub fn what(&self) -> &'static str {
        match self.contact {
            None => "tie",
            Some(_) => "contact",
        }
    }

    /// The place where it was written, for the middle of a sentence.
    pub fn line(&self) -> String {
        let place = self.location.and_then(Location::place);
        place.unwrap_or_else(|| "another entry".into())
    }
}

/// Two bodies in messages, or the two sides of one that touches itself.
pub(crate) fn both(a: &str, b: &str) -> String {
    if a == b {
        format!("both sides of body `{a}`")
    } else {
        format!("bodies `{a}` and `{b}`")
    }
}

/// The first few names, for messages.
pub(crate) fn some_names(bodies: &[Body]) -> String {
    let mut names: Vec<String> = bodies
        .iter()
        .take(6)
        .map(|b| format!("`{}`", b.spec.name))
        .collect();
    if bodies.len() > 6 {
        names.push("…".into());
    }
    names.join(", ")
}
