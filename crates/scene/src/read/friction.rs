//! The keys of friction and of softness in [[contact]] and [[obstacle]].

use super::document::{Item, TableSection, Value};
use super::SceneReader;
use crate::model::friction::{ContactLaw, FrictionSpec};
use crate::model::profile::Profile;
use base::Result;

impl SceneReader {
    /// The law of an entry: friction, `stiffness` and `stick_stiffness`.
    pub(super) fn law(&self, section: &mut TableSection) -> Result<ContactLaw> {
        let friction = self.friction(section)?;
        let soft = section.take("stiffness");
        if let (Some(item), false) = (soft, self.form.is_elastic()) {
            return item.error(
                "`stiffness` in a scene with one unknown at a node, where physics = \"elasticity\" was expected",
            );
        }
        let stiffness = soft.map(|item| self.stiffness(item)).transpose()?;
        let stick = section.take("stick_stiffness");
        if let (Some(stick), None) = (stick, &friction) {
            return stick.error("`stick_stiffness` without `friction` or `tresca`");
        }
        Ok(ContactLaw {
            friction,
            stiffness,
            stick_stiffness: stick.map(|item| self.stiffness(item)).transpose()?,
        })
    }

    /// A positive number, or an expression or a table.
    fn stiffness(&self, item: &Item) -> Result<Profile> {
        match number(item) {
            Some(v) if !(v > 0.0 && v.is_finite()) => {
                item.error(format!("{v} where a positive number was expected"))
            }
            _ => self.profile(item),
        }
    }

    /// `friction` with `friction_limit`, or `tresca`.
    fn friction(&self, section: &mut TableSection) -> Result<Option<FrictionSpec>> {
        let friction = section.take("friction");
        let limit = section.take("friction_limit");
        let tresca = section.take("tresca");
        let Some(first) = friction.or(limit).or(tresca) else {
            return Ok(None);
        };
        if !self.form.is_elastic() {
            return first.error(
                "friction in a scene with one unknown at a node, where physics = \"elasticity\" was expected",
            );
        }
        match (friction, limit, tresca) {
            (Some(_), _, Some(tresca)) => tresca.error(
                "`tresca` beside `friction` where one was expected (a bound that does not depend on the pressure, or \
                 one that does)",
            ),
            (None, Some(limit), _) => {
                limit.error("`friction_limit` without `friction`, which it limits")
            }
            (Some(friction), limit, None) => Ok(Some(FrictionSpec::Coulomb {
                coefficient: self.bound(friction)?,
                limit: limit.map(|item| self.bound(item)).transpose()?,
            })),
            (None, None, Some(tresca)) => Ok(Some(FrictionSpec::Tresca(self.bound(tresca)?))),
            (None, None, None) => Ok(None),
        }
    }

    /// A number that is not negative, or an expression or a table, whose values are looked at node by node.
    fn bound(&self, item: &Item) -> Result<Profile> {
        match number(item) {
            Some(v) if !(v >= 0.0 && v.is_finite()) => item.error(format!(
                "{v} where a number that is not negative was expected"
            )),
            _ => self.profile(item),
        }
    }
}

/// A number, if it is one.
fn number(item: &Item) -> Option<f64> {
    match item.value {
        Value::Integer(v) => Some(v as f64),
        Value::Number(v) => Some(v),
        _ => None,
    }
}
