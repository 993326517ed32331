//! Scenes with meshes of other programs: boundary groups, partitions, ties, contact, elements of second order.

use crate::support::checks::identities;
use crate::support::mpi::Scratch;
use crate::support::session::with_session;
use crate::support::solid::assembled;
use base::Error;
use fetifeti::settings::MethodSettings;
use fetifeti::solution::SolvedRow;
use fetifeti::{FetiFeti, Subdomain};
use mesh::Mesh;
use scene::Scene;

/// A mesh of Gmsh's format 2.2: the unit squares [0, n] × [0, 1], cut into 2 m × m triangles each, of first or second
/// order; square k is the group `b<k>`, and nodes on common edges are shared. The lines x = 0 and x = n are the groups
/// `left` and `right`, the lines x = k the groups `joint<k>`.
pub(super) fn squares(n: usize, m: usize, order: usize) -> String {
    let fine = order * m;
    let width = n * fine + 1;
    let node = |i: usize, j: usize| j * width + i + 1;
    let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    out += &format!("{}\n", 2 * n + 1);
    for k in 0..=n {
        let name = match k {
            0 => "left".into(),
            k if k == n => "right".into(),
            k => format!("joint{k}"),
        };
        out += &format!("1 {} \"{name}\"\n", k + 1);
    }
    for k in 0..n {
        out += &format!("2 {} \"b{k}\"\n", 100 + k);
    }
    out += &format!("$EndPhysicalNames\n$Nodes\n{}\n", width * (fine + 1));
    for j in 0..=fine {
        for i in 0..width {
            // Interior nodes are moved: nothing repeats.
            let inside = i % fine != 0 && j != 0 && j != fine && order == 1;
            let shift = if inside {
                0.2 * ((7 * i + 13 * j) as f64).sin() / m as f64
            } else {
                0.0
            };
            let (x, y) = (
                i as f64 / fine as f64 + shift,
                j as f64 / fine as f64 + 0.7 * shift,
            );
            out += &format!("{} {x} {y} 0\n", node(i, j));
        }
    }
    let mut elements = Vec::new();
    for k in 0..=n {
        for j in 0..m {
            let at = |dj: usize| node(k * fine, order * j + dj);
            elements.push(match order {
                1 => format!("1 2 {0} {0} {1} {2}", k + 1, at(0), at(1)),
                _ => format!("8 2 {0} {0} {1} {2} {3}", k + 1, at(0), at(2), at(1)),
            });
        }
    }
    for j in 0..m {
        for i in 0..n * m {
            let at = |di: usize, dj: usize| node(order * i + di, order * j + dj);
            let tag = 100 + i / m;
            elements.extend(match order {
                1 => [
                    format!("2 2 {tag} {tag} {} {} {}", at(0, 0), at(1, 0), at(1, 1)),
                    format!("2 2 {tag} {tag} {} {} {}", at(0, 0), at(1, 1), at(0, 1)),
                ],
                _ => [[[0, 0], [2, 0], [2, 2]], [[0, 0], [2, 2], [0, 2]]].map(|corners| {
                    let all = (0..3).map(|a| corners[a]).chain((0..3).map(|a| {
                        let (p, q) = (corners[a], corners[(a + 1) % 3]);
                        [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2]
                    }));
                    let list: Vec<String> = all.map(|[di, dj]| at(di, dj).to_string()).collect();
                    format!("9 2 {tag} {tag} {}", list.join(" "))
                }),
            });
        }
    }
    out += &format!("$EndNodes\n$Elements\n{}\n", elements.len());
    for (k, element) in elements.iter().enumerate() {
        out += &format!("{} {element}\n", k + 1);
    }
    out + "$EndElements\n"
}

/// A scene beside its mesh.
pub(super) struct Model(Scratch);

impl Model {
    pub(super) fn new(name: &str, mesh: &str) -> Model {
        let scratch = Scratch::new(name);
        scratch.file("m.msh", mesh);
        Model(scratch)
    }

    pub(super) fn load(&self, text: &str) -> Result<Scene, Error> {
        Scene::load(self.0.file("s.toml", text))
    }

    pub(super) fn scene(&self, text: &str) -> Scene {
        self.load(text).unwrap_or_else(|e| panic!("{e}\n{text}"))
    }

    #[track_caller]
    pub(super) fn refuses(&self, text: &str, part: &str) {
        let message = self.load(text).expect_err("refused").to_string();
        assert!(message.contains(part), "{message}");
        assert!(!message.contains('\n'), "{message}");
    }
}

/// A solution: u by subdomain, and the rows.
struct Solved {
    u: Vec<Vec<f64>>,
    rows: Vec<SolvedRow>,
}

fn solve(scene: &Scene, what: &str) -> Solved {
    let settings = MethodSettings::default().rtol(1e-12);
    let problem = scene.substructures(&|_| true).unwrap();
    let what = what.to_string();
    with_session(move |session| {
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        identities(&solver, 1e-9, &what);
        let solution = solver.solve().expect("solved");
        assert!(solution.converged(), "{what}: {}", solution.status);
        Solved {
            rows: solution.rows().to_vec(),
            u: solution.u,
        }
    })
}

/// uᵀKu of torn vectors.
fn square(local: &[Subdomain], u: &[Vec<f64>]) -> f64 {
    let each = local.iter().zip(u).map(|(sub, u)| {
        let mut ku = vec![0.0; u.len()];
        sub.k.mul(u, &mut ku);
        ku.iter().zip(u).map(|(a, b)| a * b).sum::<f64>()
    });
    each.sum()
}

/// The distance of the tied solution from a direct one of the assembled problem, in the energy norm.
fn distance_from_direct(scene: &Scene, what: &str) -> f64 {
    let problem = scene.substructures(&|_| true).unwrap();
    let direct = assembled::solve(&problem);
    let solution = solve(scene, what);
    let difference = solution.u.iter().zip(&direct).map(|(u, v)| {
        let pairs = u.iter().zip(v);
        pairs.map(|(a, b)| a - b).collect::<Vec<f64>>()
    });
    let difference: Vec<Vec<f64>> = difference.collect();
    (square(&problem.local, &difference) / square(&problem.local, &direct)).sqrt()
}

pub(super) const TWO: &str = "
physics = \"elasticity\"
[mesh]
file = \"m.msh\"
[[body]]
name = \"b0\"
young = 100
dirichlet = { left = 0 }
subdomains = 4
[[body]]
name = \"b1\"
young = \"100*(1 + x)\"
traction = { right = [1, -0.5] }
subdomains = 3
";

#[test]
fn tied_bodies_have_the_direct_solution() {
    for order in [1, 2] {
        let model = Model::new(&format!("tied{order}"), &squares(2, 6, order));
        let scene = model.scene(TWO);
        assert_eq!((scene.n_bodies(), scene.n_subdomains()), (2, 7));
        let plan = scene.plan();
        assert_eq!(plan.interfaces.len(), 1);
        assert_eq!(plan.interfaces[0].tied, 6 * order + 1);
        let away = distance_from_direct(&scene, "tied");
        assert!(away < 1e-8, "order {order}: {away:e}");
    }
}

#[test]
fn scalar_problems_have_the_direct_solution() {
    let model = Model::new("scalar_mesh", &squares(3, 5, 1));
    let body = |k: usize, more: &str| format!("[[body]]\nname = \"b{k}\"\nload = 1\n{more}\n");
    let text = format!(
        "[mesh]\nfile = \"m.msh\"\n{}{}{}",
        body(0, "dirichlet = [\"left\"]\nsubdomains = 3"),
        body(1, "rho = 100\nsubdomains = 2"),
        body(2, "flux = { right = 2 }\nsubdomains = 1"),
    );
    let away = distance_from_direct(&model.scene(&text), "scalar");
    assert!(away < 1e-8, "{away:e}");
}

/// A box of second order is the mesh of its cells; errors in L² shrink with the third power of the step.
#[test]
fn boxes_of_second_order_converge_with_order_three() {
    let error = |n: usize, order: usize, element: &str| {
        let text = format!(
            "order = {order}\nelement = \"{element}\"\nexact = \"sin(3*x)*exp(y)\"\n\
             [[body]]\nname = \"b\"\nsize = 1\nelements = {n}\nsubdomains = 2\n\
             load = {{ value = \"8*sin(3*x)*exp(y)\", quadrature = \"gauss\" }}\n\
             dirichlet = {{ left = \"0\", right = \"sin(3)*exp(y)\", bottom = \"sin(3*x)\", \
             top = \"sin(3*x)*exp(1)\" }}\n"
        );
        let scene = Scene::parse("order.toml", &text).unwrap();
        let solution = solve(&scene, "order");
        let mut sum = 0.0;
        for (index, u) in solution.u.iter().enumerate() {
            let mesh = scene.subdomain_mesh(index).unwrap();
            sum += scene.error_squares(&mesh, &mesh.nodal(u)).unwrap()[0];
        }
        sum.sqrt()
    };
    for element in ["q1", "p1"] {
        for order in [1, 2] {
            let rate = (error(4, order, element) / error(8, order, element)).log2();
            let wanted = order as f64 + 1.0;
            assert!(
                (rate - wanted).abs() < 0.25,
                "{element}, order {order}: rate {rate}"
            );
        }
    }
}

#[test]
fn solid_boxes_of_second_order_have_the_direct_solution() {
    let text = "dimension = 3\nphysics = \"elasticity\"\norder = 2\n\
        [grid]\nbodies = [2, 1, 1]\nsize = [2, 1, 1]\nelements = 2\nsubdomains = [2, 1, 1]\nyoung = 10\n\
        dirichlet = [\"left\"]\nload = [0, -1, 0]\n";
    let scene = Scene::parse("solid.toml", text).unwrap();
    assert!(matches!(scene.bodies[0].mesh(), Mesh::Cells(_)));
    let away = distance_from_direct(&scene, "solid");
    assert!(away < 1e-8, "{away:e}");
}

/// A bar that is pressed against a support: the contact carries the whole load, and pulled it opens.
#[test]
fn contact_carries_the_load_or_opens() {
    let model = Model::new("contact_mesh", &squares(2, 4, 1));
    let text = |contact: &str, pull: f64| {
        format!(
            "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n{contact}\n\
             [[body]]\nname = \"b0\"\nyoung = 100\npoisson = 0\ndirichlet = {{ left = 0 }}\nsubdomains = 2\n\
             [[body]]\nname = \"b1\"\nyoung = 100\npoisson = 0\nsubdomains = 2\n\
             traction = {{ right = [{pull}, 0] }}\nspring = {{ right = 1 }}\n"
        )
    };
    let joints = [
        "[contact]\nauto = true",
        "[[contact]]\nsurfaces = [\"joint1\", \"joint1\"]",
        "[[contact]]\nbodies = [\"b0\", \"b1\"]",
    ];
    for joint in joints {
        let force = |pull: f64| -> f64 {
            let scene = model.scene(&text(joint, pull));
            solve(&scene, joint)
                .rows
                .iter()
                .map(|row| row.multiplier)
                .sum()
        };
        // The springs take part of the load: both bars are springs of stiffness 100, the ground one of 1.
        let pressed = force(-1.0);
        let stiffness = 50.0;
        let exact = stiffness / (stiffness + 1.0);
        assert!(
            (pressed - exact).abs() < 1e-6,
            "{joint}: {pressed}, not {exact}"
        );
        assert_eq!(force(1.0), 0.0, "{joint}");
    }
}

#[test]
fn nodes_without_a_cell_are_left_out_and_said() {
    let whole = squares(2, 3, 1);
    let model = Model::new("mesh_unused", &whole);
    assert_eq!(model.scene(TWO).notes, Vec::<String>::new());
    let n: usize = whole
        .split("$Nodes\n")
        .nth(1)
        .unwrap()
        .lines()
        .next()
        .unwrap()
        .parse()
        .unwrap();
    let more = whole.replacen(
        &format!("$Nodes\n{n}\n"),
        &format!("$Nodes\n{}\n901 7 8 0\n900 5 6 0\n", n + 2),
        1,
    );
    let scene = Model::new("mesh_unused_two", &more).scene(TWO);
    assert_eq!(scene.notes.len(), 1);
    let note = &scene.notes[0];
    for part in [
        "m.msh",
        "2 nodes that no cell has",
        "the first is node 901 at [7.0, 8.0, 0.0]",
    ] {
        assert!(note.contains(part), "{note}");
    }
    assert_eq!(scene.plan().dofs, model.scene(TWO).plan().dofs);
}

/// Boxes and groups of a mesh that are near each other, with a gap of 0.01: found, and nothing else is.
#[test]
fn contacts_of_boxes_and_meshes_are_found() {
    let model = Model::new("mesh_auto_boxes", &squares(2, 4, 1));
    let body = |name: &str, origin: [f64; 2]| {
        format!("[[body]]\nname = \"{name}\"\norigin = {origin:?}\nsize = [1, 1]\nelements = 4\n")
    };
    let head = "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[contact]\nauto = true\ndistance = 0.05\n\
                [[body]]\nname = \"b0\"\n[[body]]\nname = \"b1\"\n";
    let text = format!(
        "{head}{}{}{}",
        body("above", [0.0, 1.01]),
        body("beside", [-1.01, 1.01]),
        body("far", [2.1, 0.0])
    );
    let scene = model.scene(&text);
    let name = |b: usize| scene.bodies[b].spec.name.as_str();
    let mut found: Vec<([&str; 2], f64, usize)> = Vec::new();
    for (k, i) in scene.interfaces.iter().enumerate() {
        let pair = scene.side_pair(k);
        if i.has_contact() {
            assert!(
                (pair.area - 1.0).abs() < 1e-12 && pair.angle < 1e-5,
                "{pair:?}"
            );
            assert!(pair.gap[1] - pair.gap[0] < 1e-12, "{pair:?}");
            let nodes = i.shared.iter().filter(|s| s.link.is_contact()).count();
            found.push((i.bodies.map(name), (1e6 * pair.gap[0]).round() / 1e6, nodes));
        }
    }
    found.sort_by_key(|f| f.0);
    let expected = [
        (["above", "beside"], 0.01, 5),
        (["b0", "above"], 0.01, 5),
        (["b0", "b1"], 0.0, 5),
    ];
    assert_eq!(found, expected);
}

/// As many subdomains as the cost model finds best.
#[test]
fn subdomains_are_chosen() {
    let model = Model::new("mesh_auto", &squares(2, 70, 1));
    let text = TWO
        .replace("subdomains = 4\n", "")
        .replace("subdomains = 3\n", "subdomains = \"auto\"\n");
    let scene = model.scene(&text);
    for body in &scene.bodies {
        let n = body.mesh().n_subdomains();
        assert!((2..=8).contains(&n), "{n} subdomains");
    }
    let away = distance_from_direct(&scene, "auto");
    assert!(away < 1e-8, "{away:e}");
}
