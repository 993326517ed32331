//! A second load for the same matrix, to measure a solve with everything set up. It is the first load times a factor
//! that is linear in the coordinates, so that contact zones move.

use crate::assembled::layout::UnknownLayout;
use crate::assembled::unknowns::Unknowns;
use base::Result;
use petsc::Vec as PetscVec;

/// Slopes of the factor along x and y, relative to half the size of the scene.
const SLOPE: [f64; 2] = [0.3, -0.2];

/// The factor 1 + a·(x − centre) / radius.
pub struct SecondLoad {
    centre: [f64; 3],
    radius: f64,
}

impl SecondLoad {
    /// The factor on the scene of `layout`.
    pub fn new(layout: &UnknownLayout) -> SecondLoad {
        let (centre, radius) = layout.ball();
        SecondLoad { centre, radius }
    }

    /// The factor at a place of w.
    pub fn at(&self, layout: &UnknownLayout, place: u64) -> f64 {
        self.value(layout.position(place / layout.components() as u64))
    }

    /// The load `b` on `unknowns` times the factor. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of(&self, unknowns: &Unknowns, b: &PetscVec) -> Result<PetscVec> {
        let second = b.duplicate()?;
        second.copy_from(b)?;
        let places = unknowns.places(b.ownership_range());
        for (b, place) in second.array_mut()?.iter_mut().zip(places) {
            *b *= self.at(unknowns.layout, place);
        }
        Ok(second)
    }

    fn value(&self, x: [f64; 3]) -> f64 {
        let part = |d: usize| SLOPE[d] * (x[d] - self.centre[d]) / self.radius;
        1.0 + part(0) + part(1)
    }
}

#[cfg(test)]
#[path = "../../tests/baselines/second.rs"]
mod tests;
