//! Stiffness and load of one subdomain.

use super::q1;
use crate::mesh::SubdomainMesh;
use crate::sparse::Csr;

/// How loads are integrated over an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quadrature {
    /// One point in the middle: regions that follow element borders are exact.
    #[default]
    Midpoint,
    /// The 2 × 2 Gauss rule.
    Gauss,
}

/// The nodal load ∫ f N_a over the subdomain, length (nx + 1)(ny + 1); `f` is given element and point.
pub fn load_vector<F>(mesh: &SubdomainMesh, quadrature: Quadrature, mut f: F) -> Vec<f64>
where
    F: FnMut([usize; 2], [f64; 2]) -> f64,
{
    let [dx, dy] = mesh.step;
    let [nx, ny] = mesh.elements;
    let mut out = vec![0.0; mesh.points.len()];
    for place in (0..ny).flat_map(|j| (0..nx).map(move |i| [i, j])) {
        let nodes = mesh.element_nodes(place);
        let [x, y] = mesh.points[nodes[0]];
        match quadrature {
            Quadrature::Midpoint => {
                let quarter = f(place, [x + 0.5 * dx, y + 0.5 * dy]) * (0.25 * dx * dy);
                for node in nodes {
                    out[node] += quarter;
                }
            }
            Quadrature::Gauss => {
                for (t, wt) in q1::GAUSS2 {
                    for (s, ws) in q1::GAUSS2 {
                        let value = f(place, [x + s * dx, y + t * dy]) * (ws * wt * dx * dy);
                        for (node, shape) in nodes.into_iter().zip(q1::shape(s, t)) {
                            out[node] += value * shape;
                        }
                    }
                }
            }
        }
    }
    out
}

/// K^(ij) on the free dofs, and the load with the prescribed values eliminated: f_F − K_FD u_D.
///
/// `load` is nodal, length (nx + 1)(ny + 1). A node's row is the sum over the (at most four) elements around it, so
/// the rows come out in order and sorted, and nothing has to be searched.
pub fn assemble(mesh: &SubdomainMesh, load: &[f64]) -> (Csr, Vec<f64>) {
    let [dx, dy] = mesh.step;
    let [nx, ny] = mesh.elements;
    let width = nx + 1;
    let element = q1::stiffness(dx, dy);
    let n = mesh.n_free();
    let mut k = Csr {
        row_ptr: Vec::with_capacity(n + 1),
        col: Vec::with_capacity(9 * n),
        val: Vec::with_capacity(9 * n),
    };
    k.row_ptr.push(0);
    let mut f = Vec::with_capacity(n);
    for j in 0..=ny {
        for i in 0..=nx {
            let node = j * width + i;
            if mesh.dof[node] == SubdomainMesh::PRESCRIBED {
                continue;
            }
            let stencil = stencil(mesh, &element, [i, j]);
            let mut load_here = load[node];
            for (q, &value) in stencil.iter().enumerate() {
                let (p, q) = (i + q % 3, j + q / 3);
                if p < 1 || q < 1 || p > nx + 1 || q > ny + 1 {
                    continue;
                }
                let other = (q - 1) * width + (p - 1);
                if mesh.dof[other] == SubdomainMesh::PRESCRIBED {
                    load_here -= value * mesh.prescribed[other];
                } else {
                    k.col.push(mesh.dof[other]);
                    k.val.push(value);
                }
            }
            k.row_ptr.push(k.col.len());
            f.push(load_here);
        }
    }
    (k, f)
}

/// The load of [`assemble`] alone, to the last bit.
pub fn free_load(mesh: &SubdomainMesh, load: &[f64]) -> Vec<f64> {
    let element = q1::stiffness(mesh.step[0], mesh.step[1]);
    let [nx, ny] = mesh.elements;
    let width = nx + 1;
    let mut f = Vec::with_capacity(mesh.n_free());
    let given = |node: usize| mesh.dof[node] == SubdomainMesh::PRESCRIBED;
    for node in (0..mesh.dof.len()).filter(|&n| !given(n)) {
        let (i, j) = (node % width, node / width);
        let mut load_here = load[node];
        // The stencil is wanted beside given nodes only.
        let mut values = None;
        for q in 0..9 {
            let (p, r) = (i + q % 3, j + q / 3);
            if p < 1 || r < 1 || p > nx + 1 || r > ny + 1 {
                continue;
            }
            let other = (r - 1) * width + (p - 1);
            if given(other) {
                let values = values.get_or_insert_with(|| stencil(mesh, &element, [i, j]));
                load_here -= values[q] * mesh.prescribed[other];
            }
        }
        f.push(load_here);
    }
    f
}

/// Entry 3 (1 + Δj) + (1 + Δi) is the coupling of node (i, j) with the node at offset (Δi, Δj).
#[inline]
fn stencil(mesh: &SubdomainMesh, element: &[[f64; 4]; 4], [i, j]: [usize; 2]) -> [f64; 9] {
    let [nx, ny] = mesh.elements;
    let mut stencil = [0.0; 9];
    for (a, coupling) in element.iter().enumerate() {
        // In the element below and to the left of the node (a = 3) the node is local node 3, and so on.
        let (ax, ay) = (a % 2, a / 2);
        if i < ax || j < ay || i - ax >= nx || j - ay >= ny {
            continue;
        }
        let rho = mesh.rho[(j - ay) * nx + (i - ax)];
        for (b, value) in coupling.iter().enumerate() {
            let (bx, by) = (b % 2, b / 2);
            stencil[3 * (1 + by - ay) + (1 + bx - ax)] += rho * value;
        }
    }
    stencil
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A 3 × 2 mesh of elements 0.5 × 0.25 with varying ρ; the nodes in `fixed` carry the given values.
    fn mesh(fixed: &[(usize, f64)]) -> SubdomainMesh {
        let elements = [3, 2];
        let step = [0.5, 0.25];
        let n = 12;
        let mut dof = vec![0; n];
        let mut prescribed = vec![0.0; n];
        for &(node, value) in fixed {
            dof[node] = SubdomainMesh::PRESCRIBED;
            prescribed[node] = value;
        }
        let mut next = 0;
        for d in &mut dof {
            if *d != SubdomainMesh::PRESCRIBED {
                *d = next;
                next += 1;
            }
        }
        SubdomainMesh {
            index: 0,
            body: 0,
            elements,
            step,
            points: (0..n)
                .map(|k| [(k % 4) as f64 * step[0], (k / 4) as f64 * step[1]])
                .collect(),
            dof,
            prescribed,
            rho: (0..6).map(|e| 1.0 + e as f64).collect(),
        }
    }

    #[test]
    fn the_matrix_is_the_sum_of_element_matrices() {
        let m = mesh(&[]);
        let (k, f) = assemble(&m, &[0.0; 12]);
        let mut dense = [[0.0; 12]; 12];
        let element = q1::stiffness(0.5, 0.25);
        for e in 0..6 {
            let nodes = m.element_nodes([e % 3, e / 3]);
            for a in 0..4 {
                for b in 0..4 {
                    dense[nodes[a]][nodes[b]] += m.rho[e] * element[a][b];
                }
            }
        }
        assert_eq!(f, vec![0.0; 12]);
        for (i, row) in dense.iter().enumerate() {
            let (col, _) = k.row(i);
            assert!(col.windows(2).all(|w| w[0] < w[1]));
            for (j, &value) in row.iter().enumerate() {
                assert!((k.get(i, j) - value).abs() < 1e-13);
                assert_eq!(k.get(i, j), k.get(j, i));
            }
        }
    }

    #[test]
    fn constants_are_in_the_kernel_of_a_floating_subdomain() {
        let (k, _) = assemble(&mesh(&[]), &[0.0; 12]);
        let mut y = [0.0; 12];
        k.mul(&[1.0; 12], &mut y);
        assert!(y.iter().all(|v| v.abs() < 1e-13), "{y:?}");
    }

    #[test]
    fn linear_functions_pass_the_patch_test() {
        // ρ = 1: with u = 1 + 2x − 3y prescribed on the boundary, K_FF u_F = f_F for the two inner nodes.
        let linear = |p: [f64; 2]| 1.0 + 2.0 * p[0] - 3.0 * p[1];
        let plain = mesh(&[]);
        let fixed: Vec<(usize, f64)> = (0..12)
            .filter(|k| ![5, 6].contains(k))
            .map(|k| (k, linear(plain.points[k])))
            .collect();
        let mut m = mesh(&fixed);
        m.rho = vec![1.0; 6];
        let (k, f) = assemble(&m, &[0.0; 12]);
        assert_eq!(k.n(), 2);
        let u = m.free(&m.points.iter().map(|&p| linear(p)).collect::<Vec<_>>());
        let mut y = [0.0; 2];
        k.mul(&u, &mut y);
        assert!((y[0] - f[0]).abs() < 1e-13 && (y[1] - f[1]).abs() < 1e-13);
        assert_eq!(m.nodal(&u)[6], linear(m.points[6]));
    }

    #[test]
    fn both_rules_integrate_what_they_should() {
        let m = mesh(&[]);
        let area = 1.5 * 0.5;
        for rule in [Quadrature::Midpoint, Quadrature::Gauss] {
            let total: f64 = load_vector(&m, rule, |_, _| 2.0).iter().sum();
            assert!((total - 2.0 * area).abs() < 1e-14);
        }
        // ∫ x² over [0, 1.5] × [0, 0.5], exact with two Gauss points only.
        let exact = 1.5_f64.powi(3) / 3.0 * 0.5;
        let total: f64 = load_vector(&m, Quadrature::Gauss, |_, p| p[0] * p[0])
            .iter()
            .sum();
        assert!((total - exact).abs() < 1e-14);
    }
}
