//! Element matrices of one subdomain; equal elements share one matrix.

use super::{Grid, SubdomainMesh};
use elements::cell::{self, Element};
use elements::law::{Law, Tangent};
use elements::q1;
use std::collections::HashMap;

/// The element matrices of a subdomain.
pub struct CellStiffness<'m> {
    mesh: &'m SubdomainMesh,
    kind: ElementStiffness,
}

enum ElementStiffness {
    /// Equal boxes: one matrix with coefficient 1 for each Poisson's ratio, and the index of each element's matrix
    /// (empty: the first).
    Boxes { unit: Vec<Vec<f64>>, of: Vec<u32> },
    /// Equal boxes of laws that are not isotropic: one matrix for each law, and the index of each element's.
    ByLaw { all: Vec<Vec<f64>>, of: Vec<u32> },
    /// Curved bodies: one matrix for each element, one after the other.
    Each { n: usize, all: Vec<f64> },
}

impl<'m> CellStiffness<'m> {
    /// Computes the matrices.
    pub fn new(mesh: &'m SubdomainMesh, grid: &Grid) -> CellStiffness<'m> {
        let n = grid.corners() * mesh.components();
        let kind = match grid.step {
            Some(step) if !mesh.laws.of.is_empty() => by_law(mesh, step, n),
            Some(step) => boxes(mesh, step, n),
            None => each(mesh, grid, n),
        };
        CellStiffness { mesh, kind }
    }

    /// The matrix of element `e` by rows, and the factor that multiplies it.
    #[inline]
    pub fn at(&self, e: usize) -> (&[f64], f64) {
        match &self.kind {
            ElementStiffness::Boxes { unit, of } => {
                let which = of.get(e).map_or(0, |&k| k as usize);
                (&unit[which], self.mesh.rho[e])
            }
            ElementStiffness::ByLaw { all, of } => (&all[of[e] as usize], 1.0),
            ElementStiffness::Each { n, all } => (&all[e * n * n..(e + 1) * n * n], 1.0),
        }
    }
}

/// The corners of a box.
fn corners(mesh: &SubdomainMesh, step: [f64; 3]) -> Vec<[f64; 3]> {
    let corner = |a: usize| [0, 1, 2].map(|d| step[d] * (a >> d & 1) as f64);
    (0..1 << mesh.dim).map(corner).collect()
}

/// The laws of a box are those of the whole subdomain: every element has one.
fn by_law(mesh: &SubdomainMesh, step: [f64; 3], n: usize) -> ElementStiffness {
    let points = corners(mesh, step);
    let matrix = |tangent: &Tangent| {
        let mut out = vec![0.0; n * n];
        let material = mesh.form.elastic(Law::General(*tangent));
        cell::stiffness(mesh.dim, &points, mesh.form.element, &material, &mut out);
        out
    };
    ElementStiffness::ByLaw {
        all: mesh.laws.tangents.iter().map(matrix).collect(),
        of: mesh.laws.of.iter().map(|of| of[1]).collect(),
    }
}

fn boxes(mesh: &SubdomainMesh, step: [f64; 3], n: usize) -> ElementStiffness {
    let points = corners(mesh, step);
    let matrix = |poisson: f64| {
        if mesh.dim == 2 && n == 4 && mesh.form.element == Element::Q1 {
            return q1::stiffness(step[0], step[1]).concat();
        }
        let mut out = vec![0.0; n * n];
        let material = mesh.form.material(1.0, poisson);
        cell::stiffness(mesh.dim, &points, mesh.form.element, &material, &mut out);
        out
    };
    let first = mesh.poisson.first().copied().unwrap_or(0.0);
    if mesh.poisson.iter().all(|&p| p == first) {
        return ElementStiffness::Boxes {
            unit: vec![matrix(first)],
            of: Vec::new(),
        };
    }
    let mut known: HashMap<u64, u32> = HashMap::new();
    let mut unit = Vec::new();
    let of = mesh.poisson.iter().map(|&p| {
        *known.entry(p.to_bits()).or_insert_with(|| {
            unit.push(matrix(p));
            unit.len() as u32 - 1
        })
    });
    let of = of.collect();
    ElementStiffness::Boxes { unit, of }
}

fn each(mesh: &SubdomainMesh, grid: &Grid, n: usize) -> ElementStiffness {
    let mut all = vec![0.0; n * n * mesh.n_elements()];
    for (e, (out, place)) in all
        .chunks_exact_mut(n * n)
        .zip(grid.element_places())
        .enumerate()
    {
        let points = mesh.element_points(grid, place);
        let material = mesh.material(e);
        let element = mesh.form.element;
        cell::stiffness(mesh.dim, &points[..grid.corners()], element, &material, out);
    }
    ElementStiffness::Each { n, all }
}
