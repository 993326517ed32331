//! Readers for the targets of `make fuzz`, compiled into the library as tests/inside is (docs/reliability.md).
//!
//! Each takes any bytes. It must end without a panic, and what it refuses it must refuse in one sentence that names the
//! place: the file, or what of it was read.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use base::{Error, ErrorKind, Result};
use fetifeti::Settings;
use mesh::{defects, gmsh, Extractor, Members, MeshFile};
use petsc::{Options, Session};
use scene::checkpoint::{self, NoRecords};
use scene::{need::Need, CellGrid, DeckScenes, Expr, NumberFormat, Scene, Tone, Variables};

/// Elements of the largest scene that is made from what was read: a reader shows its mistakes on small ones.
const LARGEST: f64 = 3e3;
const MOST_BODIES: usize = 40;

/// Checks the sentence of a refusal.
fn judge<T>(result: Result<T>, place: &str) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(error) if matches!(error.kind(), ErrorKind::Input | ErrorKind::Environment) => {
            let said = error.to_string();
            assert!(!said.contains('\n'), "several lines: {said}");
            assert!(said.contains(place), "{place} is not named: {said}");
            None
        }
        Err(other) => panic!("another error than one of the input: {other}"),
    }
}

/// A scene; what it names lies nowhere.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    const FILE: &str = "/nowhere/scene.toml";
    let Some(spec) = judge(scene::read(FILE, text), FILE) else {
        return;
    };
    let need = Need::of(spec.bodies.iter(), &spec.form, true);
    if need.elements <= LARGEST && spec.bodies.len() <= MOST_BODIES {
        if let Some(scene) = judge(Scene::new(spec), "") {
            let _ = judge(scene.substructures(&|_| true), "");
        }
    }
}

/// A mesh of Gmsh, and the bodies of its groups.
pub fn mesh(bytes: &[u8]) {
    const FILE: &str = "a.msh";
    let Some(file) = judge(gmsh::read(FILE, bytes), FILE) else {
        return;
    };
    bodies(file, FILE);
}

fn bodies(file: MeshFile, name: &str) {
    let groups = file.groups.clone();
    let _ = file.unused(3, &[], &[]);
    let mut file = file;
    for dim in [2, 3] {
        let mut mesh = Extractor::new(file, dim);
        for group in &groups {
            let Members::Cells { dim: of, cells } = &group.members else {
                continue;
            };
            if *of != dim {
                continue;
            }
            for part in mesh.connected(cells) {
                if let Some(body) = judge(mesh.extract(&part, 1.0), name) {
                    defects(&body, &Default::default());
                }
            }
        }
        file = mesh.file().clone();
    }
}

/// A deck, and the scenes of its steps.
pub fn deck(bytes: &[u8]) {
    const FILE: &str = "a.inp";
    let include = |name: &str| Err(Error::input(format!("{name}: there is no file here")));
    if let Some(file) = judge(deck::read_mesh(FILE, bytes, &include), "") {
        bodies(file, FILE);
    }
    let Some(deck) = judge(deck::read(FILE, bytes, &include), "") else {
        return;
    };
    if deck.mesh.cells.len() as f64 > LARGEST {
        return;
    }
    let Some(scenes) = judge(DeckScenes::of(deck), FILE) else {
        return;
    };
    let _ = scenes.notes();
    for step in 0..scenes.n_steps().min(3) {
        if let Some(scene) = judge(scenes.scene("a", step), "") {
            let _ = judge(scene.substructures(&|_| true), "");
        }
    }
}

/// A checkpoint as it lies on the disk, and the same bytes as the content of one whose length and hash are right.
pub fn checkpoint(bytes: &[u8]) {
    for file in [bytes.to_vec(), checkpoint::file::around(bytes)] {
        let _ = checkpoint::file::from_bytes::<NoRecords>(&file);
    }
}

/// An expression, its values and its gradients.
pub fn expression(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match Expr::parse(text) {
        Ok(read) => {
            for point in [[0.0; 3], [0.3, -0.7, 1e9], [f64::NAN, f64::INFINITY, -0.0]] {
                let at = Variables {
                    point,
                    ..Variables::default()
                };
                let value = read.eval(&at);
                let with = read.eval_gradient(&at);
                assert!(with.value == value || value.is_nan(), "{value} {with:?}");
            }
            let _ = (read.as_constant(), read.to_string());
        }
        Err(said) => assert!(!said.is_empty() && !said.contains('\n'), "{said}"),
    }
}

/// The place of a file of this process.
fn scratch(name: &str) -> PathBuf {
    let place = ["/dev/shm", "/tmp"].map(Path::new);
    let place = place.into_iter().find(|p| p.is_dir()).expect("a directory");
    place.join(format!("fetifeti-fuzz-{}{name}", std::process::id()))
}

/// A file of coefficients: the first byte says the format, the next three the counts.
pub fn coefficients(bytes: &[u8]) {
    let [kind, x, y, z, content @ ..] = bytes else {
        return;
    };
    let counts = [x, y, z].map(|n| usize::from(*n));
    static FILES: OnceLock<[PathBuf; 3]> = OnceLock::new();
    let files = FILES.get_or_init(|| [".txt", ".bin", ".png"].map(scratch));
    let file = &files[usize::from(kind % 3)];
    std::fs::write(file, content).expect("a file for the bytes");
    let name = file.display().to_string();
    let format = [
        None,
        Some(NumberFormat::F32),
        Some(NumberFormat::F64),
        Some(NumberFormat::Text),
    ];
    let cells = match kind % 3 {
        2 => CellGrid::picture(
            file,
            [1.0, 1e3],
            [Tone::Linear, Tone::Log][usize::from(kind / 3 % 2)],
        ),
        _ => CellGrid::read(file, counts, format[usize::from(kind / 3 % 4)]),
    };
    if let Some(cells) = judge(cells, &name) {
        let _ = cells.range();
        let _ = judge(cells.find(|v| v.is_nan() || v <= 0.0), &name);
    }
}

/// A line of arguments with blanks between them; the options of PETSc among them become settings.
pub fn options(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    thread_local! {
        static SESSION: Session = Session::new(&[], "").expect("PETSc starts");
    }
    let words: Vec<String> = text.split_ascii_whitespace().map(String::from).collect();
    let Some(invocation) = judge(crate::parse_line(words), "fetifeti --help") else {
        return;
    };
    SESSION.with(|session| {
        let options = Options::new(session, "");
        let mut set = Vec::new();
        let mut words = invocation.iter().peekable();
        while let Some(name) = words.next() {
            // What PETSc itself does with its own options is not asked here.
            let Some(name) = name.strip_prefix("-fetifeti_") else {
                continue;
            };
            let name = format!("fetifeti_{name}");
            let value = words.next_if(|w| !w.starts_with("-fetifeti_"));
            if options.set_value(&name, value.map(String::as_str)).is_err() {
                continue;
            }
            set.push(name);
        }
        match Settings::default().with_options(session) {
            Ok(_) => {}
            Err(error) if matches!(error.kind(), ErrorKind::Petsc(_)) => {}
            refused => {
                let _ = judge(refused, "-fetifeti_");
            }
        }
        for name in set {
            let _ = options.clear_value(&name);
        }
    });
}
