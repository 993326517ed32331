//! The assembled problem solved by a sparse Cholesky factorisation: the standard that every solve of the method is
//! compared with.

use std::collections::BTreeMap;
use std::path::Path;

use elements::cell::{self, Element, Material};
use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Solution};
use petsc::{Options, Session};
use scene::assembly::SubdomainMesh;
use scene::{Numbering, Scene};

/// Solution of an assembled scene, torn by subdomain.
pub struct Direct {
    pub scene: Scene,
    meshes: Vec<SubdomainMesh>,
    /// Nodal values of each subdomain, including prescribed ones.
    pub nodal: Vec<Vec<f64>>,
}

impl Direct {
    pub fn new(scene: Scene) -> Direct {
        let numbering = Numbering::new(&scene);
        let n = numbering.len() as usize;
        let range = 0..scene.n_subdomains();
        let meshes: Vec<SubdomainMesh> = range.map(|s| scene.subdomain_mesh(s).unwrap()).collect();
        let mut entries: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        let mut f = vec![0.0; n];
        let mut global = Vec::new();
        for mesh in &meshes {
            let s = scene.assemble(mesh).unwrap();
            let place: Vec<usize> = s
                .dofs
                .iter()
                .map(|&d| numbering.global(d) as usize)
                .collect();
            for (i, &gi) in place.iter().enumerate() {
                f[gi] += s.f[i];
                let (col, val) = s.k.row(i);
                for (&j, &v) in col.iter().zip(val) {
                    *entries.entry((gi, place[j as usize])).or_default() += v;
                }
            }
            global.push(place);
        }
        let triplets: Vec<_> = entries
            .iter()
            .map(|(&(i, j), &v)| Triplet::new(i, j, v))
            .collect();
        let k = SparseColMat::try_new_from_triplets(n, n, &triplets).unwrap();
        let factor = k.sp_cholesky(Side::Lower).unwrap();
        let mut u = vec![0.0; n];
        // Residuals are in twice the working precision: refinement then ends at the rounding of u itself, for any
        // contrast of the coefficients.
        for _ in 0..4 {
            let mut r: Vec<(f64, f64)> = f.iter().map(|&f| (f, 0.0)).collect();
            for (&(i, j), &v) in &entries {
                let product = -v * u[j];
                let rest = (-v).mul_add(u[j], -product);
                let sum = r[i].0 + product;
                let part = sum - r[i].0;
                r[i].1 += (r[i].0 - (sum - part)) + (product - part) + rest;
                r[i].0 = sum;
            }
            let r = Mat::from_fn(n, 1, |i, _| r[i].0 + r[i].1);
            let correction = factor.solve(&r);
            u.iter_mut()
                .enumerate()
                .for_each(|(i, u)| *u += correction[(i, 0)]);
        }
        let torn = |place: &Vec<usize>| place.iter().map(|&g| u[g]).collect::<Vec<f64>>();
        let nodal = meshes
            .iter()
            .zip(&global)
            .map(|(m, place)| m.nodal(&torn(place)))
            .collect();
        Direct {
            scene,
            meshes,
            nodal,
        }
    }

    pub fn example(name: &str) -> Direct {
        // Tests of packages in the root of the repository and in crates/ ask for it.
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = package.ancestors().find(|d| d.join("Cargo.lock").is_file());
        let scenes = root.expect("a workspace").join("examples/scenes");
        Direct::new(Scene::load(scenes.join(format!("{name}.toml"))).unwrap())
    }

    /// Square of the energy norm of nodal functions, torn by subdomain, element by element.
    pub fn energy(&self, nodal: &[Vec<f64>]) -> f64 {
        let mut sum = 0.0;
        for (mesh, u) in self.meshes.iter().zip(nodal) {
            let grid = mesh.grid().unwrap();
            let points = mesh.element_points(grid, [0; 3]);
            let mut k = [0.0; 16];
            let unit = Material::Scalar { rho: 1.0 };
            cell::stiffness(2, &points[..4], Element::Q1, &unit, &mut k);
            let [nx, ny, _] = grid.elements;
            for (e, rho) in mesh.rho.iter().enumerate() {
                assert!(e < nx * ny);
                let nodes = grid.element_nodes([e % nx, e / nx, 0]);
                for (a, row) in k.chunks_exact(4).enumerate() {
                    for (b, entry) in row.iter().enumerate() {
                        // Rows of the element matrix sum to zero: energies of differences suffer no cancellation from a
                        // large mean.
                        sum +=
                            rho * entry * (u[nodes[a]] - u[nodes[0]]) * (u[nodes[b]] - u[nodes[0]]);
                    }
                }
            }
        }
        sum
    }

    /// ‖u − u_direct‖ / ‖u_direct‖ in the energy norm; `u` by local dof of each subdomain.
    pub fn distance(&self, u: &[Vec<f64>]) -> f64 {
        let nodal: Vec<Vec<f64>> = self.meshes.iter().zip(u).map(|(m, u)| m.nodal(u)).collect();
        let difference =
            |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
        let difference: Vec<Vec<f64>> = nodal.iter().zip(&self.nodal).map(difference).collect();
        (self.energy(&difference) / self.energy(&self.nodal)).sqrt()
    }

    /// Sets the method up on the whole scene.
    pub fn solver(&self, session: &Session, settings: &MethodSettings) -> FetiFeti {
        let problem = self.scene.substructures(&|_| true).unwrap();
        FetiFeti::new(session, problem, settings.clone()).expect("set up")
    }

    /// Solves by the method, and measures the distance from the direct solution.
    pub fn run(&self, session: &Session, settings: &MethodSettings) -> (Solution, f64) {
        let solution = self.solver(session, settings).solve().expect("solved");
        let distance = self.distance(&solution.u);
        (solution, distance)
    }
}

/// MethodSettings that stop at 1e-12.
pub fn tight() -> MethodSettings {
    MethodSettings::default().rtol(1e-12)
}

/// Runs `work` with PETSc options (names without `-fetifeti_`), and removes them afterwards.
pub fn with_options<T>(session: &Session, options: &[(&str, &str)], work: impl FnOnce() -> T) -> T {
    struct Cleared<'a>(Options, &'a [(&'a str, &'a str)]);
    impl Drop for Cleared<'_> {
        fn drop(&mut self) {
            for (name, _) in self.1 {
                self.0.clear_value(name).expect("the option can be cleared");
            }
        }
    }
    let set = Cleared(Options::new(session, "fetifeti_"), options);
    for (name, value) in options {
        set.0
            .set_value(name, Some(value))
            .expect("the option can be set");
    }
    work()
}

/// 4 × 4 bodies, the inner ones floating, and the three bodies of the partly tied scene.
pub fn floating_scenes() -> Vec<(&'static str, Direct)> {
    let grid = "[grid]\nbodies = 4\nsubdomains = 2\nelements_per_subdomain = 3\n\
                dirichlet = \"all\"\nload = \"1 + x - 2*y\"\n\
                rho = { checkerboard = [1, 20], by = \"body\" }\n";
    vec![
        (
            "grid",
            Direct::new(Scene::parse("grid.toml", grid).unwrap()),
        ),
        ("partly_tied", Direct::example("partly_tied")),
    ]
}
