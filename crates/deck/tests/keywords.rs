use super::*;
use std::collections::HashSet;

#[test]
fn keywords_are_there_once_and_found_by_their_names() {
    let names: HashSet<String> = KEYWORDS.iter().map(|(name, _)| squeeze(name)).collect();
    assert_eq!(names.len(), KEYWORDS.len());
    for &(name, kind) in KEYWORDS {
        assert_eq!(verdict(&squeeze(name)), Some((name, kind)));
    }
    assert_eq!(
        verdict("NODEPRINT"),
        Some(("NODE PRINT", KeywordTreatment::Read))
    );
    assert_eq!(verdict("NODES"), None);
}

/// Reasons end the sentence "file, line 5: *KEYWORD: reason".
#[test]
fn reasons_are_parts_of_a_sentence() {
    for (name, kind) in KEYWORDS {
        let reason = match kind {
            KeywordTreatment::Read => continue,
            KeywordTreatment::Ignored(r)
            | KeywordTreatment::Refused(r)
            | KeywordTreatment::RefusedMesh(r)
            | KeywordTreatment::InMaterial(r) => r,
        };
        assert!(
            reason.len() > 10 && !reason.ends_with('.') && !reason.contains('\n'),
            "{name}"
        );
        assert!(reason.starts_with(char::is_lowercase), "{name}");
    }
}
