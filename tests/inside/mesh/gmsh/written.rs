//! What we write is what we read: tests of `src/mesh/gmsh/write.rs`. The meshes are files of Gmsh, so that the order
//! of nodes is Gmsh's.

use super::*;

#[test]
fn meshes_of_gmsh_are_the_same_after_writing() {
    let mut kinds = BTreeSet::new();
    for file in meshes(&folder()) {
        let mesh = load(&file).expect("a mesh");
        let of_cells = |g: &crate::mesh::Group| matches!(g.members, Members::Cells { .. });
        assert!(mesh.groups.iter().all(of_cells), "{}", name(&file));
        let again = read(&name(&file), &write(&mesh)).unwrap_or_else(|e| panic!("{e}"));
        kinds.extend(again.cells.kinds().iter().map(|k| k.name()));
        assert_eq!(mesh.points, again.points, "{}", name(&file));
        assert_eq!(mesh.node_ids, again.node_ids, "{}", name(&file));
        // A cell in two groups is written twice: compare each group by what its cells are.
        for group in &mesh.groups {
            let found = again.groups.iter().find(|g| g.name == group.name);
            let cells = |mesh: &MeshFile, group: &crate::mesh::Group| -> Vec<(String, Vec<u32>)> {
                let Members::Cells { cells, .. } = &group.members else {
                    panic!("cells");
                };
                let cell = |&c: &u32| {
                    let kind = mesh.cells.kind(c as usize).name().to_string();
                    (kind, mesh.cells.nodes(c as usize).to_vec())
                };
                cells.iter().map(cell).collect()
            };
            let found = found.unwrap_or_else(|| panic!("{}: {}", name(&file), group.name));
            assert_eq!(cells(&mesh, group), cells(&again, found), "{}", group.name);
        }
    }
    assert!(kinds.len() > 10, "few kinds of cells: {kinds:?}");
}
