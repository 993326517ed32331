//! Passes on where a private build of PETSc lies, so that the program finds its libraries when it runs, and to the
//! tests where the repository lies.

use std::path::Path;

fn main() {
    println!("cargo:rerun-if-env-changed=DEP_PETSC_RPATH");
    let rpath = std::env::var("DEP_PETSC_RPATH").unwrap_or_default();
    for dir in rpath.split(':').filter(|dir| !dir.is_empty()) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{dir}");
    }
    let package = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it");
    let root = Path::new(&package).ancestors().nth(2).expect("crates/cli");
    println!("cargo:rustc-env=FETIFETI_ROOT={}", root.display());
}
