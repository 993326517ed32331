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
type HardDeck = (&'static str, &'static str, &'static str, KnownDisplacement);

/// One a row.
const DECKS: [HardDeck; 3] = [
    (
        "wedge-column",
        "a pulled column of C3D6, each of which can turn against the next without energy",
        include_str!("../../../../../tests/data/cases/04c_wedge_column_pulled.inp"),
        // CalculiX 2.20.
        KnownDisplacement {
            at: [0.0, 0.0, 3.0],
            axis: 2,
            value: 8.741_655e-4,
            within: 1e-9,
        },
    ),
    (
        "pin-of-12-digits",
        "a pin pressed into a ring, whose turn nothing resists but rounding of its coordinates",
        include_str!("../../../../../tests/data/cases/01_pin_spins_12digits.inp"),
        // Lamé has 4.613e-4 for circles, of which 24 facets and three cells across give 4.4 % less. CalculiX 2.20 on
        // springs: 4.341e-4.
        KnownDisplacement {
            at: [0.3, 0.0, 0.0],
            axis: 0,
            value: -4.409e-4,
            within: 1e-6,
        },
    ),
    (
        "clamp",
        "a clamp that presses on itself",
        include_str!("../../../../../tests/data/cases/07_contact_of_one_body.inp"),
        // An active set on the same mesh; CalculiX 2.20 on springs: 0.05483.
        KnownDisplacement {
            at: [11.0, 0.0, 0.0],
            axis: 1,
            value: 0.05467,
            within: 1e-5,
        },
    ),
];

/// All of them.
pub fn decks() -> Vec<HardCase> {
    let case = |(name, title, text, point): HardDeck| HardCase {
        name,
        title: title.into(),
        text: text.into(),
        force: None,
        point: Some(point),
    };
    DECKS.into_iter().map(case).collect()
}
