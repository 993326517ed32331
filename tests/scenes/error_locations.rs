//! Errors carry file, line, key, body and cause as data: a program that embeds the solver need not read the sentence.

use std::error::Error as _;

use base::ErrorKind;
use fetifeti::{FetiFeti, Settings};
use scene::{DeckScenes, Scene};

use crate::support::scene_message::{body, pair};
use crate::support::session::with_session;

fn refused(text: &str) -> base::Error {
    let result = Scene::parse("s.toml", text).and_then(|s| s.check_values());
    result.expect_err("a mistake")
}

#[test]
fn keys_of_scenes() {
    let unknown = refused(&pair("[[contact]]\nbodies = [\"a\", \"b\"]\ngapp = 1\n"));
    let place = unknown.location();
    assert_eq!(place.file(), Some("s.toml"));
    assert_eq!(place.line_number(), Some(13));
    assert_eq!(place.key(), Some("gapp"));
    assert!(unknown.message().starts_with("unknown key `gapp`"));
    assert_eq!(
        unknown.to_string(),
        format!("s.toml:13: {}", unknown.message())
    );

    let missing = refused(&pair("[[contact]]\ngap = 1\n"));
    assert_eq!(missing.location().key(), Some("bodies"));
    assert_eq!(missing.location().line_number(), Some(11));

    let wrong = refused(&body("a", "[0, 0]", "elements = \"many\""));
    assert_eq!(wrong.location().key(), Some("elements"));
    assert_eq!(wrong.location().line_number(), Some(5));
    let in_a_list = refused(&body("a", "[0, inf]", "elements = 4"));
    assert_eq!(in_a_list.location().key(), Some("origin"));
    assert_eq!(in_a_list.location().line_number(), Some(3));
}

#[test]
fn bodies_of_scenes() {
    let one = body("a", "[0, 0]", "elements = 4");
    let twice = refused(&(one.clone() + &one));
    assert_eq!(twice.location().bodies(), ["a"]);
    let line = twice.location().line_number().expect("a line");
    assert!((6..=8).contains(&line), "{twice}");
    assert!(twice
        .to_string()
        .starts_with(&format!("s.toml:{line}: body `a`: ")));
    assert!(twice.source().is_none());
}

#[test]
fn files_beside_a_scene() {
    let absent = refused("[mesh]\nfile = \"absent.msh\"\n");
    assert_eq!(absent.kind(), ErrorKind::Input);
    assert_eq!(absent.location().file(), Some("s.toml"));
    assert_eq!(absent.location().line_number(), Some(2));
    let of_mesh = absent.source().expect("the error of the mesh");
    let of_mesh = of_mesh.downcast_ref::<base::Error>().expect("ours");
    assert_eq!(of_mesh.location().file(), Some("absent.msh"));
    let of_disk = of_mesh.source().expect("the error of the disk");
    let of_disk = of_disk
        .downcast_ref::<std::io::Error>()
        .expect("the disk's");
    assert_eq!(of_disk.kind(), std::io::ErrorKind::NotFound);
    let sentence = absent.to_string();
    assert!(
        sentence.starts_with("s.toml:2: absent.msh: the mesh cannot be read: "),
        "{sentence}"
    );
}

#[test]
fn lines_of_decks() {
    let path = std::env::temp_dir().join(format!("fetifeti-place-{}.inp", std::process::id()));
    std::fs::write(&path, "*NODE\n1, 0, 0, 0\n2, x, 0, 0\n").expect("a file");
    let error = DeckScenes::load(&path).map(|_| ()).expect_err("a mistake");
    std::fs::remove_file(&path).expect("a file");
    assert_eq!(error.location().line_number(), Some(3));
    assert_eq!(error.location().file(), path.to_str());
    assert!(error.to_string().contains(", line 3: "), "{error}");
}

/// A square that floats and is pushed: the solver names it.
#[test]
fn bodies_of_the_solver() {
    with_session(|session| {
        let text = body("plate", "[0, 0]", "elements = 4\nload = 1\n");
        let scene = Scene::parse("s.toml", &text).expect("a scene");
        let problem = scene.substructures(&|_| true).expect("matrices");
        let solver = FetiFeti::new(session, problem, Settings::default());
        let solved = solver.and_then(|mut s| s.solve());
        let error = solved.map(|_| ()).expect_err("nothing holds it");
        assert_eq!(error.kind(), ErrorKind::Input);
        assert_eq!(error.location().bodies(), ["plate"]);
        assert_eq!(error.location().file(), None);
        assert!(error.to_string().contains("\"plate\""), "{error}");
    });
}
