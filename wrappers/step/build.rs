//! Names the shared library, and passes on where a private build of PETSc lies, so that the library finds it.

include!("../../packaging/abi.rs");

fn main() {
    println!("cargo:rerun-if-changed=../../packaging/abi.rs");
    println!("cargo:rerun-if-env-changed=DEP_PETSC_RPATH");
    let rpath = std::env::var("DEP_PETSC_RPATH").unwrap_or_default();
    for dir in rpath.split(':').filter(|dir| !dir.is_empty()) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{dir}");
    }
    // The solver inside has the functions of fetifeti.h, too. They are not shown, so that a program may be linked with
    // both libraries.
    println!("cargo:rustc-link-arg=-Wl,--exclude-libs,ALL");
    name_the_library("fetifeti_step");
}
