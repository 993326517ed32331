//! Unit tests of `crates/scene/src/assembly/recovery.rs`.

use super::*;
use elements::cell::{Cure, Plane};
use elements::form::{Form, Physics};
use mesh::Cells;
use std::collections::HashMap;

/// The unit square or cube of n^D cells, each cut into simplices of second order, its inner nodes moved a little; cells
/// stay affine.
fn simplices(dim: usize, n: usize) -> SubdomainMesh {
    let corner = |p: [usize; 3]| -> [f64; 3] {
        let inner = (0..dim).all(|d| p[d] > 0 && p[d] < n);
        let wave = |d: usize| ((3 * p[d] + 5 * p[(d + 1) % dim] + 7 * d) as f64).sin();
        let shift = |d: usize| if inner { 0.15 * wave(d) } else { 0.0 };
        [0, 1, 2].map(|d| {
            if d < dim {
                (p[d] as f64 + shift(d)) / n as f64
            } else {
                0.0
            }
        })
    };
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut known: HashMap<[[usize; 3]; 2], u32> = HashMap::new();
    let mut node = |a: [usize; 3], b: [usize; 3]| -> u32 {
        *known.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            let (p, q) = (corner(a), corner(b));
            points.push([0, 1, 2].map(|d| 0.5 * (p[d] + q[d])));
            points.len() as u32 - 1
        })
    };
    let kind = [CellKind::Triangle6, CellKind::Tet10][dim - 2];
    // Kuhn's simplices: a way along the axes in every order, even orders first turned to the left.
    let orders: &[(&[usize], bool)] = match dim {
        2 => &[(&[0, 1], true), (&[1, 0], false)],
        _ => &[
            (&[0, 1, 2], true),
            (&[1, 2, 0], true),
            (&[2, 0, 1], true),
            (&[0, 2, 1], false),
            (&[2, 1, 0], false),
            (&[1, 0, 2], false),
        ],
    };
    let mut cells = Cells::default();
    for k in 0..n.pow(dim as u32) {
        let at = [k % n, k / n % n, k / (n * n)];
        for (order, left) in orders {
            let mut way = vec![at];
            for &d in *order {
                let mut next = way[way.len() - 1];
                next[d] += 1;
                way.push(next);
            }
            if !left {
                way.swap(0, 1);
            }
            let mut nodes: Vec<u32> = way.iter().map(|&p| node(p, p)).collect();
            let edges = kind.edges().iter();
            nodes.extend(edges.map(|e| node(way[usize::from(e[0])], way[usize::from(e[1])])));
            cells.push(kind, &nodes);
        }
    }
    let form = Form {
        physics: Physics::Elasticity {
            plane: Plane::Strain,
            cure: Cure::None,
        },
        ..Form::default()
    };
    SubdomainMesh {
        index: 0,
        body: 0,
        dim,
        form,
        rho: vec![2.0; cells.len()],
        poisson: vec![0.3; cells.len()],
        laws: Default::default(),
        heat: None,
        elements: SubdomainElements::Cells(cells),
        dof: (0..(dim * points.len()) as u32).collect(),
        prescribed: vec![0.0; dim * points.len()],
        points,
        integration: Vec::new(),
        spring: Vec::new(),
    }
}

/// The stress of a gradient in plane strain or space, E = 2, ν = 0.3.
fn hooke(g: [[f64; 3]; 3]) -> [f64; 6] {
    let (lambda, mu) = (2.0 * 0.3 / (1.3 * 0.4), 1.0 / 1.3);
    let trace = g[0][0] + g[1][1] + g[2][2];
    let normal = |i: usize| lambda * trace + 2.0 * mu * g[i][i];
    let shear = |i: usize, j: usize| mu * (g[i][j] + g[j][i]);
    [
        normal(0),
        normal(1),
        normal(2),
        shear(0, 1),
        shear(1, 2),
        shear(0, 2),
    ]
}

/// The largest error, and the root of the mean square, of averaged stress at the nodes.
fn errors(
    mesh: &SubdomainMesh,
    u: impl Fn([f64; 3]) -> [f64; 3],
    gradient: impl Fn([f64; 3]) -> [[f64; 3]; 3],
) -> [f64; 2] {
    let nodal: Vec<f64> = mesh
        .points
        .iter()
        .flat_map(|&p| u(p)[..mesh.dim].to_vec())
        .collect();
    let mut sums = vec![NodalStressSum::default(); mesh.points.len()];
    let cells = mesh.cells();
    let mut total = 0.0;
    for_each_cell(mesh, &nodal, |e, volume, at| {
        assert!(volume > 0.0);
        total += volume;
        for (&k, node) in cells.nodes(e).iter().zip(at) {
            sums[k as usize].add(volume, node);
        }
    });
    assert!((total - 1.0).abs() < 1e-12);
    let (mut worst, mut square) = (0.0_f64, 0.0);
    for (sum, &p) in sums.iter().zip(&mesh.points) {
        let (found, exact) = (sum.mean().stress, hooke(gradient(p)));
        for (a, b) in found.iter().zip(exact) {
            worst = worst.max((a - b).abs());
            square += (a - b).powi(2) / sums.len() as f64;
        }
    }
    [worst, square.sqrt()]
}

#[test]
fn linear_stress_is_exact() {
    for dim in [2, 3] {
        let flat = if dim == 2 { 0.0 } else { 1.0 };
        let u = |[x, y, z]: [f64; 3]| {
            let last = flat * (y * z - 2.0 * x * z + z * z);
            [x * x - 3.0 * x * y + y, 2.0 * y * y + x * y + z * x, last]
        };
        let gradient = |[x, y, z]: [f64; 3]| {
            [
                [2.0 * x - 3.0 * y, -3.0 * x + 1.0, 0.0],
                [y + z, 4.0 * y + x, flat * x],
                [-2.0 * z * flat, z * flat, flat * (y - 2.0 * x + 2.0 * z)],
            ]
        };
        let [worst, _] = errors(&simplices(dim, 3), u, gradient);
        assert!(worst < 1e-11, "{dim}: {worst}");
    }
}

#[test]
fn recovered_stress_converges_with_the_square_of_the_size() {
    let u = |[x, y, z]: [f64; 3]| {
        let [a, b] = [(2.0 * x + y).sin(), (x - y).cos()];
        [a + z * x, b * (1.0 + z), a * z]
    };
    let gradient = |dim: usize| {
        move |[x, y, z]: [f64; 3]| {
            let ([s, c], [p, q]) = (
                [(2.0 * x + y).sin(), (2.0 * x + y).cos()],
                [(x - y).sin(), (x - y).cos()],
            );
            let f = if dim == 2 { 0.0 } else { 1.0 };
            [
                [2.0 * c + z, c, f * x],
                [-p * (1.0 + z), p * (1.0 + z), f * q],
                [f * 2.0 * c * z, f * c * z, f * s],
            ]
        }
    };
    for (dim, sizes) in [(2, [8, 16]), (3, [4, 8])] {
        let all = sizes.map(|n| errors(&simplices(dim, n), u, gradient(dim)));
        let order = (all[0][1] / all[1][1]).log2();
        assert!(order > 1.8, "{dim}: {all:?}, order {order}");
        // Stresses are of the size of 5.
        assert!(all[1][1] < 0.04, "{dim}: {all:?}");
    }
}

#[test]
fn sums_are_means_by_weight() {
    let node = |s: f64| NodeStress {
        strain: [s; 6],
        stress: [2.0 * s; 6],
    };
    let (mut one, mut other) = (NodalStressSum::default(), NodalStressSum::default());
    one.add(1.0, &node(4.0));
    other.add(3.0, &node(8.0));
    one.merge(&other);
    assert_eq!(one.mean(), node(7.0));
    assert_eq!(NodalStressSum::default().mean(), NodeStress::default());
}
