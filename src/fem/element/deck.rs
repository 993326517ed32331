//! Which of our elements an element of a deck is.

use super::Integration;
use crate::fem::cell::Plane;
use crate::mesh::deck::{self, ElementType, Model};
use crate::mesh::CellKind;

/// How the stiffness of an element of a deck is integrated, and what a plane one models; [`Integration`] lists where
/// that differs from CalculiX, [`check`](super::check) says whether there is such an element.
///
/// What decks call full is not always: CalculiX integrates its wedges with fewer points.
pub fn deck_element(element: ElementType) -> (Integration, Option<Plane>) {
    let integration = match (element.integration(), element.kind()) {
        (deck::Integration::Full, CellKind::Wedge6 | CellKind::Wedge15) => Integration::Reduced,
        (deck::Integration::Full, _) => Integration::Full,
        (deck::Integration::Reduced, _) => Integration::Reduced,
        (deck::Integration::Incompatible, _) => Integration::Incompatible,
    };
    let plane = match element.model() {
        Model::Solid => None,
        Model::PlaneStrain => Some(Plane::Strain),
        Model::PlaneStress => Some(Plane::Stress),
        Model::Axisymmetric => Some(Plane::Axial),
    };
    (integration, plane)
}

#[cfg(test)]
#[path = "../../../tests/inside/fem/element/deck.rs"]
mod tests;
