//! Unit tests of `src/embed/nullspace.rs`.

use super::*;
use crate::matrices::grid_laplacian;

/// A truss in the plane: bars of stiffness one between nodes, two components a node.
fn truss(nodes: &[[f64; 2]], bars: &[(usize, usize)]) -> Csr {
    let mut triplets = Vec::new();
    for &(a, b) in bars {
        let along = [0, 1].map(|d| nodes[b][d] - nodes[a][d]);
        let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
        for (s, i) in [(1.0, a), (-1.0, b)] {
            for (t, j) in [(1.0, a), (-1.0, b)] {
                for (d, x) in along.iter().enumerate() {
                    for (e, y) in along.iter().enumerate() {
                        let value = s * t * x * y / (length * length);
                        triplets.push(((2 * i + d) as u32, (2 * j + e) as u32, value));
                    }
                }
            }
        }
    }
    Csr::from_triplets(2 * nodes.len(), &triplets)
}

/// Rows of triangles between two lines of nodes, from `x` on.
fn strip(nodes: &mut Vec<[f64; 2]>, bars: &mut Vec<(usize, usize)>, x: f64, cells: usize) {
    let first = nodes.len();
    for i in 0..=cells {
        let at = first + 2 * i;
        nodes.extend([[x + i as f64, 0.1], [x + i as f64, 1.0]]);
        bars.push((at, at + 1));
        if i > 0 {
            bars.extend([(at - 2, at), (at - 1, at + 1), (at - 2, at + 1)]);
        }
    }
}

fn size_of_kernel(k: &Csr, guess: &KernelVectors) -> usize {
    let found = kernel(k, guess).unwrap();
    let mut y = vec![0.0; k.n()];
    let stiffest = k.diagonal().into_iter().fold(0.0, f64::max);
    for v in &found {
        k.mul(v, &mut y);
        let largest = y.iter().fold(0.0f64, |a, y| a.max(y.abs()));
        assert!(largest < 1e-11 * stiffest, "{largest:e}");
    }
    found.len()
}

#[test]
fn a_mechanism_is_found_beside_the_rigid_motions() {
    let (mut nodes, mut bars) = (Vec::new(), Vec::new());
    strip(&mut nodes, &mut bars, 0.0, 9);
    assert_eq!(
        size_of_kernel(&truss(&nodes, &bars), &KernelVectors::new()),
        3
    );
    // A second strip hangs by one bar that turns at both ends, a third one by a common node.
    let end = nodes.len() - 1;
    strip(&mut nodes, &mut bars, 12.0, 4);
    bars.push((end, end + 1));
    assert_eq!(
        size_of_kernel(&truss(&nodes, &bars), &KernelVectors::new()),
        5
    );
    let end = nodes.len() - 1;
    let far = nodes.len();
    nodes.extend([[20.0, 3.0], [21.0, 3.0]]);
    bars.extend([(end, far), (end, far + 1), (far, far + 1)]);
    let k = truss(&nodes, &bars);
    assert_eq!(size_of_kernel(&k, &KernelVectors::new()), 6);
    // Known motions shorten the work and change nothing.
    let translation = |d: usize| {
        (0..k.n())
            .map(|i| f64::from(u8::from(i % 2 == d)))
            .collect()
    };
    assert_eq!(size_of_kernel(&k, &vec![translation(0), translation(1)]), 6);
    // So do wrong ones.
    let wrong = (0..k.n()).map(|i| (i * i % 17) as f64).collect();
    assert_eq!(size_of_kernel(&k, &vec![wrong]), 6);
}

#[test]
fn a_weak_spring_holds() {
    for (spring, expected) in [(0.0, 1), (1e-8, 0), (1.0, 0)] {
        let (mut k, _) = grid_laplacian(20, 30, 0.0);
        let at = k.row_ptr[77] + k.row(77).0.iter().position(|&j| j == 77).unwrap();
        k.val[at] += spring;
        let ones = vec![vec![1.0; k.n()]];
        for guess in [&KernelVectors::new(), &ones] {
            assert_eq!(size_of_kernel(&k, guess), expected, "spring {spring:e}");
        }
    }
}

#[test]
fn soft_parts_are_no_motions() {
    // Every node is alone in its softness: pivots of 1e-6 of the diagonal.
    let (mut k, _) = grid_laplacian(12, 12, 0.0);
    let factor = |i: usize| if i % 5 == 0 { 1e3 } else { 1.0 };
    for i in 0..k.n() {
        for at in k.row_ptr[i]..k.row_ptr[i + 1] {
            k.val[at] *= factor(i) * factor(k.col[at] as usize);
        }
    }
    // K = D L D has the kernel D⁻¹ 1.
    assert_eq!(size_of_kernel(&k, &KernelVectors::new()), 1);
}

#[test]
fn an_indefinite_matrix_is_told_from_a_singular_one() {
    let (k, _) = grid_laplacian(12, 12, 0.0);
    for (shift, definite) in [(0.0, true), (1e-3, false), (0.2, false)] {
        let mut k = k.clone();
        for i in 0..k.n() {
            let at = k.row_ptr[i] + k.row(i).0.iter().position(|&j| j as usize == i).unwrap();
            k.val[at] -= shift;
        }
        let found = kernel(&k, &vec![vec![1.0; k.n()]]);
        assert_eq!(found.is_ok(), definite, "shift {shift}");
        if let Err(e) = found {
            assert!(e.energy.is_some_and(|e| e < -1e-10), "{e:?}");
        }
    }
}
