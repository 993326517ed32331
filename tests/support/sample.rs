//! Some of the cases in `make test`, all of them in `make test-all`.
//!
//! Tests with many cases take a sample, and order their cases so that what differs most is in it.

/// Whether all cases are wanted: `make test-all` sets this variable.
pub fn all_cases() -> bool {
    std::env::var_os("FETIFETI_TEST_ALL").is_some()
}

/// Every `every`-th case from the first on, or all of them.
pub fn sample<T>(
    every: usize,
    cases: impl IntoIterator<Item = T>,
) -> std::iter::StepBy<impl Iterator<Item = T>> {
    cases.into_iter().step_by(of(every, 1))
}

/// How many random cases, or how many cycles: `few`, or `all` of them.
pub fn of(few: usize, all: usize) -> usize {
    match all_cases() {
        true => all,
        false => few,
    }
}
