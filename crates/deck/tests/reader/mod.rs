//! Decks as they are read; the sentences that refuse them.

mod bodies;
mod friction;
mod gaps;
mod joints;
mod sets;
mod steps;

use crate::{read, read_mesh, Deck};
use base::Error;
use mesh::Members;

/// Two cubes of edge 1 side by side, each with nodes of its own: 1 to 8 and 11 to 18.
const CUBES: &str = "*NODE,NSET=N\n1\n2,1\n3,1,1\n4,0,1\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
    11,1\n12,2\n13,2,1\n14,1,1\n15,1,0,1\n16,2,0,1\n17,2,1,1\n18,1,1,1\n\
    *ELEMENT,TYPE=C3D8,ELSET=E\n1,1,2,3,4,5,6,7,8\n2,11,12,13,14,15,16,17,18\n";
const REST: &str = "*MATERIAL,NAME=M\n*ELASTIC\n1.,.3\n*SOLID SECTION,ELSET=E,MATERIAL=M\n";
const STEP: &str = "*STEP\n*STATIC\n*END STEP\n";

fn deck(model: &str, step: &str) -> Result<Deck, Error> {
    let text = format!("{CUBES}{model}{REST}*STEP\n*STATIC\n{step}*END STEP\n");
    read("a.inp", text.as_bytes(), &|_| Err(Error::input("no files")))
}

fn good(model: &str, step: &str) -> Deck {
    deck(model, step).unwrap_or_else(|e| panic!("{e} in {model}{step}"))
}

/// The message without its place; model data begin in line 21.
fn bad(model: &str, step: &str) -> String {
    let read = deck(model, step).map(|_| ());
    let message = read.expect_err("a deck that is refused").to_string();
    assert!(message.starts_with("a.inp, line "), "{message}");
    assert!(!message.contains('\n') && message.len() < 250, "{message}");
    message.split_once(": ").expect("a place").1.to_string()
}

fn whole(text: &str) -> String {
    let read = read("a.inp", text.as_bytes(), &|_| Err(Error::input("no files"))).map(|_| ());
    read.expect_err("a deck that is refused").to_string()
}

fn group<'a>(deck: &'a Deck, name: &str) -> &'a Members {
    let found = deck.mesh.groups.iter().find(|g| g.name == name);
    &found.expect("a group").members
}

/// Wherever a deck ends or a character is wrong, there is one sentence.
#[test]
fn decks_that_are_cut_off_or_damaged_are_refused_or_read() {
    let block = include_str!("../block.inp");
    let none = |_: &str| Err(Error::input("no files"));
    for end in 0..block.len() {
        let cut = &block[..end];
        if let Err(error) = read("a.inp", cut.as_bytes(), &none) {
            assert!(error.to_string().starts_with("a.inp"), "{error}");
        }
        let mut damaged = block.as_bytes().to_vec();
        for byte in [b'*', b',', b'9', b'\n', 0xff] {
            damaged[end] = byte;
            let read = read("a.inp", &damaged, &none);
            assert!(
                read.is_ok()
                    || !read
                        .map(|_| ())
                        .expect_err("an error")
                        .to_string()
                        .contains('\n')
            );
            let _ = read_mesh("a.inp", &damaged, &none);
        }
    }
    assert!(read("a.inp", &block.as_bytes()[..block.len() - 10], &none).is_err());
}
