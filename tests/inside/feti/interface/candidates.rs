//! Unit tests of `src/feti/interface/candidates.rs`.

use super::*;

#[test]
fn what_comes_twice_passes_and_little_else() {
    let n = 50_000u64;
    let mut table = HashTable::new(2 * n as usize);
    let first = (0..n).map(|i| 7 * i);
    let second = (0..n).map(|i| 7 * (i + n - 100));
    first.chain(second).for_each(|dof| table.see(dof));
    assert!((n - 100..n).all(|i| table.passes(7 * i)));
    let others = (0..n - 100).filter(|i| table.passes(7 * i)).count();
    assert!(others < n as usize / 10, "{others} of {n}");
    table.mark(3);
    assert!(table.passes(3));
}
