//! `shape` of a body, and the rigid bodies of obstacles.

use super::document::{Item, TableSection, Value};
use super::SceneReader;
use crate::model::expr::Expr;
use crate::model::map::{BodyShape, Map, Round};
use crate::model::rigid::Rigid;
use base::linalg::vec3::unit;
use base::Result;
use mesh::BoxMesh;

impl SceneReader {
    /// How a box is bent: coordinates as expressions, or a named shape with its measures.
    pub(super) fn map(&self, item: &Item, mesh: &BoxMesh) -> Result<Map> {
        const FORMS: &str =
            "`x`, `y` (and `z`), `annulus`, `half_disc`, `quarter_disc`, `half_ball` or `quarter_ball`";
        let mut section = item.section("`shape`")?;
        let mut found = Vec::new();
        let axes = ["x", "y", "z"];
        let coordinates = axes.map(|key| section.take(key));
        if coordinates.iter().any(Option::is_some) {
            let mut e = axes.map(|key| Expr::parse(key).expect("a variable"));
            for (e, item) in e.iter_mut().zip(coordinates).take(self.dim) {
                if let Some(item) = item {
                    *e = self.expression(item)?;
                }
            }
            if let Some(item) = coordinates[2].filter(|_| self.dim == 2) {
                return item.error("`z` in a plane scene");
            }
            found.push(BodyShape::Expressions(e));
        }
        found.extend(section.read("annulus", |item| self.annulus(item))?);
        for (key, ball, quarter) in [
            ("half_disc", false, false),
            ("quarter_disc", false, true),
            ("half_ball", true, false),
            ("quarter_ball", true, true),
        ] {
            found.extend(section.read(key, |item| {
                if ball && self.dim == 2 {
                    item.error(format!("`{key}` in a plane scene"))
                } else {
                    Ok(BodyShape::Round(self.round(item, ball, quarter)?))
                }
            })?);
        }
        section.finish()?;
        Ok(Map {
            origin: mesh.origin,
            size: mesh.size,
            shape: item.only(found, "a shape", "shapes", FORMS)?,
        })
    }

    fn annulus(&self, item: &Item) -> Result<BodyShape> {
        let mut section = item.section("`annulus`")?;
        let centre = section.read("centre", |item| self.pair(item, "a point [x, y]"))?;
        let inner = self.positive(section.need("inner", "the inner radius")?)?;
        let outer_item = section.need("outer", "the outer radius")?;
        let outer = self.positive(outer_item)?;
        if outer <= inner {
            return outer_item.error(format!(
                "the outer radius {outer} where one above {inner} was expected"
            ));
        }
        let mut angle = |key| section.read(key, |item| self.number(item));
        let (from, to) = (angle("from")?.unwrap_or(0.0), angle("to")?.unwrap_or(90.0));
        section.finish()?;
        if !(from < to && to - from <= 360.0) {
            return item.error(format!(
                "angles from {from} to {to} degrees where from < to ≤ from + 360 was expected"
            ));
        }
        Ok(BodyShape::Annulus {
            centre: centre.unwrap_or_default(),
            radii: [inner, outer],
            // The reverse order would turn elements inside out: x runs outwards.
            angles: [from.to_radians(), to.to_radians()],
        })
    }

    fn round(&self, item: &Item, ball: bool, quarter: bool) -> Result<Round> {
        let mut section = item.section("this shape")?;
        let radius = self.positive(section.need("radius", "the radius")?)?;
        let centre = section.read("centre", |item| {
            if ball {
                self.vector(item, "a point [x, y, z]")
            } else {
                let [x, y] = self.pair(item, "a point [x, y]")?;
                Ok([x, y, 0.0])
            }
        })?;
        let grading = section.read("grading", |item| self.positive(item))?;
        let focus = section.read("focus", |item| self.positive(item))?;
        let trim = section.read("trim", |item| match self.positive(item)? {
            t if t <= 1.0 => Ok(t),
            t => item.error(format!("{t} where a fraction up to 1 was expected")),
        })?;
        let poles = [("bottom", false), ("top", true)];
        let upwards = section.read("pole", |item| item.choice(&poles))?;
        section.finish()?;
        Ok(Round {
            centre: centre.unwrap_or_default(),
            radius,
            quarter,
            ball,
            upwards: upwards.unwrap_or(false),
            grading: grading.unwrap_or(1.0),
            focus,
            trim: trim.unwrap_or(1.0),
        })
    }

    /// The rigid body of an obstacle, if it has one: `plane`, `cylinder` or `sphere`.
    pub(super) fn rigid(&self, section: &mut TableSection, entry: &Item) -> Result<Option<Rigid>> {
        let mut found = Vec::new();
        found.extend(section.read("plane", |item| {
            let mut plane = item.section("`plane`")?;
            let point = self.vector(plane.need("point", "a point of the plane")?, "a point")?;
            let normal = self.direction(plane.need("normal", "its normal")?)?;
            plane.finish()?;
            Ok(Rigid::Plane { point, normal })
        })?);
        for (key, sphere) in [("cylinder", false), ("sphere", true)] {
            found.extend(section.read(key, |item| self.rigid_round(item, sphere))?);
        }
        match found.len() {
            0 | 1 => Ok(found.pop()),
            _ => entry.error("several of `plane`, `cylinder` and `sphere` where one was expected"),
        }
    }

    fn rigid_round(&self, item: &Item, sphere: bool) -> Result<Rigid> {
        let mut round = item.section("this obstacle")?;
        let centre = self.vector(round.need("centre", "a point")?, "a point")?;
        let radius = self.positive(round.need("radius", "the radius")?)?;
        let axis = match (sphere, self.dim) {
            (true, 3) => None,
            // In the plane a sphere is a disc, too.
            (_, 2) => Some([0.0, 0.0, 1.0]),
            _ => Some(self.direction(round.need("axis", "the direction of its axis")?)?),
        };
        let cavity = round.read("cavity", |item| match item.value {
            Value::Truth(v) => Ok(v),
            _ => item.expected("true or false"),
        })?;
        round.finish()?;
        Ok(Rigid::Round {
            centre,
            axis,
            radius,
            cavity: cavity.unwrap_or(false),
        })
    }

    /// The unit vector in the given direction.
    fn direction(&self, item: &Item) -> Result<[f64; 3]> {
        match unit(self.vector(item, "a direction")?) {
            Some(direction) => Ok(direction),
            None => item.error("the direction 0 where a vector was expected"),
        }
    }
}
