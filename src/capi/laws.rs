//! The law of a row in contact: friction, and stiffnesses where it is soft.

use crate::substructures::{FrictionBound, Law};
use crate::Result;
use base::Fault;

/// PETSC_INFINITY.
pub const INFINITY: f64 = f64::MAX / 4.0;

/// The law of a row beyond (B u)_r ≤ gap_r: forces and stiffnesses of the row, or of its unit area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLaw {
    friction: Option<FrictionBound>,
    /// The multiplier over the overclosure; ∞ for hard contact.
    stiffness: f64,
    /// The force of friction over the elastic slip; ∞ without one.
    stick_stiffness: f64,
}

/// The law as the host gives it, each number if it does.
#[derive(Debug, Clone, Copy, Default)]
pub struct GivenLaw {
    pub friction: Option<f64>,
    pub limit: Option<f64>,
    pub tresca: Option<f64>,
    pub stiffness: Option<f64>,
    pub stick_stiffness: Option<f64>,
}

impl Default for ContactLaw {
    fn default() -> ContactLaw {
        ContactLaw {
            friction: None,
            stiffness: f64::INFINITY,
            stick_stiffness: f64::INFINITY,
        }
    }
}

impl ContactLaw {
    /// The law of what `whose` names.
    ///
    /// # Errors
    /// Numbers out of range; numbers that do not go together.
    pub fn new(given: &GivenLaw, whose: &dyn Fn() -> String) -> Result<ContactLaw> {
        let bounds = [
            ("a coefficient of friction", given.friction),
            ("a limit of friction", given.limit),
            ("a Tresca bound", given.tresca),
        ];
        let stiffnesses = [
            ("a contact stiffness", given.stiffness),
            ("a stick stiffness", given.stick_stiffness),
        ];
        let out = |what: &str, v: f64, expected: &str| {
            Err(Fault::OutOfRange.error(format!(
                "{} has {what} of {v}, expected {expected}",
                whose()
            )))
        };
        for (what, value) in bounds {
            if let Some(v) = value.filter(|v| v.is_nan() || *v < 0.0) {
                return out(what, v, "a number that is not negative");
            }
        }
        for (what, value) in stiffnesses {
            if let Some(v) = value.filter(|v| v.is_nan() || *v <= 0.0) {
                return out(what, v, "a positive number");
            }
        }
        let finite = |v: Option<f64>| v.filter(|v| *v < INFINITY);
        let positive = |v: Option<f64>| v.filter(|v| *v > 0.0);
        let wrong = |what: &str, expected: &str| {
            Err(Fault::Wrong.error(format!("{} has {what}, expected {expected}", whose())))
        };
        let friction = match (positive(given.friction), positive(given.tresca)) {
            (Some(_), Some(_)) => {
                return wrong(
                    "a Tresca bound beside a coefficient of friction",
                    "one of them",
                );
            }
            (Some(coefficient), None) => Some(FrictionBound::Coulomb {
                coefficient,
                limit: finite(given.limit).unwrap_or(f64::INFINITY),
            }),
            (None, Some(bound)) => Some(FrictionBound::Tresca(bound)),
            (None, None) => None,
        };
        if finite(given.limit).is_some() && given.friction.is_none() {
            return wrong(
                "a limit of friction without friction",
                "a coefficient of friction beside it",
            );
        }
        let slides = given.friction.or(given.tresca).is_some();
        if finite(given.stick_stiffness).is_some() && !slides {
            return wrong(
                "a stick stiffness without friction",
                "a coefficient of friction or a Tresca bound beside it",
            );
        }
        Ok(ContactLaw {
            friction,
            stiffness: finite(given.stiffness).unwrap_or(f64::INFINITY),
            stick_stiffness: finite(given.stick_stiffness).unwrap_or(f64::INFINITY),
        })
    }

    /// Whether a row of this kind may have the law.
    ///
    /// # Errors
    /// An equation whose law is another one than that of hard contact without friction.
    pub fn suits(&self, kind: Law, whose: &dyn Fn() -> String) -> Result<()> {
        if kind.is_inequality() || *self == ContactLaw::default() {
            return Ok(());
        }
        let what = match self.friction {
            Some(_) => "friction",
            None => "a contact stiffness",
        };
        Err(Fault::Wrong.error(format!(
            "{} has {what} and is an equation, expected an inequality",
            whose()
        )))
    }

    /// Whether it has friction.
    pub fn has_friction(&self) -> bool {
        self.friction.is_some()
    }

    /// The bound of the force of friction of a row of this area; `None` without friction.
    pub fn bound(&self, area: f64) -> Option<FrictionBound> {
        self.friction.map(|friction| match friction {
            FrictionBound::Coulomb { coefficient, limit } => FrictionBound::Coulomb {
                coefficient,
                limit: limit * area,
            },
            FrictionBound::Tresca(bound) => FrictionBound::Tresca(bound * area),
        })
    }

    /// By how much a unit force compresses a normal row of this area.
    pub fn compliance(&self, area: f64) -> f64 {
        1.0 / (self.stiffness * area)
    }

    /// By how much a unit force moves a tangential row of this area while it sticks.
    pub fn stick_compliance(&self, area: f64) -> f64 {
        1.0 / (self.stick_stiffness * area)
    }

    /// The numbers of the law; those of one law are the same.
    pub fn numbers(&self) -> [f64; 5] {
        let [coefficient, limit, bound] = match self.friction {
            None => [0.0, f64::INFINITY, 0.0],
            Some(FrictionBound::Coulomb { coefficient, limit }) => [coefficient, limit, 0.0],
            Some(FrictionBound::Tresca(bound)) => [0.0, f64::INFINITY, bound],
        };
        [
            coefficient,
            limit,
            bound,
            self.stiffness,
            self.stick_stiffness,
        ]
    }
}

#[cfg(test)]
#[path = "../../tests/inside/capi/laws.rs"]
mod tests;
