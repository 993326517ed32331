//! Conditions on sides of bodies: given values, fluxes, tractions, pressures.

use super::document::{Item, Section, Value};
use super::Reader;
use crate::error::Result;
use crate::scene::model::field::Field;
use crate::scene::model::spec::{free_all_round, held_all_round, Force, Sides, SurfaceLoad, SIDES};

impl<'a> Reader<'a> {
    /// Dirichlet conditions: "all", "none", a list of sides held at zero, or a table of values.
    pub(super) fn sides(&self, item: &'a Item) -> Result<Sides> {
        let mut sides = free_all_round();
        let names = self.sides_list().replace(" or ", ", ");
        let wanted = format!("\"all\", a list of sides ({names}) or a table of their values");
        match &item.value {
            Value::Text(text) if text == "all" => sides = held_all_round(),
            Value::Text(text) if text == "none" => {}
            Value::List(items) => {
                for item in items {
                    self.text(item, &format!("a side ({names})"))?;
                    sides[self.side(item)?] = held_all_round()[0].clone();
                }
            }
            Value::Table(_) => {
                let mut section = Section::new(self.source, "`dirichlet`", item)?;
                for (side, name) in sides.iter_mut().zip(SIDES).take(2 * self.dim) {
                    if let Some(value) = section.take(name) {
                        *side = self.given(value)?;
                    }
                }
                section.finish()?;
            }
            _ => return self.expected(item, &wanted),
        }
        Ok(sides)
    }

    /// The given values of one side: one for all components, a list of them, or a table with some of the keys x, y, z.
    fn given(&self, item: &'a Item) -> Result<[Option<Field>; 3]> {
        let c = self.form.components(self.dim);
        let field = |item| Ok(Some(Field::Expression(self.expression(item)?)));
        let mut out = [const { None }; 3];
        match &item.value {
            Value::List(items) if c > 1 && items.len() == c => {
                for (value, item) in out.iter_mut().zip(items) {
                    *value = field(item)?;
                }
            }
            Value::Table(_) if c > 1 => {
                let mut section = Section::new(self.source, "this side", item)?;
                for (value, key) in out.iter_mut().zip(["x", "y", "z"]).take(c) {
                    if let Some(item) = section.take(key) {
                        *value = field(item)?;
                    }
                }
                section.finish()?;
            }
            Value::List(_) if c > 1 => {
                return self.error(
                    item,
                    format_args!("{} where {c} components were expected", item.value.kind()),
                )
            }
            _ => out[..c].fill(field(item)?),
        }
        Ok(out)
    }

    /// Loads on sides: `flux` of a scalar, `traction` and `pressure` in elasticity.
    pub(super) fn surface_loads(&self, section: &mut Section<'a>) -> Result<Vec<SurfaceLoad>> {
        let mut out = Vec::new();
        let elastic = self.form.is_elastic();
        for (key, meant) in [
            ("flux", !elastic),
            ("traction", elastic),
            ("pressure", elastic),
        ] {
            let Some(item) = (if meant { section.take(key) } else { None }) else {
                continue;
            };
            let mut sides = Section::new(self.source, key, item)?;
            for (side, name) in SIDES.into_iter().enumerate().take(2 * self.dim) {
                let Some(value) = sides.take(name) else {
                    continue;
                };
                let force = match key {
                    "pressure" => Force::Pressure(Field::Expression(self.expression(value)?)),
                    _ => Force::Traction(self.components(value)?),
                };
                out.push(SurfaceLoad { side, force });
            }
            sides.finish()?;
        }
        Ok(out)
    }

    /// Elastic foundations on sides.
    pub(super) fn springs(&self, section: &mut Section<'a>) -> Result<Vec<(usize, Field)>> {
        let mut out = Vec::new();
        let Some(item) = section.take("spring") else {
            return Ok(out);
        };
        let mut sides = Section::new(self.source, "`spring`", item)?;
        for (side, name) in SIDES.into_iter().enumerate().take(2 * self.dim) {
            if let Some(value) = sides.take(name) {
                out.push((side, Field::Expression(self.expression(value)?)));
            }
        }
        sides.finish()?;
        Ok(out)
    }

    /// An expression for each component.
    fn components(&self, item: &'a Item) -> Result<Vec<Field>> {
        let c = self.form.components(self.dim);
        if c == 1 {
            return Ok(vec![Field::Expression(self.expression(item)?)]);
        }
        match &item.value {
            Value::List(items) if items.len() == c => items
                .iter()
                .map(|i| Ok(Field::Expression(self.expression(i)?)))
                .collect(),
            _ => self.expected(item, &format!("a list of {c} components")),
        }
    }
}
