//! Which way the faces of a side go around.

use std::collections::BTreeMap;

use super::side::MortarFace;

/// Two neighbouring faces that go around in opposite ways, by their places in the list: one of them has its normal
/// inside the body. `None` if all neighbours agree.
pub fn one_way(faces: &[MortarFace]) -> Option<[usize; 2]> {
    // In the plane the ends of a face, in space its edges, from corner to corner.
    let mut seen: BTreeMap<[u32; 2], Vec<(usize, bool)>> = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        let corners = &face.nodes[..face.kind.corners()];
        for (k, &a) in corners.iter().enumerate() {
            let (key, forward) = match face.kind.dim() {
                1 => ([a, a], k == 0),
                _ => {
                    let b = corners[(k + 1) % corners.len()];
                    ([a.min(b), a.max(b)], a < b)
                }
            };
            seen.entry(key).or_default().push((f, forward));
        }
    }
    // Where more than two faces meet, a body touches itself.
    seen.into_values().find_map(|list| match list[..] {
        [(f, a), (g, b)] if a == b => Some([f, g]),
        _ => None,
    })
}

#[cfg(test)]
#[path = "../../tests/mortar/orientation.rs"]
mod tests;
