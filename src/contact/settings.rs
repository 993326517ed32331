//! Options of the contact loop (prefix `fetifeti_contact_`).

use super::tuning::Tuning;
use crate::{Error, Result};
use petsc::{named, Options};

/// The method of the outer loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ContactType {
    /// Primal-dual active set; damped Newton steps on the augmented Lagrangian where its sets wander.
    ActiveSet,
    /// Damped Newton steps on the augmented Lagrangian from the start.
    AugmentedLagrangian,
    /// SMALBE-M with MPRGP.
    Smalbe,
}

named!(ContactType {
    ActiveSet = "active_set",
    AugmentedLagrangian = "augmented_lagrangian",
    Smalbe = "smalbe",
});

/// Settings of the contact loop.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactSettings {
    /// `fetifeti_contact_type`.
    pub kind: ContactType,
    /// `fetifeti_contact_max_it`: outer steps.
    pub max_it: usize,
    /// `fetifeti_contact_inner_rtol`: reduction of the residual, in (0, 1), in a step of the active-set method while
    /// the set still changes.
    pub inner_rtol: f64,
    /// `fetifeti_contact_face_pc`: whether M⁻¹ preconditions SMALBE inside the free face.
    pub face_pc: bool,
    /// The constants of the loop. They have no options.
    pub tuning: Tuning,
}

impl Default for ContactSettings {
    fn default() -> Self {
        ContactSettings {
            kind: ContactType::ActiveSet,
            max_it: 200,
            inner_rtol: 0.1,
            face_pc: true,
            tuning: Tuning::DEFAULT,
        }
    }
}

impl ContactSettings {
    /// These settings, overridden by the options.
    pub(crate) fn with_options(mut self, o: &Options) -> Result<ContactSettings> {
        let help = "method of the contact loop";
        self.kind = o.named("contact_type", self.kind, help)?;
        let help = "outer steps of the contact loop at most";
        self.max_it = o.usize("contact_max_it", self.max_it, help)?;
        let help = "reduction of the residual per contact step while the active set changes";
        self.inner_rtol = o.f64("contact_inner_rtol", self.inner_rtol, help)?;
        if !(self.inner_rtol > 0.0 && self.inner_rtol < 1.0) {
            return Err(Error::input(format!(
                "option {} is {}, expected a number between 0 and 1",
                o.full_name("contact_inner_rtol"),
                self.inner_rtol
            )));
        }
        let help = "precondition SMALBE inside the free face";
        self.face_pc = o.bool("contact_face_pc", self.face_pc, help)?;
        Ok(self)
    }
}
