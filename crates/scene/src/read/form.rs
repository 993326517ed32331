//! Dimension, physics and elements of a scene.

use super::document::{Item, TableSection, Value};
use super::SceneReader;
use base::Result;
use elements::cell::{Cure, Element, Plane};
use elements::element::Integration;
use elements::form::{Form, Physics};
use mesh::CellMesh;

/// How the cells of a body are integrated.
pub(super) fn integration(item: &Item) -> Result<Integration> {
    item.choice(&[
        ("full", Integration::Full),
        ("reduced", Integration::Reduced),
        ("incompatible", Integration::Incompatible),
    ])
}

/// The rule of every cell; none: all in full.
pub(super) fn rules(rule: Option<Integration>, mesh: &CellMesh) -> Vec<Integration> {
    match rule.unwrap_or_default() {
        Integration::Full => Vec::new(),
        rule => vec![rule; mesh.cells.len()],
    }
}

impl SceneReader {
    /// Reads the keys of the scene on which all others depend.
    pub(super) fn new(scene: &mut TableSection) -> Result<SceneReader> {
        let dim = scene.read("dimension", |item| match item.value {
            Value::Integer(d @ (2 | 3)) => Ok(d as usize),
            _ => item.expected("2 or 3"),
        })?;
        let dim = dim.unwrap_or(2);
        let mut form = Form::default();
        let physics = [("scalar", false), ("elasticity", true)];
        let elastic = scene.read("physics", |item| item.choice(&physics))? == Some(true);
        let elements = [("q1", Element::Q1), ("p1", Element::P1)];
        if let Some(element) = scene.read("element", |item| item.choice(&elements))? {
            form.element = element;
        }
        let plane = scene.read("plane", |item| {
            if !elastic || dim == 3 {
                item.error("`plane` outside plane elasticity, where it says nothing")
            } else {
                item.choice(&[
                    ("strain", Plane::Strain),
                    ("stress", Plane::Stress),
                    ("axisymmetric", Plane::Axial),
                ])
            }
        })?;
        let locking = scene.take("locking");
        let cure = locking.map(|item| {
            if elastic {
                item.choice(&[
                    ("none", Cure::None),
                    ("selective", Cure::Selective),
                    ("bbar", Cure::BBar),
                ])
            } else {
                item.error("`locking` outside elasticity, where nothing locks")
            }
        });
        let (plane, cure) = (plane.unwrap_or_default(), cure.transpose()?);
        if elastic {
            let cure = cure.unwrap_or_default();
            form.physics = Physics::Elasticity { plane, cure };
        }
        // Rings have no cells of boxes; what others refuse is said when their mesh is known.
        if let Some(item) = locking.filter(|_| !form.is_axial()) {
            let material = form.material(1.0, 0.3);
            if let Err(message) = material.check(dim, form.element) {
                return item.error(message);
            }
        }
        let order = scene.read("order", super::order)?.unwrap_or(1);
        Ok(SceneReader { order, dim, form })
    }
}
