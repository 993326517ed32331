//! For the tests of elements: distorted cells, small meshes of every kind, assembly and a direct solver.

use super::map::interpolate_position;
use super::shape_functions::{reference_nodes, shape};
use super::{stiffness, Integration};
use crate::cell::{Cure, Material, Plane};
use crate::kind::CellKind;
use crate::law::{Constants, Law, Transverse};
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use std::collections::HashMap;

/// Numbers in \[−1, 1\), the same for the same seed.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// The kinds that are cells of the plane or of space.
pub fn solid_kinds() -> impl Iterator<Item = CellKind> {
    CellKind::ALL.into_iter().filter(|kind| kind.dim() >= 2)
}

pub fn elastic(young: f64, poisson: f64, plane: Plane, cure: Cure) -> Material {
    Material::Elastic {
        law: Law::Isotropic { young, poisson },
        plane,
        cure,
    }
}

pub const STEEL: Material = Material::Elastic {
    law: Law::Isotropic {
        young: 3.0,
        poisson: 0.3,
    },
    plane: Plane::Strain,
    cure: Cure::None,
};

/// Fibres in the plane, along no axis.
pub fn fibres(plane: Plane) -> Material {
    let fibres = Transverse {
        young: [14.0, 1.0],
        poisson: [0.3, 0.4],
        shear: 0.5,
    };
    let axes = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
    Material::Elastic {
        law: Law::General(fibres.tangent().expect("a sound law").along(&axes)),
        plane,
        cure: Cure::None,
    }
}

/// Every material and integration that a kind takes.
pub fn combinations(kind: CellKind) -> Vec<(Material, Integration)> {
    let mut all = Vec::new();
    let mut materials = vec![Material::Scalar { rho: 2.5 }];
    for plane in [Plane::Strain, Plane::Stress] {
        for cure in [Cure::None, Cure::Selective, Cure::BBar] {
            for poisson in [0.0, 0.3, 0.4999] {
                materials.push(elastic(3.0, poisson, plane, cure));
            }
        }
    }
    materials.push(fibres(Plane::Strain));
    materials.push(fibres(Plane::Stress));
    for material in materials {
        for integration in INTEGRATIONS {
            if super::check(kind, kind.dim(), &material, integration).is_ok() {
                all.push((material, integration));
            }
        }
    }
    all
}

pub const INTEGRATIONS: [Integration; 3] = [
    Integration::Full,
    Integration::Reduced,
    Integration::Incompatible,
];

/// A point inside the reference cell.
pub fn inside(kind: CellKind, random: &mut Random) -> [f64; 3] {
    // A positive combination of the corners.
    let nodes = reference_nodes(kind);
    let weights: Vec<f64> = (0..kind.corners())
        .map(|_| 0.05 + random.next().powi(2))
        .collect();
    let sum: f64 = weights.iter().sum();
    let weights: Vec<f64> = weights.into_iter().map(|w| w / sum).collect();
    interpolate_position(&nodes[..kind.corners()], &weights)
}

/// The reference cell, stretched, and with every node moved.
pub fn distorted(kind: CellKind, seed: u64) -> Vec<[f64; 3]> {
    moved(kind, seed, 0.08)
}

/// The reference cell under an affine map.
pub fn affine(kind: CellKind) -> Vec<[f64; 3]> {
    let flat = kind.dim() == 2;
    let map = |[x, y, z]: [f64; 3]| {
        [
            1.0 + 0.8 * x + 0.2 * y + 0.1 * z,
            -2.0 - 0.1 * x + 1.2 * y + 0.3 * z,
            if flat {
                0.0
            } else {
                0.2 * x - 0.1 * y + 0.7 * z
            },
        ]
    };
    reference_nodes(kind).into_iter().map(map).collect()
}

/// A cell with straight edges: only the corners are moved.
pub fn straight(kind: CellKind, seed: u64) -> Vec<[f64; 3]> {
    let corners = distorted(kind.linear(), seed);
    let nodes = reference_nodes(kind);
    let at = |&node: &[f64; 3]| interpolate_position(&corners, &shape(kind.linear(), node).value);
    nodes.iter().map(at).collect()
}

fn moved(kind: CellKind, seed: u64, by: f64) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    let mut points = affine(kind);
    for point in &mut points {
        for x in &mut point[..kind.dim()] {
            *x += by * random.next();
        }
    }
    points
}

pub fn matrix(
    kind: CellKind,
    points: &[[f64; 3]],
    material: &Material,
    integration: Integration,
) -> Mat<f64> {
    let dim = kind.dim();
    let n = points.len() * material.components(dim);
    let mut k = vec![f64::NAN; n * n];
    stiffness(kind, dim, points, material, integration, &mut k);
    Mat::from_fn(n, n, |i, j| k[i * n + j])
}

/// How a cell of a grid is cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cut {
    Whole,
    /// Two triangles or six tetrahedra.
    Simplices,
    /// Two wedges; their triangles are at the bottom and at the top.
    Wedges,
    /// Six pyramids around the middle.
    Pyramids,
    /// Pyramids around the middle, but two tetrahedra on the side at x = 1.
    PyramidsAndTetrahedra,
}

/// How each cell of a grid is cut, by its place.
pub type Cuts = fn([usize; 3]) -> Cut;

/// Which nodes of second order there are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    First,
    /// With nodes in the middle of edges only.
    Serendipity,
    /// Also in the middle of quadrilaterals and hexahedra.
    Second,
}

/// A mesh of the unit square or cube, or of an image of it.
pub struct Mesh {
    pub dim: usize,
    pub points: Vec<[f64; 3]>,
    pub cells: Vec<(CellKind, Vec<usize>)>,
    pub boundary: Vec<bool>,
}

impl Mesh {
    /// A grid of n cells per direction, each cut as `cut` says. `map` moves the corners; other nodes are in the middle.
    pub fn new(
        dim: usize,
        n: usize,
        order: Order,
        cut: impl Fn([usize; 3]) -> Cut,
        mut map: impl FnMut([f64; 3]) -> [f64; 3],
    ) -> Mesh {
        let mut mesh = Mesh::corners(dim, n, cut);
        mesh.mark_boundary();
        let mut moved: Vec<[f64; 3]> = mesh.points.iter().map(|&p| map(p)).collect();
        mesh.raise(order);
        // Middle nodes of the moved mesh: the same mean of corners.
        let sources = mesh.middle_sources();
        for around in sources {
            let mean = |d: usize| around.iter().map(|&p: &usize| moved[p][d]).sum::<f64>();
            let point = [0, 1, 2].map(|d| mean(d) / around.len() as f64);
            moved.push(point);
        }
        assert_eq!(moved.len(), mesh.points.len());
        mesh.mark_boundary();
        mesh.points = moved;
        mesh
    }

    /// A grid of n cells per direction, each cut as `cut` says. `map` moves all nodes: cells are curved.
    pub fn curved(
        dim: usize,
        n: usize,
        order: Order,
        cut: impl Fn([usize; 3]) -> Cut,
        map: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Mesh {
        let mut mesh = Mesh::corners(dim, n, cut);
        mesh.raise(order);
        mesh.mark_boundary();
        mesh.points = mesh.points.iter().map(|&p| map(p)).collect();
        mesh
    }

    fn corners(dim: usize, n: usize, cut: impl Fn([usize; 3]) -> Cut) -> Mesh {
        let size = [n, n, if dim == 2 { 0 } else { n }];
        let index = |i: usize, j: usize, k: usize| (k * (n + 1) + j) * (n + 1) + i;
        let mut mesh = Mesh {
            dim,
            points: Vec::new(),
            cells: Vec::new(),
            boundary: Vec::new(),
        };
        for k in 0..=size[2] {
            for j in 0..=n {
                for i in 0..=n {
                    mesh.points.push([i, j, k].map(|c| c as f64 / n as f64));
                }
            }
        }
        for k in 0..size[2].max(1) {
            for j in 0..n {
                for i in 0..n {
                    let ring = |k| {
                        [
                            index(i, j, k),
                            index(i + 1, j, k),
                            index(i + 1, j + 1, k),
                            index(i, j + 1, k),
                        ]
                    };
                    let cut = cut([i, j, k]);
                    if dim == 2 {
                        mesh.add_square(ring(0), cut);
                    } else {
                        let [a, b, c, d] = ring(k);
                        let [e, f, g, h] = ring(k + 1);
                        mesh.add_cube([a, b, c, d, e, f, g, h], cut);
                    }
                }
            }
        }
        mesh
    }

    fn add_square(&mut self, [a, b, c, d]: [usize; 4], cut: Cut) {
        if cut == Cut::Whole {
            self.cells.push((CellKind::Quad4, vec![a, b, c, d]));
        } else {
            self.cells.push((CellKind::Triangle3, vec![a, b, c]));
            self.cells.push((CellKind::Triangle3, vec![a, c, d]));
        }
    }

    fn add_cube(&mut self, v: [usize; 8], cut: Cut) {
        let mut add = |kind: CellKind, nodes: &[usize]| self.cells.push((kind, nodes.to_vec()));
        let [a, b, c, d, e, f, g, h] = v;
        match cut {
            Cut::Whole => add(CellKind::Hex8, &v),
            Cut::Wedges => {
                add(CellKind::Wedge6, &[a, b, c, e, f, g]);
                add(CellKind::Wedge6, &[a, c, d, e, g, h]);
            }
            Cut::Simplices => {
                // Around the diagonal from a to g, along the edges.
                for [p, q] in [[b, c], [c, d], [d, h], [h, e], [e, f], [f, b]] {
                    add(CellKind::Tet4, &[a, p, q, g]);
                }
            }
            Cut::Pyramids | Cut::PyramidsAndTetrahedra => {
                let sum = |i: usize| v.iter().map(|&p| self.points[p][i]).sum::<f64>();
                let middle = [0, 1, 2].map(|i| sum(i) / 8.0);
                let apex = self.points.len();
                for (s, side) in CellKind::Hex8.sides().iter().enumerate() {
                    // Seen from inside the side is the other way round.
                    let base: Vec<usize> = side
                        .nodes
                        .iter()
                        .rev()
                        .map(|&p| v[usize::from(p)])
                        .collect();
                    let [p, q, r, t] = base[..] else {
                        unreachable!()
                    };
                    if s == 3 && cut == Cut::PyramidsAndTetrahedra {
                        add(CellKind::Tet4, &[p, q, r, apex]);
                        add(CellKind::Tet4, &[p, r, t, apex]);
                    } else {
                        add(CellKind::Pyramid5, &[p, q, r, t, apex]);
                    }
                }
                self.points.push(middle);
            }
        }
    }

    /// Adds the nodes of second order.
    fn raise(&mut self, order: Order) {
        if order == Order::First {
            return;
        }
        let mut middles: HashMap<Vec<usize>, usize> = HashMap::new();
        for (kind, nodes) in &mut self.cells {
            let second = match (*kind, order) {
                (CellKind::Triangle3, _) => CellKind::Triangle6,
                (CellKind::Tet4, _) => CellKind::Tet10,
                (CellKind::Wedge6, _) => CellKind::Wedge15,
                (CellKind::Quad4, Order::Second) => CellKind::Quad9,
                (CellKind::Quad4, _) => CellKind::Quad8,
                (CellKind::Hex8, Order::Second) => CellKind::Hex27,
                (CellKind::Hex8, _) => CellKind::Hex20,
                (kind, _) => panic!("no second order of a {}", kind.name()),
            };
            let corners = nodes.clone();
            let reference = reference_nodes(second);
            for at in &reference[kind.nodes()..] {
                // The corners on whose mean the node lies: those that its linear functions do not leave out.
                let weights = shape(*kind, *at).value;
                let mut around: Vec<usize> = (0..corners.len())
                    .filter(|&a| weights[a] > 1e-9)
                    .map(|a| corners[a])
                    .collect();
                around.sort_unstable();
                let place = *middles.entry(around.clone()).or_insert_with(|| {
                    let sum = |d: usize| around.iter().map(|&p| self.points[p][d]).sum::<f64>();
                    let mean = [0, 1, 2].map(|d| sum(d) / around.len() as f64);
                    self.points.push(mean);
                    self.points.len() - 1
                });
                nodes.push(place);
            }
            *kind = second;
        }
    }

    /// For each middle node, in order, the corners around it.
    fn middle_sources(&self) -> Vec<Vec<usize>> {
        let mut sources: HashMap<usize, Vec<usize>> = HashMap::new();
        for (kind, nodes) in &self.cells {
            let reference = reference_nodes(*kind);
            for a in kind.corners()..kind.nodes() {
                let weights = shape(kind.linear(), reference[a]).value;
                let around = (0..kind.corners())
                    .filter(|&c| weights[c] > 1e-9)
                    .map(|c| nodes[c]);
                sources.insert(nodes[a], around.collect());
            }
        }
        let mut sources: Vec<_> = sources.into_iter().collect();
        sources.sort_unstable();
        sources.into_iter().map(|(_, around)| around).collect()
    }

    fn mark_boundary(&mut self) {
        let dim = self.dim;
        let on = |p: &[f64; 3]| p[..dim].iter().any(|x| !(1e-9..1.0 - 1e-9).contains(x));
        self.boundary = self.points.iter().map(on).collect();
    }

    pub fn cell_points(&self, nodes: &[usize]) -> Vec<[f64; 3]> {
        nodes.iter().map(|&p| self.points[p]).collect()
    }

    /// The solution whose values on the boundary are those of `given`, with the body force `force`: by a sparse
    /// Cholesky factorisation.
    pub fn solve(
        &self,
        material: &Material,
        integration: Integration,
        given: impl Fn([f64; 3]) -> [f64; 3],
        force: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Vec<f64> {
        let c = material.components(self.dim);
        let n = c * self.points.len();
        let mut u = vec![0.0; n];
        let (mut number, mut free) = (vec![usize::MAX; n], 0);
        for (p, point) in self.points.iter().enumerate() {
            for i in 0..c {
                if self.boundary[p] {
                    u[c * p + i] = given(*point)[i];
                } else {
                    number[c * p + i] = free;
                    free += 1;
                }
            }
        }
        let mut right = Mat::<f64>::zeros(free, 1);
        let mut triplets = Vec::new();
        for (kind, nodes) in &self.cells {
            let points = self.cell_points(nodes);
            let dofs: Vec<usize> = nodes
                .iter()
                .flat_map(|p| (0..c).map(move |i| c * p + i))
                .collect();
            let integration = match super::check(*kind, self.dim, material, integration) {
                Ok(()) => integration,
                Err(_) => Integration::Full,
            };
            let k = matrix(*kind, &points, material, integration);
            let mut load = vec![0.0; dofs.len()];
            super::body_load(*kind, self.dim, &points, c, &force, &mut load);
            for (i, &row) in dofs.iter().enumerate() {
                if number[row] == usize::MAX {
                    continue;
                }
                right[(number[row], 0)] += load[i];
                for (j, &col) in dofs.iter().enumerate() {
                    if number[col] == usize::MAX {
                        right[(number[row], 0)] -= k[(i, j)] * u[col];
                    } else {
                        triplets.push(Triplet::new(number[row], number[col], k[(i, j)]));
                    }
                }
            }
        }
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(free, free, &triplets)
            .expect("a matrix");
        let factor = matrix.sp_cholesky(Side::Lower).expect("positive definite");
        let solution = factor.solve(&right);
        for (x, &number) in u.iter_mut().zip(&number) {
            if number != usize::MAX {
                *x = solution[(number, 0)];
            }
        }
        u
    }
}
