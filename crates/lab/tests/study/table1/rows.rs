//! Unit tests of `crates/lab/src/study/table1/mod.rs`.

use super::*;

#[test]
fn the_quick_study_has_the_first_rows_of_the_paper() {
    let all = rows(false, None).unwrap();
    assert_eq!((all.len(), all[19]), (20, [2, 2, 128]));
    assert_eq!(rows(true, None).unwrap(), [[2, 2, 2], [4, 2, 2], [6, 2, 2]]);
    assert_eq!(rows(true, Some("3, 1,5")).unwrap(), [[3, 1, 5]]);
}

#[test]
fn a_wrong_row_is_named_with_what_was_expected() {
    for wrong in ["2,4", "1,2,2", "2,0,2", "2,4,2,2", "2;4;2", "rows"] {
        let error = rows(false, Some(wrong)).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!(
                "the study has no case \"{wrong}\": \
                 expected three counts of at least 1 (2 for the first) as in 2,4,2"
            )
        );
        assert_eq!(error.kind(), base::ErrorKind::Input);
    }
}
