//! The constants of friction.

/// The constants of friction. They decide how a loop comes to its end, and not which end is a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FrictionTuning {
    /// Factor on the reduction of the residual in a step while forces of friction change.
    pub finer: f64,
    /// Forces of friction are at rest if a step moves none by more than this many tolerances, relative to the largest
    /// force of a row.
    pub still: f64,
    /// A body slides away if nothing but friction beyond its bound has held it after this many steps in a row.
    pub slides: usize,
}

impl FrictionTuning {
    /// The constants as they are used.
    pub const DEFAULT: FrictionTuning = FrictionTuning {
        finer: 1e-2,
        still: 1.0,
        slides: 8,
    };
}
