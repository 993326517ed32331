//! The names of boundary groups and sides that bodies have, for messages.

use crate::model::body::BodySpec;

/// The first few of some names.
pub(super) fn some(names: &[String]) -> String {
    let more = if names.len() > 12 { ", …" } else { "" };
    format!("{}{more}", names[..names.len().min(12)].join(", "))
}

/// The first few names of the sides that the bodies have, each once.
pub(super) fn sides_of<'b>(bodies: impl IntoIterator<Item = &'b BodySpec>) -> String {
    let mut names: Vec<String> = Vec::new();
    for body in bodies {
        let sides = match body.mesh.cells() {
            Some(_) => 0..body.mesh.n_sides(),
            None => body.mesh.outer_sides(),
        };
        for side in sides {
            let name = format!("`{}`", body.mesh.side_name(side));
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    some(&names)
}
