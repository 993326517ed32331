use super::*;
use std::collections::HashSet;

#[test]
fn keywords_are_there_once_and_found_by_their_names() {
    let names: HashSet<String> = KEYWORDS.iter().map(|(name, _)| squeeze(name)).collect();
    assert_eq!(names.len(), KEYWORDS.len());
    for &(name, kind) in KEYWORDS {
        assert_eq!(verdict(&squeeze(name)), Some((name, kind)));
    }
    assert_eq!(verdict("NODEPRINT"), Some(("NODE PRINT", Verdict::Read)));
    assert_eq!(verdict("NODES"), None);
}

/// Reasons end the sentence "file, line 5: *KEYWORD: reason".
#[test]
fn reasons_are_parts_of_a_sentence() {
    for (name, kind) in KEYWORDS {
        let reason = match kind {
            Verdict::Read => continue,
            Verdict::Ignored(r) | Verdict::Refused(r) | Verdict::RefusedMesh(r) => r,
            Verdict::InMaterial(r) | Verdict::InInteraction(r) => r,
        };
        assert!(
            reason.len() > 10 && !reason.ends_with('.') && !reason.contains('\n'),
            "{name}"
        );
        assert!(reason.starts_with(char::is_lowercase), "{name}");
    }
}
