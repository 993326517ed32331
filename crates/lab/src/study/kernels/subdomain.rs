//! The matrix of a subdomain that touches no side of the domain, with loads whose solutions are known.

use std::sync::Arc;

use super::KernelCase;
use base::linalg::csr::Csr;
use base::{Error, Result};
use scene::Scene;

/// A floating subdomain.
pub struct Sample {
    /// Elements across it.
    pub elements: usize,
    /// K.
    pub k: Csr,
    /// Positions of its dofs.
    pub positions: Vec<[f64; 3]>,
    /// The dofs on its surface.
    pub interface: Vec<u32>,
    /// A known solution u, with load K u.
    pub solution: Vec<f64>,
    /// K u.
    pub load: Vec<f64>,
    /// K_II.
    pub inner: Csr,
    /// Positions of the interior dofs.
    pub inner_positions: Vec<[f64; 3]>,
    /// A known solution u_I, with load K_II u_I.
    pub inner_solution: Vec<f64>,
    /// K_II u_I.
    pub inner_load: Vec<f64>,
}

impl Sample {
    /// The middle one of three subdomains in every direction.
    pub fn new(case: &KernelCase, elements: usize) -> Result<Sample> {
        let scene = Scene::parse(case.name, &scene(case, elements))?;
        let sub = scene.subdomain(scene.n_subdomains() / 2)?;
        let positions = sub
            .coordinates
            .ok_or_else(|| Error::environment("a subdomain without coordinates"))?;
        let k = sub.k;
        let surface = surface(&positions, case.dim);
        let (interface, inside): (Vec<u32>, Vec<u32>) =
            (0..k.n() as u32).partition(|&i| surface[i as usize]);
        let inner = k.restricted(&inside);
        let solution: Vec<f64> = (0..k.n()).map(|i| (1.0 + i as f64).sin()).collect();
        let inner_solution: Vec<f64> = inside.iter().map(|&i| solution[i as usize]).collect();
        let product = |a: &Csr, u: &[f64]| {
            let mut f = vec![0.0; u.len()];
            a.mul(u, &mut f);
            f
        };
        Ok(Sample {
            elements,
            load: product(&k, &solution),
            inner_load: product(&inner, &inner_solution),
            inner_positions: inside.iter().map(|&i| positions[i as usize]).collect(),
            k: Arc::unwrap_or_clone(k),
            positions,
            interface,
            solution,
            inner,
            inner_solution,
        })
    }
}

fn scene(case: &KernelCase, elements: usize) -> String {
    let (physics, rest) = match (case.elastic, case.dim) {
        (false, _) => ("scalar", "load = 1.0\n"),
        (true, 2) => ("elasticity", "poisson = 0.3\nload = [1.0, 0.0]\n"),
        (true, _) => ("elasticity", "poisson = 0.3\nload = [1.0, 0.0, 0.0]\n"),
    };
    format!(
        "dimension = {}\nphysics = \"{physics}\"\n[grid]\nbodies = 1\nsubdomains = 3\n\
         elements_per_subdomain = {elements}\ndirichlet = \"all\"\n{rest}",
        case.dim
    )
}

/// For each point, whether it lies on a side of the bounding box.
fn surface(x: &[[f64; 3]], dim: usize) -> Vec<bool> {
    let mut out = vec![false; x.len()];
    for axis in 0..dim {
        let values = || x.iter().map(|p| p[axis]);
        let (low, high) = (
            values().fold(f64::INFINITY, f64::min),
            values().fold(f64::NEG_INFINITY, f64::max),
        );
        for (out, v) in out.iter_mut().zip(values()) {
            *out |= (v - low).min(high - v) < 1e-9 * (high - low);
        }
    }
    out
}
