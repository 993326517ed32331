//! Files that Gmsh and meshio wrote, read and compared with what they say is in them.

use super::*;
use crate::Members;
use ::elements::kind::CellKind;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

mod fuzz;
mod groups;
mod mistakes;
mod written;

/// Where the meshes are that tests/fixtures/meshes/make_gmsh.py wrote.
fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/meshes")
}

/// The Gmsh files of a folder, by name.
fn meshes(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let files = entries.map(|e| e.expect("an entry").path());
    let mut files: Vec<PathBuf> = files
        .filter(|f| f.extension().is_some_and(|e| e == "msh"))
        .collect();
    files.sort();
    files
}

fn name(file: &Path) -> String {
    file.file_name()
        .expect("a name")
        .to_string_lossy()
        .into_owned()
}

/// The contents of a mesh, as its `.txt` says.
struct Described {
    points: Vec<[f64; 3]>,
    /// VTK's number of the kind, and the nodes.
    cells: Vec<(u8, Vec<usize>)>,
    /// Name and dimension, and the cells.
    groups: BTreeMap<(String, usize), BTreeSet<usize>>,
}

impl Described {
    /// Reads what belongs to a mesh.
    fn of(mesh: &Path) -> Described {
        let name = name(mesh);
        let model = name.split('.').next().expect("a name");
        let path = mesh.with_file_name(format!("{model}.txt"));
        let text = std::fs::read_to_string(path).expect("a description");
        let mut lines = text.lines();
        let count = |word: &str, lines: &mut std::str::Lines| -> usize {
            let line = lines.next().expect("a count");
            let count = line.strip_prefix(word).expect("a count").trim();
            count.parse().expect("a count")
        };
        fn numbers<T: std::str::FromStr<Err: std::fmt::Debug>>(line: &str) -> Vec<T> {
            let words = line.split_whitespace();
            words.map(|w| w.parse().expect("a number")).collect()
        }
        let points = (0..count("points", &mut lines))
            .map(|_| {
                numbers(lines.next().expect("a point"))
                    .try_into()
                    .expect("x, y, z")
            })
            .collect();
        let cells = (0..count("cells", &mut lines))
            .map(|_| {
                let cell: Vec<usize> = numbers(lines.next().expect("a cell"));
                (cell[0] as u8, cell[1..].to_vec())
            })
            .collect();
        let groups = (0..count("groups", &mut lines))
            .map(|_| {
                let name = lines.next().expect("a name").to_string();
                let group: Vec<usize> = numbers(lines.next().expect("a group"));
                ((name, group[0]), group[1..].iter().copied().collect())
            })
            .collect();
        Described {
            points,
            cells,
            groups,
        }
    }

    /// Whether all kinds of its cells are ours.
    fn is_ours(&self) -> bool {
        let ours = |vtk: u8| CellKind::ALL.iter().any(|k| k.vtk() == vtk);
        self.cells.iter().all(|c| ours(c.0))
    }

    /// Asks a mesh to have the same points, cells and groups.
    fn compare(&self, mesh: &MeshFile) {
        let name = &mesh.name;
        let place = |p: &[f64; 3]| {
            let near = |q: &[f64; 3]| p.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-12);
            self.points.iter().position(near)
        };
        let places: Vec<Option<usize>> = mesh.points.iter().map(place).collect();
        assert_eq!(mesh.points.len(), mesh.node_ids.len(), "{name}");
        assert_eq!(mesh.cells.len(), mesh.cell_ids.len(), "{name}");
        let mut known: BTreeMap<(u8, Vec<usize>), usize> = BTreeMap::new();
        for (k, cell) in self.cells.iter().enumerate() {
            assert!(known.insert(cell.clone(), k).is_none(), "{name}: cell {k}");
        }
        let cells: Vec<usize> = mesh
            .cells
            .iter()
            .map(|(kind, nodes)| {
                let nodes = nodes.iter().map(|&n| places[n as usize].expect("a point"));
                let cell = (kind.vtk(), nodes.collect());
                let found = known.remove(&cell);
                found.unwrap_or_else(|| panic!("{name}: the cell {cell:?}"))
            })
            .collect();
        assert!(known.is_empty(), "{name}: {known:?} are missing");
        let mut groups = BTreeMap::new();
        for group in &mesh.groups {
            let Members::Cells { dim, cells: of } = &group.members else {
                panic!("{name}: {} is of other members", group.name);
            };
            assert!(of.is_sorted_by(|a, b| a < b), "{name}: {}", group.name);
            let of = of.iter().map(|&c| cells[c as usize]).collect();
            let twice = groups.insert((group.name.clone(), *dim), of);
            assert!(twice.is_none(), "{name}: {}", group.name);
        }
        assert_eq!(groups, self.groups, "{name}");
    }
}

/// A mesh with elements that are not ours is refused, every other is what it is said to be.
fn try_out(file: &Path) -> Result<MeshFile> {
    let said = Described::of(file);
    let mesh = load(file);
    match &mesh {
        Ok(mesh) => {
            assert!(said.is_ours(), "{} was read", mesh.name);
            said.compare(mesh);
        }
        Err(e) => {
            let e = e.to_string();
            // meshio drops entities all of whose nodes are on others.
            let of_meshio = name(file).contains(".meshio41.") && e.contains("not in $Entities");
            assert!(!said.is_ours() || of_meshio, "{e}");
        }
    }
    mesh
}

#[test]
fn files_of_gmsh_and_meshio_are_what_they_say() {
    let files = meshes(&folder());
    let refused: Vec<String> = files
        .iter()
        .filter_map(|f| try_out(f).err().map(|e| e.to_string()))
        .collect();
    assert!(files.len() >= 20, "{}", files.len());
    let [only] = &refused[..] else {
        panic!("{refused:?}");
    };
    let (place, reason) = only.split_once(": ").expect("a place");
    assert!(place.ends_with("pyramids2i.gmsh22.msh, line 116"), "{only}");
    assert!(
        reason.starts_with("element 27 is of type 19 (a pyramid of 13 nodes), where "),
        "{only}"
    );
    let sum: u64 = files
        .iter()
        .map(|f| std::fs::metadata(f).expect("a file").len())
        .sum();
    assert!(sum < 150_000, "{sum} bytes");
}

/// Middle nodes lie in the middles of edges and faces that are straight.
#[test]
fn middle_nodes_are_where_they_belong() {
    let straight = ["plate2", "bricks2", "tets2", "wedges2"];
    let mut kinds = BTreeSet::new();
    for file in meshes(&folder()) {
        if !straight.iter().any(|s| name(&file).starts_with(s)) {
            continue;
        }
        let mesh = load(&file).expect("a mesh");
        for (kind, nodes) in mesh.cells.iter().filter(|c| c.0.order() == 2) {
            let point = |k: u8| mesh.points[nodes[usize::from(k)] as usize];
            let at = |node: usize, of: &[u8]| {
                let middle = of.iter().map(|&k| point(k));
                let sum = middle.fold([0.0; 3], |s, p| [s[0] + p[0], s[1] + p[1], s[2] + p[2]]);
                let found = point(node as u8);
                // Gmsh finds the middles of curves by iteration.
                let far = (0..3).any(|i| (sum[i] / of.len() as f64 - found[i]).abs() > 1e-10);
                assert!(!far, "{}: node {node} of a {}", mesh.name, kind.name());
            };
            let edges = kind.edges();
            for (e, edge) in edges.iter().enumerate() {
                at(kind.corners() + e, edge);
            }
            let corners: Vec<u8> = (0..kind.corners() as u8).collect();
            match kind {
                CellKind::Quad9 => at(8, &corners),
                CellKind::Hex27 => {
                    for side in kind.sides() {
                        at(usize::from(side.nodes[8]), &side.nodes[..4]);
                    }
                    at(26, &corners);
                }
                _ => {}
            }
            kinds.insert(kind);
        }
    }
    let second = CellKind::ALL.into_iter().filter(|k| k.order() == 2);
    assert_eq!(kinds, second.collect());
}

/// Numbers are those of the file, groups stand in the order of their names, and no point is dropped.
#[test]
fn numbers_and_order_are_kept() {
    let mesh = load(folder().join("sparse.gmsh41.msh")).expect("a mesh");
    assert!(mesh.node_ids.iter().all(|id| id % 1000 == 0));
    assert!(mesh.node_ids.iter().any(|&id| id > 10_000_000_000));
    let names: Vec<&str> = mesh.groups.iter().map(|g| g.name.as_str()).collect();
    let named = ["tip", "bottom", "überall", "turned", "quads"];
    assert_eq!(names[..5], named);
    assert_eq!(
        names[5..],
        ["triangles, three-sided", "plate", "4"],
        "without a name last"
    );

    let text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n7 0 0 0\n5 1 0 0\n6 9 9 9\n$EndNodes\n\
                $Elements\n1\n8 1 2 3 1 5 7\n$EndElements\n";
    let mesh = read("a.msh", text.as_bytes()).expect("a mesh");
    assert_eq!(mesh.points.len(), 3);
    assert_eq!((mesh.node_ids, mesh.cell_ids), (vec![7, 5, 6], vec![8]));
    assert_eq!(mesh.cells.nodes(0), [1, 0]);
}

#[test]
fn what_is_no_file_is_refused() {
    let sentence = |path: &Path| load(path).unwrap_err().to_string();
    let (there, lost) = (folder(), folder().join("lost.msh"));
    let (here, name) = (there.display(), lost.display());
    let expected = format!("{here} is no file, where one with a mesh was expected");
    assert_eq!(sentence(&there), expected);
    let found = sentence(&lost);
    assert!(
        found.starts_with(&format!("{name}: the mesh cannot be read: ")),
        "{found}"
    );
}

/// Reads every mesh of the folder GMSH_MESHES and says what came of it. Those with a description are compared with it.
#[test]
#[ignore = "reads the meshes of the folder GMSH_MESHES, which tests/fixtures/meshes/make_gmsh.py fills"]
fn every_file_of_a_folder_is_read_or_refused() {
    let folder = std::env::var_os("GMSH_MESHES").expect("GMSH_MESHES, a folder");
    let files = meshes(Path::new(&folder));
    assert!(!files.is_empty(), "no mesh in {folder:?}");
    for file in files {
        let described = name(&file)
            .split('.')
            .next()
            .map(|m| m.to_string() + ".txt");
        let described = file.with_file_name(described.expect("a name")).exists();
        let mesh = if described {
            try_out(&file)
        } else {
            load(&file)
        };
        let name = name(&file);
        match mesh {
            Ok(mesh) => {
                let mut kinds: BTreeMap<CellKind, usize> = BTreeMap::new();
                for &kind in mesh.cells.kinds() {
                    *kinds.entry(kind).or_default() += 1;
                }
                let kinds: Vec<String> = kinds.iter().map(|(k, n)| format!("{n} {k:?}")).collect();
                let (points, groups) = (mesh.points.len(), mesh.groups.len());
                let compared = if described { ", as described" } else { "" };
                println!(
                    "| {name} | {points} points, {}, {groups} groups{compared} |",
                    kinds.join(", ")
                );
            }
            Err(e) => println!("| {name} | refused: {e} |"),
        }
    }
}
