//! `make dist` and the files of the Debian package. What takes minutes, the whole `make deb`, is not run here.

use std::path::Path;
use std::process::Command;

use crate::installed::{files, install_to, run};
use crate::support::mpi::Scratch;

const ROOT: &str = env!("FETIFETI_ROOT");
const DEBIAN: &str = concat!(env!("FETIFETI_ROOT"), "/packaging/debian");

/// All that Cargo.lock names is found in the archive: cargo reads the manifests of all crates with neither a network
/// nor anything that was loaded before.
#[test]
fn the_source_archive_needs_no_registry() {
    let git = Command::new("git")
        .args(["rev-parse", "HEAD"])
        .current_dir(ROOT)
        .output();
    if !git.is_ok_and(|out| out.status.success()) {
        // Sources out of such an archive: there is no repository to make another one of.
        assert!(Path::new(ROOT).join("vendor").is_dir());
        return;
    }
    let scratch = Scratch::new("dist");
    let dir = scratch.path("dist");
    run(
        "scripts/dist.sh",
        &[&dir, "--unpacked"],
        Path::new(ROOT),
        "",
    );
    let tree = Path::new(&dir).join(concat!("fetifeti-", env!("CARGO_PKG_VERSION")));
    for file in ["README.md", "vendor/mpi/Cargo.toml", "scripts/install.sh"] {
        assert!(tree.join(file).is_file(), "{file}");
    }
    let read = || {
        Command::new(env!("CARGO"))
            .args(["metadata", "--offline", "--locked", "--format-version", "1"])
            .current_dir(&tree)
            .env("CARGO_HOME", scratch.path("home"))
            .output()
            .expect("cargo starts")
    };
    let out = read();
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{said}");
    let known = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(known.contains("/vendor/faer/Cargo.toml"), "{known}");
    // Without the crates the same command fails: it does not look elsewhere.
    std::fs::remove_dir_all(tree.join("vendor/faer")).expect("it was there");
    assert!(!read().status.success());
}

/// Whether a path begins with a pattern of debhelper, in which `*` is any part of one name.
fn covers(pattern: &str, path: &str) -> bool {
    let mut names = path.split('/');
    pattern.split('/').all(|p| {
        let Some(name) = names.next() else {
            return false;
        };
        match p.split_once('*') {
            Some((before, after)) => name.starts_with(before) && name.ends_with(after),
            None => p == name,
        }
    })
}

/// Each file that `make install` puts somewhere lies in one Debian package, and each entry of their lists names some.
#[test]
fn debian_packages_have_all_files() {
    let read = |name: &str| {
        let path = format!("{DEBIAN}/{name}");
        std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
    };
    let control = read("control");
    let packages = control.lines().filter_map(|l| l.strip_prefix("Package: "));
    let mut patterns: Vec<String> = read("not-installed").lines().map(String::from).collect();
    for package in packages {
        let listed = read(&format!("{package}.install"));
        patterns.extend(listed.lines().map(String::from));
    }
    let scratch = Scratch::new("debian");
    let root = scratch.path("root");
    install_to(&scratch, "/usr", &root, "/usr/lib/some-linux-gnu");
    let all = files(Path::new(&root));
    let all: Vec<&str> = all
        .iter()
        .filter_map(|f| f.strip_prefix(&root).ok()?.to_str())
        .collect();
    for file in &all {
        let found = patterns.iter().filter(|p| covers(p, file)).count();
        assert_eq!(found, 1, "{file} lies in {found} packages");
    }
    for pattern in &patterns {
        // Python's files come from pip.
        let python = pattern.starts_with("usr/lib/python3");
        assert!(
            python || all.iter().any(|f| covers(pattern, f)),
            "{pattern}"
        );
    }
}

/// dpkg reads the files, and the version is that of the crate.
#[test]
fn debian_files_are_well_formed() {
    let changelog = format!("{DEBIAN}/changelog");
    let version = run(
        "dpkg-parsechangelog",
        &["-l", &changelog, "-S", "Version"],
        Path::new(ROOT),
        "",
    );
    let upstream = version.trim().split('-').next();
    assert_eq!(upstream, Some(env!("CARGO_PKG_VERSION")));
    // Exit code 1: something is not installed, as rustup's toolchain is no package; 2: it cannot be read.
    let out = Command::new("dpkg-checkbuilddeps")
        .arg(format!("{DEBIAN}/control"))
        .output()
        .expect("dpkg-dev is there");
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(matches!(out.status.code(), Some(0 | 1)), "{said}");
}
