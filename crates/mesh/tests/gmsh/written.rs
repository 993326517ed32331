//! Files that we write are read as they were: tests of `crates/mesh/src/gmsh/write.rs`. The meshes are files of Gmsh,
//! so that the order of nodes is Gmsh's.

use super::*;

#[test]
fn meshes_of_gmsh_are_the_same_after_writing() {
    let mut kinds = BTreeSet::new();
    for file in meshes(&folder()) {
        // Some have elements that we do not have.
        let Ok(mesh) = load(&file) else {
            continue;
        };
        let of_cells = |g: &crate::MeshGroup| matches!(g.members, Members::Cells { .. });
        assert!(mesh.groups.iter().all(of_cells), "{}", name(&file));
        // The format has one group for a cell.
        let mut grouped = vec![0; mesh.cells.len()];
        for group in &mesh.groups {
            if let Members::Cells { cells, .. } = &group.members {
                cells.iter().for_each(|&c| grouped[c as usize] += 1);
            }
        }
        if grouped.iter().any(|&n| n > 1) {
            continue;
        }
        let again = read(&name(&file), &write(&mesh)).unwrap_or_else(|e| panic!("{e}"));
        kinds.extend(again.cells.kinds().iter().map(|k| k.name()));
        assert_eq!(mesh.points, again.points, "{}", name(&file));
        assert_eq!(mesh.node_ids, again.node_ids, "{}", name(&file));
        assert_eq!(mesh.cells, again.cells, "{}", name(&file));
        for group in &mesh.groups {
            let found = again.groups.iter().find(|g| g.name == group.name);
            let found = found.unwrap_or_else(|| panic!("{}: {}", name(&file), group.name));
            assert_eq!(group.members, found.members, "{}", group.name);
        }
    }
    assert!(kinds.len() > 10, "few kinds of cells: {kinds:?}");
}
