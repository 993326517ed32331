//! The physical problem in words.

use crate::fem::cell::{Cure, Element, Plane};
use crate::fem::Physics;
use crate::scene::Scene;

/// Equation and elements, such as "plane strain elasticity, Q1, no cure of locking". Units are those of the scene.
pub fn form(scene: &Scene) -> String {
    let element = match scene.form.element {
        Element::Q1 => "Q1",
        Element::P1 => "P1",
    };
    let solid = scene.dim() == 3;
    let (equation, cure) = match scene.form.physics {
        Physics::Scalar if solid => ("three-dimensional scalar", None),
        Physics::Scalar => ("plane scalar", None),
        Physics::Elasticity { plane, cure } => (
            match plane {
                _ if solid => "three-dimensional elasticity",
                Plane::Strain => "plane strain elasticity",
                Plane::Stress => "plane stress elasticity",
                Plane::Axial => "axisymmetric elasticity",
            },
            Some(match cure {
                Cure::None => "no cure of locking",
                Cure::Selective => "selective reduced integration",
                Cure::BBar => "B-bar",
            }),
        ),
    };
    let parts = [Some(equation), Some(element), cure];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
#[path = "../../tests/inside/cli/physics.rs"]
mod tests;
