//! Unit tests of `src/embed/partition.rs`.

use super::*;
use crate::testing::with_session;

/// Bonds of a w × h grid of subdomains: 9 dofs along sides, 1 at corners.
fn grid(w: usize, h: usize) -> Vec<Bond> {
    let mut bonds = Vec::new();
    for low in 0..w * h {
        for high in low + 1..w * h {
            let (dx, dy) = ((low % w).abs_diff(high % w), high / w - low / w);
            if dx <= 1 && dy <= 1 {
                bonds.push(Bond {
                    low,
                    high,
                    shared: if dx + dy == 1 { 9 } else { 1 },
                    holds: true,
                });
            }
        }
    }
    bonds
}

fn parted(n: usize, bonds: &[Bond], parts: usize) -> Vec<u64> {
    let bonds = bonds.to_vec();
    with_session(move |session| partition(session, "part_", n, &bonds, parts).unwrap())
}

#[test]
fn groups_are_equal_and_connected() {
    for (w, h, parts) in [(4, 4, 2), (4, 4, 4), (6, 4, 3), (3, 3, 2), (5, 1, 2)] {
        let group = parted(w * h, &grid(w, h), parts);
        let body = connected(&group, &grid(w, h));
        assert_eq!(body.iter().max().unwrap() + 1, parts, "{group:?}");
        for b in 0..parts {
            let size = body.iter().filter(|&&x| x == b).count();
            assert!(size == w * h / parts || size == (w * h).div_ceil(parts));
        }
    }
}

#[test]
fn pieces_stay_whole_unless_they_are_large() {
    // Two pieces, of 16 and of 6 subdomains, whose numbers alternate at first.
    let place = |piece: usize, s: usize| if s < 6 { 2 * s + piece } else { 6 + s };
    let of = |piece: usize, bond: Bond| Bond {
        low: place(piece, bond.low),
        high: place(piece, bond.high),
        ..bond
    };
    let ordered = |b: Bond| Bond {
        low: b.low.min(b.high),
        high: b.low.max(b.high),
        ..b
    };
    let large = grid(4, 4).into_iter().map(|b| ordered(of(0, b)));
    let small = grid(3, 2).into_iter().map(|b| ordered(of(1, b)));
    let bonds: Vec<Bond> = large.chain(small).collect();
    let bodies = |most: usize| {
        let all = bonds.clone();
        let group =
            with_session(move |session| whole_pieces(session, "part_", 22, &all, most).unwrap());
        connected(&group, &bonds)
    };
    let size = |body: &[usize], b: usize| body.iter().filter(|&&x| x == b).count();
    let sizes = |most: usize| {
        let body = bodies(most);
        let all = (0..=*body.iter().max().unwrap()).map(|b| size(&body, b));
        let mut all: Vec<usize> = all.collect();
        all.sort_unstable();
        all
    };
    assert_eq!(sizes(1000), [6, 16]);
    assert_eq!(sizes(16), [6, 16]);
    assert_eq!(sizes(8), [6, 8, 8]);
    assert_eq!(sizes(4), [3, 3, 4, 4, 4, 4]);
}

#[test]
fn groups_are_round() {
    // The partition must also succeed if corners hold nothing, as in elasticity.
    let mut bonds = grid(4, 4);
    bonds.iter_mut().for_each(|b| b.holds = b.shared > 1);
    let group = parted(16, &bonds, 4);
    let block = |s: usize| s % 4 / 2 + 2 * (s / 8);
    for (s, t) in (0..16).flat_map(|s| (0..16).map(move |t| (s, t))) {
        assert_eq!(group[s] == group[t], block(s) == block(t), "{group:?}");
    }
}

/// Dofs in common between groups.
fn cut(group: &[u64], bonds: &[Bond]) -> usize {
    let between = bonds.iter().filter(|b| group[b.low] != group[b.high]);
    between.map(|b| b.shared).sum()
}

#[test]
fn exchanges_keep_sizes_and_end_where_none_helps() {
    let bonds = grid(6, 4);
    let near = neighbours(24, &bonds);
    // Rows of the grid in turn: the worst start.
    for parts in [2, 3, 4] {
        let start: Vec<u64> = (0..24).map(|s| s % parts).collect();
        let end = exchanged(&near, start.clone());
        let size = |group: &[u64], g: u64| group.iter().filter(|&&x| x == g).count();
        assert!((0..parts).all(|g| size(&end, g) == size(&start, g)));
        assert!(cut(&end, &bonds) < cut(&start, &bonds) / 2, "{end:?}");
        // No exchange of two subdomains leaves fewer dofs in common.
        for (s, t) in (0..24).flat_map(|s| (0..s).map(move |t| (s, t))) {
            let mut other = end.clone();
            other.swap(s, t);
            assert!(cut(&other, &bonds) >= cut(&end, &bonds), "{s} {t} {end:?}");
        }
    }
}
