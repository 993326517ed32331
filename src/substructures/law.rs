//! The law of a row: which multipliers λ it may have, and how λ goes with B u − c.
//!
//! ```text
//!     tie           λ any              B u = c
//!     unilateral    λ ≥ 0              B u ≤ c,     λ (B u − c) = 0
//!     friction      |λ| ≤ g            B u = c where |λ| < g; g is that of its node (`friction`)
//! ```
//!
//! Each law is a set of admissible multipliers. The dual of the set is what a gap may be, and the projection onto it is
//! the force of a spring that stands for the row. This file alone matches on the law: the linear method, the contact
//! loop and the certificate ask it.

use bytemuck::{Pod, Zeroable};
use std::fmt;

/// The law of a row. Multipliers and gaps are in the units of the problem: a multiplier is a force, a gap B u − c a
/// displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Law {
    /// An equation: (B u)_r = c_r, with any multiplier.
    Tie,
    /// An inequality: (B u)_r ≤ c_r, with a multiplier that is not negative and that vanishes where the row is open
    /// [Lee (3.1)-(3.3)].
    Unilateral,
    /// A tangential row of a node with friction: (B u)_r = c_r where the node sticks. Where it slips the multiplier is
    /// given, and its bound follows from the normal row: [`FrictionNode`](super::FrictionNode) has it.
    Friction,
}

/// The state of a row after a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RowState {
    /// An inequality that holds as an equation: the sides are in contact.
    Holds,
    /// The row does not hold: the sides are apart.
    Open,
    /// An equation.
    Tied,
    /// A tangential row: the sides stick.
    Sticks,
    /// A tangential row: the sides slip, with a friction force.
    Slips,
}

/// A law on its way between ranks.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct SentLaw {
    /// Its [`kind`](Law::kind).
    kind: u64,
}

impl SentLaw {
    /// The law that was sent.
    pub fn law(self) -> Law {
        Law::of_kind(self.kind).expect("a law that a rank has sent")
    }
}

impl Law {
    /// A number for the kind of law: the FetiFetiRowKind of the C interface, and a key where laws are told apart.
    pub fn kind(self) -> u64 {
        match self {
            Law::Tie => 0,
            Law::Unilateral => 1,
            Law::Friction => 2,
        }
    }

    /// The law of this [`kind`](Law::kind); `None` if there is none.
    pub fn of_kind(kind: u64) -> Option<Law> {
        [Law::Tie, Law::Unilateral, Law::Friction]
            .into_iter()
            .find(|law| law.kind() == kind)
    }

    /// The law as ranks send it.
    pub fn sent(self) -> SentLaw {
        SentLaw { kind: self.kind() }
    }

    /// Whether the row bounds displacements on one side.
    pub fn is_inequality(self) -> bool {
        match self {
            Law::Tie | Law::Friction => false,
            Law::Unilateral => true,
        }
    }

    /// Whether the contact loop decides if the row holds. A row of another law holds as the problem says.
    pub fn is_decided(self) -> bool {
        match self {
            Law::Tie => false,
            Law::Unilateral | Law::Friction => true,
        }
    }

    /// Whether it is a tangential row of a node with friction.
    pub fn is_friction(self) -> bool {
        match self {
            Law::Tie | Law::Unilateral => false,
            Law::Friction => true,
        }
    }

    /// The least admissible multiplier; −∞ where there is none.
    pub fn least(self) -> f64 {
        match self {
            Law::Tie | Law::Friction => f64::NEG_INFINITY,
            Law::Unilateral => 0.0,
        }
    }

    /// The admissible multiplier nearest to λ. It is also the force of a spring of compliance C in the row's place,
    /// which is λ = s for s = μ + (B u − c)/C if nothing bounds it.
    pub fn project(self, lambda: f64) -> f64 {
        match self {
            Law::Tie | Law::Friction => lambda,
            Law::Unilateral => lambda.max(0.0),
        }
    }

    /// Whether a multiplier or a spring force λ is one that the row bears: a row that bears none is released.
    pub fn bears(self, lambda: f64) -> bool {
        match self {
            Law::Tie | Law::Friction => true,
            Law::Unilateral => lambda > 0.0,
        }
    }

    /// How far λ is from the admissible multipliers; 0 for one of them. An inequality with a positive pull pulls.
    pub fn pull(self, lambda: f64) -> f64 {
        match self {
            Law::Tie | Law::Friction => 0.0,
            Law::Unilateral => (-lambda).max(0.0),
        }
    }

    /// The multiplier of a row that does not hold, of which `given` is asked for.
    pub fn released(self, given: f64) -> f64 {
        match self {
            Law::Tie | Law::Unilateral => 0.0,
            Law::Friction => given,
        }
    }

    /// How far B u − c = `gap` violates a row; 0 where it does not. An equation that does not `hold` is violated by
    /// nothing, an inequality counts in any state.
    pub fn violation(self, gap: f64, holds: bool) -> f64 {
        match self {
            Law::Tie | Law::Friction if holds => gap.abs(),
            Law::Tie | Law::Friction => 0.0,
            Law::Unilateral => gap.max(0.0),
        }
    }

    /// |λ (B u − c)| where the law asks it to vanish, else 0.
    pub fn complementarity(self, lambda: f64, gap: f64) -> f64 {
        match self {
            Law::Tie | Law::Friction => 0.0,
            Law::Unilateral => (lambda * gap).abs(),
        }
    }

    /// How much a row that does the work `work` = gᵀα on a rigid motion α stands against that motion: it stands against
    /// it if this is positive.
    pub fn resistance(self, work: f64) -> f64 {
        match self {
            Law::Tie | Law::Friction => work.abs(),
            Law::Unilateral => work,
        }
    }

    /// The state of a row, which holds or does not, with its multiplier.
    pub fn state(self, lambda: f64, holds: bool) -> RowState {
        match self {
            Law::Tie if holds => RowState::Tied,
            Law::Unilateral if holds => RowState::Holds,
            Law::Friction if holds => RowState::Sticks,
            Law::Friction if lambda != 0.0 => RowState::Slips,
            Law::Tie | Law::Unilateral | Law::Friction => RowState::Open,
        }
    }
}

impl fmt::Display for Law {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Law::Tie => "tie",
            Law::Unilateral => "contact",
            Law::Friction => "friction",
        })
    }
}

#[cfg(test)]
#[path = "../../tests/inside/substructures/law.rs"]
mod tests;
