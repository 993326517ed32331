//! The kinds of preconditioners by the names that users write. No other file distinguishes them.

#[cfg(test)]
#[path = "../../../../tests/inside/feti/operators/preconditioner/table.rs"]
mod tests;

use super::coarse_corrected::COARSE_CORRECTED;
use super::dirichlet::DIRICHLET;
use super::identity::IDENTITY;
use super::lumped::LUMPED;
use super::PreconditionerKind;
use crate::feti::settings::PcType;

/// The preconditioner that `pc_type` asks for.
pub fn kind(pc_type: PcType) -> &'static PreconditionerKind {
    match pc_type {
        PcType::None => &IDENTITY,
        PcType::Lumped => &LUMPED,
        PcType::Dirichlet => &DIRICHLET,
        PcType::CoarseCorrected => &COARSE_CORRECTED,
    }
}
