//! Parts, instances and their assembly, as Abaqus writes them: such a deck is made flat before it is read.
//!
//! Every instance gets the cards of its part, with what stands in the instance itself. Its nodes and elements have
//! their own numbers plus those of all instances before; its sets and surfaces are called INSTANCE.NAME, and NAME, too,
//! where nothing else is. Coordinates are those of the assembly. What stands in the assembly and behind it names an
//! instance's nodes INSTANCE.NUMBER.
//!
//! ```text
//!     Cards ── outline: parts, instances ──> Outline ── flat: numbers, names ──> Cards
//! ```

mod flat;
mod outline;
mod pieces;
mod placement;
mod short;
mod targets;

use super::cards::Cards;
use super::deck_line::Note;
use base::Result;
use flat::Flat;
use outline::DeckOutline;

/// Keywords that only such decks have; *SYSTEM moves the nodes behind it.
const STRUCTURE: [&str; 7] = [
    "PART",
    "ENDPART",
    "ASSEMBLY",
    "ENDASSEMBLY",
    "INSTANCE",
    "ENDINSTANCE",
    "SYSTEM",
];

/// The deck without parts, and notes on its parts and instances. A deck without keywords of parts stays as it is.
///
/// # Errors
/// Parts, instances and assemblies that do not end or begin where they must, and names that nothing has.
pub(super) fn flatten(cards: Cards) -> Result<(Cards, Vec<Note>)> {
    let is_flat = |c: &super::cards::Card| !STRUCTURE.contains(&c.keyword.as_str());
    if cards.cards.iter().all(is_flat) {
        return Ok((cards, Vec::new()));
    }
    let outline = DeckOutline::new(&cards)?;
    let mut flat = Flat::new(&cards, &outline)?;
    flat.write()?;
    let (flat, notes) = flat.end();
    Ok((cards.rewritten(flat), notes))
}

#[cfg(test)]
#[path = "../../tests/assembly.rs"]
mod tests;
