//! Dead references: what documents and comments name is there. And no line has more than 120 characters.
//!
//! Held against the repository, in every text that git knows:
//!
//! - a path that begins with `src/`, `crates/`, `tests/`, `docs/`, `wrappers/`, `examples/` or `scripts/`;
//! - the target of a link in a page, with its heading where it names one;
//! - a section of docs/theory.md, written `docs/theory.md, section 9` or `[theory](theory.md), section 9`;
//! - in CONTRIBUTING.md and docs/architecture.md a name before its file, `find` (`src/scene/rows/entries.rs`): the file
//!   has it.
//!
//! docs/architecture.md has a row for each crate and for each room of the solver (tests/architecture.rs).
//!
//! Longer lines are for what cannot be broken: rows of tables, and in pages what is shown as it is.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Folders whose files are named by their path.
const ROOTS: [&str; 7] = [
    "src/",
    "crates/",
    "tests/",
    "docs/",
    "wrappers/",
    "examples/",
    "scripts/",
];

/// Endings of the texts that are read.
const READ: [&str; 12] = [
    "rs", "md", "toml", "c", "h", "f90", "F90", "py", "sh", "cff", "run", "Makefile",
];

/// Characters of the longest line.
const WIDTH: usize = 120;

/// This file: it has dead references on purpose.
const OWN: &str = "tests/references.rs";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every text of the repository with its path.
fn texts() -> Vec<(PathBuf, String)> {
    let mut files = Vec::new();
    collect(root(), &mut files);
    let inside = files
        .iter()
        .map(|f| f.strip_prefix(root()).expect("inside"));
    inside
        .map(|file| {
            let text = std::fs::read_to_string(root().join(file)).expect("a text");
            (file.to_path_buf(), text)
        })
        .collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy();
        if path.is_dir() {
            let known = !name.starts_with('.') || name == ".ci" || name == ".cargo";
            if known && name != "target" && name != "out" {
                collect(&path, files);
            }
        } else if READ.contains(&name.rsplit('.').next().expect("a name")) {
            files.push(path);
        }
    }
}

/// A text as one line, so that a reference may be broken between two: without the marks of comments.
fn flat(text: &str) -> String {
    let lines = text.lines().map(|line| {
        let line = line.trim_start();
        let marks = ["//!", "///", "//", "!", "#"].iter();
        let line = marks.fold(line, |l, mark| l.strip_prefix(mark).unwrap_or(l));
        line.trim()
    });
    lines.collect::<Vec<_>>().join(" ")
}

/// Paths of files and folders that a text names.
fn paths(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let part = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    for word in text.split(|c| !part(c)) {
        // `../../docs/x.md` is a link, and is followed from where it stands.
        let path = word.trim_start_matches("./").trim_end_matches(['.', '/']);
        let in_root = ROOTS.iter().any(|r| path.starts_with(r));
        // The beginning of several names, a name to be chosen, a folder of PETSc's, and a manifest's own program.
        let other = path.ends_with('_')
            || path.contains("NAME")
            || path.starts_with("src/ksp")
            || path == "src/main.rs";
        if in_root && !other {
            found.insert(path.to_string());
        }
    }
    found
}

/// Targets of the links of a page, those to other hosts left out.
fn links(page: &str) -> Vec<&str> {
    let targets = page.split("](").skip(1);
    let targets = targets.filter_map(|rest| rest.split(')').next());
    targets
        .filter(|t| !t.contains("://") && !t.contains(' '))
        .collect()
}

/// A heading as links name it.
fn anchor(heading: &str) -> String {
    let letters = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = letters
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.collect::<String>().replace(' ', "-")
}

/// The numbers behind `theory.md, section` in a text.
fn sections(text: &str) -> Vec<usize> {
    let mut found = Vec::new();
    for rest in text.split("theory.md").skip(1) {
        let rest = rest.trim_start_matches([')', '`', ',']).trim_start();
        let Some(rest) = rest.strip_prefix("section") else {
            continue;
        };
        // One number, or several: `sections 11 and 12`.
        for word in rest.trim_start_matches('s').split_whitespace() {
            let number = word.trim_matches(|c: char| !c.is_ascii_digit());
            match number.parse() {
                Ok(n) => found.push(n),
                Err(_) if word == "and" => {}
                Err(_) => break,
            }
            if word.ends_with(['.', ')', ';', ':']) {
                break;
            }
        }
    }
    found
}

/// The numbers of the sections that a page has.
fn numbered(page: &str) -> BTreeSet<usize> {
    let headings = page.lines().filter_map(|l| l.strip_prefix("## "));
    let numbers = headings.filter_map(|h| h.split(' ').next()?.parse().ok());
    numbers.collect()
}

/// Names in backquotes with the file that follows them in brackets.
fn named(page: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for (at, _) in page.match_indices("` (`") {
        let name = page[..at].rsplit('`').next().unwrap_or_default();
        let file = page[at + 4..].split('`').next().unwrap_or_default();
        let last = name.rsplit("::").next().unwrap_or_default();
        let is_name = !last.is_empty() && last.chars().all(|c| c.is_alphanumeric() || c == '_');
        if is_name && file.ends_with(".rs") {
            found.push((last.to_string(), file.to_string()));
        }
    }
    found
}

/// What is wrong with a text that stands in `file`; `exists` knows the files, `theory` the sections.
fn dead(
    file: &Path,
    text: &str,
    exists: &dyn Fn(&Path) -> bool,
    theory: &BTreeSet<usize>,
) -> Vec<String> {
    let at = file.display();
    let flat = flat(text);
    let mut dead = Vec::new();
    for path in paths(text).iter().filter(|p| !exists(Path::new(p))) {
        dead.push(format!("{at}: {path} is not there"));
    }
    for n in sections(&flat).iter().filter(|n| !theory.contains(n)) {
        dead.push(format!("{at}: docs/theory.md has no section {n}"));
    }
    if file.extension().is_some_and(|e| e == "md") {
        let folder = file.parent().expect("a folder");
        for link in links(text) {
            let target = link.split('#').next().expect("a target");
            let path = match target {
                "" => file.to_path_buf(),
                _ => plain(&folder.join(target)),
            };
            if !exists(&path) {
                dead.push(format!("{at}: the link {link} leads nowhere"));
            }
        }
    }
    dead
}

/// A path without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part.as_os_str().to_str() {
            Some("..") => drop(out.pop()),
            Some(".") => {}
            _ => out.push(part),
        }
    }
    out
}

/// The lines of a text that are too long.
fn too_long(file: &Path, text: &str) -> Vec<String> {
    let page = file.extension().is_some_and(|e| e == "md");
    let mut fenced = false;
    let mut found = Vec::new();
    for (at, line) in text.lines().enumerate() {
        fenced ^= line.starts_with("```");
        let length = line.chars().count();
        if length > WIDTH && !is_row(line) && !(page && (fenced || is_shown(line))) {
            let file = file.display();
            found.push(format!("{file}:{}: {length} characters", at + 1));
        }
    }
    found
}

/// Whether a line is a row of a table, in a page or in a comment of documentation.
fn is_row(line: &str) -> bool {
    let line = line.trim_start();
    let marks = ["//!", "///"].iter();
    let text = marks.fold(line, |l, mark| l.strip_prefix(mark).unwrap_or(l));
    text.trim_start().starts_with('|')
}

/// Whether a line of a page is shown as it is, a command, output or a formula, or is a picture or link as a whole.
fn is_shown(line: &str) -> bool {
    let link = line.starts_with('[') || line.starts_with("![");
    line.starts_with("    ") || (link && line.ends_with(')'))
}

fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

#[test]
fn what_is_named_is_there() {
    let theory = numbered(&read("docs/theory.md"));
    assert!(theory.len() >= 14, "{theory:?}");
    let texts = texts();
    assert!(texts.len() > 400, "only {} texts were found", texts.len());
    let exists = |path: &Path| root().join(path).exists();
    let looked = texts.iter().filter(|(file, _)| file != Path::new(OWN));
    let found: Vec<String> = looked
        .flat_map(|(file, text)| dead(file, text, &exists, &theory))
        .collect();
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn lines_are_not_too_long() {
    let texts = texts();
    assert!(texts.iter().any(|(file, _)| file == Path::new(OWN)));
    let found: Vec<String> = texts
        .iter()
        .flat_map(|(file, text)| too_long(file, text))
        .collect();
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn headings_that_links_name_are_there() {
    let pages = texts();
    let pages = pages
        .iter()
        .filter(|(f, _)| f.extension().is_some_and(|e| e == "md"));
    let mut seen = 0;
    for (file, text) in pages {
        for link in links(text) {
            let Some((target, heading)) = link.split_once('#') else {
                continue;
            };
            let page = match target {
                "" => text.clone(),
                _ => read(&plain(&file.parent().expect("a folder").join(target)).to_string_lossy()),
            };
            let mut headings = page.lines().filter(|l| l.starts_with('#'));
            let there = headings.any(|h| anchor(h) == heading);
            assert!(there, "{}: {link} has no such heading", file.display());
            seen += 1;
        }
    }
    assert!(seen >= 2, "only {seen} links name a heading");
}

#[test]
fn names_stand_in_their_files() {
    for page in ["docs/architecture.md", "CONTRIBUTING.md"] {
        let named = named(&flat(&read(page)));
        assert!(page != "docs/architecture.md" || named.len() > 30);
        for (name, file) in named {
            let there = read(&file).contains(&name);
            assert!(there, "{page}: {file} has no `{name}`");
        }
    }
}

/// The crates, and the rooms of the solver that tests/architecture.rs lists.
fn rooms() -> BTreeSet<String> {
    let test = read("tests/architecture.rs");
    let list = test.split("const ROOMS").nth(1).expect("the order");
    let list = list.split("];").next().expect("its end");
    let rooms = list.split('"').skip(1).step_by(2);
    let rooms = rooms.map(|name| format!("src/{name}"));
    let crates = std::fs::read_dir(root().join("crates")).expect("crates");
    let crates = crates.map(|c| c.expect("a crate").file_name());
    let crates = crates.map(|name| format!("crates/{}", name.to_string_lossy()));
    rooms.chain(crates).collect()
}

/// The crates and rooms of a page's tables.
fn mapped(page: &str) -> BTreeSet<String> {
    let rows = page.lines().filter_map(|l| l.strip_prefix("| `"));
    let names = rows.filter_map(|l| l.split('`').next());
    let names = names.map(|n| n.trim_end_matches(".rs").to_string());
    let few = |n: &String| n.matches('/').count() == 1;
    let folders = |n: &String| n.starts_with("src/") || n.starts_with("crates/");
    names.filter(few).filter(folders).collect()
}

#[test]
fn the_map_has_every_crate_and_room() {
    let rooms = rooms();
    assert!(rooms.len() > 18, "{rooms:?}");
    let mapped = mapped(&read("docs/architecture.md"));
    let missing: Vec<_> = rooms.difference(&mapped).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// A page and a comment of a few lines, each with something that is not there.
#[test]
fn what_is_dead_is_found() {
    let exists = |path: &Path| {
        let known = ["docs/theory.md", "docs/a.md", "src/fem/map.rs", "README.md"];
        known.iter().any(|k| Path::new(k) == path)
    };
    let theory = numbered("# Theory\n\n## 1 Spaces\n\n## 12 Deflation\n\n## References\n");
    assert_eq!(theory, [1, 12].into());
    let dead = |file: &str, text: &str| dead(Path::new(file), text, &exists, &theory);

    let page =
        "See [theory](theory.md), sections 1 and 12, [home](../README.md), `src/fem/map.rs`.";
    assert_eq!(dead("docs/a.md", page), [""; 0]);
    let page = "See [b](b.md), [theory](theory.md), section 3, and `src/fem/lost.rs`.";
    assert_eq!(
        dead("docs/a.md", page),
        [
            "docs/a.md: src/fem/lost.rs is not there",
            "docs/a.md: docs/theory.md has no section 3",
            "docs/a.md: the link b.md leads nowhere"
        ]
    );
    let comment =
        "//! Deflation (docs/theory.md, section\n//! 12), after docs/theory.md,\n/// section 2.\n";
    assert_eq!(
        dead("src/fem/map.rs", comment),
        ["src/fem/map.rs: docs/theory.md has no section 2"]
    );
    assert_eq!(anchor("## Local solvers"), "local-solvers");
    let page = "Then `Scene::find` (`src/fem/map.rs`) and `x` (a word).";
    assert_eq!(
        named(page),
        [("find".to_string(), "src/fem/map.rs".to_string())]
    );
    let map = "text\n| room | what |\n| `crates/fem` | a |\n| `src/solver.rs` | b |\n\n| `src/a/b.rs` | c |\n";
    assert_eq!(
        mapped(map),
        ["crates/fem", "src/solver"].map(String::from).into()
    );
}

/// A page and a source, each with long lines that may be and one that may not.
#[test]
fn what_is_too_long_is_found() {
    let (word, words) = ("ü".repeat(WIDTH), "word ".repeat(WIDTH / 4));
    let page = format!(
        "{word}\n| {words} |\n![{words}](a.png)\n    {words}\n```\n{words}\n```\n[a](b.md) {words}\n"
    );
    let long = |file: &str, text: &str| too_long(Path::new(file), text);
    assert_eq!(long("docs/a.md", &page), ["docs/a.md:8: 160 characters"]);
    let source = format!("//! | {words} |\n    /// {words}\n    f(\"{words}\");\n");
    assert_eq!(
        long("src/a.rs", &source),
        ["src/a.rs:2: 158 characters", "src/a.rs:3: 160 characters"]
    );
}
