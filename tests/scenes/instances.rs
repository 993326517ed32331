//! Copies by a table of placements have the answer of the same bodies with meshes of their own.

use crate::support::mpi::Scratch;
use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use scene::Scene;

/// What two scenes are compared by: the displacements, all multipliers, their sum by body, and the energy.
struct Found {
    kinds: usize,
    energy: f64,
    u: Vec<Vec<f64>>,
    lambda: Vec<f64>,
}

fn solve(scene: Scene) -> Found {
    with_session(move |session| {
        let problem = scene.substructures(&|_| true).expect("substructures");
        let settings = MethodSettings::default().rtol(1e-12);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        let solution = solver.solve().expect("solved");
        assert!(solution.converged(), "{}", solution.status);
        Found {
            kinds: solver.facts().kinds,
            energy: solution.energy,
            lambda: solution.rows().iter().map(|r| r.multiplier).collect(),
            u: solution.u,
        }
    })
}

#[track_caller]
fn assert_same(a: &Found, b: &Found) {
    let far = |x: &[f64], y: &[f64]| {
        assert_eq!(x.len(), y.len());
        let size = y.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
        let away = x.iter().zip(y).map(|(x, y)| (x - y).abs());
        away.fold(0.0, f64::max) / size
    };
    let away = (a.energy - b.energy).abs();
    assert!(away <= 1e-10 * b.energy.abs(), "{} {}", a.energy, b.energy);
    assert!(
        far(&a.lambda, &b.lambda) < 1e-7,
        "{}",
        far(&a.lambda, &b.lambda)
    );
    for (k, (x, y)) in a.u.iter().zip(&b.u).enumerate() {
        assert!(far(x, y) < 1e-7, "subdomain {k}: {}", far(x, y));
    }
}

const CONTACT: &str = "[contact]\nauto = true\n";

#[test]
fn a_wall_of_placed_bricks_is_the_wall_of_single_bricks() {
    let head = "physics = \"elasticity\"\n";
    // The rows are shifted by half a brick; the last brick stands upright.
    let places = [
        [0.0, 0.0],
        [2.0, 0.0],
        [1.0, 1.0],
        [3.0, 1.0],
        [0.0, 2.0],
        [2.0, 2.0],
    ];
    let brick =
        "size = [2, 1]\nelements = [4, 2]\nload = [0.1, -1]\nyoung = 100\nspring = { top = 2 }\n";
    let list: Vec<String> = places.iter().map(|p| format!("{p:?}")).collect();
    let copies = format!(
        "{head}[[body]]\nname = \"brick\"\n{brick}instances = [{}, {{ at = [6, 1], angle = 90 }}]\n\
         [[body.only]]\ninstances = \"0..1\"\ndirichlet = [\"bottom\"]\n\
         [[body.only]]\ninstances = 6\ndirichlet = [\"right\", \"bottom\"]\n{CONTACT}",
        list.join(", ")
    );
    let mut single = head.to_string();
    for (k, p) in places.iter().enumerate() {
        let held = ["dirichlet = [\"bottom\"]\n", ""][usize::from(k > 1)];
        single += &format!("[[body]]\nname = \"b{k}\"\norigin = {p:?}\n{brick}{held}");
    }
    single +=
        &format!(
        "[[body]]\nname = \"b6\"\norigin = [5, 1]\n{}dirichlet = [\"top\", \"right\"]\n{CONTACT}",
        brick.replace("[2, 1]", "[1, 2]").replace("[4, 2]", "[2, 4]")
        .replace("top", "left")
    );
    let [copies, single] = [copies, single].map(|text| Scene::parse("s.toml", &text).unwrap());
    assert!(copies.points.len() > 20);
    // The pairs of nodes are the same but for the numbers in the upright brick.
    let pairs = |scene: &Scene| -> Vec<_> {
        scene
            .interfaces
            .iter()
            .map(|i| (i.bodies, i.shared.len()))
            .collect()
    };
    assert_eq!(pairs(&copies), pairs(&single));
    // Bodies that stand are the same to the last bit.
    for s in 0..6 {
        let [a, b] = [&copies, &single].map(|scene| scene.subdomain(s).unwrap());
        assert_eq!((a.k, a.f, a.dofs), (b.k, b.f, b.dofs));
    }
    let [mut a, mut b] = [copies, single].map(solve);
    // The nodes of the upright brick come in another order.
    let sorted = |found: &mut Found| {
        let mut last = found.u.pop().unwrap();
        last.sort_by(f64::total_cmp);
        found.u.push(last);
        found.lambda.sort_by(f64::total_cmp);
    };
    sorted(&mut a);
    sorted(&mut b);
    assert_same(&a, &b);
}

/// A cube of tetrahedra around the z axis, with nodes inside moved, as groups `name` and `foot_name`.
struct Cube {
    name: &'static str,
    /// Where its nodes go.
    place: fn([f64; 3]) -> [f64; 3],
}

fn mesh(cubes: &[Cube]) -> String {
    const N: usize = 3;
    const ORDERS: [[usize; 3]; 6] = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [1, 0, 2],
        [2, 1, 0],
    ];
    let node = |i: usize, j: usize, k: usize| (k * (N + 1) + j) * (N + 1) + i;
    let (mut groups, mut nodes, mut elements) = (String::new(), String::new(), Vec::new());
    for (c, cube) in cubes.iter().enumerate() {
        let first = c * (N + 1).pow(3) + 1;
        groups += &format!(
            "3 {} \"{}\"\n2 {} \"foot_{1}\"\n",
            2 * c + 1,
            cube.name,
            2 * c + 2
        );
        for at in 0..(N + 1).pow(3) {
            let place = [at % (N + 1), at / (N + 1) % (N + 1), at / (N + 1).pow(2)];
            let inside = place.iter().all(|p| (1..N).contains(p));
            let moved = if inside {
                0.04 * ((7 * at) as f64).sin()
            } else {
                0.0
            };
            let [x, y, z] = place.map(|p| p as f64 / N as f64);
            let [x, y, z] = (cube.place)([x - 0.5 + moved, y - 0.5 - 0.7 * moved, z + 0.3 * moved]);
            nodes += &format!("{} {x:.17} {y:.17} {z:.17}\n", first + at);
        }
        for at in 0..N.pow(3) {
            let [i, j, k] = [at % N, at / N % N, at / N / N];
            for (number, order) in ORDERS.iter().enumerate() {
                let mut p = [i, j, k];
                let mut cell = vec![node(i, j, k)];
                for &axis in order {
                    p[axis] += 1;
                    cell.push(node(p[0], p[1], p[2]));
                }
                if number >= 3 {
                    cell.swap(1, 2);
                }
                let cell: Vec<String> = cell.iter().map(|v| (first + v).to_string()).collect();
                elements.push(format!("4 2 {0} {0} {1}", 2 * c + 1, cell.join(" ")));
            }
            if k == 0 {
                let q = [
                    node(i, j, 0),
                    node(i + 1, j, 0),
                    node(i + 1, j + 1, 0),
                    node(i, j + 1, 0),
                ];
                for t in [[0, 1, 2], [0, 2, 3]] {
                    let t = t.map(|a| (first + q[a]).to_string());
                    elements.push(format!("2 2 {0} {0} {1}", 2 * c + 2, t.join(" ")));
                }
            }
        }
    }
    let elements: Vec<String> = (1..)
        .zip(&elements)
        .map(|(k, e): (usize, &String)| format!("{k} {e}\n"))
        .collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n{groups}$EndPhysicalNames\n$Nodes\n{}\n{nodes}\
         $EndNodes\n$Elements\n{}\n{}$EndElements\n",
        2 * cubes.len(),
        cubes.len() * (N + 1).pow(3),
        elements.len(),
        elements.concat()
    )
}

/// A turn by 30° about z.
fn aslant([x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = 30f64.to_radians().sin_cos();
    [cos * x - sin * y, sin * x + cos * y, z]
}

#[test]
fn a_tower_of_placed_meshes_is_the_tower_of_single_meshes() {
    let scratch = Scratch::new("instances-tower");
    // The second stands on the first, the third is turned by a right angle, the fourth by 30 degrees: its nodes do not
    // match. The fifth is far away, upside down.
    let cubes = [
        Cube {
            name: "b0",
            place: |x| x,
        },
        Cube {
            name: "b1",
            place: |[x, y, z]| [x, y, z + 1.0],
        },
        Cube {
            name: "b2",
            place: |[x, y, z]| [-y, x, z + 2.0],
        },
        Cube {
            name: "b3",
            place: |x| {
                let [x, y, z] = aslant(x);
                [x, y, z + 3.0]
            },
        },
        Cube {
            name: "b4",
            place: |[x, y, z]| [x, -y, 4.0 + 1.0 - z],
        },
    ];
    scratch.file("one.msh", &mesh(&cubes[..1]));
    scratch.file("all.msh", &mesh(&cubes));
    let body = "young = 100\nsubdomains = 2\nload = [0.02, 0.01, -1]\nspring = { all = 0.5 }\n";
    let head = |file: &str| {
        format!("dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"{file}\"\n")
    };
    let copies = format!(
        "{}[[body]]\nname = \"b0\"\n{body}instances = [[0, 0, 0], [0, 0, 1], {{ at = [0, 0, 2], axis = [0, 0, 3], \
         angle = 90 }}, {{ at = [0, 0, 3], rotation = [0, 0, 30] }}, [0, 0, 5, 180, 0, 0]]\n\
         [[body.only]]\ninstances = 0\ndirichlet = {{ foot_b0 = 0 }}\n\
         [[body.only]]\ninstances = 4\ntraction = {{ foot_b0 = [0, 0, -0.5] }}\n{CONTACT}",
        head("one.msh")
    );
    let mut single = head("all.msh");
    for (k, cube) in cubes.iter().enumerate() {
        single += &format!("[[body]]\nname = \"{}\"\n{body}", cube.name);
        single += [
            "dirichlet = { foot_b0 = 0 }\n",
            "",
            "",
            "",
            "traction = { foot_b4 = [0, 0, -0.5] }\n",
        ][k];
    }
    single += CONTACT;
    let [copies, single] = [("c.toml", copies), ("s.toml", single)].map(|(name, text)| {
        Scene::load(scratch.file(name, &text)).unwrap_or_else(|e| panic!("{e}"))
    });
    assert_eq!(copies.interfaces.len(), 4);
    assert!(
        copies.mortar_rows().count() > 10,
        "{}",
        copies.mortar_rows().count()
    );
    let [a, b] = [copies, single].map(solve);
    assert_same(&a, &b);
    assert_eq!(a.kinds, b.kinds);
}

#[test]
fn materials_turn_with_a_copy_and_loads_do_not() {
    let brick = |more: &str| {
        format!(
        "physics = \"elasticity\"\n[[body]]\nname = \"b\"\nsize = [2, 1]\nelements = [4, 2]\nload = [\"y\", -1]\n{more}"
    )
    };
    // E grows along the brick; so it grows upwards where the brick stands upright.
    let placed = brick("young = \"1 + x\"\ninstances = [[5, 3, 90]]\n");
    let written = brick("young = \"1 + y - 3\"\norigin = [4, 3]\n")
        .replace("[2, 1]", "[1, 2]")
        .replace("[4, 2]", "[2, 4]");
    let [a, b] = [placed, written].map(|text| {
        let scene = Scene::parse("s.toml", &text).unwrap();
        let mesh = scene.subdomain_mesh(0).unwrap();
        let mut nodes: Vec<_> = mesh
            .points
            .iter()
            .map(|p| p.map(|v| (1e9 * v).round()))
            .zip(0..)
            .collect();
        nodes.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let sub = scene.subdomain(0).unwrap();
        let order: Vec<usize> = nodes.iter().flat_map(|(_, k)| [2 * k, 2 * k + 1]).collect();
        let k: Vec<f64> = order
            .iter()
            .flat_map(|&i| order.iter().map(|&j| sub.k.get(i, j)).collect::<Vec<_>>())
            .collect();
        let f: Vec<f64> = order.iter().map(|&i| sub.f[i]).collect();
        (k, f)
    });
    for (x, y) in a.0.iter().zip(&b.0).chain(a.1.iter().zip(&b.1)) {
        assert!((x - y).abs() < 1e-12, "{x} {y}");
    }
}
