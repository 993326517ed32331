//! Unit tests of `src/embed/frame.rs`.

use super::*;

/// A matrix by dense rows; zeros are stored where `pattern` has an entry.
fn csr(rows: &[&[f64]]) -> Csr {
    let mut triplets = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let entries = row.iter().enumerate().filter(|(_, v)| **v != 0.0);
        triplets.extend(entries.map(|(j, v)| (i as u32, j as u32, *v)));
    }
    Csr::from_triplets(rows.len(), &triplets)
}

#[test]
fn symmetry_is_seen_in_patterns_of_any_shape() {
    let k = csr(&[&[2.0, -1.0, 0.0], &[-1.0, 2.0, -1.0], &[0.0, -1.0, 2.0]]);
    assert_eq!(sound(&k, &k.val), Some(vec![2.0; 3]));
    // (entry, value): an entry that differs from its partner, a diagonal that is not positive, no number.
    for (e, v) in [
        (1, -0.9),
        (5, -1.1),
        (3, 0.0),
        (3, -2.0),
        (3, f64::NAN),
        (4, f64::NAN),
    ] {
        let mut entries = k.val.clone();
        entries[e] = v;
        assert_eq!(sound(&k, &entries), None, "entry {e} is {v}");
    }
    // An entry without a partner, above and below the diagonal; rounding is none.
    for rows in [
        [&[2.0, 1.0, 0.5][..], &[1.0, 2.0, 0.0], &[0.0, 0.0, 2.0]],
        [&[2.0, 1.0, 0.0][..], &[1.0, 2.0, 0.0], &[0.5, 0.0, 2.0]],
        [&[2.0, 0.0, 0.0][..], &[0.0, 2.0, 0.0], &[0.0, 0.5, 2.0]],
    ] {
        let mut k = csr(&rows);
        assert_eq!(sound(&k, &k.val), None, "{rows:?}");
        k.val
            .iter_mut()
            .filter(|v| **v == 0.5)
            .for_each(|v| *v = 1e-12);
        assert!(sound(&k, &k.val).is_some(), "{rows:?}");
    }
}

#[test]
fn entries_find_their_places() {
    // Dofs 3, 5, 7, 9: 7 is known, 9 has no stiffness here; the host lists them in another order, 5 twice.
    let k = csr(&[&[4.0, -1.0], &[-1.0, 4.0]]);
    let rows = PieceRows {
        dofs: vec![3, 5, 7, 9],
        place: vec![
            RowDestination::Unknown { part: 0, row: 0 },
            RowDestination::Unknown { part: 0, row: 1 },
            RowDestination::Known,
            RowDestination::Empty,
        ],
        coupled: vec![true, true, false, false],
    };
    let host: [&[f64]; 6] = [
        &[3.0, 0.0, -2.0, 0.0, 0.0, 0.0],  // 5
        &[0.0, 8.0, 0.0, 0.0, 0.0, 0.0],   // 7
        &[-2.0, 0.0, 6.0, -0.5, 0.0, 0.0], // 3
        &[0.0, 0.0, -0.5, 1.0, 0.0, 0.0],  // 5
        &[0.0; 6],                         // 9
        &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0],   // none
    ];
    let local = |host: &[&[f64]]| Local {
        k: Cow::Owned(csr(host)),
        dofs: Cow::Owned(vec![5, 7, 3, 5, 9, -1]),
    };
    let place = |host: &[&[f64]]| {
        let mut out = TornValues {
            k: vec![vec![0.0; 4]],
            diagonal: Vec::new(),
            known: vec![Vec::new()],
            fixed: BTreeMap::new(),
        };
        add(&[&k], &local(host), &rows, &mut out).map(|()| out)
    };
    let found = place(&host).expect("it fits");
    assert_eq!(found.k, [[6.0, -2.5, -2.5, 4.0]]);
    assert_eq!(found.fixed, BTreeMap::from([(7, 8.0)]));
    // An entry in the column of the known dof is a part of the load; one in its row makes it unknown.
    let mut other = host;
    other[2] = &[-2.0, 0.25, 6.0, -0.5, 0.0, 0.0];
    assert_eq!(place(&other).expect("it fits").known, [[(0, 7, 0.25)]]);
    other = host;
    other[1] = &[0.0, 8.0, 0.25, 0.0, 0.0, 0.0];
    assert!(place(&other).is_none());
    // Stiffness where there was none, a row that is no longer coupled, no number.
    other = host;
    other[4] = &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    assert!(place(&other).is_none());
    other = host;
    (other[0], other[3]) = (
        &[3.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
    );
    assert!(place(&other).is_none());
    other = host;
    other[0] = &[f64::NAN, 0.0, -2.0, 0.0, 0.0, 0.0];
    assert!(place(&other).is_none());
}
