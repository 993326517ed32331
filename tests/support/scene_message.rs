//! The program's message for a wrong scene, and scenes for such tests.

use scene::Scene;

/// The message for the scene `text`.
pub fn message(text: &str) -> String {
    let result = Scene::parse("s.toml", text).and_then(|s| s.check_values());
    match result {
        Ok(()) => panic!("accepted:\n{text}"),
        Err(e) if e.is_input() => {
            assert_eq!(e.exit_code(), 2);
            let message = e.to_string();
            assert!(!message.contains('\n'), "{message}");
            message
        }
        Err(e) => panic!("{e:?}"),
    }
}

/// A body on three lines: 1 + `line` is its header.
pub fn body(name: &str, origin: &str, more: &str) -> String {
    format!("[[body]]\nname = \"{name}\"\norigin = {origin}\nsize = [1, 1]\n{more}\n")
}

/// Two unit squares side by side, followed by `more`.
pub fn pair(more: &str) -> String {
    format!(
        "{}{}{more}",
        body("a", "[0, 0]", "elements = 4"),
        body("b", "[1, 0]", "elements = 4")
    )
}

#[track_caller]
pub fn check(text: &str, expected: &str) {
    assert_eq!(message(text), expected);
}
