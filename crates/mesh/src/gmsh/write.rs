//! Writes meshes in Gmsh's binary format 2.2, which every version of Gmsh and most other programs read.

use std::io::Write;

use super::kinds;
use crate::{Members, MeshFile};
use elements::kind::CellKind;

/// The bytes of a file with the points, the cells and the groups of cells of `mesh`. A cell that is in no group has the
/// physical tag 0.
///
/// # Panics
/// For groups of nodes or of sides, and for a cell in several groups, which the format does not have.
pub fn write(mesh: &MeshFile) -> Vec<u8> {
    let mut out = Vec::new();
    text(&mut out, "$MeshFormat\n2.2 1 8\n");
    number(&mut out, 1);
    text(&mut out, "\n$EndMeshFormat\n");
    let mut tags = vec![0; mesh.cells.len()];
    text(
        &mut out,
        &format!("$PhysicalNames\n{}\n", mesh.groups.len()),
    );
    for (k, group) in mesh.groups.iter().enumerate() {
        let Members::Cells { dim, cells } = &group.members else {
            panic!("{}: a group of cells was expected", group.name);
        };
        for &c in cells {
            let tag: &mut i32 = &mut tags[c as usize];
            assert_eq!(*tag, 0, "cell {c} is in two groups");
            *tag = k as i32 + 1;
        }
        text(&mut out, &format!("{dim} {} \"{}\"\n", k + 1, group.name));
    }
    text(
        &mut out,
        &format!("$EndPhysicalNames\n$Nodes\n{}\n", mesh.points.len()),
    );
    for (id, point) in mesh.node_ids.iter().zip(&mesh.points) {
        number(&mut out, *id as i32);
        for x in point {
            out.extend_from_slice(&x.to_le_bytes());
        }
    }
    let elements = mesh.cells.len();
    text(&mut out, &format!("\n$EndNodes\n$Elements\n{elements}\n"));
    for ((c, cell), &tag) in mesh.cells.iter().enumerate().zip(&tags) {
        element(&mut out, mesh, cell, [mesh.cell_ids[c] as i32, tag]);
    }
    text(&mut out, "\n$EndElements\n");
    out
}

/// One element: a block of its own, with a physical and an elementary tag.
fn element(
    out: &mut Vec<u8>,
    mesh: &MeshFile,
    (kind, nodes): (CellKind, &[u32]),
    [id, tag]: [i32; 2],
) {
    let (gmsh, order) = kinds::number(kind);
    for value in [gmsh, 1, 2, id, tag, tag] {
        number(out, value);
    }
    let mut theirs = [0; CellKind::MOST_NODES];
    for (k, &node) in nodes.iter().enumerate() {
        let place = order.map_or(k, |order| usize::from(order[k]));
        theirs[place] = mesh.node_ids[node as usize] as i32;
    }
    for &node in &theirs[..nodes.len()] {
        number(out, node);
    }
}

fn number(out: &mut Vec<u8>, value: i32) {
    out.extend_from_slice(&value.to_le_bytes());
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.write_all(text.as_bytes())
        .expect("memory takes all bytes");
}
