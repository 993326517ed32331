//! Conditions on sides of bodies: given values, fluxes, tractions, pressures.

use super::document::{Item, TableSection, Value};
use super::SceneReader;
use crate::model::body::{free_all_round, held, held_all_round, Force, GivenSides, SurfaceLoad};
use crate::model::field::Field;
use base::Result;

impl SceneReader {
    /// Dirichlet conditions: "all", "none", a list of sides held at zero, or a table of values.
    pub(super) fn sides(&self, item: &Item) -> Result<GivenSides> {
        let mut sides = free_all_round();
        let mut hold = |side: usize, given: [Option<Field>; 3]| {
            let n = sides.len().max(side + 1);
            sides.resize(n, [const { None }; 3]);
            sides[side] = given;
        };
        let names = self.sides_list().replace(" or ", ", ");
        match &item.value {
            _ if item.is("all") => return Ok(held_all_round()),
            _ if item.is("none") => {}
            Value::List(items) => {
                for item in items {
                    item.text(&format!("a side ({names})"))?;
                    hold(self.side(item)?, held());
                }
            }
            Value::Table(_) => {
                for (side, given) in self.by_side(item, "`dirichlet`", |i| self.given(i))? {
                    hold(side, given);
                }
            }
            _ => {
                return item.expected(format!(
                    "\"all\", a list of sides ({names}) or a table of their values"
                ))
            }
        }
        Ok(sides)
    }

    /// The given values of one side: one for all components, a list of them, or a table with some of the keys x, y, z.
    pub(super) fn given(&self, item: &Item) -> Result<[Option<Field>; 3]> {
        let c = self.form.components(self.dim);
        let mut out = [const { None }; 3];
        match &item.value {
            Value::List(items) if c > 1 && items.len() == c => {
                for (value, item) in out.iter_mut().zip(items) {
                    *value = Some(self.formula(item)?);
                }
            }
            Value::Table(_) if c > 1 => {
                let mut section = item.section("this side")?;
                out = self.by_axis(&mut section, |i| self.formula(i))?;
                section.finish()?;
            }
            Value::List(_) if c > 1 => {
                let found = item.value.kind();
                return item.error(format!("{found} where {c} components were expected"));
            }
            _ => out[..c].fill(Some(self.formula(item)?)),
        }
        Ok(out)
    }

    /// Loads on sides: `flux` of a scalar, `traction` and `pressure` in elasticity. A key that is there replaces what
    /// `loads` has of its kind.
    pub(super) fn surface_loads(
        &self,
        section: &mut TableSection,
        loads: &mut Vec<SurfaceLoad>,
    ) -> Result<()> {
        let traction = |item: &Item| {
            let list = self.components(item)?;
            let fields = list.into_iter().map(Field::Expression);
            Ok(Force::Traction(fields.collect()))
        };
        let pressure = |item: &Item| Ok(Force::Pressure(self.formula(item)?));
        let found = if self.form.is_elastic() {
            vec![
                section.read("traction", |i| self.by_side(i, "traction", traction))?,
                section.read("pressure", |i| self.by_side(i, "pressure", pressure))?,
            ]
        } else {
            vec![section.read("flux", |i| self.by_side(i, "flux", traction))?]
        };
        for (kind, found) in found.into_iter().enumerate() {
            let Some(found) = found else { continue };
            let is_pressure = |load: &SurfaceLoad| matches!(load.force, Force::Pressure(_));
            loads.retain(|load| is_pressure(load) != (kind == 1));
            let each = found.into_iter();
            loads.extend(each.map(|(side, force)| SurfaceLoad { side, force }));
        }
        Ok(())
    }

    /// Elastic foundations on sides.
    pub(super) fn springs(
        &self,
        section: &mut TableSection,
    ) -> Result<Option<Vec<(usize, Field)>>> {
        let read = |item| self.by_side(item, "`spring`", |i| self.formula(i));
        section.read("spring", read)
    }

    /// A number or an expression as a field.
    pub(super) fn formula(&self, item: &Item) -> Result<Field> {
        self.expression(item).map(Field::Expression)
    }
}
