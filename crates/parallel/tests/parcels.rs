//! Unit tests of `crates/parallel/src/parcels.rs`.

use super::*;

#[test]
fn parcels_travel_unchanged() {
    let mut parcels: Parcels<[u32; 3], f64> = Parcels::default();
    parcels.push([1, 2, 3], [0.5, -0.0]);
    parcels.push([4, 5, 6], []);
    parcels.push([7, 8, 9], [1e300]);
    let mut words = Vec::new();
    parcels.write(&mut words);
    // The number of records, their ends, the records and the values.
    assert_eq!(words.len(), 2 + 2 * 3 + 3 * 3 + 2 * 3);
    let read: Parcels<[u32; 3], f64> = Parcels::read(&words);
    assert_eq!(read, parcels);
    let all: Vec<_> = read.iter().collect();
    assert_eq!(all[1], ([4, 5, 6], &[][..]));
    assert_eq!(all[2], ([7, 8, 9], &[1e300][..]));
    assert!(read.get(0).1[1].is_sign_negative());

    let empty: Parcels<usize, u32> = Parcels::default();
    let mut words = Vec::new();
    empty.write(&mut words);
    assert!(words.is_empty());
    assert_eq!(Parcels::<usize, u32>::read(&words), empty);
}
