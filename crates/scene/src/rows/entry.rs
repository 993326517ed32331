//! An entry of [[tie]] or [[contact]], and its name in messages.

use crate::body::Body;
use crate::model::entry::EntryId;
use crate::model::joints::{ContactSpec, Extent, PairSelector, TieSpec};
use crate::model::profile::Profile;
use base::Location;

/// One entry, a tie or a contact.
#[derive(Clone, Copy)]
pub(crate) struct Entry<'a> {
    pub pair: &'a PairSelector,
    pub extent: &'a Extent,
    pub location: Option<&'a Location>,
    /// The gap of a contact; `None`: a tie.
    pub gap: Option<&'a Profile>,
    /// Which one it is, `None` for the default.
    pub id: Option<EntryId>,
    /// Whether it names the sides, or the nodes: it applies to the interface of these only.
    pub names_sides: bool,
}

impl<'a> Entry<'a> {
    pub fn tie(number: usize, spec: &'a TieSpec) -> Entry<'a> {
        Entry {
            pair: &spec.pair,
            extent: &spec.extent,
            location: Some(&spec.location),
            gap: None,
            id: Some(EntryId::Tie(number)),
            names_sides: spec.sides.is_some(),
        }
    }

    pub fn contact(number: usize, spec: &'a ContactSpec) -> Entry<'a> {
        Entry {
            pair: &spec.pair,
            extent: &spec.extent,
            location: Some(&spec.location),
            gap: Some(&spec.gap),
            id: Some(EntryId::Contact(number)),
            names_sides: spec.sides.is_some() || spec.opposed.is_some(),
        }
    }

    /// Whether it is a contact, and no tie.
    pub fn is_contact(&self) -> bool {
        self.gap.is_some()
    }

    /// "tie" or "contact".
    pub fn what(&self) -> &'static str {
        if self.is_contact() {
            "contact"
        } else {
            "tie"
        }
    }

    /// Its name for the middle of a sentence.
    pub fn named(&self) -> String {
        match self.id {
            Some(id) => id.named(self.location),
            None => format!("the {} by default", self.what()),
        }
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
