//! Decks that once had a wrong answer or none, with a displacement that another program has.

use super::cases::HardCase;

/// A displacement that is known beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownDisplacement {
    /// Where a node is.
    pub at: [f64; 3],
    /// The direction, an axis.
    pub axis: usize,
    /// Its value.
    pub value: f64,
    /// The largest deviation that is right.
    pub within: f64,
}

/// Name, what is hard, the deck, and what is known.
type Deck = (&'static str, &'static str, &'static str, KnownDisplacement);

/// One a row.
const DECKS: [Deck; 1] = [(
    "wedge-column",
    "a pulled column of C3D6, each of which can turn against the next without energy",
    include_str!("../../../tests/data/cases/04c_wedge_column_pulled.inp"),
    // CalculiX 2.20.
    KnownDisplacement {
        at: [0.0, 0.0, 3.0],
        axis: 2,
        value: 8.741_655e-4,
        within: 1e-9,
    },
)];

/// All of them.
pub fn decks() -> Vec<HardCase> {
    let case = |(name, title, text, point): Deck| HardCase {
        name,
        title: title.into(),
        text: text.into(),
        force: None,
        point: Some(point),
    };
    DECKS.into_iter().map(case).collect()
}
