//! The meaning of fields of data lines and parameters that stand in an instance or in the assembly.

use std::collections::HashMap;

use crate::cards::squeeze;
use crate::numbers::{is_whole, whole};

/// Nodes or elements.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Of {
    Nodes,
    Cells,
}

/// Numbers that are added to those of an instance: to its nodes', to its elements'.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Offsets(pub [u64; 2]);

impl Offsets {
    pub fn of(self, what: Of) -> u64 {
        self.0[what as usize]
    }
}

/// The meaning of names and numbers in the whole deck.
#[derive(Default)]
pub(super) struct DeckNames<'a> {
    /// The numbers that are added, by instance.
    pub instances: HashMap<&'a str, Offsets>,
    /// The name of the assembly, which may stand before others.
    pub assembly: &'a str,
}

/// Where a card stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CardScope<'a> {
    /// The instance; `None`: the assembly, or the deck itself.
    pub instance: Option<&'a str>,
    pub offsets: Offsets,
}

impl CardScope<'_> {
    /// The name of a set or surface that is defined here.
    pub fn name(&self, names: &DeckNames<'_>, name: &str) -> String {
        match self.instance {
            _ if name.is_empty() => String::new(),
            Some(instance) => format!("{instance}.{name}"),
            None => names.plain(name).to_string(),
        }
    }

    /// A number of a node or an element.
    pub fn number(&self, text: &str, of: Of) -> String {
        match whole(text) {
            Some(id) => id.saturating_add(self.offsets.of(of)).to_string(),
            None => text.to_string(),
        }
    }

    /// The target that a field names, a number or a set: in an instance its own, and elsewhere those of instances by
    /// their names.
    pub fn target(&self, names: &DeckNames<'_>, text: &str, of: Of) -> String {
        if text.is_empty() {
            return String::new();
        }
        if is_whole(text) {
            return self.number(text, of);
        }
        let squeezed = squeeze(text).replace('"', "");
        let name = names.plain(&squeezed);
        if let Some((instance, rest)) = names.split(name) {
            return match whole(rest) {
                Some(id) => id
                    .saturating_add(names.instances[instance].of(of))
                    .to_string(),
                None => name.to_string(),
            };
        }
        self.name(names, name)
    }
}

impl<'a> DeckNames<'a> {
    /// A name without that of the assembly before it.
    fn plain<'n>(&self, name: &'n str) -> &'n str {
        let rest = name.strip_prefix(self.assembly);
        let rest = rest.and_then(|rest| rest.strip_prefix('.'));
        match rest {
            Some(rest) if !self.assembly.is_empty() && !self.is_instance(self.assembly) => rest,
            _ => name,
        }
    }

    /// The name of an instance without that of the assembly.
    pub fn instance<'n>(&self, name: &'n str) -> &'n str {
        self.plain(name)
    }

    fn is_instance(&self, name: &str) -> bool {
        self.instances.contains_key(name)
    }

    /// The instance that a name begins with, and what stands behind its dot.
    fn split<'n>(&self, name: &'n str) -> Option<(&'n str, &'n str)> {
        let dots = name.match_indices('.').map(|(at, _)| at);
        let mut parts = dots.map(|at| (&name[..at], &name[at + 1..]));
        parts.find(|(instance, rest)| self.is_instance(instance) && !rest.is_empty())
    }
}
