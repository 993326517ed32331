//! What the compiler does not hold: the order of the rooms inside the solver, circles of at most three files inside a
//! crate, and files of at most 400 lines. The order of the crates is cargo's. The map is in docs/architecture.md.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The rooms of `src`, from the first to the last: each imports from those before it.
const ROOMS: [&str; 9] = [
    "status",
    "substructures",
    "feti",
    "contact",
    "settings",
    "solution",
    "solver",
    "embed",
    "capi",
];

const MOST_IN_A_CIRCLE: usize = 3;
const MOST_LINES: usize = 400;

/// A module by its path in its crate, `feti::jump::operator`; the root is "".
type Modules = BTreeMap<String, String>;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folders of sources: the solver's and those of the other crates.
fn sources() -> Vec<PathBuf> {
    let crates = std::fs::read_dir(root().join("crates")).expect("crates");
    let crates = crates.map(|c| c.expect("a crate").path().join("src"));
    let mut all: Vec<PathBuf> = crates.filter(|s| s.is_dir()).collect();
    all.push(root().join("src"));
    all
}

fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path, endings));
        } else if endings
            .iter()
            .any(|e| path.extension().is_some_and(|x| x == *e))
        {
            found.push(path);
        }
    }
    found
}

/// The modules of a crate with their code, comments and names of tests left out.
fn modules(src: &Path) -> Modules {
    let module = |file: PathBuf| {
        let path = file
            .strip_prefix(src)
            .expect("below src")
            .with_extension("");
        let path = path.to_string_lossy().replace('/', "::");
        let path = path.strip_suffix("::mod").unwrap_or(&path);
        let text = std::fs::read_to_string(&file).expect("a source");
        let lines = text.lines().map(|l| l.split("//").next().unwrap_or(""));
        let path = if path == "lib" { "" } else { path };
        (path.to_string(), lines.collect::<Vec<_>>().join("\n"))
    };
    files(src, &["rs"]).into_iter().map(module).collect()
}

/// The paths from the root of the crate that the module `of` names: what follows `crate::` and `super::`, groups taken
/// apart.
fn named(of: &str, code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let letter = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    for (begin, mark) in [("crate", 0), ("super", 1)] {
        for (at, _) in code.match_indices(&format!("{begin}::")) {
            if code[..at].ends_with(letter) {
                continue;
            }
            let mut rest = &code[at + begin.len() + 2..];
            let mut up = mark;
            while let Some(further) = rest.strip_prefix("super::") {
                (rest, up) = (further, up + 1);
            }
            let mut base: Vec<&str> = of.split("::").filter(|p| !p.is_empty()).collect();
            base.truncate(if mark == 0 {
                0
            } else {
                base.len().saturating_sub(up)
            });
            take_apart(&base.join("::"), rest, &mut found);
        }
    }
    found
}

fn take_apart(base: &str, rest: &str, found: &mut BTreeSet<String>) {
    let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
    let (path, rest) = rest.split_at(end.unwrap_or(rest.len()));
    let whole = [base, path.trim_matches(':')].join("::");
    let whole = whole.trim_matches(':').to_string();
    let Some(inner) = rest
        .strip_prefix('{')
        .filter(|_| path.is_empty() || path.ends_with("::"))
    else {
        found.insert(whole);
        return;
    };
    let mut depth = 0;
    let mut first = true;
    for (at, c) in inner.char_indices() {
        if depth == 0 && (first || c == ',') {
            let part = inner[at..].trim_start_matches(|c: char| c == ',' || c.is_whitespace());
            take_apart(&whole, part, found);
        }
        first = false;
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => return,
            '}' => depth -= 1,
            _ => {}
        }
    }
}

/// Which modules of its crate each module imports. A name that a folder re-exports counts for the folder.
fn imports(modules: &Modules) -> BTreeMap<&str, BTreeSet<&str>> {
    let module_of = |path: &str| {
        let mut path = path;
        loop {
            match modules.get_key_value(path) {
                Some((module, _)) => return module.as_str(),
                None => path = path.rfind("::").map_or("", |end| &path[..end]),
            }
        }
    };
    let of = |(module, code): (&'_ String, &String)| {
        let named = named(module, code);
        let targets = named.iter().map(|path| module_of(path));
        // What a folder shows of itself is no import, and neither is the root.
        let inside =
            |t: &&str| !t.is_empty() && *t != module && !module.starts_with(&format!("{t}::"));
        targets.filter(inside).collect::<BTreeSet<_>>()
    };
    modules
        .iter()
        .map(|entry| (entry.0.as_str(), of(entry)))
        .collect()
}

#[test]
fn no_circle_has_more_than_three_files() {
    let mut large = Vec::new();
    for src in sources() {
        let modules = modules(&src);
        let imports = imports(&modules);
        let reached = |from: &str| {
            let mut seen = BTreeSet::new();
            let mut left = vec![from];
            while let Some(next) = left.pop() {
                let new = imports
                    .get(next)
                    .into_iter()
                    .flatten()
                    .filter(|m| !seen.contains(*m));
                let new: Vec<&str> = new.copied().collect();
                seen.extend(new.iter().copied());
                left.extend(new);
            }
            seen
        };
        for module in imports.keys() {
            let circle: Vec<&str> = reached(module)
                .into_iter()
                .filter(|other| reached(other).contains(module))
                .collect();
            if circle.len() > MOST_IN_A_CIRCLE && circle[0] == *module {
                large.push(format!("{}: {}", src.display(), circle.join(", ")));
            }
        }
    }
    assert!(large.is_empty(), "\n{}\n", large.join("\n"));
}

#[test]
fn each_room_of_the_solver_imports_from_those_before_it() {
    let modules = modules(&root().join("src"));
    let room = |module: &str| module.split("::").next().unwrap_or_default().to_string();
    let place = |module: &str| ROOMS.iter().position(|r| *r == room(module));
    let mut back = Vec::new();
    for (module, targets) in imports(&modules) {
        let here = place(module);
        assert!(
            module.is_empty() || here.is_some(),
            "{module} is in no room"
        );
        let wrong = targets.iter().filter(|t| here.is_some() && place(t) > here);
        back.extend(wrong.map(|t| format!("{module} imports {t}")));
    }
    assert!(back.is_empty(), "\n{}\n", back.join("\n"));
}

#[test]
fn no_source_is_longer_than_400_lines() {
    let mut all: Vec<PathBuf> = sources().iter().flat_map(|s| files(s, &["rs"])).collect();
    all.extend(files(&root().join("wrappers"), &["rs", "c"]));
    assert!(all.len() > 600, "only {} files were found", all.len());
    let lines = |file: &PathBuf| std::fs::read_to_string(file).map_or(0, |t| t.lines().count());
    let long = all.iter().map(|file| (lines(file), file.display()));
    let long = long.filter(|(n, _)| *n > MOST_LINES);
    let said: Vec<String> = long.map(|(n, file)| format!("{file}: {n} lines")).collect();
    assert!(said.is_empty(), "split by idea:\n{}\n", said.join("\n"));
}

#[test]
fn imports_are_found() {
    let files = [
        ("", "pub mod feti;"),
        ("feti", "pub mod a;\npub mod b;"),
        (
            "feti::a",
            "use super::b::{self, B};\nuse crate::contact::{Step, state::{State, X}};",
        ),
        ("feti::b", "fn f() { super::super::contact::go() }"),
        ("contact", "use crate::feti::{a::A, b};"),
        ("contact::state", "use super::Step;"),
    ];
    let modules: Modules = files.map(|(m, t)| (m.to_string(), t.to_string())).into();
    let imports = imports(&modules);
    assert_eq!(
        imports["feti::a"],
        ["feti::b", "contact", "contact::state"].into()
    );
    assert_eq!(imports["feti::b"], ["contact"].into());
    assert_eq!(imports["contact"], ["feti::a", "feti::b"].into());
    assert!(imports["contact::state"].is_empty());
}
