//! Which of our elements an element of a deck is.

use deck::{ElementModel, ElementType};
use elements::cell::Plane;
use elements::element::Integration;
use elements::kind::CellKind;

/// How the stiffness of an element of a deck is integrated, and what a plane one models; [`Integration`] lists where
/// that differs from CalculiX, [`check`](elements::element::check) says whether there is such an element.
///
/// Full integration in the sense of decks is not always full: CalculiX integrates its wedges with fewer points.
pub fn deck_element(element: ElementType) -> (Integration, Option<Plane>) {
    let integration = match (element.integration(), element.kind()) {
        (deck::Integration::Full, CellKind::Wedge6 | CellKind::Wedge15) => Integration::Reduced,
        (deck::Integration::Full, _) => Integration::Full,
        (deck::Integration::Reduced, _) => Integration::Reduced,
        (deck::Integration::Incompatible, _) => Integration::Incompatible,
    };
    let plane = match element.model() {
        ElementModel::Solid => None,
        ElementModel::PlaneStrain => Some(Plane::Strain),
        ElementModel::PlaneStress => Some(Plane::Stress),
        ElementModel::Axisymmetric => Some(Plane::Axial),
    };
    (integration, plane)
}

#[cfg(test)]
#[path = "../../tests/deck/element.rs"]
mod tests;
