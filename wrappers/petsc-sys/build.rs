//! Finds PETSc, SLEPc and MPI, refuses builds that fetifeti cannot use, compiles the shim and writes the bindings.

use std::path::{Path, PathBuf};
use std::process::{exit, Command};
use std::{env, fs};

include!("names.rs");

fn main() {
    for file in [
        "build.rs",
        "names.rs",
        "wrapper.h",
        "shim.h",
        "shim.c",
        "compat.h",
        "process.c",
    ] {
        println!("cargo:rerun-if-changed={file}");
    }
    for var in [
        "PETSC_DIR",
        "PETSC_ARCH",
        "SLEPC_DIR",
        "PKG_CONFIG_PATH",
        "MPICC",
    ] {
        println!("cargo:rerun-if-env-changed={var}");
    }

    let own_build = prefer_petsc_dir();
    let petsc = probe(&["petsc", "PETSc"], "PETSc", "PETSC_DIR");
    let slepc = probe(&["slepc", "SLEPc"], "SLEPc", "SLEPC_DIR");

    let minor = |version: &str| version.split('.').take(2).collect::<Vec<_>>().join(".");
    if minor(&petsc.version) != minor(&slepc.version) {
        fail(&format!(
            "PETSc {} and SLEPc {} do not belong together: their first two numbers must agree.",
            petsc.version, slepc.version
        ));
    }

    let mut include = petsc.include_paths.clone();
    include.extend(slepc.include_paths.iter().cloned());
    refuse_unusable(&include);
    include.extend(mpi_include());
    include.dedup();

    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    shim(&include);
    bindings(&include, &out);

    // The loader does not search the directories of a private build; the top crate turns these into an rpath.
    let rpath: Vec<String> = if own_build {
        let paths = slepc.link_paths.iter().chain(&petsc.link_paths);
        paths.map(|p| p.display().to_string()).collect()
    } else {
        Vec::new()
    };
    println!("cargo:rpath={}", rpath.join(":"));
    // For the C sources of the top crate.
    let include: Vec<String> = include.iter().map(|p| p.display().to_string()).collect();
    println!("cargo:include={}", include.join(":"));
}

/// Puts the pkg-config directories below PETSC_DIR and SLEPC_DIR first; tells whether PETSC_DIR is set.
fn prefer_petsc_dir() -> bool {
    let arch = env::var("PETSC_ARCH").unwrap_or_default();
    let mut first = Vec::new();
    for var in ["PETSC_DIR", "SLEPC_DIR"] {
        let Ok(dir) = env::var(var) else { continue };
        for below in [arch.as_str(), ""] {
            let lib = Path::new(&dir).join(below).join("lib/pkgconfig");
            if lib.is_dir() {
                first.push(lib);
                break;
            }
        }
    }
    let found = !first.is_empty();
    if found {
        first.extend(env::split_paths(
            &env::var_os("PKG_CONFIG_PATH").unwrap_or_default(),
        ));
        let joined =
            env::join_paths(first).unwrap_or_else(|e| fail(&format!("PKG_CONFIG_PATH: {e}.")));
        env::set_var("PKG_CONFIG_PATH", joined);
    }
    found
}

fn probe(names: &[&str], what: &str, var: &str) -> pkg_config::Library {
    for name in names {
        if let Ok(library) = pkg_config::Config::new()
            .range_version("3.18".."3.27")
            .probe(name)
        {
            return library;
        }
    }
    fail(&format!(
        "{what} 3.18 to 3.26 was not found by pkg-config: \
         install it (Debian: libpetsc-real-dev, libslepc-real-dev) or set {var}."
    ))
}

/// Where mpi.h lies: by pkg-config, else from what the compiler wrapper passes on.
fn mpi_include() -> Vec<PathBuf> {
    for name in ["ompi-c", "mpich", "mpi"] {
        let probed = pkg_config::Config::new().cargo_metadata(false).probe(name);
        if let Ok(library) = probed {
            return library.include_paths;
        }
    }
    let mpicc = env::var("MPICC").unwrap_or_else(|_| "mpicc".into());
    match Command::new(&mpicc).arg("-show").output() {
        Ok(out) => String::from_utf8_lossy(&out.stdout)
            .split_whitespace()
            .filter_map(|word| word.strip_prefix("-I").map(PathBuf::from))
            .collect(),
        Err(e) => fail(&format!(
            "mpi.h was not found: pkg-config knows neither ompi-c nor mpich, and {mpicc} does not run ({e})."
        )),
    }
}

/// Refuses scalar and index types that fetifeti does not support, with one sentence instead of pages of type errors.
fn refuse_unusable(include: &[PathBuf]) {
    let Some(path) = include
        .iter()
        .map(|dir| dir.join("petscconf.h"))
        .find(|p| p.is_file())
    else {
        fail("petscconf.h was not found in PETSc's include directories.");
    };
    println!("cargo:rerun-if-changed={}", path.display());
    let text = fs::read_to_string(&path)
        .unwrap_or_else(|e| fail(&format!("{} cannot be read: {e}.", path.display())));
    let defined = |name: &str| {
        text.lines().any(|line| {
            let mut words = line.split_whitespace();
            words.next() == Some("#define") && words.next() == Some(name)
        })
    };
    for (name, kind) in [
        ("PETSC_USE_COMPLEX", "complex scalars"),
        ("PETSC_USE_REAL_SINGLE", "single precision"),
        ("PETSC_USE_REAL___FLOAT128", "quadruple precision"),
        ("PETSC_USE_REAL___FP16", "half precision"),
    ] {
        if defined(name) {
            fail(&format!(
                "The PETSc described by {} was configured with {kind}; \
                 fetifeti needs real double scalars.",
                path.display()
            ));
        }
    }
}

fn shim(include: &[PathBuf]) {
    let mut build = cc::Build::new();
    build
        .file("shim.c")
        .file("process.c")
        .includes(include)
        .define("PETSC_SKIP_COMPLEX", None)
        .flag_if_supported("-Wno-unused-parameter")
        .compile("fetifeti_shim");
}

fn bindings(include: &[PathBuf], out: &Path) {
    let mut builder = bindgen::Builder::default()
        .header("wrapper.h")
        .clang_arg("-DPETSC_SKIP_COMPLEX")
        .clang_args(include.iter().map(|dir| format!("-I{}", dir.display())))
        .prepend_enum_name(false)
        .layout_tests(false)
        .generate_comments(false)
        .merge_extern_blocks(true)
        // MPI's types come from the `mpi` crate, so that its communicators and ours are the same type.
        .blocklist_type("MPI_.*|ompi_.*|PetscMPIInt|PetscErrorCode")
        .parse_callbacks(Box::new(bindgen::CargoCallbacks::new()));
    for name in FUNCTIONS {
        builder = builder.allowlist_function(name);
    }
    for name in VARIABLES {
        builder = builder.allowlist_var(name);
    }
    for name in TYPES {
        builder = builder.allowlist_type(name);
    }
    let path = out.join("bindings.rs");
    let written = builder
        .generate()
        .map_err(|e| e.to_string())
        .and_then(|bindings| bindings.write_to_file(&path).map_err(|e| e.to_string()));
    if let Err(e) = written {
        fail(&format!(
            "bindgen could not read the headers of PETSc and SLEPc: {e}"
        ));
    }
}

fn fail(sentence: &str) -> ! {
    println!("cargo:warning={sentence}");
    eprintln!("{sentence}");
    exit(1)
}
