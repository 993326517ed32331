//! The steps of a deck: supports, loads and what is asked for.

use super::deck_line::DeckLine;
use super::joint::Friction;

/// A *STEP, with everything that holds at its end: amplitudes are evaluated, and what earlier steps leave is included.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DeckStep {
    /// Where it begins.
    pub place: DeckLine,
    /// How long it takes.
    pub duration: f64,
    /// The total time at its end, as CalculiX prints it.
    pub time: f64,
    /// Displacements that are given, by node and direction.
    pub supports: Vec<Support>,
    /// Forces at nodes, by node and direction.
    pub forces: Vec<NodeForce>,
    /// Pressures on sides, by cell and side.
    pub pressures: Vec<Pressure>,
    /// Forces on cells.
    pub body_loads: Vec<BodyLoad>,
    /// Temperatures that are given, by increasing node; those of the beginning elsewhere.
    pub temperatures: Vec<(u32, f64)>,
    /// The friction of each interaction; `None`: none.
    pub friction: Vec<Option<Friction>>,
    /// The tables that are to be printed.
    pub prints: Vec<NodePrint>,
    /// The fields that are to be written: *NODE FILE, *EL FILE and their likes.
    pub fields: Vec<FieldRequest>,
}

/// A displacement that is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// The node.
    pub node: u32,
    /// The direction, 0 to 2, in the system of the node.
    pub dof: u8,
    /// The displacement.
    pub value: f64,
    /// Where it stands.
    pub place: DeckLine,
}

/// A force at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeForce {
    /// The node.
    pub node: u32,
    /// The direction, 0 to 2, in the system of the node.
    pub dof: u8,
    /// The force; on axisymmetric bodies that on the whole circumference.
    pub value: f64,
    /// Where it stands: the first of those that were added.
    pub place: DeckLine,
}

/// A pressure on a side, against the outer normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressure {
    /// The cell.
    pub cell: u32,
    /// The side of its kind, from 0.
    pub side: u8,
    /// The pressure.
    pub value: f64,
    /// Where it stands: the first of those that were added.
    pub place: DeckLine,
}

/// A force on cells by mass.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyLoad {
    /// The cells, by increasing places.
    pub cells: Vec<u32>,
    /// The kind of the load.
    pub kind: BodyLoadKind,
    /// Where it stands.
    pub place: DeckLine,
}

/// The kind of a [`BodyLoad`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BodyLoadKind {
    /// An acceleration: density times it is the force by volume.
    Gravity([f64; 3]),
    /// Density times `omega2` times the vector from the axis is the force by volume.
    Centrifugal {
        /// The square of the angular velocity.
        omega2: f64,
        /// A point of the axis.
        point: [f64; 3],
        /// Its direction, of length 1.
        direction: [f64; 3],
    },
}

/// A quantity that a *NODE PRINT prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Printed {
    /// Displacements (U).
    Displacement,
    /// Forces (RF): reactions and loads.
    Force,
}

/// Whether the sum of forces is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Totals {
    /// The force of each node.
    #[default]
    No,
    /// The force of each node and their sum.
    Yes,
    /// Their sum.
    Only,
}

/// A *NODE PRINT.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodePrint {
    /// The node set.
    pub nset: String,
    /// Its nodes in the order in which they are printed.
    pub nodes: Vec<u32>,
    /// The quantities that are printed.
    pub printed: Vec<Printed>,
    /// Whether sums are printed.
    pub totals: Totals,
    /// Whether vectors are printed in the global system where nodes have one of their own.
    pub global: bool,
    /// Where it stands.
    pub place: DeckLine,
}

/// Fields that are to be written to a file of results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldRequest {
    /// The keyword, such as "*NODE FILE".
    pub keyword: &'static str,
    /// The names of the fields, in capitals.
    pub fields: Vec<String>,
    /// Where it stands.
    pub place: DeckLine,
}
