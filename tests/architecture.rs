//! The order of the rooms: each imports only from those before it, and inside a room no circle has more than three
//! files. No file of the sources is longer than 400 lines.
//!
//! The imports are read from the sources: `use` statements and paths that begin with `crate` or `super`. A name that a
//! module re-exports counts for the file that it comes from. What only tests import does not count. The map
//! is in docs/architecture.md.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The doors, from the first to the last.
const ORDER: [&str; 26] = [
    "error",
    "linalg",
    "petsc",
    "status",
    "parallel",
    "cholesky",
    "mesh",
    "fem",
    "mortar",
    "substructures",
    "feti",
    "contact",
    "settings",
    "solution",
    "solver",
    "scene",
    "embed",
    "capi",
    "assembled",
    "report",
    "checkpoint",
    "baselines",
    "study",
    "cli",
    "lib",
    "main",
];

/// Files of one room that may import each other in a circle.
const MOST_IN_A_CIRCLE: usize = 3;

/// A module by its path: `["feti", "jump", "operator"]`; the root is `["lib"]`.
type Module = Vec<String>;

/// Every module's imports: the modules that it names, and how it names them.
type Imports = BTreeMap<Module, BTreeMap<Module, String>>;

/// The modules of a crate with their sources.
struct Sources(BTreeMap<Module, String>);

impl Sources {
    fn of_this_crate() -> Sources {
        let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let mut files = Vec::new();
        collect(&src, "rs", &mut files);
        let modules = files.into_iter().map(|file| {
            let inside = file
                .strip_prefix(&src)
                .expect("below src")
                .with_extension("");
            let mut path: Module = inside.iter().map(|p| p.to_string_lossy().into()).collect();
            if path.len() > 1 && path.last().is_some_and(|p| p == "mod") {
                path.pop();
            }
            (path, std::fs::read_to_string(&file).expect("a source file"))
        });
        Sources(modules.filter(|(path, _)| !only_for_tests(path)).collect())
    }

    /// The longest path of a module that `path` begins with; the root where there is none.
    fn module_of(&self, path: &[String]) -> Module {
        let known = (1..=path.len()).rev().map(|n| path[..n].to_vec());
        let mut known = known.filter(|p| self.0.contains_key(p));
        known.next().unwrap_or_else(|| vec!["lib".into()])
    }

    /// What modules re-export: the path behind each path.
    fn exports(&self) -> BTreeMap<Vec<String>, Vec<String>> {
        let mut exports = BTreeMap::new();
        for (module, text) in &self.0 {
            for path in uses(&code(text), true) {
                let behind = self.absolute(module, &path);
                if let (Some(behind), Some(name)) = (behind, path.last()) {
                    exports.insert(
                        [inside(module), std::slice::from_ref(name)].concat(),
                        behind,
                    );
                }
            }
        }
        exports
    }

    fn imports(&self) -> Imports {
        let exports = self.exports();
        let mut all = Imports::new();
        for (module, text) in &self.0 {
            let named = all.entry(module.clone()).or_default();
            let code = code(text);
            let private = uses(&code, false).into_iter().chain(inline(&code));
            let private = private.map(|path| (path, false));
            let public = uses(&code, true).into_iter().map(|path| (path, true));
            for (path, public) in private.chain(public) {
                let Some(mut absolute) = self.absolute(module, &path) else {
                    continue;
                };
                // Through one facade after the other to the file itself.
                for _ in 0..8 {
                    let known = (1..=absolute.len()).rev();
                    let mut known = known.filter_map(|n| Some((n, exports.get(&absolute[..n])?)));
                    match known.next() {
                        Some((n, behind)) if !self.0.contains_key(&absolute[..n]) => {
                            absolute = [behind, &absolute[n..]].concat();
                        }
                        _ => break,
                    }
                }
                let target = self.module_of(&absolute);
                // A facade does not lean on what it shows.
                let shown = public && room(&target) == room(module);
                if target != *module && !shown {
                    named.entry(target).or_insert_with(|| path.join("::"));
                }
            }
        }
        all
    }

    /// The path from the root that `path` means in `module`; `None` for other crates.
    fn absolute(&self, module: &[String], path: &[String]) -> Option<Vec<String>> {
        let here = inside(module);
        let first = path.first()?.as_str();
        Some(match first {
            "crate" => path[1..].to_vec(),
            "self" => [here, &path[1..]].concat(),
            "super" => {
                let up = path.iter().take_while(|p| *p == "super").count();
                let above = here.len().checked_sub(up)?;
                [&here[..above], &path[up..]].concat()
            }
            _ => {
                let child = [here, &path[..1]].concat();
                if !self.0.contains_key(&child) {
                    return None;
                }
                [here, path].concat()
            }
        })
    }
}

/// The path of what stands in a module: nothing before it in the root.
fn inside(module: &[String]) -> &[String] {
    if module == ["lib"] {
        &[]
    } else {
        module
    }
}

/// All files below a folder with this ending.
fn collect(folder: &Path, ending: &str, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, ending, files);
        } else if path.extension().is_some_and(|e| e == ending) {
            files.push(path);
        }
    }
}

fn only_for_tests(path: &[String]) -> bool {
    let test = |p: &String| p.ends_with("tests") || p == "testing";
    path.iter().any(test)
}

/// The source without comments and without its tests.
fn code(text: &str) -> String {
    let end = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
    let lines = text[..end].lines();
    let code = lines.map(|line| line.split("//").next().unwrap_or_default());
    code.collect::<Vec<_>>().join("\n")
}

/// The paths of all `use` statements, groups taken apart: of those that re-export, or of the others.
fn uses(code: &str, public: bool) -> Vec<Vec<String>> {
    let mut paths = Vec::new();
    for statement in code.split(';') {
        let Some(at) = statement
            .rfind("use ")
            .filter(|&at| begins(statement, at) == Some(public))
        else {
            continue;
        };
        let tree: String = statement[at + 4..]
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ");
        take_apart("", &tree, &mut paths);
    }
    paths
}

/// Whether the statement at `at` is public; `None` if more than its visibility stands before it on its line.
fn begins(text: &str, at: usize) -> Option<bool> {
    let before = text[..at].rsplit('\n').next().unwrap_or_default().trim();
    match before {
        "" => Some(false),
        visibility if visibility.starts_with("pub") => Some(true),
        _ => None,
    }
}

fn take_apart(prefix: &str, tree: &str, paths: &mut Vec<Vec<String>>) {
    let Some(open) = tree.find('{') else {
        let whole = format!("{prefix}{tree}");
        let path = whole.split(" as ").next().unwrap_or_default();
        let parts = path.split("::").map(|p| p.trim().to_string());
        paths.push(
            parts
                .filter(|p| p != "self" || path.starts_with("self"))
                .collect(),
        );
        return;
    };
    let close = tree.rfind('}').unwrap_or(tree.len());
    let inner = format!("{prefix}{}", &tree[..open]);
    let (mut depth, mut start) = (0, open + 1);
    for (at, c) in tree[open + 1..close].char_indices() {
        let at = open + 1 + at;
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                take_apart(&inner, tree[start..at].trim(), paths);
                start = at + 1;
            }
            _ => {}
        }
    }
    if !tree[start..close].trim().is_empty() {
        take_apart(&inner, tree[start..close].trim(), paths);
    }
}

/// Paths in expressions and types that begin with `crate::` or `super::`.
fn inline(code: &str) -> Vec<Vec<String>> {
    let part_of_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = code.split(|c| !part_of_path(c));
    let begins = |w: &&str| w.starts_with("crate::") || w.starts_with("super::");
    // Groups of use statements are not for here.
    let paths = words.filter(begins).filter(|w| !w.ends_with(':'));
    let parts = paths.map(|w| w.split("::").filter(|p| !p.is_empty()).map(String::from));
    let paths = parts.map(Iterator::collect::<Vec<_>>);
    paths.filter(|path| path.len() > 1).collect()
}

fn room(module: &[String]) -> &str {
    module[0].as_str()
}

fn name(module: &[String]) -> String {
    module.join("::")
}

/// The arrows that point to a room behind their own, one sentence each.
fn arrows_back(imports: &Imports) -> Vec<String> {
    let door = |module: &[String]| ORDER.iter().position(|o| *o == room(module));
    let mut arrows = Vec::new();
    for (module, named) in imports {
        for (target, path) in named {
            match (door(module), door(target)) {
                (Some(from), Some(to)) if to <= from => {}
                (Some(_), Some(_)) => arrows.push(format!(
                    "{} imports {} ({path}), but {} stands behind {}",
                    name(module),
                    name(target),
                    room(target),
                    room(module)
                )),
                _ => arrows.push(format!(
                    "{} or {} has no door in the order",
                    room(module),
                    room(target)
                )),
            }
        }
    }
    arrows
}

/// Circles of files inside a room: the sets of modules that reach each other.
fn circles(imports: &Imports) -> Vec<BTreeSet<Module>> {
    let reach = |from: &Module| {
        let mut seen = BTreeSet::new();
        let mut left = vec![from];
        while let Some(module) = left.pop() {
            let named = imports.get(module).into_iter().flat_map(BTreeMap::keys);
            for next in named.filter(|m| room(m) == room(from)) {
                if seen.insert(next.clone()) {
                    left.push(next);
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> =
        imports.keys().map(|m| (m, reach(m))).collect();
    let circle = |m: &Module| -> BTreeSet<Module> {
        let there = reached[m].iter();
        let back = there.filter(|n| reached.get(n).is_some_and(|r| r.contains(m)));
        back.cloned().collect()
    };
    let all: BTreeSet<BTreeSet<Module>> = imports.keys().map(circle).collect();
    all.into_iter().filter(|c| c.len() > 1).collect()
}

#[test]
fn each_room_imports_from_those_before_it() {
    let imports = Sources::of_this_crate().imports();
    assert!(
        imports.len() > 300,
        "only {} modules were found",
        imports.len()
    );
    let arrows = arrows_back(&imports);
    assert!(arrows.is_empty(), "\n{}\n", arrows.join("\n"));
}

#[test]
fn no_circle_inside_a_room_has_more_than_three_files() {
    let circles = circles(&Sources::of_this_crate().imports());
    let large = circles.iter().filter(|c| c.len() > MOST_IN_A_CIRCLE);
    let said: Vec<String> = large
        .map(|c| c.iter().map(|m| name(m)).collect::<Vec<_>>().join(", "))
        .collect();
    assert!(said.is_empty(), "circles:\n{}\n", said.join("\n"));
}

/// Lines that a file of `src` and `wrappers` may have.
const MOST_LINES: usize = 400;

#[test]
fn no_source_is_longer_than_400_lines() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for (folder, ending) in [("src", "rs"), ("wrappers", "rs"), ("wrappers", "c")] {
        collect(&root.join(folder), ending, &mut files);
    }
    assert!(files.len() > 300, "only {} files were found", files.len());
    let lines =
        |file: &PathBuf| std::fs::read_to_string(file).map_or(0, |text| text.lines().count());
    let long: Vec<String> = files
        .iter()
        .map(|file| (lines(file), file.display()))
        .filter(|(n, _)| *n > MOST_LINES)
        .map(|(n, file)| format!("{file} has {n} lines: split it by idea"))
        .collect();
    assert!(long.is_empty(), "\n{}\n", long.join("\n"));
}

/// A crate of a few lines, with an arrow back, a re-export in the way, and a circle.
#[test]
fn arrows_and_circles_are_found() {
    let module = |path: &str| path.split("::").map(String::from).collect::<Module>();
    let files = [
        ("lib", "pub mod feti;\npub use contact::{State, Step as S};"),
        ("feti", "pub mod a;\npub mod b;"),
        (
            "feti::a",
            "use super::b::{self, B};\nuse crate::linalg::csr;",
        ),
        (
            "feti::b",
            "fn f() { crate::State::new() } // crate::cli is no import\nuse super::a;",
        ),
        (
            "contact",
            "pub use crate::feti::{\n    a::A,\n    b::{B, C},\n};",
        ),
        (
            "linalg::csr",
            "#[cfg(test)]\nmod tests {\n    use crate::cli::main;\n}",
        ),
        ("cli", "use std::fmt;\nuse crate::contact::Step;"),
    ];
    let sources = Sources(files.map(|(m, t)| (module(m), t.to_string())).into());
    let imports = sources.imports();
    assert_eq!(
        arrows_back(&imports),
        ["feti::b imports contact (crate::State::new), but contact stands behind feti"]
    );
    let circle: BTreeSet<Module> = [module("feti::a"), module("feti::b")].into();
    assert_eq!(circles(&imports), [circle]);
    assert_eq!(imports[&module("contact")].len(), 2);
    assert!(imports[&module("linalg::csr")].is_empty());
}
