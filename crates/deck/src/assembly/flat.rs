//! The cards of a flat deck: those of every instance, with its names and numbers, then those of the assembly.

use std::collections::HashMap;
use std::ops::Range;

use super::outline::{value, DeckOutline, Instance};
use super::pieces::{coordinates, is_system, largest, of_instance, turned, ElementLines};
use super::placement::InstancePlacement;
use super::targets::{CardScope, DeckNames, Of, Offsets};
use crate::cards::{Card, Cards, DataLine, Flattened, Param, SourceLine};
use crate::deck_line::{DeckLine, Note};
use crate::numbers::{clip, real};
use base::Result;
use mesh::Digits;

/// Keywords that every instance of a part has of its own. Others are told once, where they stand in the part.
const OF_INSTANCES: [&str; 14] = [
    "NODE",
    "ELEMENT",
    "NSET",
    "ELSET",
    "SURFACE",
    "SOLIDSECTION",
    "EQUATION",
    "MPC",
    "TRANSFORM",
    "ORIENTATION",
    "TIE",
    "BOUNDARY",
    "CLOAD",
    "GAP",
];

/// Lines that instances may have beside 100 for each line of the deck: few lines can say what no memory holds.
const ROOM: usize = 5_000_000;

/// The flat deck as far as it is written.
pub(super) struct Flat<'a> {
    cards: &'a Cards,
    pub(super) outline: &'a DeckOutline<'a>,
    names: DeckNames<'a>,
    /// By instance what is added to its numbers, and its largest numbers then.
    pub(super) numbers: Vec<[Offsets; 2]>,
    /// The offsets that are added to the numbers of the assembly's own nodes and elements.
    own: Offsets,
    text: String,
    pub(super) lines: Vec<SourceLine>,
    pub(super) out: Vec<Card>,
    notes: Vec<Note>,
    /// The digits of coordinates that are moved.
    digits: Digits,
}

impl<'a> Flat<'a> {
    /// Nothing is written yet; numbers are dealt out.
    pub fn new(cards: &'a Cards, outline: &'a DeckOutline<'a>) -> Result<Flat<'a>> {
        let mut top = Offsets::default();
        let mut numbers = Vec::new();
        let mut names = DeckNames {
            instances: HashMap::new(),
            assembly: outline.assembly,
        };
        let mut room = ROOM.saturating_add(cards.lines().saturating_mul(100));
        for instance in &outline.instances {
            let lines = of_instance(outline, instance).map(|c| 1 + c.lines().len());
            room = room.checked_sub(lines.sum()).ok_or_else(|| {
                let message = "*INSTANCE: the instances up to this one have more lines than memory should hold";
                cards.files.error(instance.place, message)
            })?;
            let most = largest(cards, of_instance(outline, instance));
            let above = Offsets([0, 1].map(|k| top.0[k].saturating_add(most.0[k])));
            names.instances.insert(instance.name, top);
            numbers.push([top, above]);
            top = above;
        }
        let most = largest(cards, outline.others.iter().copied());
        let own = Offsets([0, 1].map(|k| if most.0[k] > 0 { top.0[k] } else { 0 }));
        Ok(Flat {
            cards,
            outline,
            names,
            numbers,
            own,
            text: String::new(),
            lines: Vec::new(),
            out: Vec::new(),
            notes: Vec::new(),
            digits: Digits::default(),
        })
    }

    /// Writes everything.
    pub fn write(&mut self) -> Result<()> {
        let outline = self.outline;
        let mut used = vec![false; outline.parts.len()];
        for (k, instance) in outline.instances.iter().enumerate() {
            let scope = CardScope {
                instance: Some(instance.name),
                offsets: self.numbers[k][0],
            };
            let again = std::mem::replace(&mut used[instance.part], true);
            let of_part = outline.parts[instance.part].cards.len();
            let mut system = InstancePlacement::NONE;
            let mut of_gap = false;
            for (i, card) in of_instance(outline, instance).enumerate() {
                let told = again && i < of_part;
                let keyword = card.keyword.as_str();
                // The law of gap elements stands below their *GAP.
                let is_law = ["FRICTION", "SURFACEBEHAVIOR"].contains(&keyword);
                of_gap = keyword == "GAP" || of_gap && keyword != "SURFACEINTERACTION";
                let own = OF_INSTANCES.contains(&keyword) || of_gap && is_law;
                if !told || own || is_system(card) {
                    self.card(card, [scope; 2], &instance.placement, &mut system)?;
                }
            }
            self.note_of(instance, self.numbers[k][0]);
        }
        for (part, used) in outline.parts.iter().zip(used) {
            if !used {
                let reason = format!("part {} has no instance: it is left out", clip(part.name));
                self.note("*PART", part.place, reason);
            }
        }
        self.short_names()?;
        let scope = CardScope {
            instance: None,
            offsets: self.own,
        };
        let mut system = InstancePlacement::NONE;
        for &card in &outline.others {
            let data = self.scope_of(card, scope)?;
            self.card(card, [scope, data], &InstancePlacement::NONE, &mut system)?;
        }
        Ok(())
    }

    /// The deck as it was written: lines, the text of new ones, cards, and notes.
    pub fn end(self) -> (Flattened, Vec<Note>) {
        let flat = Flattened {
            lines: self.lines,
            text: self.text,
            cards: self.out,
            resolution: self.digits.resolution(),
        };
        (flat, self.notes)
    }

    /// Where the data of a card of the assembly stand: sets may be of an instance.
    fn scope_of(&self, card: &Card, scope: CardScope<'a>) -> Result<CardScope<'a>> {
        let named = match card.keyword.as_str() {
            "NSET" | "ELSET" => value(card, "INSTANCE"),
            _ => None,
        };
        let Some(name) = named else {
            return Ok(scope);
        };
        let plain = self.names.instance(name);
        match self.names.instances.get_key_value(plain) {
            Some((&instance, &offsets)) => Ok(CardScope {
                instance: Some(instance),
                offsets,
            }),
            None => {
                let message = format!("*{}: there is no instance {}", card.keyword, clip(name));
                Err(self.cards.files.error(card.place, message))
            }
        }
    }

    /// Writes a card whose names are defined in the first scope, and whose data stand in the second.
    pub(super) fn card(
        &mut self,
        card: &Card,
        [own, data]: [CardScope<'a>; 2],
        placement: &InstancePlacement,
        system: &mut InstancePlacement,
    ) -> Result<()> {
        if is_system(card) {
            *system = self.system(card)?;
            return Ok(());
        }
        let names = std::mem::take(&mut self.names);
        let target = |text: &str, of: Of| data.target(&names, text, of);
        let each =
            |row: &DataLine, change: &dyn Fn(usize, &str) -> String| -> Option<Vec<String>> {
                let fields = row.fields.iter().enumerate();
                Some(fields.map(|(k, f)| change(k, f)).collect())
            };
        let first = |row: &DataLine, of: Of| {
            each(row, &|k, f| match k {
                0 => target(f, of),
                _ => f.to_string(),
            })
        };
        let generate = value(card, "GENERATE").is_some();
        let set = |row: &DataLine, of: Of| {
            each(row, &|k, f| match (generate, k) {
                (true, 2..) => f.to_string(),
                (true, _) => data.number(f, of),
                (false, _) => target(f, of),
            })
        };
        let moves = !placement.is_none() || !system.is_none();
        let [nodes, cells] = data.offsets.0;
        let mut elements = ElementLines::of(card);
        let mut digits = self.digits;
        let range = self.rows(card, &mut |row| match card.keyword.as_str() {
            "NODE" if nodes == 0 && !moves => None,
            "NODE" => {
                let at = moves.then(|| coordinates(row)).flatten();
                let at = at.map(|x| placement.point(system.point(x)));
                let mut fields = vec![data.number(row.field(0), Of::Nodes)];
                match at {
                    // What is computed has all digits, and is known to as many as were written.
                    Some(x) => {
                        (1..=3).for_each(|k| digits.see(row.field(k).as_bytes()));
                        fields.extend(x.map(|v| format!("{v:?}")));
                    }
                    None => fields.extend(row.fields.iter().skip(1).map(|f| f.to_string())),
                }
                Some(fields)
            }
            "ELEMENT" if nodes == 0 && cells == 0 && own.instance.is_some() => None,
            "ELEMENT" => {
                let begins = elements.begins(row);
                each(row, &|k, f| {
                    if begins && k == 0 {
                        data.number(f, Of::Cells)
                    } else {
                        target(f, Of::Nodes)
                    }
                })
            }
            "NSET" => set(row, Of::Nodes),
            "ELSET" => set(row, Of::Cells),
            "SURFACE" => match value(card, "TYPE") {
                Some("NODE") => first(row, Of::Nodes),
                _ => first(row, Of::Cells),
            },
            "DLOAD" => first(row, Of::Cells),
            "BOUNDARY" | "CLOAD" | "DSLOAD" | "TEMPERATURE" | "INITIALCONDITIONS" => {
                first(row, Of::Nodes)
            }
            "TIE" | "CONTACTPAIR" => each(row, &|_, f| target(f, Of::Nodes)),
            "EQUATION" if row.fields.len() > 1 => each(row, &|k, f| match k % 3 {
                0 => target(f, Of::Nodes),
                _ => f.to_string(),
            }),
            "MPC" => each(row, &|k, f| match k {
                0 => f.to_string(),
                _ => target(f, Of::Nodes),
            }),
            "TRANSFORM" | "ORIENTATION" if !placement.is_none() => turned(card, row, placement),
            _ => None,
        });
        let name = |p: &Param| -> Option<Param> {
            let of_surface = card.keyword == "SURFACE" && p.name == "NAME";
            let value = match p.name.as_str() {
                "NSET" | "ELSET" | "ORIENTATION" => own.name(&names, &p.value),
                "NAME" if of_surface || card.keyword == "ORIENTATION" => own.name(&names, &p.value),
                "ADJUST" | "MASTER" | "SLAVE" if real(&p.value).is_none() => {
                    own.target(&names, &p.value, Of::Nodes)
                }
                "INSTANCE" if data.instance.is_some() => return None,
                _ => p.value.clone(),
            };
            Some(Param {
                name: p.name.clone(),
                value,
            })
        };
        let params = card.params.iter().filter_map(name).collect();
        self.digits = digits;
        self.names = names;
        self.out.push(card.with(params, range));
        Ok(())
    }

    /// The data lines of a card: with other fields, or as they are where `change` gives none.
    fn rows(
        &mut self,
        card: &Card,
        change: &mut dyn FnMut(&DataLine) -> Option<Vec<String>>,
    ) -> Range<usize> {
        let start = self.lines.len();
        let cards = self.cards;
        for l in card.lines() {
            let row = cards.row(l);
            match change(&row) {
                None => self.lines.push(cards.line_of(l)),
                Some(fields) => self.line(row.place, &fields.join(", ")),
            }
        }
        start..self.lines.len()
    }

    /// A new line.
    pub(super) fn line(&mut self, place: DeckLine, text: &str) {
        let from = self.text.len();
        self.text.push_str(text);
        self.text.push('\n');
        let bytes = from..self.text.len() - 1;
        self.lines.push(self.cards.new_line(place, bytes));
    }

    /// The system that *SYSTEM defines.
    fn system(&self, card: &Card) -> Result<InstancePlacement> {
        let fail = |message: &str| self.cards.files.error(card.place, message);
        let mut numbers = Vec::new();
        for (k, row) in self.cards.rows(card).enumerate() {
            // The first line has two points, the second one.
            numbers.resize(if k == 0 { 0 } else { 6 }, 0.0);
            for field in &row.fields {
                let x = if field.is_empty() {
                    Some(0.0)
                } else {
                    real(field)
                };
                numbers.push(x.ok_or_else(|| fail("*SYSTEM: its lines have coordinates alone"))?);
            }
        }
        if numbers.len() > 9 {
            return Err(fail("*SYSTEM: three points at most were expected"));
        }
        numbers.resize(numbers.len().div_ceil(3) * 3, 0.0);
        let points: Vec<[f64; 3]> = numbers.chunks(3).map(|x| [x[0], x[1], x[2]]).collect();
        InstancePlacement::system(&points).ok_or_else(|| fail("*SYSTEM: its points define no axes"))
    }

    fn note(&mut self, keyword: &str, place: DeckLine, reason: String) {
        self.notes.push(Note {
            keyword: keyword.into(),
            place,
            reason,
        });
    }

    /// A sentence on the numbers of an instance, where they are not its own.
    fn note_of(&mut self, instance: &Instance, Offsets([nodes, cells]): Offsets) {
        if nodes + cells > 0 {
            let reason = format!(
                "nodes of instance {} have their own numbers plus {nodes} in messages and tables, elements plus \
                 {cells}",
                clip(instance.name)
            );
            self.note("*INSTANCE", instance.place, reason);
        }
    }
}
