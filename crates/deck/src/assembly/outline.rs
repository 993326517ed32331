//! The outline of a deck of parts: which cards are a part's, an instance's, the assembly's, and the deck's own.

use std::collections::HashSet;

use super::placement::InstancePlacement;
use crate::cards::{Card, Cards};
use crate::deck_line::DeckLine;
use crate::numbers::{clip, real};
use base::{Error, Result};

/// A part, with its cards.
pub(super) struct DeckPart<'a> {
    pub name: &'a str,
    pub place: DeckLine,
    pub cards: Vec<&'a Card>,
}

/// An instance of a part, with what stands in it beside.
pub(super) struct Instance<'a> {
    pub name: &'a str,
    pub place: DeckLine,
    /// Its part, as a place in the list of parts.
    pub part: usize,
    pub placement: InstancePlacement,
    pub cards: Vec<&'a Card>,
}

/// The cards of a deck by where they stand.
#[derive(Default)]
pub(super) struct DeckOutline<'a> {
    pub parts: Vec<DeckPart<'a>>,
    pub instances: Vec<Instance<'a>>,
    /// The name of the assembly, empty if it has none.
    pub assembly: &'a str,
    /// The cards of the assembly, and all others, in the order of the file.
    pub others: Vec<&'a Card>,
}

/// The block that is open at a card.
#[derive(Clone, Copy, PartialEq)]
enum Open {
    Part,
    Assembly,
    Instance,
}

impl<'a> DeckOutline<'a> {
    /// Deals out the cards.
    pub fn new(cards: &'a Cards) -> Result<DeckOutline<'a>> {
        let mut outline = DeckOutline::default();
        // What is open, with the cards that opened it.
        let mut open: Vec<(Open, &Card)> = Vec::new();
        let mut assembled = false;
        let (mut parts, mut instances) = (HashSet::new(), HashSet::new());
        // The names of the parts of the instances, which may come later.
        let mut wanted: Vec<(&str, &Card)> = Vec::new();
        for card in &cards.cards {
            let fail = |message: String| Err(cards.files.error(card.place, message));
            let inside = open.last().map(|o| o.0);
            let state = |open: &[(Open, &Card)]| match open.last() {
                None => String::from("no *PART, *ASSEMBLY or *INSTANCE is open"),
                Some((_, by)) => format!(
                    "{}, which begins in {}, has not ended (*END {} was expected before)",
                    written(by),
                    cards.files.at(by.place),
                    by.keyword
                ),
            };
            match card.keyword.as_str() {
                "PART" => match inside {
                    None => {
                        let name = name_of(cards, card, "NAME")?;
                        if !parts.insert(name) {
                            return fail(format!("*PART: part {} is defined before", clip(name)));
                        }
                        open.push((Open::Part, card));
                        outline.parts.push(DeckPart {
                            name,
                            place: card.place,
                            cards: Vec::new(),
                        });
                    }
                    Some(_) => return fail(format!("*PART: {}", state(&open))),
                },
                "ASSEMBLY" => match inside {
                    None if assembled => {
                        return fail(
                            "*ASSEMBLY: a deck has one assembly, and this is a second".into(),
                        )
                    }
                    None => {
                        assembled = true;
                        outline.assembly = value(card, "NAME").unwrap_or("");
                        open.push((Open::Assembly, card));
                    }
                    Some(_) => return fail(format!("*ASSEMBLY: {}", state(&open))),
                },
                "INSTANCE" => match inside {
                    Some(Open::Assembly) => {
                        if value(card, "LIBRARY").is_some() || value(card, "INSTANCE").is_some() {
                            return fail(
                                "*INSTANCE: instances of other computations are not read; write PART=".into(),
                            );
                        }
                        let part = name_of(cards, card, "PART")?;
                        let name = value(card, "NAME")
                            .filter(|n| !n.is_empty())
                            .unwrap_or(part);
                        if !instances.insert(name) {
                            return fail(format!(
                                "*INSTANCE: instance {} is defined before",
                                clip(name)
                            ));
                        }
                        wanted.push((part, card));
                        open.push((Open::Instance, card));
                        outline.instances.push(Instance {
                            name,
                            place: card.place,
                            part: 0,
                            placement: placement(cards, card)?,
                            cards: Vec::new(),
                        });
                    }
                    None => {
                        return fail(
                            "*INSTANCE: instances stand between *ASSEMBLY and *END ASSEMBLY".into(),
                        )
                    }
                    Some(_) => return fail(format!("*INSTANCE: {}", state(&open))),
                },
                "ENDPART" if inside == Some(Open::Part) => drop(open.pop()),
                "ENDASSEMBLY" if inside == Some(Open::Assembly) => drop(open.pop()),
                "ENDINSTANCE" if inside == Some(Open::Instance) => drop(open.pop()),
                "ENDPART" | "ENDASSEMBLY" | "ENDINSTANCE" => {
                    return fail(format!("*END {}: {}", &card.keyword[3..], state(&open)))
                }
                "STEP" if inside.is_some() => return fail(format!("*STEP: {}", state(&open))),
                _ => outline.add(inside, card),
            }
        }
        if let Some((_, by)) = open.last() {
            let message = format!(
                "{} does not end (*END {} was expected)",
                written(by),
                by.keyword
            );
            return Err(cards.files.error(by.place, message));
        }
        for (k, (name, card)) in wanted.into_iter().enumerate() {
            outline.instances[k].part = outline.part(cards, name, card)?;
        }
        if outline.instances.is_empty() {
            outline.stand_alone();
        }
        Ok(outline)
    }

    /// Adds a card where it stands.
    fn add(&mut self, inside: Option<Open>, card: &'a Card) {
        let of_part = self.parts.last_mut().map(|p| &mut p.cards);
        let of_instance = self.instances.last_mut().map(|i| &mut i.cards);
        let list = match inside {
            Some(Open::Part) => of_part,
            Some(Open::Instance) => of_instance,
            Some(Open::Assembly) | None => None,
        };
        list.unwrap_or(&mut self.others).push(card);
    }

    /// Without an assembly, as other programs write meshes, each part is there once, at its place.
    fn stand_alone(&mut self) {
        let parts = self.parts.iter().enumerate();
        let instance = |(k, part): (usize, &DeckPart<'a>)| Instance {
            name: part.name,
            place: part.place,
            part: k,
            placement: InstancePlacement::NONE,
            cards: Vec::new(),
        };
        self.instances = parts.map(instance).collect();
    }

    /// The part of this name.
    fn part(&self, cards: &Cards, name: &str, card: &Card) -> Result<usize> {
        let found = self.parts.iter().position(|p| p.name == name);
        found.ok_or_else(|| {
            let names: Vec<String> = self.parts.iter().take(8).map(|p| clip(p.name)).collect();
            let list = if names.is_empty() {
                "the deck has none".into()
            } else {
                format!("parts are {}", names.join(", "))
            };
            let message = format!("*INSTANCE: there is no part {} ({list})", clip(name));
            cards.files.error(card.place, message)
        })
    }
}

/// The value of a parameter.
pub(super) fn value<'a>(card: &'a Card, name: &str) -> Option<&'a str> {
    let found = card.params.iter().find(|p| p.name == name);
    found.map(|p| p.value.as_str())
}

/// The value of a parameter that must be there.
fn name_of<'a>(cards: &Cards, card: &'a Card, key: &str) -> Result<&'a str> {
    match value(card, key) {
        Some(name) if !name.is_empty() => Ok(name),
        _ => {
            let message = format!("*{}: the parameter {key}= is missing", card.keyword);
            Err(cards.files.error(card.place, message))
        }
    }
}

/// A card and its name, as messages say it.
fn written(card: &Card) -> String {
    match value(card, "NAME") {
        Some(name) if !name.is_empty() => format!("*{} {}", card.keyword, clip(name)),
        _ => format!("*{}", card.keyword),
    }
}

/// The placement that the lines of an *INSTANCE say: a way, and then a turn about an axis through two points.
fn placement(cards: &Cards, card: &Card) -> Result<InstancePlacement> {
    let (mut way, mut rotation) = ([0.0; 3], None);
    for (k, row) in cards.rows(card).enumerate() {
        let fail = |message: &str| -> Error { cards.files.error(row.place, message) };
        let numbers: Option<Vec<f64>> = row
            .fields
            .iter()
            .map(|f| if f.is_empty() { Some(0.0) } else { real(f) })
            .collect();
        let numbers = numbers.ok_or_else(|| fail("*INSTANCE: its lines have numbers alone"))?;
        match (k, &numbers[..]) {
            (0, list) if list.len() <= 3 => way[..list.len()].copy_from_slice(list),
            (0 | 1, &[a, b, c, d, e, f, angle]) if rotation.is_none() => {
                rotation = Some(([a, b, c], [d, e, f], angle));
            }
            _ => {
                return Err(fail(
                    "*INSTANCE: a line of a translation (x, y, z) and one of a rotation (two points of the axis and \
                     an angle in degrees: 7 numbers) were expected",
                ))
            }
        }
    }
    InstancePlacement::new(way, rotation).ok_or_else(|| {
        let message = "*INSTANCE: the two points of the axis of rotation are one";
        cards.files.error(card.place, message)
    })
}
