//! Unit tests of `crates/base/src/output.rs`.

use super::*;
use crate::scratch::Scratch;

#[test]
fn writes_replaces_and_leaves_nothing_behind() {
    let dir = Scratch::new("output");
    let path = dir.0.join("a/b/file.txt");
    write_text(&path, "one").unwrap();
    write_text(&path, "two").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "two");
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
}

#[test]
fn failure_keeps_the_old_file() {
    let dir = Scratch::new("output-keep");
    let path = dir.0.join("file.txt");
    write_text(&path, "old").unwrap();
    let result = write_file(&path, |out| {
        out.write_all(b"half")?;
        Err(std::io::Error::other("the disk is full"))
    });
    let message = result.unwrap_err().to_string();
    assert!(
        message.contains("file.txt") && message.contains("disk is full"),
        "{message}"
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(fs::read_dir(&dir.0).unwrap().count(), 1);
}

#[test]
fn unwritable_places_are_environment_errors_with_the_path() {
    let dir = Scratch::new("output-bad");
    let file = dir.0.join("file");
    write_text(&file, "x").unwrap();
    // A file where a directory is needed, and a directory where a file is needed.
    for bad in [file.join("below.json"), dir.0.clone()] {
        for error in [
            write_text(&bad, "x").unwrap_err(),
            prepare_file(&bad).unwrap_err(),
        ] {
            assert_eq!(error.exit_code(), 3);
            let message = error.to_string();
            assert!(
                message.contains("output-bad") && !message.contains('\n'),
                "{message}"
            );
        }
    }
}

#[test]
fn devices_stay_devices() {
    use std::os::unix::fs::FileTypeExt;
    write_text(Path::new("/dev/null"), "x").unwrap();
    assert!(fs::metadata("/dev/null")
        .unwrap()
        .file_type()
        .is_char_device());
}
