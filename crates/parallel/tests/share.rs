//! Unit tests of `crates/parallel/src/share.rs`.

use super::contiguous_share;

#[test]
fn shares_cover_everything_once() {
    for n in 0..12 {
        for ranks in 1..6 {
            let mut next = 0;
            for rank in 0..ranks {
                let share = contiguous_share(n, ranks, rank);
                assert_eq!(share.start, next);
                assert!(share.len() == n / ranks || share.len() == n / ranks + 1);
                next = share.end;
            }
            assert_eq!(next, n);
        }
    }
}
