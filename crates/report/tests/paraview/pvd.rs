//! Unit tests of `crates/report/src/paraview/pvd.rs`.

use super::*;
use crate::scratch::Scratch;

#[test]
fn the_file_is_complete_after_every_step() {
    let dir = Scratch::new("pvd");
    let path = dir.0.join("solution.pvd");
    let mut pvd = Pvd::new(&path);
    let count = || {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.ends_with("</VTKFile>\n"));
        text.matches("<DataSet ").count()
    };
    pvd.add(0.1, &dir.0.join("steps/a & \"b\".vtu")).unwrap();
    assert_eq!(count(), 1);
    pvd.add(1e-1 + 0.2, &dir.0.join("2.vtu")).unwrap();
    assert_eq!(count(), 2);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(
        text.contains("file=\"steps/a &amp; &quot;b&quot;.vtu\""),
        "{text}"
    );
    assert!(text.contains("timestep=\"0.30000000000000004\""), "{text}");
    // The same step once more, as after a restart.
    pvd.add(0.1, &dir.0.join("again.vtu")).unwrap();
    assert_eq!(count(), 2);
    assert_eq!(pvd.entries[0], (0.1, "again.vtu".to_string()));
    // No other file is left behind.
    assert_eq!(std::fs::read_dir(&dir.0).unwrap().count(), 1);
}

#[test]
fn a_collection_without_a_directory() {
    let mut pvd = Pvd::new("x.pvd");
    assert!(pvd.add(0.0, Path::new("/elsewhere/1.vtu")).is_err());
    assert!(pvd.entries.is_empty());
}

#[test]
fn bad_times_and_places_are_refused() {
    let dir = Scratch::new("pvd-bad");
    let mut pvd = Pvd::new(dir.0.join("solution.pvd"));
    pvd.add(1.0, &dir.0.join("1.vtu")).unwrap();
    for (t, file, part) in [
        (f64::NAN, dir.0.join("2.vtu"), "NaN"),
        (0.5, dir.0.join("2.vtu"), "after 1"),
        (2.0, PathBuf::from("/elsewhere/2.vtu"), "/elsewhere/2.vtu"),
    ] {
        let message = pvd.add(t, &file).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
    assert_eq!(pvd.entries.len(), 1);
}
