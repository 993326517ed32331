//! Locking of Q1 and its cures: deflection of two bodies that bend, nearly incompressible or not, over refinements.
//!
//!     cargo run --release --example locking
//!
//! The tables of docs/locking.md are this program's output. It needs no MPI and no options.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use fetifeti_scene::elements::cell::{self, Cure, Element, Material, Plane};
use fetifeti_scene::elements::law::Law;

/// A block of cells: corner points of its map, cells per direction.
struct Block {
    dim: usize,
    corners: Vec<[f64; 3]>,
    cells: [usize; 3],
}

impl Block {
    /// Cook's membrane: a tapered panel, 48 wide, held at the left.
    fn cook(n: usize) -> Block {
        Block {
            dim: 2,
            corners: vec![
                [0.0, 0.0, 0.0],
                [48.0, 44.0, 0.0],
                [0.0, 44.0, 0.0],
                [48.0, 60.0, 0.0],
            ],
            cells: [n, n, 0],
        }
    }

    /// A beam of length 8 with a square cross-section of n × n cells; cells are twice as long as high.
    fn beam(n: usize) -> Block {
        let corner = |a: usize| [8.0 * (a & 1) as f64, (a >> 1 & 1) as f64, (a >> 2) as f64];
        Block {
            dim: 3,
            corners: (0..8).map(corner).collect(),
            cells: [4 * n, n, n],
        }
    }

    fn node(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * (self.cells[1] + 1) + j) * (self.cells[0] + 1) + i
    }

    fn point(&self, at: [usize; 3]) -> [f64; 3] {
        let mut out = [0.0; 3];
        for (a, corner) in self.corners.iter().enumerate() {
            let mut shape = 1.0;
            for (d, (&i, &n)) in at.iter().zip(&self.cells).enumerate().take(self.dim) {
                let s = i as f64 / n as f64;
                shape *= if a >> d & 1 == 1 { s } else { 1.0 - s };
            }
            for i in 0..3 {
                out[i] += shape * corner[i];
            }
        }
        out
    }

    /// The mean vertical displacement of the right end under a total shear force of 1 there; the left end is held.
    fn deflection(&self, element: Element, material: &Material) -> f64 {
        let dim = self.dim;
        let [nx, ny, nz] = self.cells;
        let nodes = (nx + 1) * (ny + 1) * (nz + 1);
        let held = |node: usize| node % (nx + 1) == 0;
        let size = dim << dim;
        let (mut stiffness, mut triplets) = (vec![0.0; size * size], Vec::new());
        let mut load = vec![0.0; dim * nodes];
        let mut area = 0.0;
        for k in 0..nz.max(1) {
            for j in 0..ny {
                for i in 0..nx {
                    let corner = |a: usize| [i + (a & 1), j + (a >> 1 & 1), k + (a >> 2)];
                    let points: Vec<_> = (0..1 << dim).map(|a| self.point(corner(a))).collect();
                    let dofs: Vec<usize> = (0..size)
                        .map(|dof| dim * self.node(corner(dof / dim)) + dof % dim)
                        .collect();
                    cell::stiffness(dim, &points, element, material, &mut stiffness);
                    for (p, &row) in dofs.iter().enumerate() {
                        for (q, &col) in dofs.iter().enumerate().filter(|(_, &col)| col <= row) {
                            if !held(row / dim) && !held(col / dim) {
                                triplets.push(Triplet::new(row, col, stiffness[p * size + q]));
                            }
                        }
                    }
                    if i + 1 < nx {
                        continue;
                    }
                    let end = cell::Side {
                        axis: 0,
                        upper: true,
                    };
                    let points: Vec<_> = end.corners(dim).map(|a| points[a]).collect();
                    let weights = cell::side_weights(dim, &points, end.outward(dim), element);
                    for (a, share) in end.corners(dim).zip(weights.area) {
                        load[dim * self.node(corner(a)) + 1] += share;
                        area += share;
                    }
                }
            }
        }
        for node in (0..nodes).filter(|&n| held(n)) {
            for dof in dim * node..dim * (node + 1) {
                triplets.push(Triplet::new(dof, dof, 1.0));
            }
        }
        let n = dim * nodes;
        let k = SparseColMat::try_new_from_triplets(n, n, &triplets).expect("indices in range");
        let rhs = Mat::from_fn(n, 1, |dof, _| load[dof] / area);
        let u = k
            .sp_cholesky(Side::Lower)
            .expect("a positive definite matrix")
            .solve(&rhs);
        (0..n).map(|dof| u[(dof, 0)] * load[dof]).sum::<f64>() / area
    }
}

fn elastic(poisson: f64, cure: Cure) -> Material {
    Material::Elastic {
        law: Law::Isotropic {
            young: 1.0,
            poisson,
        },
        plane: Plane::Strain,
        cure,
    }
}

fn table(name: &str, block: fn(usize) -> Block, sizes: &[usize], fine: usize) {
    for poisson in [0.3, 0.4999] {
        let reference = block(fine).deflection(Element::Q1, &elastic(poisson, Cure::BBar));
        println!(
            "\n{name}, nu = {poisson}: deflection {reference:.5e} with B-bar and n = {fine}\n"
        );
        println!("| n | Q1 | Q1, selective | Q1, B-bar | P1 |");
        println!("|---|---|---|---|---|");
        for &n in sizes {
            let part = |element: Element, cure: Cure| {
                block(n).deflection(element, &elastic(poisson, cure)) / reference
            };
            println!(
                "| {n} | {:.4} | {:.4} | {:.4} | {:.4} |",
                part(Element::Q1, Cure::None),
                part(Element::Q1, Cure::Selective),
                part(Element::Q1, Cure::BBar),
                part(Element::P1, Cure::None),
            );
        }
    }
}

fn main() {
    table("Cook's membrane", Block::cook, &[4, 8, 16, 32, 64], 256);
    table("Beam", Block::beam, &[2, 4, 8], 16);
}
