//! Unit tests of `src/contact/state.rs`.

use super::ActiveSetProgress;

#[test]
fn progress_is_a_new_smallest_number() {
    let mut progress = ActiveSetProgress::default();
    assert!(!progress.stalled(1));
    for (wrong, stalled) in [
        (9, false),
        (9, true),
        (8, false),
        (12, true),
        (9, true),
        (7, false),
    ] {
        progress.note(wrong);
        assert_eq!(progress.stalled(1), stalled, "{wrong}");
        assert_eq!(progress.wrong(), wrong);
    }
}

#[test]
fn progress_begins_anew() {
    let mut progress = ActiveSetProgress::default();
    [1, 19].into_iter().for_each(|wrong| progress.note(wrong));
    assert!(progress.stalled(1));
    progress.begin(19);
    assert!(!progress.stalled(1));
    assert_eq!(progress.wrong(), 19);
    progress.note(5);
    assert!(!progress.stalled(1));
    progress.note(5);
    assert!(progress.stalled(1));
}
