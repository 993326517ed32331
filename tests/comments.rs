//! Comments of documentation stand alone: who reads one of them, on its page or in an editor, sees neither the item
//! before it nor the rest of a sentence that began there.

use std::path::{Path, PathBuf};

/// Beginnings that lean on what stands somewhere else.
const LEANING: [&str; 4] = ["…", "The same", "Those", "What"];

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// The text of a line of documentation.
fn text(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let text = line
        .strip_prefix("///")
        .or_else(|| line.strip_prefix("//!"))?;
    Some(text.trim())
}

/// The numbers of the lines at which a paragraph of documentation leans on something, with the line.
fn leaning(source: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut begins = true;
    for (n, line) in source.lines().enumerate() {
        let Some(text) = text(line) else {
            begins = true;
            continue;
        };
        let leans = |word: &str| {
            let rest = text.strip_prefix(word);
            rest.is_some_and(|r| !r.starts_with(char::is_alphanumeric) || word == "…")
        };
        if begins && LEANING.iter().any(|word| leans(word)) {
            found.push((n + 1, line));
        }
        begins = text.is_empty();
    }
    found
}

#[test]
fn comments_of_documentation_stand_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in [
        "src",
        "crates",
        "wrappers/petsc-sys/src",
        "wrappers/step/src",
    ] {
        collect(&root.join(folder), &mut files);
    }
    assert!(files.len() > 700, "only {} files were found", files.len());
    let mut said = Vec::new();
    for file in files {
        let source = std::fs::read_to_string(&file).expect("a source");
        let lines = leaning(&source);
        said.extend(
            lines
                .iter()
                .map(|(n, l)| format!("{}:{n}: {l}", file.display())),
        );
    }
    assert!(said.is_empty(), "\n{}\n", said.join("\n"));
}

#[test]
fn leaning_comments_are_found() {
    let source = "//! What rows are.\n//!\n//! The same for nodes.\n\n\
                  /// Whatever it is.\n/// Those of a file.\nfn f() {}\n\
                  /// A number;\n/// … and its unit.\n///\n/// … or none.\n    // The same.\n    /// Those.\n";
    let lines: Vec<usize> = leaning(source).iter().map(|l| l.0).collect();
    assert_eq!(lines, [1, 3, 11, 13]);
}
