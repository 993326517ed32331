//! The deck as far as it is read, and the functions that every part of the reader needs.

use super::gaps::Gaps;
use super::held::{Amplitude, DeckState};
use super::ids::Ids;
use super::named::Sets;
use crate::cards::{Card, Cards};
use crate::deck_line::{DeckLine, Files, Note};
use crate::keywords::verdict;
use crate::model::Deck;
use base::Result;
use elements::kind::CellKind;
use mesh::Digits;
use std::collections::HashMap;

/// Entries that names in a deck may stand for beside 16 a line: sets of sets, or steps that keep everything, can say in
/// few lines what no memory holds.
const ENTRIES: usize = 5_000_000;

/// The reader of a deck, with all that is read so far.
pub(crate) struct DeckReader<'a> {
    pub(super) cards: &'a Cards,
    pub(super) files: &'a Files,
    /// Whether everything is read, or the mesh only.
    pub(super) whole: bool,
    pub(super) deck: Deck,
    pub(super) nodes: Ids,
    /// The digits of the coordinates.
    pub(super) digits: Digits,
    /// The digits of the factors of equations.
    pub(super) factor_digits: Digits,
    pub(super) cells: Ids,
    pub(super) nsets: Sets,
    pub(super) elsets: Sets,
    /// Surfaces of nodes.
    pub(super) node_surfaces: Sets,
    /// Surfaces of sides: (cell, side) in one number, cell · 8 + side.
    pub(super) side_surfaces: Sets,
    pub(super) amplitudes: Vec<Amplitude>,
    pub(super) amplitude_names: HashMap<String, usize>,
    pub(super) materials: HashMap<String, u32>,
    pub(super) orientations: HashMap<String, u32>,
    pub(super) interactions: HashMap<String, u32>,
    pub(super) gaps: Gaps,
    /// The contact pairs that say that nodes meet surfaces, by their lines.
    pub(super) by_nodes: Vec<DeckLine>,
    pub(super) state: DeckState,
    /// Entries that are left, see [`ENTRIES`].
    pub(super) entries: usize,
}

impl<'a> DeckReader<'a> {
    pub fn new(cards: &'a Cards, whole: bool) -> DeckReader<'a> {
        DeckReader {
            cards,
            files: &cards.files,
            whole,
            deck: Deck::default(),
            nodes: Ids::default(),
            digits: Digits::default(),
            factor_digits: Digits::default(),
            cells: Ids::default(),
            nsets: Sets::default(),
            elsets: Sets::default(),
            node_surfaces: Sets::default(),
            side_surfaces: Sets::default(),
            amplitudes: Vec::new(),
            amplitude_names: HashMap::new(),
            materials: HashMap::new(),
            orientations: HashMap::new(),
            interactions: HashMap::new(),
            gaps: Gaps::default(),
            by_nodes: Vec::new(),
            state: DeckState::default(),
            entries: ENTRIES.saturating_add(cards.lines().saturating_mul(16)),
        }
    }

    /// Takes `n` entries from those that are left.
    pub(super) fn spend(&mut self, n: usize, place: DeckLine) -> Result<()> {
        match self.entries.checked_sub(n) {
            Some(left) => {
                self.entries = left;
                Ok(())
            }
            None => {
                let message = "the deck says too much in too few lines: its sets and steps have more entries than \
                               memory should hold";
                Err(self.files.error(place, message))
            }
        }
    }

    /// The error at the keyword line of `card`.
    pub(super) fn error<T>(&self, card: &Card, message: impl AsRef<str>) -> Result<T> {
        let message = format!("{}: {}", title(card), message.as_ref());
        Err(self.files.error(card.place, message))
    }

    pub(super) fn note(card: &Card, place: DeckLine, reason: impl Into<String>) -> Note {
        Note {
            keyword: title(card),
            place,
            reason: reason.into(),
        }
    }

    /// The number of a cell in the file, for messages.
    pub(super) fn cell_id(&self, cell: u32) -> u64 {
        self.deck.mesh.cell_ids[cell as usize]
    }

    pub(super) fn kind(&self, cell: u32) -> CellKind {
        self.deck.mesh.cells.kind(cell as usize)
    }
}

/// The keyword of a card as it is written, with its asterisk.
pub(super) fn title(card: &Card) -> String {
    match verdict(&card.keyword) {
        Some((name, _)) => format!("*{name}"),
        None => format!("*{}", card.keyword),
    }
}
