//! The primal constraints of bodies, as a user chooses them.

use crate::substructures::EntityKind;
use petsc::named;

/// The functions that edges and faces are averaged with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Averages {
    /// One average for each component.
    Components,
    /// One average for each motion without energy, of those that differ on the edge or face: six for most faces of
    /// elastic solids, three for edges in the plane.
    Motions,
}

named!(Averages { Components = "components", Motions = "motions" });

/// The kinds of primal constraints inside a body; at least one of them is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Primal {
    /// Values at vertices.
    pub vertices: bool,
    /// Averages over edges.
    pub edges: bool,
    /// Averages over faces.
    pub faces: bool,
    /// The functions that edges and faces are averaged with.
    pub averages: Averages,
}

impl Default for Primal {
    fn default() -> Self {
        Primal {
            vertices: true,
            edges: true,
            faces: false,
            averages: Averages::Components,
        }
    }
}

impl Primal {
    pub(super) const NAMES: [&'static str; 3] = ["vertices", "edges", "faces"];

    /// Whether averages over entities of this kind are primal.
    pub fn takes(self, kind: EntityKind) -> bool {
        match kind {
            EntityKind::Edge => self.edges,
            EntityKind::Face => self.faces,
        }
    }

    /// The value as the option takes it.
    pub fn name(self) -> String {
        let chosen = [self.vertices, self.edges, self.faces];
        let names = Self::NAMES.iter().zip(chosen).filter(|n| n.1).map(|n| *n.0);
        names.collect::<Vec<_>>().join(",")
    }

    /// Parses a list with commas; `None` if a word is wrong.
    pub fn parse(text: &str) -> Option<Primal> {
        let mut chosen = [false; 3];
        for word in text.split(',') {
            let word = word.trim().to_ascii_lowercase();
            chosen[Self::NAMES.iter().position(|n| *n == word)?] = true;
        }
        let [vertices, edges, faces] = chosen;
        Some(Primal {
            vertices,
            edges,
            faces,
            averages: Averages::Components,
        })
    }
}
