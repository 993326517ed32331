//! Unit tests of `src/embed/bodies.rs`.

use super::*;
use crate::testing::with_session;
use base::linalg::csr::Csr;
use parallel::owners::Owners;

fn bond(low: usize, high: usize, holds: bool) -> Bond {
    Bond {
        low,
        high,
        shared: 9,
        holds,
    }
}

/// The bodies of subdomains on one rank.
fn bodies(group: &[u64], bonds: &[Bond]) -> Vec<usize> {
    let (group, bonds) = (group.to_vec(), bonds.to_vec());
    with_session(move |session| {
        let sharers = Sharers {
            first: 0,
            n_subdomains: group.len(),
            of: Default::default(),
            neighbours: vec![Vec::new(); group.len()],
            owners: Owners::new(session.comm(), 0),
        };
        let found = Bodies::new(session, &sharers, &group, &bonds);
        assert_eq!(found.n, found.mine.iter().max().unwrap() + 1);
        assert!((0..group.len()).all(|s| found.of(s as u32) == found.mine[s]));
        found.mine
    })
}

#[test]
fn a_group_in_two_pieces_is_two_bodies() {
    let row = [bond(0, 1, true), bond(1, 2, true)];
    assert_eq!(bodies(&[7, 3, 7], &row), [0, 1, 2]);
    assert_eq!(bodies(&[7, 7, 7], &row), [0, 0, 0]);
}

#[test]
fn what_does_not_hold_makes_no_body() {
    let row = [bond(0, 1, true), bond(1, 2, false)];
    assert_eq!(bodies(&[0, 0, 0], &row), [0, 0, 1]);
}

#[test]
fn all_are_named_or_none() {
    let groups = |named: &[Option<u64>]| {
        let part = |&body: &Option<u64>| TornSubdomain {
            body,
            k: Csr::default(),
            dofs: Vec::new(),
            known: Vec::new(),
        };
        let parts: Vec<TornSubdomain> = named.iter().map(part).collect();
        with_session(move |session| {
            named_groups(session, 5, &parts).map_err(|error| error.to_string())
        })
    };
    assert!(groups(&[Some(1), None])
        .unwrap_err()
        .contains("subdomain 6 was given no body"));
    assert_eq!(groups(&[None, None]).unwrap(), None);
    assert_eq!(groups(&[Some(4), Some(1)]).unwrap(), Some(vec![4, 1]));
}
