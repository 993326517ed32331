//! Decks of Abaqus and CalculiX (`.inp`): a strict reader of what static steps of linear elasticity with contact need.
//!
//! [`read`] takes a whole deck, [`read_mesh`] its mesh only. What would change the answer and is not supported is
//! refused in one sentence with its line; what does not change it stands in [`Deck::ignored`]. [`KEYWORDS`] is the
//! verdict on every keyword. Decks of parts and instances are made flat before they are read (`assembly`).

mod assembly;
mod cards;
mod dat;
mod deck_line;
mod element;
mod gap;
mod joint;
mod keywords;
mod model;
mod numbers;
mod reader;
mod step;

pub use dat::{read_dat, write_dat, DatQuantity, DatTable, TableRow};
pub use deck_line::{DeckLine, Files, Note};
pub use element::{ElementModel, ElementType, Integration};
pub use gap::{Gap, GapElement};
pub use joint::{
    Adjust, ContactKind, ContactPair, Friction, Interaction, Overclosure, SurfaceName, Tie,
};
pub use keywords::{KeywordTreatment, KEYWORDS};
pub use model::{Deck, DeckEquation, DeckMaterial, Orientation, Section, Term, Transform};
pub use step::{
    BodyLoad, BodyLoadKind, DeckStep, FieldRequest, NodeForce, NodePrint, Pressure, Printed,
    Support, Totals,
};

use base::Result;
use cards::Cards;
use mesh::file::MeshFile;
use reader::DeckReader;

/// Reads the deck `text`; `name` is its name in messages, and `include` reads the files that it includes, whose names
/// it gets as they are written.
pub fn read(name: &str, text: &[u8], include: &dyn Fn(&str) -> Result<Vec<u8>>) -> Result<Deck> {
    let (cards, notes) = assembly::flatten(Cards::new(name, text, include)?)?;
    let mut deck = DeckReader::new(&cards, true).deck()?;
    deck.placed = notes;
    Ok(deck)
}

/// Reads the mesh of the deck `text` and nothing else: nodes, elements of every shape, sets and surfaces.
pub fn read_mesh(
    name: &str,
    text: &[u8],
    include: &dyn Fn(&str) -> Result<Vec<u8>>,
) -> Result<MeshFile> {
    let (cards, _) = assembly::flatten(Cards::new(name, text, include)?)?;
    DeckReader::new(&cards, false).mesh()
}

#[cfg(test)]
#[path = "../tests/deck.rs"]
mod tests;
