//! `make install`: what lands where, and programs that are built with it outside of the source tree.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::mpi::{mpirun, Scratch};
use crate::support::plugin::{library, number_after, step_library};

/// An installation below `prefix`, with DESTDIR if it is not empty.
fn install(scratch: &Scratch, prefix: &str, destdir: &str) -> String {
    install_to(scratch, prefix, destdir, "")
}

/// As `install`, with another LIBDIR if it is not empty.
pub fn install_to(scratch: &Scratch, prefix: &str, destdir: &str, libdir: &str) -> String {
    let built = PathBuf::from(scratch.path("built"));
    std::fs::create_dir_all(&built).expect("a directory");
    for (file, name) in [
        (env!("CARGO_BIN_EXE_fetifeti"), "fetifeti"),
        (&library(), "libfetifeti.so"),
        (&step_library(), "libfetifeti_step.so"),
    ] {
        let _ = std::os::unix::fs::symlink(file, built.join(name));
    }
    let mut command = Command::new("scripts/install.sh");
    command
        .arg(&built)
        .args([prefix, destdir])
        .current_dir(env!("FETIFETI_ROOT"));
    if !libdir.is_empty() {
        command.env("LIBDIR", libdir);
    }
    succeed(command)
}

/// What the command prints; it must succeed.
pub fn run(program: &str, args: &[&str], dir: &Path, pkg_config: &str) -> String {
    let mut command = Command::new(program);
    command.args(args).current_dir(dir);
    if !pkg_config.is_empty() {
        // Another PETSc than the system's is found by what was there before.
        let before = std::env::var("PKG_CONFIG_PATH").unwrap_or_default();
        command.env("PKG_CONFIG_PATH", format!("{pkg_config}:{before}"));
    }
    succeed(command)
}

fn succeed(mut command: Command) -> String {
    let out = command
        .output()
        .unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{command:?}: {said}");
    String::from_utf8_lossy(&out.stdout).into_owned()
}

/// All files and links below a directory.
pub fn files(below: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(below).expect("a directory") {
        let path = entry.expect("an entry").path();
        if path.is_dir() && !path.is_symlink() {
            all.extend(files(&path))
        } else {
            all.push(path)
        }
    }
    all
}

/// Asks that a file names neither the source tree nor the directory of the crates.
pub fn names_no_tree(file: &Path) {
    let tree = env!("FETIFETI_ROOT").as_bytes();
    let home = std::env::var("CARGO_HOME").or_else(|_| Ok(std::env::var("HOME")? + "/.cargo"));
    let crates = home.map(|home: String| home + "/registry/");
    let crates = crates.unwrap_or_else(|_: std::env::VarError| "/registry/src/".into());
    let bytes = std::fs::read(file).expect("a file");
    let mut places = bytes.windows(crates.len());
    let bad = |w: &[u8]| w == crates.as_bytes();
    assert!(!places.any(bad), "{}: {crates}", file.display());
    // Panics inside of code that a dependency generates name its file below target/ in unoptimised builds.
    let mut places = bytes.windows(tree.len() + 8);
    let bad = |w: &[u8]| w.starts_with(tree) && !w.ends_with(b"/target/");
    assert!(!places.any(bad), "{}", file.display());
}

#[test]
fn nothing_lies_beside_the_prefix_or_knows_the_source_tree() {
    let scratch = Scratch::new("install-destdir");
    let root = scratch.path("root");
    install(&scratch, "/opt/fetifeti", &root);
    let prefix = Path::new(&root).join("opt/fetifeti");
    let all = files(Path::new(&root));
    assert!(all.iter().all(|f| f.starts_with(&prefix)));
    let listed = std::fs::read_to_string(prefix.join("share/fetifeti/installed"));
    let listed = listed.expect("a list of the files");
    assert_eq!(listed.lines().count(), all.len());
    for file in listed.lines() {
        assert!(prefix.join(file).exists(), "{file}");
    }
    for file in &all {
        names_no_tree(file);
    }
    for name in ["libfetifeti.so", "libfetifeti_step.so"] {
        let library = prefix.join("lib").join(name).display().to_string();
        let dynamic = run("readelf", &["-d", &library], &prefix, "");
        assert!(dynamic.contains(&format!("[{name}.0]")), "{dynamic}");
        let sections = run("readelf", &["-S", &library], &prefix, "");
        assert!(!sections.contains(".debug_info"), "{name} is not stripped");
    }
}

#[test]
fn examples_build_with_what_was_installed() {
    let scratch = Scratch::new("install-prefix");
    let prefix = scratch.path("prefix");
    let below = |path: &str| Path::new(&prefix).join(path);
    let said = install(&scratch, &prefix, "");
    assert!(said.contains(&prefix), "{said}");

    let program = below("bin/fetifeti").display().to_string();
    let version = run(&program, &["--version"], &below("."), "");
    assert!(version.contains(env!("CARGO_PKG_VERSION")), "{version}");
    let scene = below("share/fetifeti/examples/scenes/model_contact.toml");
    let solved = run(
        &program,
        &["solve", &scene.display().to_string()],
        &below("."),
        "",
    );
    assert!(solved.contains("CONVERGED"), "{solved}");

    // With pkg-config: C and Fortran.
    let examples = below("share/fetifeti/examples/embedding");
    let search = below("lib/pkgconfig").display().to_string();
    run("make", &["-s"], &examples, &search);
    let contact = examples.join("contact").display().to_string();
    let out = mpirun(2, &contact, &["-contact", "-m", "17"], &[]);
    assert!((number_after(&out, "force") - 0.1).abs() < 1e-6);
    let bars = examples.join("bars").display().to_string();
    let out = mpirun(2, &bars, &[], &[]);
    let (force, exact) = (number_after(&out, "force"), number_after(&out, "exact"));
    assert!((force - exact).abs() < 1e-6 * exact);
    let has_ten_steps = |dir: &Path| {
        let scene = concat!(env!("FETIFETI_ROOT"), "/examples/scenes/press_ramp.toml");
        let program = dir.join("steps").display().to_string();
        let out = mpirun(2, &program, &["-scene", scene], &[]);
        assert_eq!(out.code, 0, "{}", out.all());
        assert_eq!(out.stdout.matches("force").count(), 10, "{}", out.all());
    };
    has_ten_steps(&examples);

    // With CMake, also after the installation was moved.
    let moved = scratch.path("moved");
    std::fs::rename(&prefix, &moved).expect("the directory moves");
    let cmake = PathBuf::from(scratch.path("cmake"));
    std::fs::create_dir_all(&cmake).expect("a directory");
    let source = Path::new(&moved).join("share/fetifeti/examples/embedding");
    let hint = format!("-DCMAKE_PREFIX_PATH={moved}");
    run("cmake", &[&hint, &source.display().to_string()], &cmake, "");
    run("make", &["-s"], &cmake, "");
    let out = mpirun(
        2,
        &cmake.join("contact").display().to_string(),
        &["-contact"],
        &[],
    );
    assert!((number_after(&out, "force") - 0.1).abs() < 1e-6);
    has_ten_steps(&cmake);

    // What was built there stays, what was installed goes.
    let root = Path::new(env!("FETIFETI_ROOT"));
    let makefile = root.join("Makefile").display().to_string();
    let to = format!("PREFIX={moved}");
    run("make", &["-s", "-f", &makefile, "uninstall", &to], root, "");
    let left = files(Path::new(&moved));
    let made = |f: &PathBuf| f.starts_with(&source);
    assert!(left.iter().all(made), "{left:?}");
}

#[test]
fn the_header_says_the_version_of_the_crate() {
    let header = include_str!("../../wrappers/fetifeti.h");
    let number = |name: &str| {
        let line = header
            .lines()
            .find(|l| l.contains(&format!("#define FETIFETI_VERSION_{name} ")));
        let last = line.and_then(|l| l.split_whitespace().last());
        last.expect("a version macro").to_string()
    };
    let version = ["MAJOR", "MINOR", "SUBMINOR"].map(number).join(".");
    assert_eq!(version, env!("CARGO_PKG_VERSION"));
}

#[test]
fn a_prefix_that_cannot_be_written_is_named() {
    let scratch = Scratch::new("install-bad");
    std::fs::write(scratch.path("file"), "").expect("a file");
    let built = Path::new(env!("CARGO_BIN_EXE_fetifeti"));
    let dir = built.parent().expect("a directory").display().to_string();
    let root = env!("FETIFETI_ROOT");
    let try_it = |args: &[&str]| {
        let out = Command::new("scripts/install.sh")
            .args(args)
            .current_dir(root)
            .output();
        let out = out.expect("the script runs");
        assert_eq!(out.status.code(), Some(3));
        String::from_utf8_lossy(&out.stderr).into_owned()
    };
    let said = try_it(&[&dir, "relative/prefix"]);
    assert!(
        said.contains("relative/prefix") && said.contains("absolute"),
        "{said}"
    );
    let nowhere = scratch.path("nothing");
    let said = try_it(&[&nowhere, "/opt"]);
    assert!(
        said.contains(&nowhere) && said.contains("make build"),
        "{said}"
    );
}
