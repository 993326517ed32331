//! Condition numbers of one mesh in several partitions: a regular one, that of the crate, or any from a file.
//!
//!     cargo run --release --example partitions PROBLEM N graph > FILE      the cells and their neighbours
//!     cargo run --release --example partitions PROBLEM N PARTITION         the condition number
//!
//! PROBLEM is `poisson` or `plane` (the unit square in triangles, 8 × 8 subdomains), `tetrahedra` or `hexahedra` (the
//! elastic unit cube, 4 × 4 × 4 subdomains); all are one body that is held at the left. N is the number of intervals
//! along the side of a regular subdomain. PARTITION is `regular`, `ours`, or a file with the part of every cell,
//! numbers from 0, as gpmetis writes it for the graph. The table of docs/meshes.md is made by scripts/partitions.py.

use std::process::ExitCode;

use fetifeti::settings::MethodSettings;
use fetifeti::{Error, FetiFeti, Result, Session};
use fetifeti_scene::elements::cell::{Cure, Plane};
use fetifeti_scene::elements::form::Physics;
use fetifeti_scene::elements::kind::CellKind;
use fetifeti_scene::mesh::partition::{Adjacency, Interface, Partition, Sharing};
use fetifeti_scene::mesh::{places, BoxMesh, CellMesh, Cells, SideGroup};
use fetifeti_scene::{BodySpec, Field, Scene, SceneSpec};

/// Regular subdomains along an axis of the square, and of the cube.
const CUTS: [usize; 2] = [8, 4];

/// The corners of a quadrilateral or hexahedron.
const CORNERS: [[usize; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];

/// The simplices that fill a square or a cube, by places in `CORNERS`: all have the diagonal, and positive volume.
const TRIANGLES: [&[usize]; 2] = [&[0, 1, 2], &[0, 2, 3]];
const TETRAHEDRA: [&[usize]; 6] = [
    &[0, 1, 2, 6],
    &[0, 2, 3, 6],
    &[0, 3, 7, 6],
    &[0, 7, 4, 6],
    &[0, 4, 5, 6],
    &[0, 5, 1, 6],
];

fn main() -> ExitCode {
    fetifeti::run(run)
}

fn run(session: &Session) -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [problem, n, partition, ..] = &args[..] else {
        return Err(Error::input("expected PROBLEM N PARTITION"));
    };
    let (dim, elastic, kind, simplices) = match problem.as_str() {
        "poisson" => (2, false, CellKind::Triangle3, &TRIANGLES[..]),
        "plane" => (2, true, CellKind::Triangle3, &TRIANGLES[..]),
        "tetrahedra" => (3, true, CellKind::Tet4, &TETRAHEDRA[..]),
        "hexahedra" => (
            3,
            true,
            CellKind::Hex8,
            &[&[0, 1, 2, 3, 4, 5, 6, 7][..]][..],
        ),
        other => return Err(Error::input(format!("unknown problem `{other}`"))),
    };
    let number = |text: &str| {
        let number = text.parse::<usize>();
        number.map_err(|e| Error::input(format!("`{text}`: {e}")))
    };
    let (mesh, regular) = mesh(dim, number(n)?, kind, simplices);
    let adjacency = Adjacency::new(&mesh.cells);
    if partition == "graph" {
        print!("{}", graph(&adjacency));
        return Ok(());
    }
    let most = regular.iter().max().map_or(0, |&p| p as usize + 1);
    let part = match partition.as_str() {
        "regular" => regular,
        "ours" => {
            let work = vec![1.0; mesh.cells.len()];
            Partition::new(&mesh.cells, &adjacency, &work, most).part
        }
        file => {
            let text = std::fs::read_to_string(file);
            let text = text.map_err(|e| Error::input(format!("{file}: {e}")))?;
            let parts: Result<Vec<usize>> = text.split_whitespace().map(number).collect();
            let parts = parts?;
            if parts.len() != mesh.cells.len() || parts.iter().any(|&p| p >= most) {
                let expected = format!("{} parts below {most}", mesh.cells.len());
                return Err(Error::input(format!("{file}: expected {expected}")));
            }
            parts.into_iter().map(|p| p as u32).collect()
        }
    };
    let pieces = pieces(&adjacency, &part);
    let sharing = Sharing::new(&mesh.cells, &part, most, mesh.points.len());
    let interface = Interface::new(&mesh.cells, &adjacency, &mesh.points, &part, &sharing, true);
    let largest = (0..most as u32).map(|p| part.iter().filter(|q| **q == p).count());
    let largest = largest.max().unwrap_or(0);
    let (vertices, edges) = (interface.vertices.len(), interface.edges.len());
    let faces = interface.faces.len();
    let mut body = BodySpec::new("body", mesh.partitioned(part, most, interface));
    let components = if elastic { dim } else { 1 };
    body.load.fields = vec![Field::constant(1.0); components];
    body.dirichlet = vec![[const { None }; 3]; 2].into();
    for c in 0..components {
        body.dirichlet[0][c] = Some(Field::constant(0.0));
    }
    let mut spec = SceneSpec::tied(problem.as_str(), vec![body]);
    if elastic {
        let (plane, cure) = (Plane::Strain, Cure::None);
        spec.form.physics = Physics::Elasticity { plane, cure };
    }
    let scene = Scene::new(spec)?;
    let mine = fetifeti::share(session, scene.n_subdomains());
    let substructures = scene.substructures(&|s| mine.contains(&s))?;
    // So that the Krylov method's estimate of the spectrum has all its digits.
    let settings = MethodSettings::default().rtol(1e-12);
    let mut solver = FetiFeti::new(session, substructures, settings)?;
    let solution = solver.solve()?;
    if !solution.converged() {
        return Err(Error::not_converged(solution.status.to_string()));
    }
    let spectrum = solution.estimate.expect("it iterates");
    let facts = solver.facts();
    if session.rank() == 0 {
        println!(
            "problem       {problem}, {most} subdomains of at most {largest} cells, {partition}"
        );
        println!("pieces        {pieces}");
        println!("shared        {vertices} vertices, {edges} edges, {faces} faces");
        println!("primal        {}", facts.primal);
        println!("multipliers   {}", facts.multipliers_local);
        println!("iterations    {}", solution.iterations);
        println!("kappa         {:.3}", spectrum.kappa());
    }
    Ok(())
}

/// The unit square or cube in one subdomain, and the regular subdomain of every cell. The first group of sides is the
/// left side.
fn mesh(dim: usize, n: usize, kind: CellKind, simplices: &[&[usize]]) -> (CellMesh, Vec<u32>) {
    let cuts = CUTS[dim - 2];
    let along = |count: usize| [count, count, if dim == 3 { count } else { 0 }];
    let grid = BoxMesh {
        origin: [0.0; 3],
        size: along(1).map(|one| one as f64),
        elements: along(cuts * n),
        subdomains: along(cuts).map(|count| count.max(1)),
    };
    let points: Vec<[f64; 3]> = places(grid.nodes()).map(|p| grid.position(p)).collect();
    let (mut cells, mut part) = (Cells::default(), Vec::new());
    for place in places(grid.elements.map(|count| count.max(1))) {
        let [i, j, k] = place.map(|at| at / n);
        for simplex in simplices {
            let corner = |&a: &usize| grid.node([0, 1, 2].map(|d| place[d] + CORNERS[a][d])) as u32;
            cells.push(kind, &simplex.iter().map(corner).collect::<Vec<u32>>());
            part.push(((k * cuts + j) * cuts + i) as u32);
        }
    }
    let skin = Adjacency::new(&cells).boundary;
    let held = |&(c, side): &(u32, u8)| {
        let mut nodes = cells.side_nodes(c as usize, side.into());
        nodes.all(|k| points[k as usize][0] == 0.0)
    };
    let left = SideGroup {
        name: "left".into(),
        nodes: (0..points.len() as u32)
            .filter(|&k| points[k as usize][0] == 0.0)
            .collect(),
        faces: skin.iter().copied().filter(held).collect(),
    };
    (CellMesh::new(dim, points, cells, vec![left], skin), part)
}

/// The graph of the cells as gpmetis reads it: counts, then the neighbours of every cell, numbered from 1.
fn graph(adjacency: &Adjacency) -> String {
    let lines: Vec<Vec<String>> = (0..adjacency.len())
        .map(|c| {
            adjacency
                .neighbours(c)
                .map(|d| (d + 1).to_string())
                .collect()
        })
        .collect();
    let edges = lines.iter().map(Vec::len).sum::<usize>() / 2;
    let lines: Vec<String> = lines.iter().map(|line| line.join(" ")).collect();
    format!("{} {edges}\n{}\n", lines.len(), lines.join("\n"))
}

/// The number of connected pieces of all parts; as many as parts if each is connected.
fn pieces(adjacency: &Adjacency, part: &[u32]) -> usize {
    let mut seen = vec![false; part.len()];
    let mut count = 0;
    for start in 0..part.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        count += 1;
        let mut open = vec![start];
        while let Some(c) = open.pop() {
            for d in adjacency.neighbours(c).map(|d| d as usize) {
                if part[d] == part[c] && !seen[d] {
                    seen[d] = true;
                    open.push(d);
                }
            }
        }
    }
    count
}
