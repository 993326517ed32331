//! Pieces of the cards of parts: sets, elements over several lines, numbers, points.

use super::outline::{value, DeckOutline, Instance};
use super::placement::InstancePlacement;
use super::targets::{Of, Offsets};
use crate::cards::{Card, Cards, DataLine};
use crate::element::shape;
use crate::numbers::{real, whole};

/// A set or a surface: "NSET", "ELSET" or "SURFACE", and its name.
pub(super) type SetName<'a> = (&'static str, &'a str);

/// The cards of an instance: those of its part, and its own.
pub(super) fn of_instance<'a>(
    outline: &'a DeckOutline<'a>,
    instance: &'a Instance<'a>,
) -> impl Iterator<Item = &'a Card> + Clone {
    let part = outline.parts[instance.part].cards.iter();
    part.chain(&instance.cards).copied()
}

/// Whether a card is a *SYSTEM.
pub(super) fn is_system(card: &Card) -> bool {
    card.keyword == "SYSTEM"
}

/// The set or surface that a card defines.
pub(super) fn defined(card: &Card) -> Option<SetName<'_>> {
    let (kind, key) = match card.keyword.as_str() {
        "NODE" | "NSET" => ("NSET", "NSET"),
        "ELEMENT" | "ELSET" => ("ELSET", "ELSET"),
        "SURFACE" => ("SURFACE", "NAME"),
        _ => return None,
    };
    let name = value(card, key).filter(|name| !name.is_empty())?;
    Some((kind, name))
}

/// The largest numbers of nodes and of elements.
pub(super) fn largest<'c>(cards: &Cards, list: impl Iterator<Item = &'c Card>) -> Offsets {
    let mut most = [0, 0];
    for card in list {
        let mut elements = ElementLines::of(card);
        let of = match card.keyword.as_str() {
            "NODE" => Of::Nodes,
            "ELEMENT" => Of::Cells,
            _ => continue,
        };
        for row in cards.rows(card) {
            if of == Of::Nodes || elements.begins(&row) {
                let id = whole(row.field(0)).unwrap_or(0);
                most[of as usize] = id.max(most[of as usize]);
            }
        }
    }
    Offsets(most)
}

/// Which lines of an *ELEMENT begin an element: others go on with its nodes.
pub(super) struct ElementLines {
    /// The nodes of one; 1 where the kind is not known, so that every line begins one.
    nodes: usize,
    /// The nodes of the present element that are still to come.
    left: usize,
}

impl ElementLines {
    pub fn of(card: &Card) -> ElementLines {
        let kind = value(card, "TYPE").and_then(shape);
        ElementLines {
            nodes: kind.map_or(1, |k| k.nodes()),
            left: 0,
        }
    }

    pub fn begins(&mut self, row: &DataLine) -> bool {
        let begins = self.left == 0;
        let (due, here) = if begins {
            (self.nodes, row.fields.len().saturating_sub(1))
        } else {
            (self.left, row.fields.len())
        };
        self.left = due.saturating_sub(here);
        begins
    }
}

/// The coordinates of a node, if they can be read.
pub(super) fn coordinates(row: &DataLine) -> Option<[f64; 3]> {
    let mut out = [0.0; 3];
    for (k, x) in out.iter_mut().enumerate() {
        *x = match row.field(k + 1) {
            "" => 0.0,
            text => real(text)?,
        };
    }
    Some(out)
}

/// The two points of a *TRANSFORM or an *ORIENTATION of a part that is placed.
pub(super) fn turned(
    card: &Card,
    row: &DataLine,
    placement: &InstancePlacement,
) -> Option<Vec<String>> {
    let numbers: Option<Vec<f64>> = row.fields.iter().map(|f| real(f)).collect();
    let numbers = numbers.filter(|n| n.len() == 6)?;
    let cylindrical =
        value(card, "TYPE") == Some("C") || value(card, "SYSTEM") == Some("CYLINDRICAL");
    let points = numbers.chunks(3).map(|x| [x[0], x[1], x[2]]);
    let placed = points.flat_map(|x| {
        if cylindrical {
            placement.point(x)
        } else {
            placement.vector(x)
        }
    });
    Some(placed.map(|x| format!("{x:?}")).collect())
}
