use super::*;
use base::Error;
use elements::kind::CellKind;
use elements::law::Law;
use mesh::{Members, MeshGroup};

fn read_text(text: &str) -> Result<Deck> {
    read("a.inp", text.as_bytes(), &|_| Err(Error::input("no files")))
}

/// A deck that has nearly everything; the answers are in the tests below.
const BLOCK: &str = include_str!("block.inp");

#[test]
fn a_deck_is_read_with_its_names_resolved() {
    let deck = read_text(BLOCK).expect("a deck");
    assert_eq!(deck.mesh.points[6], [1.0, 1.0, 1.0]);
    assert_eq!(deck.mesh.cells.nodes(0), [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(deck.elements, [ElementType::C3D8]);
    assert_eq!((deck.model(), deck.dim()), (ElementModel::Solid, 3));
    let names: Vec<&str> = deck.mesh.groups.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["N", "E", "LOC", "FIX", "REV"]);
    let loc = MeshGroup {
        name: "LOC".into(),
        members: Members::Nodes(vec![5, 6]),
    };
    assert_eq!(deck.mesh.groups[2], loc);
    assert_eq!(deck.cell_section, [0]);
    assert_eq!(
        (deck.sections[0].material, deck.sections[0].thickness),
        (0, 1.0)
    );
    let steel = Law::Isotropic {
        young: 1e4,
        poisson: 0.3,
    };
    assert_eq!(deck.materials[0].elastic, Some(steel));
    assert_eq!(deck.node_transform, [(5, 0), (6, 0)]);
    let s = 0.5_f64.sqrt();
    let frame = deck.frame(6).expect("a system");
    let expected = [[s, s, 0.0], [-s, s, 0.0], [0.0, 0.0, 1.0]];
    assert!(frame
        .iter()
        .flatten()
        .zip(expected.iter().flatten())
        .all(|(a, b)| (a - b).abs() < 1e-15));
    assert_eq!(deck.frame(0), None);
}

/// `block.dat` is what CalculiX prints: in free nodes, its forces are the loads.
#[test]
fn loads_hold_as_in_calculix() {
    let deck = read_text(BLOCK).expect("a deck");
    let tables = read_dat(include_str!("block.dat"));
    for (step, time) in deck.steps.iter().zip([1.5, 2.5, 2.5]) {
        assert_eq!(step.time, time);
        assert_eq!(step.supports.len(), 12);
        assert!(step.supports.iter().all(|s| s.node < 4 && s.value == 0.0));
    }
    for (step, printed) in deck.steps.iter().zip([&tables[1], &tables[5]]) {
        let mut forces = [[0.0; 3]; 8];
        for f in &step.forces {
            forces[f.node as usize][usize::from(f.dof)] += f.value;
        }
        for row in printed.rows.iter().filter(|r| r.id > 4) {
            for (ours, theirs) in forces[row.id as usize - 1].iter().zip(row.vector) {
                assert!(
                    (ours - theirs).abs() < 1e-6,
                    "node {}: {ours}, not {theirs}",
                    row.id
                );
            }
        }
    }
    let last: Vec<(u32, u8, f64)> = deck.steps[2]
        .forces
        .iter()
        .map(|f| (f.node, f.dof, f.value))
        .collect();
    assert_eq!(last, [(4, 0, 7.0)]);
    assert_eq!(tables[8].rows[0].vector[0], -7.0);
    assert_eq!(deck.steps[1].prints, deck.steps[0].prints);
    assert_eq!(deck.steps[2].prints.len(), 1);
    assert_eq!(deck.steps[2].prints[0].totals, Totals::Only);
}

/// Gmsh and meshio write sides and edges as elements, too; these are no bodies, but groups of a mesh may be of them.
#[test]
fn meshes_may_have_cells_of_every_dimension() {
    let text = "*HEADING\nx\n*NODE\n1,0\n2,1\n3,0,1\n4,0,0,1\n5,.5\n\
                *ELEMENT,TYPE=T3D3,ELSET=Line\n1,1,5,2\n*ELEMENT,TYPE=CPS3,ELSET=Side\n7,1,2,3\n\
                *ELEMENT,TYPE=C3D4,ELSET=Body\n9,1,2,3,4\n*ELSET,ELSET=all\nLine,Side,Body\n\
                *BEAM SECTION,ELSET=Line,MATERIAL=x,SECTION=RECT\n1,1\n";
    let mesh = read_mesh("a.inp", text.as_bytes(), &|_| unreachable!()).expect("a mesh");
    assert_eq!(
        mesh.cells.kinds(),
        [CellKind::Line3, CellKind::Triangle3, CellKind::Tet4]
    );
    assert_eq!(mesh.cells.nodes(0), [0, 1, 4], "the middle comes last");
    assert_eq!(mesh.cell_ids, [1, 7, 9]);
    let all: Vec<&Members> = mesh
        .groups
        .iter()
        .filter(|g| g.name == "ALL")
        .map(|g| &g.members)
        .collect();
    let of = |dim: usize, cell: u32| Members::Cells {
        dim,
        cells: vec![cell],
    };
    assert_eq!(all, [&of(1, 0), &of(2, 1), &of(3, 2)]);
    let error = read_text(text).expect_err("no deck").to_string();
    assert_eq!(
        error,
        "a.inp, line 17: *BEAM SECTION: beams, shells, membranes and trusses are not supported"
    );
}

/// The examples of CalculiX, where Debian's package calculix-ccx-test is installed: each is read or refused in one
/// sentence. Prints how many, and by which keyword.
#[test]
fn examples_of_calculix_are_read_or_refused() {
    let dir = std::path::Path::new("/usr/share/doc/calculix-ccx-test/examples/test");
    let Ok(entries) = std::fs::read_dir(dir) else {
        return;
    };
    let mut refused = std::collections::BTreeMap::<String, usize>::new();
    let (mut read_decks, mut all) = (Vec::new(), 0);
    for path in entries.map(|e| e.expect("an entry").path()) {
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .to_string();
        let text = if name.ends_with(".inp") {
            std::fs::read(&path).expect("a file")
        } else if name.ends_with(".inp.gz") {
            let unpacked = std::process::Command::new("gzip")
                .arg("-dc")
                .arg(&path)
                .output();
            unpacked.expect("gzip").stdout
        } else {
            continue;
        };
        all += 1;
        match read(&name, &text, &|n| {
            Err(Error::input(format!("there is no file {n}")))
        }) {
            Ok(deck) => {
                assert!(deck.steps.iter().all(|s| !s.supports.is_empty()), "{name}");
                read_decks.push(name);
            }
            Err(error) => {
                let message = error.to_string();
                assert!(message.starts_with(&format!("{name}, line ")), "{message}");
                assert!(!message.contains('\n') && message.len() < 250, "{message}");
                let keyword = message.split(": ").find(|p| p.starts_with('*'));
                *refused
                    .entry(keyword.unwrap_or("data").to_string())
                    .or_default() += 1;
            }
        }
    }
    let mut refused: Vec<_> = refused.into_iter().collect();
    refused.sort_by_key(|r| std::cmp::Reverse(r.1));
    println!(
        "{} of {all} decks are read: {}",
        read_decks.len(),
        read_decks.join(" ")
    );
    for (keyword, count) in refused {
        println!("{count:4}  {keyword}");
    }
    for name in [
        "achtelp",
        "axial",
        "beam10p",
        "beamptied1",
        "c3d15",
        "contactenergy",
        "hueeber1",
        "segment1",
    ] {
        assert!(
            read_decks
                .iter()
                .any(|r| r.trim_end_matches(".gz") == format!("{name}.inp")),
            "{name}"
        );
    }
}
