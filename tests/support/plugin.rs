//! The plug-in under mpirun: PETSc's own example programs and ours, compiled here, with the library loaded.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::mpi::{mpirun, Output, Scratch};

/// The library that cargo built for this test, or another build of it: scripts/test_newer.sh has one for a newer PETSc.
pub fn library() -> String {
    if let Ok(path) = std::env::var("FETIFETI_TEST_LIBRARY") {
        return path;
    }
    let own = std::env::current_exe().expect("the test knows its own path");
    let deps = own.parent().expect("a test lies in a directory");
    let path = deps.join("libfetifeti.so");
    assert!(path.is_file(), "{} is missing", path.display());
    path.display().to_string()
}

/// The library of load steps that cargo built for this test.
pub fn step_library() -> String {
    library().replace("libfetifeti.so", "libfetifeti_step.so")
}

/// The output of pkg-config for PETSc.
fn pkg_config(args: &[&str]) -> Vec<String> {
    for name in ["PETSc", "petsc"] {
        let out = Command::new("pkg-config").args(args).arg(name).output();
        let out = out.expect("pkg-config runs");
        if out.status.success() {
            let text = String::from_utf8_lossy(&out.stdout).into_owned();
            return text.split_whitespace().map(String::from).collect();
        }
    }
    panic!("pkg-config does not know PETSc");
}

/// Where petsc4py of this PETSc lies: scripts/newer_petsc.sh puts it beside the library, Debian next to the PETSc that
/// it was built for.
pub fn petsc4py() -> String {
    let of = |name| std::env::var(name).unwrap_or_default();
    match std::env::var("PETSC_DIR") {
        Ok(dir) => format!("{dir}/{}/python", of("PETSC_ARCH")),
        Err(_) => {
            "/usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages".into()
        }
    }
}

/// The first two numbers of PETSc's version.
pub fn petsc_version() -> (u32, u32) {
    let text = pkg_config(&["--modversion"]).join("");
    let mut numbers = text.split('.').map(|n| n.parse().expect("a number"));
    let mut next = || numbers.next().expect("a version has two numbers");
    (next(), next())
}

/// The path of one of PETSc's tutorials below a folder such as `ksp/ksp` (Debian: libpetsc3.18-dev-examples).
fn tutorial(of: &str, name: &str) -> PathBuf {
    let below = format!("{of}/tutorials");
    let prefix = pkg_config(&["--variable=prefix"]).join(" ");
    let own = std::env::var("PETSC_DIR").map(|dir| PathBuf::from(dir).join("src"));
    let installed = [PathBuf::from(prefix), "/usr/share/petsc/3.18".into()];
    let installed = installed.map(|p| p.join("share/petsc/examples/src"));
    let places = own.into_iter().chain(installed);
    let found = places
        .map(|p| p.join(&below).join(name))
        .find(|p| p.is_file());
    found.unwrap_or_else(|| panic!("PETSc's example {name} is not installed: run scripts/setup.sh"))
}

/// A program compiled for a test.
pub struct Program(String);

impl Program {
    /// One of PETSc's ksp tutorials.
    pub fn tutorial(scratch: &Scratch, name: &str) -> Program {
        Program::tutorial_below("ksp/ksp", scratch, name)
    }

    /// One of the tutorials below a folder of PETSc's sources, such as `ts`.
    pub fn tutorial_below(of: &str, scratch: &Scratch, name: &str) -> Program {
        let source = tutorial(of, &format!("{name}.c"));
        Program::compile("mpicc", scratch, &source, &[])
    }

    /// One of PETSc's ksp tutorials with another build of PETSc: a directory below Debian's /usr/lib/petscdir, with `*`
    /// for the architecture.
    pub fn tutorial_of(scratch: &Scratch, name: &str, build: &str) -> Program {
        let (above, pattern) = build.split_once('/').expect("two folders");
        let end = pattern.trim_start_matches('*');
        let above = Path::new("/usr/lib/petscdir").join(above);
        let entries = std::fs::read_dir(&above).into_iter().flatten().flatten();
        let found = entries
            .map(|e| e.path())
            .find(|p| p.to_string_lossy().ends_with(end));
        let dir = found.unwrap_or_else(|| panic!("{build} is not installed: run scripts/setup.sh"));
        let flags = Command::new("pkg-config")
            .args(["--cflags", "--libs"])
            .args(
                std::fs::read_dir(dir.join("lib/pkgconfig"))
                    .into_iter()
                    .flatten()
                    .flatten()
                    .map(|e| e.path())
                    .take(1),
            )
            .output()
            .expect("pkg-config runs");
        assert!(
            flags.status.success(),
            "{build}: {}",
            String::from_utf8_lossy(&flags.stderr)
        );
        let flags = String::from_utf8_lossy(&flags.stdout).into_owned();
        let flags: Vec<String> = flags.split_whitespace().map(String::from).collect();
        let source = Path::new("/usr/share/petsc/3.18/share/petsc/examples/src/ksp/ksp/tutorials")
            .join(format!("{name}.c"));
        Program::compile_with("mpicc", scratch, &source, &flags)
    }

    /// One of our sources, from tests/plugin.
    pub fn own(compiler: &str, scratch: &Scratch, name: &str) -> Program {
        let dir = Path::new(env!("FETIFETI_ROOT")).join("tests/plugin");
        Program::compile(compiler, scratch, &dir.join(name), &[])
    }

    /// One of our sources, by its path in the repository. It uses wrappers/fetifeti.h and is linked with the library.
    pub fn linked(compiler: &str, scratch: &Scratch, path: &str) -> Program {
        Program::linked_with(compiler, scratch, path, &[])
    }

    /// As `linked`, with more options of the compiler.
    pub fn linked_with(
        compiler: &str,
        scratch: &Scratch,
        path: &str,
        options: &[String],
    ) -> Program {
        let root = Path::new(env!("FETIFETI_ROOT"));
        let (library, headers) = (library(), root.join("wrappers"));
        let dir = Path::new(&library)
            .parent()
            .expect("it lies in a directory");
        let more = [
            format!("-I{}", headers.display()),
            library.clone(),
            format!("-Wl,-rpath,{}", dir.display()),
        ];
        let all = [&more, options].concat();
        Program::compile(compiler, scratch, &root.join(path), &all)
    }

    /// As `linked`, in Fortran with the module of wrappers/fetifeti.f90.
    pub fn fortran_with_module(scratch: &Scratch, path: &str) -> Program {
        let root = Path::new(env!("FETIFETI_ROOT"));
        let module = root.join("wrappers/fetifeti.f90").display().to_string();
        let object = scratch.path("module.o");
        let out = Command::new("mpif90")
            .args(["-c", "-ffree-line-length-0", "-o", &object, &module])
            .current_dir(&scratch.0)
            .output()
            .expect("mpif90 runs");
        let said = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "{module}: {said}");
        let library = library();
        let dir = Path::new(&library)
            .parent()
            .expect("it lies in a directory");
        let rpath = format!("-Wl,-rpath,{}", dir.display());
        Program::compile(
            "mpif90",
            scratch,
            &root.join(path),
            &[object, library.clone(), rpath],
        )
    }

    fn compile(compiler: &str, scratch: &Scratch, source: &Path, more: &[String]) -> Program {
        let all = [more, &pkg_config(&["--cflags", "--libs"])].concat();
        Program::compile_with(compiler, scratch, source, &all)
    }

    fn compile_with(compiler: &str, scratch: &Scratch, source: &Path, more: &[String]) -> Program {
        let stem = source.file_stem().expect("a source has a name");
        let program = scratch.path(&stem.to_string_lossy());
        let out = Command::new(compiler)
            .args(["-O1", "-o", &program])
            .arg(source)
            .args(more)
            .args(["-llapack", "-lblas", "-lm"])
            .args((compiler == "mpif90").then_some("-ffree-line-length-0"))
            .current_dir(&scratch.0)
            .output()
            .unwrap_or_else(|e| panic!("{compiler}: {e}"));
        let said = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "{}: {said}", source.display());
        Program(program)
    }

    /// The path of the program.
    #[allow(dead_code)] // not every test program needs it
    pub fn path(&self) -> &str {
        &self.0
    }

    /// Runs the program with these options, separated by blanks.
    pub fn run(&self, ranks: usize, options: &str) -> Output {
        let args: Vec<&str> = options.split_whitespace().collect();
        mpirun(ranks, &self.0, &args, &[])
    }

    /// As `run`, with the plug-in loaded.
    pub fn with_plugin(&self, ranks: usize, options: &str) -> Output {
        self.run(ranks, &format!("{options} -dll_append {}", library()))
    }
}

/// A vector that PETSc wrote to a binary file.
pub fn vector(path: &str) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{path}: {e}"));
    let word = |at: usize| i32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    // With 64-bit indices both numbers of the header have eight bytes, of which the last four count here.
    let wide = word(0) == 0;
    let (class, length) = if wide { (4, 12) } else { (0, 4) };
    assert_eq!(word(class), 1_211_214, "{path} is no vector");
    let entries = bytes[length + 4..].chunks_exact(8);
    let out: Vec<f64> = entries
        .map(|b| f64::from_be_bytes(b.try_into().expect("eight bytes")))
        .collect();
    assert_eq!(out.len(), word(length) as usize);
    out
}

/// The number that follows `text` in the output of a run.
pub fn number_after(out: &Output, text: &str) -> f64 {
    let at = out.stdout.find(text);
    let at = at.unwrap_or_else(|| panic!("no \"{text}\" in {}", out.all()));
    let rest = out.stdout[at + text.len()..].split_whitespace().next();
    rest.and_then(|w| w.trim_end_matches(',').parse().ok())
        .unwrap_or_else(|| panic!("no number after \"{text}\" in {}", out.all()))
}
