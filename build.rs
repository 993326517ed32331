//! Compiles the C half of the PETSc plug-in, and passes on where a private build of PETSc lies, so that the program
//! finds its libraries when it runs.

use std::path::{Path, PathBuf};

include!("packaging/abi.rs");

fn main() {
    println!("cargo:rerun-if-changed=packaging/abi.rs");
    println!("cargo:rerun-if-env-changed=DEP_PETSC_RPATH");
    println!("cargo:rerun-if-env-changed=DEP_PETSC_INCLUDE");
    for file in [
        "kspfetifeti.c",
        "kspbodies.c",
        "kspregister.c",
        "kspfetifeti.h",
    ] {
        println!("cargo:rerun-if-changed=wrappers/{file}");
    }
    let rpath = std::env::var("DEP_PETSC_RPATH").unwrap_or_default();
    for dir in rpath.split(':').filter(|dir| !dir.is_empty()) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{dir}");
    }
    let include = std::env::var("DEP_PETSC_INCLUDE").unwrap_or_default();
    cc::Build::new()
        .file("wrappers/kspfetifeti.c")
        .file("wrappers/kspbodies.c")
        .file("wrappers/kspregister.c")
        .includes(include.split(':').filter(|dir| !dir.is_empty()))
        .define("PETSC_SKIP_COMPLEX", None)
        .flag_if_supported("-Wno-unused-parameter")
        .compile("kspfetifeti");
    name_the_library();
}

/// Gives the shared library the name that programs ask the loader for, with the version of its interface. Cargo writes
/// libfetifeti.so; links beside it let programs that are linked with that file run.
fn name_the_library() {
    let name = format!("libfetifeti.so.{ABI}");
    println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,{name}");
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    // target/PROFILE/build/fetifeti-HASH/out
    let Some(profile) = out.ancestors().nth(3) else {
        return;
    };
    for dir in [profile.to_path_buf(), profile.join("deps")] {
        let link = dir.join(&name);
        if dir.is_dir() && !link.exists() {
            let _ = std::fs::remove_file(&link);
            if let Err(e) = std::os::unix::fs::symlink(Path::new("libfetifeti.so"), &link) {
                println!("cargo:warning={} cannot be made: {e}", link.display());
            }
        }
    }
}
