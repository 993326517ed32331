//! Dimension, physics and elements of a scene; the exact solution.

use super::document::{Item, Section, Source, Value};
use super::Reader;
use crate::error::Result;
use crate::fem::cell::{Cure, Element, Plane};
use crate::fem::{Form, Physics};
use crate::scene::model::expr::Expr;

impl<'a> Reader<'a> {
    /// Reads the keys of the scene on which all others depend.
    pub(super) fn new(source: &'a Source<'a>, scene: &mut Section<'a>) -> Result<Reader<'a>> {
        let mut reader = Reader {
            source,
            dim: 2,
            form: Form::default(),
        };
        if let Some(item) = scene.take("dimension") {
            reader.dim = match item.value {
                Value::Integer(d @ (2 | 3)) => d as usize,
                _ => return reader.expected(item, "2 or 3"),
            };
        }
        let elastic = match scene.take("physics") {
            None => false,
            Some(item) => reader.choice(item, &["scalar", "elasticity"])? == 1,
        };
        if let Some(item) = scene.take("element") {
            reader.form.element = match reader.choice(item, &["q1", "p1"])? {
                0 => Element::Q1,
                _ => Element::P1,
            };
        }
        let plane = match scene.take("plane") {
            None => Plane::Strain,
            Some(item) if !elastic || reader.dim == 3 => {
                return reader.error(
                    item,
                    "`plane` outside plane elasticity, where it says nothing",
                )
            }
            Some(item) => match reader.choice(item, &["strain", "stress"])? {
                0 => Plane::Strain,
                _ => Plane::Stress,
            },
        };
        let locking = scene.take("locking");
        let cure = match locking {
            None => Cure::None,
            Some(item) if !elastic => {
                return reader.error(item, "`locking` outside elasticity, where nothing locks")
            }
            Some(item) => match reader.choice(item, &["none", "selective", "bbar"])? {
                0 => Cure::None,
                1 => Cure::Selective,
                _ => Cure::BBar,
            },
        };
        if elastic {
            reader.form.physics = Physics::Elasticity { plane, cure };
        }
        if let Some(item) = locking {
            let material = reader.form.material(1.0, 0.3);
            if let Err(message) = material.check(reader.dim, reader.form.element) {
                return reader.error(item, message);
            }
        }
        Ok(reader)
    }

    /// The index of one of several words.
    pub(super) fn choice(&self, item: &Item, words: &[&str]) -> Result<usize> {
        let found = match &item.value {
            Value::Text(text) => words.iter().position(|w| w == text),
            _ => None,
        };
        match found {
            Some(k) => Ok(k),
            None => {
                let quoted: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
                let (last, first) = quoted.split_last().expect("one word at least");
                self.expected(item, &format!("{} or {last}", first.join(", ")))
            }
        }
    }

    /// The exact solution: an expression for each component.
    pub(super) fn exact(&self, item: &'a Item) -> Result<Vec<Expr>> {
        let c = self.form.components(self.dim);
        if c == 1 {
            return Ok(vec![self.expression(item)?]);
        }
        match &item.value {
            Value::List(items) if items.len() == c => {
                items.iter().map(|i| self.expression(i)).collect()
            }
            _ => self.expected(item, &format!("a list of {c} components")),
        }
    }

    /// `origin`, by default 0.
    pub(super) fn origin(&self, section: &mut Section<'a>) -> Result<[f64; 3]> {
        let wanted = ["a point [x, y]", "a point [x, y, z]"][self.dim - 2];
        match section.take("origin") {
            Some(item) => self.vector(item, wanted),
            None => Ok([0.0; 3]),
        }
    }

    /// The edge lengths of the unit box.
    pub(super) fn unit(&self) -> [f64; 3] {
        [1.0, 1.0, [0.0, 1.0][self.dim - 2]]
    }
}
