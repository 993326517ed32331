//! Unit tests of `crates/cli/src/unused.rs`.

use super::*;

#[test]
fn the_nearest_name_is_found_and_none_where_all_are_far() {
    let names = ["-fetifeti_ksp_rtol", "-fetifeti_ksp_type", "-compare_cores"];
    let names: BTreeSet<String> = names.iter().map(|n| n.to_string()).collect();
    for (name, expected) in [
        ("-fetifeti_ksp_rtl", Some("-fetifeti_ksp_rtol")),
        ("-fetifeti_ksp_rtoll", Some("-fetifeti_ksp_rtol")),
        ("-fetifeti_ksp_tyep", Some("-fetifeti_ksp_type")),
        ("-ksp_rtol", Some("-fetifeti_ksp_rtol")),
        ("-compare_croes", Some("-compare_cores")),
        ("-fetifeti_tolerance", None),
        ("-x", None),
        ("-fetifeti_coarse_ksp_rtol", None),
    ] {
        let found = nearest(name, &names).map(String::as_str);
        assert_eq!(found, expected, "{name}");
    }
    assert_eq!(distance("", "ab"), 2);
    assert_eq!(distance("ab", "ba"), 1);
}
