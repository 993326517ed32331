//! The Python package of wrappers/python: pip installs it without a network, and its own tests run on what was
//! installed, at several numbers of ranks. Scripts that use it from the source tree.

use std::path::Path;
use std::process::Command;

use crate::installed::names_no_tree;
use crate::support::mpi::{command, mpirun, Output, Scratch};
use crate::support::plugin::{library, petsc4py};

const ROOT: &str = env!("FETIFETI_ROOT");

/// Runs a script of the source tree, which finds petsc4py, the package and the library.
pub fn script(script: &str, ranks: usize, options: &str) -> Output {
    script_with(script, ranks, options, "", &[])
}

/// As `script`, with more places for Python's modules and more environment variables.
pub fn script_with(
    script: &str,
    ranks: usize,
    options: &str,
    modules: &str,
    env: &[(&str, &str)],
) -> Output {
    let others = std::env::var("PYTHONPATH").unwrap_or_default();
    let path = format!(
        "{}:{ROOT}/wrappers/python/src:{modules}:{others}",
        petsc4py()
    );
    let library = library();
    let dir = Path::new(&library)
        .parent()
        .expect("it lies in a directory");
    let others = std::env::var("LD_LIBRARY_PATH").unwrap_or_default();
    let places = format!("{}:{others}", dir.display());
    let script = format!("{ROOT}/{script}");
    let args: Vec<&str> = [&script[..]]
        .into_iter()
        .chain(options.split(' '))
        .collect();
    let own = [
        ("PYTHONPATH", &path[..]),
        ("LD_LIBRARY_PATH", &places),
        ("FETIFETI_LIBRARY", &library),
        ("PYTHONDONTWRITEBYTECODE", "1"),
    ];
    let out = mpirun(ranks, "/usr/bin/python3", &args, &[&own, env].concat());
    assert_eq!(out.code, 0, "{options}, {ranks} ranks: {}", out.all());
    out
}

/// Runs a command that must succeed.
fn run(command: &mut Command) -> String {
    let out = command.output().expect("the command starts");
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{command:?}: {said}");
    String::from_utf8_lossy(&out.stdout).into_owned()
}

/// Copies wrappers/python into `tree`: pip writes beside the sources.
fn copy_sources(tree: &str) -> String {
    let wrappers = Path::new(tree).join("wrappers");
    std::fs::create_dir_all(&wrappers).expect("a directory");
    run(Command::new("cp")
        .arg("-r")
        .arg(format!("{ROOT}/wrappers/python"))
        .arg(&wrappers));
    wrappers.join("python").display().to_string()
}

/// pip install of these sources into a directory.
fn install(sources: &str, to: &str) -> Command {
    let mut pip = command("/usr/bin/python3");
    pip.args(["-m", "pip", "install", "--quiet", "--no-deps"])
        .args(["--no-build-isolation", "--no-index", "--target", to])
        .arg(sources);
    pip
}

/// The types in its sources agree, where mypy is installed.
#[test]
fn the_types_of_the_package_agree() {
    let mut mypy = command("python3");
    mypy.args(["-m", "mypy", "--python-executable", "/usr/bin/python3"])
        .args([
            "--cache-dir",
            "/dev/null",
            "--config-file",
            "../pyproject.toml",
        ])
        .args(["-p", "fetifeti"])
        .current_dir(format!("{ROOT}/wrappers/python/src"));
    let out = mypy.output().expect("python3 starts");
    let said = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
    if said.contains("No module named mypy") {
        println!("skipped: mypy is not installed");
        return;
    }
    assert!(out.status.success(), "{said}");
}

#[test]
fn the_package_is_installed_and_passes_its_tests() {
    let scratch = Scratch::new("python");
    let sources = copy_sources(&scratch.path("tree"));
    let place = scratch.path("packages");
    run(install(&sources, &place).env("FETIFETI_LIBRARY", library()));
    let path = format!("{place}:{}", petsc4py());
    let tests = format!("{sources}/tests");
    for ranks in [1, 2, 4] {
        let args = ["-m", "pytest", "-q", "-p", "no:cacheprovider", &tests];
        let env = [
            ("PYTHONPATH", &path[..]),
            ("FETIFETI_LIBRARY", &library()),
            ("FETIFETI_PROGRAM", env!("CARGO_BIN_EXE_fetifeti")),
            ("FETIFETI_SOURCES", ROOT),
        ];
        let out = mpirun(ranks, "/usr/bin/python3", &args, &env);
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
        assert!(out.stdout.contains(" passed"), "{}", out.all());
    }
}

/// Where no library is installed pip has cargo build it and puts it into the package. A stand-in for cargo writes down
/// how it was called, and hands over the library of this test.
#[test]
fn pip_builds_the_library_where_there_is_none() {
    let scratch = Scratch::new("python-build");
    let tree = scratch.path("tree");
    let sources = copy_sources(&tree);
    for file in ["Cargo.toml", "wrappers/fetifeti.h"] {
        let from = Path::new(ROOT).join(file);
        std::fs::copy(from, Path::new(&tree).join(file)).expect("a copy");
    }
    let (bin, target) = (scratch.path("bin"), scratch.path("target"));
    std::fs::create_dir_all(&bin).expect("a directory");
    let stand_in = format!(
        "#!/bin/sh\npwd >{bin}/called\necho \"$@\" >>{bin}/called\nmkdir -p {target}/release\n\
         cp {} {target}/release/libfetifeti.so\n",
        library()
    );
    std::fs::write(format!("{bin}/cargo"), stand_in).expect("a file");
    run(Command::new("chmod").args(["+x", &format!("{bin}/cargo")]));
    let place = scratch.path("packages");
    let path = format!("{bin}:/usr/bin:/bin");
    let empty = |command: &mut Command| {
        command
            .env("PATH", &path)
            .env("PKG_CONFIG_LIBDIR", &bin)
            .env_remove("PKG_CONFIG_PATH")
            .env_remove("FETIFETI_LIBRARY")
            .env("CARGO_TARGET_DIR", &target);
    };
    let mut pip = install(&sources, &place);
    empty(&mut pip);
    run(&mut pip);
    let called = std::fs::read_to_string(format!("{bin}/called")).expect("cargo was called");
    let expected = format!("{tree}\nbuild --release --package fetifeti\n");
    assert_eq!(called, expected);
    names_no_tree(Path::new(&format!("{place}/fetifeti/libfetifeti.so")));
    let mut python = command("/usr/bin/python3");
    python
        .arg("-c")
        .arg("import fetifeti; fetifeti.register(); print(fetifeti.find_library())")
        .env("PYTHONPATH", format!("{place}:{}", petsc4py()));
    empty(&mut python);
    let found = run(&mut python);
    assert_eq!(found.trim(), format!("{place}/fetifeti/libfetifeti.so"));
}
