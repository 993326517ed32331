//! The physical problem in words.

use elements::cell::{Cure, Element, Plane};
use elements::form::Physics;
use elements::kind::CellKind;
use mesh::Mesh;
use scene::Scene;
use std::collections::BTreeSet;

/// Equation and elements, such as "plane strain elasticity, Q1, no cure of locking". Units are those of the scene.
pub fn form(scene: &Scene) -> String {
    let element = elements(scene);
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
    let parts = [Some(equation), Some(&element[..]), cure];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The elements of all bodies: "Q1" or "P1" on boxes, the kinds of cells on meshes.
fn elements(scene: &Scene) -> String {
    let mut kinds: BTreeSet<CellKind> = BTreeSet::new();
    let mut boxes = false;
    for body in &scene.bodies {
        match body.mesh() {
            Mesh::Grid(_) => boxes = true,
            Mesh::Cells(mesh) => kinds.extend(mesh.cells.kinds()),
        }
    }
    let of_boxes = boxes.then_some(match scene.form.element {
        Element::Q1 => "Q1",
        Element::P1 => "P1",
    });
    let names = of_boxes
        .into_iter()
        .chain(kinds.into_iter().map(|kind| kind.name()));
    names.collect::<Vec<&str>>().join(" and ")
}

#[cfg(test)]
#[path = "../tests/physics.rs"]
mod tests;
