//! Unit tests of `src/feti/jump/entry_locations.rs`.

use super::*;

#[test]
fn entries_are_found_by_row_subdomain_and_dof() {
    // Row 1 has none; row 2 has the same dof number in two subdomains.
    let given = [
        (2, [0, 5, 7]),
        (0, [1, 4, 3]),
        (2, [1, 5, 8]),
        (3, [0, 0, 0]),
        (2, [0, 6, 9]),
    ];
    let place = |[subdomain, dof, entry]: [u32; 3]| EntryLocation {
        subdomain,
        dof,
        entry,
    };
    let list: Vec<(u32, EntryLocation)> = given.iter().map(|(row, p)| (*row, place(*p))).collect();
    let places = EntryPlaces::new(4, &list);
    for (row, [subdomain, dof, entry]) in given {
        assert_eq!(places.entry(row as usize, subdomain, dof), entry as usize);
    }
    assert_eq!(places.start, [0, 1, 1, 4, 5]);
}
