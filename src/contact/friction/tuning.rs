//! The constants of friction.

/// The constants of friction. They decide how a loop comes to its end, and not which end is a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FrictionTuning {
    /// Factor on the reduction of the residual in a step while forces of friction change. Loose steps mislead the
    /// states.
    ///
    /// Ten times more: a roller bearing with friction takes 24 steps in place of 9; a hundred times more: 200 are not
    /// enough.
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
        finer: 1e-4,
        still: 5.0,
        slides: 8,
    };
}
