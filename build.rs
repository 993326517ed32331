//! Compiles the C half of the PETSc plug-in, and passes on where a private build of PETSc lies, so that the program
//! finds its libraries when it runs.

include!("packaging/abi.rs");

fn main() {
    println!("cargo:rerun-if-changed=packaging/abi.rs");
    println!("cargo:rerun-if-env-changed=DEP_PETSC_RPATH");
    println!("cargo:rerun-if-env-changed=DEP_PETSC_INCLUDE");
    for file in [
        "kspfetifeti.c",
        "kspbodies.c",
        "kspmatsolve.c",
        "kspregister.c",
        "pcfetifeti.c",
        "kspfetifeti.h",
        "petsc-sys/compat.h",
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
        .file("wrappers/kspmatsolve.c")
        .file("wrappers/kspregister.c")
        .file("wrappers/pcfetifeti.c")
        .includes(include.split(':').filter(|dir| !dir.is_empty()))
        .define("PETSC_SKIP_COMPLEX", None)
        .flag_if_supported("-Wno-unused-parameter")
        .compile("kspfetifeti");
    name_the_library("fetifeti");
}
