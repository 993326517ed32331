//! Motions of single bodies that nothing holds but rounding of the input.
//!
//! Normals that follow from coordinates of twelve digits resist the free turn of a pin by 1e-12 of what they resist a
//! push. Divided by that, what is left of the load would turn the pin by many thousand radians. A row whose direction
//! is known to an angle ε, with coefficients b, may do the work ε |b| |v| on a motion v by rounding alone. The motion
//! counts as free if the rows together do no more:
//!
//! ```text
//!     Σ (B v)²  ≤  Σ (ε |b| |v|)²
//! ```
//!
//! Motions of several bodies need no such measure. Their columns of G are large and cancel, and the pivot that is left
//! shows it to the root of rounding (`gram`).

use std::borrow::Cow;

use mpi::topology::SimpleCommunicator;

use super::by_column::ByColumn;
use super::gram::Gram;
use super::kernel_motion::KernelMotion;
use super::natural::NaturalCoarse;
use super::rows::KernelRows;

impl NaturalCoarse {
    /// All rows of B R, of which only the chosen ones may hold, without what they do by rounding alone. Collective.
    pub fn rows_without_noise(
        &self,
        comm: &SimpleCommunicator,
        chosen: &[bool],
    ) -> Cow<'_, KernelRows> {
        if self.noise.is_empty() {
            Cow::Borrowed(&self.all)
        } else {
            Cow::Owned(self.without_noise(self.all.clone(), &self.gram(comm, chosen)))
        }
    }

    /// G without what its rows do by rounding alone on the motions that count as free: they do nothing on these then,
    /// and multipliers need not balance it.
    pub(super) fn without_noise(&self, g: KernelRows, gram: &Gram) -> KernelRows {
        if self.noise.is_empty() {
            return g;
        }
        let motions = ByColumn::new(self.known(), gram.unheld.iter());
        let largest: Vec<f64> = gram.unheld.iter().map(KernelMotion::largest).collect();
        g.across(&motions, &largest, |c| self.noise[c as usize].sqrt())
    }
}
