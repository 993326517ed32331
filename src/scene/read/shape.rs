//! `shape` of a body, and the rigid bodies of obstacles.

use super::document::{Item, Section, Value};
use super::Reader;
use crate::error::Result;
use crate::linalg::vec3::norm;
use crate::scene::model::expr::Expr;
use crate::scene::model::map::{BodyShape, Map, Round};
use crate::scene::model::rigid::Rigid;

impl<'a> Reader<'a> {
    /// How a box is bent: coordinates as expressions, or a named shape with its measures.
    pub(super) fn map(&self, item: &'a Item, origin: [f64; 3], size: [f64; 3]) -> Result<Map> {
        const FORMS: &str =
            "`x`, `y` (and `z`), `annulus`, `half_disc`, `quarter_disc`, `half_ball` or `quarter_ball`";
        let mut section = Section::new(self.source, "`shape`", item)?;
        let mut found = Vec::new();
        let coordinates = ["x", "y", "z"].map(|key| section.take(key));
        if coordinates.iter().any(Option::is_some) {
            let mut e = ["x", "y", "z"].map(|key| Expr::parse(key).expect("a variable"));
            for (e, item) in e.iter_mut().zip(coordinates).take(self.dim) {
                if let Some(item) = item {
                    *e = self.expression(item)?;
                }
            }
            if let Some(item) = coordinates[2].filter(|_| self.dim == 2) {
                return self.error(item, "`z` in a plane scene");
            }
            found.push(BodyShape::Expressions(e));
        }
        if let Some(item) = section.take("annulus") {
            found.push(self.annulus(item)?);
        }
        for (key, ball, quarter) in [
            ("half_disc", false, false),
            ("quarter_disc", false, true),
            ("half_ball", true, false),
            ("quarter_ball", true, true),
        ] {
            if let Some(item) = section.take(key) {
                if ball && self.dim == 2 {
                    return self.error(item, format_args!("`{key}` in a plane scene"));
                }
                found.push(BodyShape::Round(self.round(item, ball, quarter)?));
            }
        }
        section.finish()?;
        match found.len() {
            1 => Ok(Map {
                origin,
                size,
                shape: found.remove(0),
            }),
            0 => self.error(item, format_args!("a shape without {FORMS}")),
            n => self.error(
                item,
                format_args!("{n} shapes where one of {FORMS} was expected"),
            ),
        }
    }

    fn annulus(&self, item: &'a Item) -> Result<BodyShape> {
        let mut section = Section::new(self.source, "`annulus`", item)?;
        let centre = match section.take("centre") {
            Some(item) => self.pair(item, "a point [x, y]")?,
            None => [0.0; 2],
        };
        let inner = self.positive(section.need("inner", "the inner radius")?)?;
        let outer_item = section.need("outer", "the outer radius")?;
        let outer = self.positive(outer_item)?;
        if outer <= inner {
            return self.error(
                outer_item,
                format_args!("the outer radius {outer} where one above {inner} was expected"),
            );
        }
        let mut angle = |key, otherwise: f64| match section.take(key) {
            Some(item) => self.number(item),
            None => Ok(otherwise),
        };
        let (from, to) = (angle("from", 0.0)?, angle("to", 90.0)?);
        section.finish()?;
        if !(from < to && to - from <= 360.0) {
            return self.error(
                item,
                format_args!(
                    "angles from {from} to {to} degrees where from < to ≤ from + 360 was expected"
                ),
            );
        }
        Ok(BodyShape::Annulus {
            centre,
            radii: [inner, outer],
            // The reverse order would turn elements inside out: x runs outwards.
            angles: [from.to_radians(), to.to_radians()],
        })
    }

    fn round(&self, item: &'a Item, ball: bool, quarter: bool) -> Result<Round> {
        let mut section = Section::new(self.source, "this shape", item)?;
        let radius = self.positive(section.need("radius", "the radius")?)?;
        let centre = match section.take("centre") {
            None => [0.0; 3],
            Some(item) if ball => self.vector(item, "a point [x, y, z]")?,
            Some(item) => {
                let [x, y] = self.pair(item, "a point [x, y]")?;
                [x, y, 0.0]
            }
        };
        let grading = match section.take("grading") {
            Some(item) => self.positive(item)?,
            None => 1.0,
        };
        let focus = match section.take("focus") {
            Some(item) => Some(self.positive(item)?),
            None => None,
        };
        let trim = match section.take("trim") {
            Some(item) => match self.positive(item)? {
                t if t <= 1.0 => t,
                t => {
                    return self.error(
                        item,
                        format_args!("{t} where a fraction up to 1 was expected"),
                    )
                }
            },
            None => 1.0,
        };
        let upwards = match section.take("pole") {
            Some(item) => self.choice(item, &["bottom", "top"])? == 1,
            None => false,
        };
        section.finish()?;
        Ok(Round {
            centre,
            radius,
            quarter,
            ball,
            upwards,
            grading,
            focus,
            trim,
        })
    }

    /// The rigid body of an obstacle, if it has one: `plane`, `cylinder` or `sphere`.
    pub(super) fn rigid(&self, section: &mut Section<'a>, entry: &Item) -> Result<Option<Rigid>> {
        let mut found = Vec::new();
        if let Some(item) = section.take("plane") {
            let mut plane = Section::new(self.source, "`plane`", item)?;
            let point = self.vector(plane.need("point", "a point of the plane")?, "a point")?;
            let normal = self.direction(plane.need("normal", "its normal")?)?;
            plane.finish()?;
            found.push(Rigid::Plane { point, normal });
        }
        for key in ["cylinder", "sphere"] {
            let Some(item) = section.take(key) else {
                continue;
            };
            let mut round = Section::new(self.source, "this obstacle", item)?;
            let centre = self.vector(round.need("centre", "a point")?, "a point")?;
            let radius = self.positive(round.need("radius", "the radius")?)?;
            let axis = match (key, self.dim) {
                ("sphere", 3) => None,
                // In the plane a sphere is a disc, too.
                (_, 2) => Some([0.0, 0.0, 1.0]),
                _ => Some(self.direction(round.need("axis", "the direction of its axis")?)?),
            };
            let cavity = match round.take("cavity") {
                None => false,
                Some(item) => match item.value {
                    Value::Truth(v) => v,
                    _ => return self.expected(item, "true or false"),
                },
            };
            round.finish()?;
            found.push(Rigid::Round {
                centre,
                axis,
                radius,
                cavity,
            });
        }
        match found.len() {
            0 => Ok(None),
            1 => Ok(found.pop()),
            _ => self.error(
                entry,
                "several of `plane`, `cylinder` and `sphere` where one was expected",
            ),
        }
    }

    /// The unit vector in the given direction.
    fn direction(&self, item: &'a Item) -> Result<[f64; 3]> {
        let v = self.vector(item, "a direction")?;
        let length = norm(v);
        if length > 0.0 {
            Ok(v.map(|c| c / length))
        } else {
            self.error(item, "the direction 0 where a vector was expected")
        }
    }

    fn positive(&self, item: &Item) -> Result<f64> {
        match self.number(item)? {
            v if v > 0.0 => Ok(v),
            v => self.error(
                item,
                format_args!("{v} where a positive number was expected"),
            ),
        }
    }
}
