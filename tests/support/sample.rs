//! Some of the cases in `make test`, all of them in `make test-all`.
//!
//! Which ones follows from the commit: `scripts/test.sh` prints the number from which they follow, so that another
//! commit tries other cases. `FETIFETI_TEST_OFFSET=N` takes those of another run again.

/// Whether all cases are wanted: `make test-all` sets this variable.
pub fn all_cases() -> bool {
    std::env::var_os("FETIFETI_TEST_ALL").is_some()
}

/// Every `every`-th case from one of the first `every` on, or all of them.
pub fn sample<T>(every: usize, cases: impl IntoIterator<Item = T>) -> std::vec::IntoIter<T> {
    let cases: Vec<T> = cases.into_iter().collect();
    if all_cases() {
        return cases.into_iter();
    }
    // A list that is shorter than the step gives a case in any event.
    let first = offset() % every.min(cases.len()).max(1);
    let chosen: Vec<T> = cases.into_iter().skip(first).step_by(every).collect();
    chosen.into_iter()
}

/// The number from which it follows where samples begin; 0 if nobody set it.
fn offset() -> usize {
    let set = std::env::var("FETIFETI_TEST_OFFSET").unwrap_or_default();
    set.parse().unwrap_or(0)
}

/// How many random cases, or how many cycles: `few`, or `all` of them.
pub fn of(few: usize, all: usize) -> usize {
    if all_cases() {
        all
    } else {
        few
    }
}
