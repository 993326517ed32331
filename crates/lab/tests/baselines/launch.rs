//! Unit tests of `crates/lab/src/baselines/launch.rs`.

use super::*;

#[test]
fn the_programs_own_error_is_found() {
    let petsc = "[host:1] noise\nError on rank 3: PCSetUp failed with PETSc error 76\
                 \n  Zero pivot\n  PCSetUp() line 9\n----\n";
    assert_eq!(
        spoken(petsc).as_deref(),
        Some("PCSetUp failed with PETSc error 76: Zero pivot")
    );
    assert_eq!(spoken("Error: a: b\n").as_deref(), Some("a: b"));
    assert_eq!(
        spoken("----\nno slots\n----\n").as_deref(),
        Some("no slots")
    );
    assert_eq!(spoken(""), None);
}

#[test]
fn a_workspace_is_private_and_goes_away() {
    use std::os::unix::fs::PermissionsExt;
    let workspace = Workspace::new().expect("a directory");
    let dir = workspace.dir.clone();
    let mode = std::fs::metadata(&dir)
        .expect("it is there")
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o700);
    std::fs::write(workspace.file("x"), "x").expect("it can be written");
    drop(workspace);
    assert!(!dir.exists());
}
