//! Gap elements: pairs of nodes that may touch along a direction.

use super::deck_line::DeckLine;

/// A *GAP with its elements: d + n·(u₂ − u₁) ≥ 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// Its element set, in capitals.
    pub elset: String,
    /// Its elements; none where later *GAP have them all.
    pub elements: Vec<GapElement>,
    /// The clearance d; negative for an overclosure.
    pub clearance: f64,
    /// The direction n, of length 1; `None`: from the first node to the second.
    pub direction: Option<[f64; 3]>,
    /// The area of each element, by which stresses become forces.
    pub area: f64,
    /// Its law, as a place in [`Deck::interactions`](super::Deck::interactions).
    pub interaction: u32,
    /// Where it stands.
    pub place: DeckLine,
}

/// An element of type GAPUNI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GapElement {
    /// Its number in the deck.
    pub id: u64,
    /// Its nodes.
    pub nodes: [u32; 2],
    /// Where it stands.
    pub place: DeckLine,
}
