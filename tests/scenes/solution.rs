//! Scenes solved through the assembled numbering by a sparse Cholesky factorisation: exact solutions, patch tests.

use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::Side;
use scene::assembly::ErrorNorms;
use scene::{Numbering, Scene};
use std::collections::{HashMap, HashSet};

/// Solves the assembled problem and returns the scene's numbering with the solution.
fn solve(scene: &Scene) -> (Numbering, Vec<f64>) {
    let numbering = Numbering::new(scene);
    let n = numbering.len() as usize;
    let mut triplets = Vec::new();
    let mut f = faer::Mat::zeros(n, 1);
    for s in 0..scene.n_subdomains() {
        let s = scene.subdomain(s).unwrap();
        let global: Vec<usize> = s
            .dofs
            .iter()
            .map(|&d| numbering.global(d) as usize)
            .collect();
        for (i, &gi) in global.iter().enumerate() {
            f[(gi, 0)] += s.f[i];
            let (col, val) = s.k.row(i);
            for (&j, &v) in col.iter().zip(val) {
                triplets.push(Triplet::new(gi, global[j as usize], v));
            }
        }
    }
    let k = SparseColMat::try_new_from_triplets(n, n, &triplets).unwrap();
    let u = k.sp_cholesky(Side::Lower).unwrap().solve(&f);
    (numbering, (0..n).map(|i| u[(i, 0)]).collect())
}

fn errors(scene: &Scene) -> ErrorNorms {
    let (numbering, u) = solve(scene);
    let mut squares = [0.0; 3];
    for s in 0..scene.n_subdomains() {
        let mesh = scene.subdomain_mesh(s).unwrap();
        let local: Vec<f64> = scene
            .assemble(&mesh)
            .unwrap()
            .dofs
            .iter()
            .map(|&d| u[numbering.global(d) as usize])
            .collect();
        let part = scene.error_squares(&mesh, &mesh.nodal(&local)).unwrap();
        for (sum, p) in squares.iter_mut().zip(part) {
            *sum += p;
        }
    }
    ErrorNorms::from_squares(squares)
}

/// −∇·(ρ∇u) = f with ρ = 1 + x and inhomogeneous boundary values on two bodies with different subdomain grids.
fn manufactured(n: usize, quadrature: &str) -> Scene {
    // u = exp(x) cos(2y): f = −(u_x + (1 + x)(u_xx + u_yy)) = −exp(x) cos(2y) (1 + (1 + x)(1 − 4)).
    let body = |name: &str, x: f64, subdomains: &str, sides: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{x}, 0]\nsize = [1, 1]\nelements = {n}\nsubdomains = {subdomains}\n\
             rho = \"1 + x\"\n\
             load = {{ value = \"exp(x)*cos(2*y)*(2 + 3*x)\", quadrature = \"{quadrature}\" }}\n\
             dirichlet = {{ {sides} }}\n"
        )
    };
    let u = "\"exp(x)*cos(2*y)\"";
    let text = format!(
        "exact = {u}\n{}{}",
        body(
            "a",
            0.0,
            "[2, 1]",
            &format!("left = {u}, bottom = {u}, top = {u}")
        ),
        body(
            "b",
            1.0,
            "[1, 4]",
            &format!("right = {u}, bottom = {u}, top = {u}")
        ),
    );
    Scene::parse("manufactured.toml", &text).unwrap()
}

#[test]
fn the_error_is_of_second_order_in_l2_and_first_in_energy() {
    for quadrature in ["midpoint", "gauss"] {
        let norms: Vec<ErrorNorms> = [8, 16, 32, 64]
            .iter()
            .map(|&n| errors(&manufactured(n, quadrature)))
            .collect();
        for pair in norms.windows(2) {
            let order = |a: f64, b: f64| (a / b).log2();
            let l2 = order(pair[0].l2, pair[1].l2);
            let energy = order(pair[0].energy, pair[1].energy);
            assert!((l2 - 2.0).abs() < 0.05, "{quadrature}: L2 order {l2}");
            assert!(
                (energy - 1.0).abs() < 0.03,
                "{quadrature}: energy order {energy}"
            );
        }
        assert!(norms[3].l2 < 1e-3);
        // sqrt(1 + x) lies between 1 and sqrt(3) on the domain.
        assert!(norms[3].energy > norms[3].h1 && norms[3].energy < 3.0_f64.sqrt() * norms[3].h1);
    }
}

#[test]
fn linear_functions_are_exact_across_ties_of_unequal_bodies() {
    let text = "
exact = \"3 + 2*x - 5*y\"
[[body]]
name = \"low\"
origin = [0, 0]
size = [2, 1]
elements = [8, 6]
subdomains = [4, 2]
dirichlet = { left = \"3 + 2*x - 5*y\", right = \"3 + 2*x - 5*y\", bottom = \"3 + 2*x - 5*y\" }
[[body]]
name = \"left\"
origin = [0, 1]
size = [0.75, 1]
elements = [3, 4]
subdomains = [1, 2]
dirichlet = { left = \"3 + 2*x - 5*y\", top = \"3 + 2*x - 5*y\" }
[[body]]
name = \"right\"
origin = [0.75, 1]
size = [1.25, 1]
elements = [5, 4]
subdomains = [5, 1]
dirichlet = { right = \"3 + 2*x - 5*y\", top = \"3 + 2*x - 5*y\" }
";
    let norms = errors(&Scene::parse("patch.toml", text).unwrap());
    assert!(norms.l2 < 1e-12 && norms.h1 < 1e-12, "{norms:?}");
}

#[test]
fn the_sine_example_has_the_interpolation_size_error() {
    // Leading term of ‖u − u_h‖ in the H¹ seminorm for Q1 on a square mesh: h/√12 (‖u_xx‖² + ‖u_yy‖²)^½.
    let norms = errors(&Scene::load("../../examples/scenes/exact_sine.toml").unwrap());
    let pi2 = std::f64::consts::PI.powi(2);
    let leading = (1.0 / 32.0) / 12.0_f64.sqrt() * (2.0 * (pi2 / 2.0).powi(2)).sqrt();
    assert!(
        (norms.h1 / leading - 1.0).abs() < 0.01,
        "{norms:?} {leading}"
    );
    assert_eq!(norms.h1, norms.energy);
}

#[test]
fn the_numbering_is_a_bijection_that_merges_exactly_what_is_tied() {
    for name in [
        "poisson_2x2",
        "lee_column_1",
        "lee_column_2",
        "partly_tied",
        "one_body",
        "one_subdomain",
        "unequal_bodies",
    ] {
        let scene = Scene::load(format!("../../examples/scenes/{name}.toml")).unwrap();
        let numbering = Numbering::new(&scene);
        let mut position: HashMap<u64, [f64; 3]> = HashMap::new();
        let mut number: HashMap<u64, u64> = HashMap::new();
        for index in 0..scene.n_subdomains() {
            let s = scene.subdomain(index).unwrap();
            let own = numbering.range(index..index + 1);
            for (k, &dof) in s.dofs.iter().enumerate() {
                let global = numbering.global(dof);
                assert!(global < numbering.len() && global < own.end, "{name}");
                let point = s.coordinates.as_ref().unwrap()[k];
                let known = position.entry(global).or_insert(point);
                assert!(
                    (0..2).all(|d| (known[d] - point[d]).abs() < 1e-12),
                    "{name}"
                );
                let [x, y, _] = numbering.coordinates(&scene, global);
                assert!(
                    (x - point[0]).abs() + (y - point[1]).abs() < 1e-12,
                    "{name}"
                );
                number.insert(dof, global);
            }
        }
        assert_eq!(position.len() as u64, numbering.len(), "{name}");
        // The numbering merges exactly the classes that the rows span: N = body dofs − rank of the rows.
        let mut rows = scene.solver_rows(&|_| true);
        rows.retain(|r| r.holds);
        let mut rank = 0;
        let mut parent: HashMap<u64, u64> = HashMap::new();
        fn root(parent: &HashMap<u64, u64>, mut k: u64) -> u64 {
            while let Some(&p) = parent.get(&k) {
                k = p;
            }
            k
        }
        for row in &rows {
            let [a, b] = [row.terms[0].0, row.terms[1].0];
            assert_eq!(number[&a], number[&b], "{name}");
            let (a, b) = (root(&parent, a), root(&parent, b));
            if a != b {
                parent.insert(a, b);
                rank += 1;
            }
        }
        assert_eq!(number.len() as u64 - rank, numbering.len(), "{name}");
        assert_eq!(scene.plan().assembled, numbering.len(), "{name}");
    }
}

#[test]
fn partly_tied_faces_leave_slits() {
    let scene = Scene::load("../../examples/scenes/lee_column_2.toml").unwrap();
    let numbering = Numbering::new(&scene);
    // 65² − 4·64 + ... counted by hand: every body has 17² nodes, outer ones are given; each of the 24 faces has
    // nodes at t = 6/16 … 10/16 tied, five of them.
    let outer: usize = 4 * 64;
    let copies: usize = 16 * 17 * 17;
    // On the outer boundary, 12 points between bodies are counted twice.
    let expected = copies - (outer + 12) - 24 * 5;
    assert_eq!(numbering.len() as usize, expected);
    let unique: HashSet<u64> = (0..scene.n_subdomains())
        .flat_map(|s| scene.subdomain(s).unwrap().dofs)
        .map(|d| numbering.global(d))
        .collect();
    assert_eq!(unique.len(), expected);
}

#[test]
fn a_node_tied_to_a_given_value_is_given() {
    // The right body has no Dirichlet side, but its corners are tied to given nodes of the left one.
    let text = "
[[body]]
name = \"a\"
size = [1, 1]
elements = 4
dirichlet = { bottom = \"2 + x\", top = 7 }
[[body]]
name = \"b\"
origin = [1, 0]
size = [1, 1]
elements = 4
";
    let scene = Scene::parse("t.toml", text).unwrap();
    assert_eq!(scene.bodies[1].prescribed, vec![(0, 3.0), (20, 7.0)]);
    assert_eq!(scene.solver_rows(&|_| true).len(), 3);
    let mesh = scene.subdomain_mesh(1).unwrap();
    assert_eq!(mesh.local_dof(0), None);
    assert_eq!(mesh.nodal(&vec![0.5; mesh.n_free()])[20], 7.0);
}
