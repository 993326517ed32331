//! Passes on where a private build of PETSc lies, so that the program finds its libraries when it runs.

fn main() {
    println!("cargo:rerun-if-env-changed=DEP_PETSC_RPATH");
    let rpath = std::env::var("DEP_PETSC_RPATH").unwrap_or_default();
    for dir in rpath.split(':').filter(|dir| !dir.is_empty()) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{dir}");
    }
}
