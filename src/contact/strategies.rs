//! The strategies of the contact loop. A new one is a file with a [`Strategy`] and a line here.
//!
//! | strategy | proposes |
//! |---|---|
//! | [`ActiveSet`] | the equations on the set that multipliers and gaps ask for |
//! | [`AugmentedLagrangian`] | semismooth Newton steps on springs, and trials of the sets that they find |
//! | [`Smalbe`] | bound-constrained problems by MPRGP, and trials of the sets that they find |
//!
//! A trial wraps a strategy: it is an [`ActiveSet`] that is followed for as long as it comes nearer.

use super::active_set::ActiveSet;
use super::lagrangian::AugmentedLagrangian;
use super::settings::{ContactSettings, ContactType};
use super::smalbe::Smalbe;
use super::state::State;
use super::strategy::Strategy;
use crate::feti::LinearMethod;
use crate::Result;

/// The strategy of this kind, from `start` or from scratch. Collective.
///
/// # Errors
/// Bodies that the load pushes away for ever; PETSc's own errors.
pub(super) fn begin<'a>(
    kind: ContactType,
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    start: Option<State>,
) -> Result<Box<dyn Strategy + 'a>> {
    let cold = || State::cold(&method.dual().stiffness.jump);
    Ok(match kind {
        ContactType::ActiveSet => Box::new(ActiveSet::new(method, settings, start.as_ref())?),
        ContactType::AugmentedLagrangian => {
            let state = start.unwrap_or_else(cold);
            Box::new(AugmentedLagrangian::new(method, settings, state)?)
        }
        ContactType::Smalbe => {
            let state = start.unwrap_or_else(cold);
            Box::new(Smalbe::new(method, settings, state)?)
        }
    })
}
