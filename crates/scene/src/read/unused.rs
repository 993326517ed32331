//! Parts of the mesh of a scene that no entry takes: cells of no body, groups that nothing names, inner faces.

use std::collections::{BTreeSet, HashSet};

use super::mesh::SceneMesh;
use crate::model::body::BodySpec;
use crate::model::joints::{ContactSpec, ObstacleSpec, PairSelector, TieSpec};
use mesh::{Members, MeshFile, MeshGroup, SKIN};

/// Groups that are named one by one.
const LIST: usize = 8;

/// The entries of a scene that may name boundary groups.
pub(super) struct SceneEntries<'s> {
    pub bodies: &'s [BodySpec],
    pub ties: &'s [TieSpec],
    pub contacts: &'s [ContactSpec],
    pub obstacles: &'s [ObstacleSpec],
}

/// Sentences on what is left out.
pub(super) fn notes(source: &SceneMesh, entries: &SceneEntries<'_>) -> Vec<String> {
    let (file, dim) = (source.file(), source.dim());
    let mut out: Vec<String> = file.unused(dim, &source.rigid, &[]).into_iter().collect();
    out.extend(cells(source));
    let named = source.bodies.iter().map(String::as_str).collect();
    let lost = |group: &MeshGroup| match &group.members {
        Members::Cells { cells, .. } if is_of_cells(group, dim) => {
            cells.iter().any(|&c| !source.taken[c as usize])
        }
        _ => false,
    };
    out.extend(groups(file, &named, lost));
    let on_faces = entries.with_faces();
    let surfaces = file
        .groups
        .iter()
        .filter(|g| on_faces.contains(&g.name[..]));
    out.extend(surfaces.filter_map(|group| inside(file, dim, group, entries.bodies)));
    out
}

/// The sentence on boundary groups that no entry names. Where one names the whole boundary it takes all groups there.
pub(super) fn unnamed(source: &SceneMesh, entries: &SceneEntries<'_>) -> Option<String> {
    let mut named = entries.with_faces();
    named.extend(entries.held());
    if named.contains(SKIN) {
        return None;
    }
    let others = source.rigid.iter().chain(&source.bodies);
    named.extend(others.map(String::as_str));
    groups(source.file(), &named, |group| {
        !is_of_cells(group, source.dim())
    })
}

/// Whether a group has the cells of bodies.
fn is_of_cells(group: &MeshGroup, dim: usize) -> bool {
    matches!(group.members, Members::Cells { dim: of, .. } if of >= dim)
}

/// The sentence on cells that belong to no body.
fn cells(source: &SceneMesh) -> Option<String> {
    let (file, dim) = (source.file(), source.dim());
    let own = (0..file.cells.len()).filter(|&c| file.cells.kind(c).dim() == dim);
    let own: Vec<usize> = own.collect();
    let left = own.iter().filter(|&&c| !source.taken[c]);
    let (count, first) = (left.clone().count(), left.clone().next()?);
    let (belong, are) = match count {
        1 => ("belongs", "is"),
        _ => ("belong", "are"),
    };
    Some(format!(
        "{}: {count} of {} cells of dimension {dim} {belong} to no [[body]] and {are} left out, the first is cell {}",
        file.name,
        own.len(),
        file.cell_ids[*first]
    ))
}

/// The sentence on those of some groups that nothing names.
fn groups(
    file: &MeshFile,
    named: &BTreeSet<&str>,
    meant: impl Fn(&MeshGroup) -> bool,
) -> Option<String> {
    let size = |group: &MeshGroup| match &group.members {
        Members::Cells { dim, cells } => {
            let what = match (dim, cells.len()) {
                (3, 1) => "solid cell",
                (3, _) => "solid cells",
                (2, 1) => "face",
                (2, _) => "faces",
                (1, 1) => "edge",
                (1, _) => "edges",
                (_, 1) => "point",
                _ => "points",
            };
            format!("`{}` ({} {what})", group.name, cells.len())
        }
        Members::Nodes(nodes) => format!("`{}` ({} nodes)", group.name, nodes.len()),
        Members::Sides(sides) => format!("`{}` ({} sides)", group.name, sides.len()),
    };
    let groups = file.groups.iter().filter(|group| meant(group));
    let lost = groups.filter(|group| !named.contains(&group.name[..]));
    let mut lost: Vec<String> = lost.map(size).collect();
    if lost.is_empty() {
        return None;
    }
    let what = if lost.len() == 1 { "group" } else { "groups" };
    if lost.len() > LIST {
        let more = lost.split_off(LIST).len();
        lost.push(format!("and {more} more"));
    }
    Some(format!(
        "{}: no entry of the scene names the {what} {}",
        file.name,
        lost.join(", ")
    ))
}

/// The sentence on the faces of a group that are on no boundary of a body: no load and no contact acts there.
fn inside(file: &MeshFile, dim: usize, group: &MeshGroup, bodies: &[BodySpec]) -> Option<String> {
    let Members::Cells { dim: of, cells } = &group.members else {
        return None;
    };
    if *of + 1 != dim {
        return None;
    }
    let sorted = |nodes: &mut dyn Iterator<Item = u64>| -> Vec<u64> {
        let mut nodes: Vec<u64> = nodes.collect();
        nodes.sort_unstable();
        nodes
    };
    let mut outer: HashSet<Vec<u64>> = HashSet::new();
    for mesh in bodies.iter().filter_map(|body| body.mesh.cells()) {
        let Some(side) = mesh.sides.iter().find(|side| side.name == group.name) else {
            continue;
        };
        for &(cell, face) in &side.faces {
            let nodes = mesh.cells.side_nodes(cell as usize, face.into());
            outer.insert(sorted(&mut nodes.map(|k| mesh.node_ids[k as usize])));
        }
    }
    let is_outer = |c: &&u32| {
        let nodes = file.cells.nodes(**c as usize).iter();
        outer.contains(&sorted(&mut nodes.map(|&k| file.node_ids[k as usize])))
    };
    let lost = cells.len() - cells.iter().filter(is_outer).count();
    (lost > 0).then(|| {
        format!(
            "{}: {lost} of {} faces of the group `{}` are on no boundary of a body and are left out",
            file.name,
            cells.len(),
            group.name
        )
    })
}

impl<'s> SceneEntries<'s> {
    /// The groups on which something is given.
    fn held(&self) -> BTreeSet<&'s str> {
        let of_body = |body: &'s BodySpec| {
            let given = (0..body.mesh.n_sides()).filter(|&side| body.holds(side));
            given.map(|side| body.mesh.side_name(side))
        };
        self.bodies.iter().flat_map(of_body).collect()
    }

    /// The groups whose faces are asked for: those with loads, springs and joints.
    fn with_faces(&self) -> BTreeSet<&'s str> {
        let mut out = BTreeSet::new();
        for body in self.bodies {
            let loads = body.surface.iter().map(|load| load.side);
            let springs = body.springs.iter().map(|spring| spring.0);
            out.extend(loads.chain(springs).map(|side| body.mesh.side_name(side)));
        }
        let ties = self.ties.iter().map(|t| (&t.pair, t.sides));
        let contacts = self.contacts.iter().map(|c| (&c.pair, c.sides));
        for (pair, sides) in ties.chain(contacts) {
            match (pair, sides) {
                (PairSelector::Surfaces(a, b), _) => out.extend([&a[..], &b[..]]),
                (PairSelector::Named(a, b), Some(sides)) => {
                    for (name, side) in [a, b].into_iter().zip(sides) {
                        out.extend(self.side(name, side));
                    }
                }
                _ => {}
            }
        }
        for obstacle in self.obstacles {
            let bodies = self.bodies.iter();
            let meant =
                bodies.filter(|b| obstacle.body.as_ref().is_none_or(|name| b.name == *name));
            for body in meant {
                let known = obstacle
                    .sides
                    .iter()
                    .filter(|side| **side < body.mesh.n_sides());
                out.extend(known.map(|side| body.mesh.side_name(*side)));
            }
        }
        out
    }

    fn side(&self, body: &str, side: usize) -> Option<&'s str> {
        let body = self.bodies.iter().find(|b| b.name == body)?;
        Some(body.mesh.side_name(side))
    }
}
