//! A random mesh of two bodies, one on the other.

use std::fmt::Write;

use super::rng::Rng;
use super::scenes::number;

/// A mesh of Gmsh 2.2: two blocks of squares or cubes, or of triangles.
pub fn mesh(rng: &mut Rng, dim: usize, [low, high]: [&str; 2]) -> String {
    let (mut nodes, mut cells) = (Vec::new(), Vec::new());
    let triangles = dim == 2 && rng.one_in(2);
    for block in 0..2_usize {
        let n: Vec<usize> = (0..3)
            .map(|d| match (d < dim, dim) {
                (false, _) => 0,
                (true, 2) => rng.between(1, 6),
                _ => rng.between(1, 3),
            })
            .collect();
        let first = nodes.len() + 1;
        let id = |i: [usize; 3]| first + i[0] + (n[0] + 1) * (i[1] + (n[1] + 1) * i[2]);
        let up = dim - 1;
        for k in 0..=n[2] {
            for j in 0..=n[1] {
                for i in 0..=n[0] {
                    let at = [i, j, k];
                    let mut x = [0.0; 3];
                    for d in 0..dim {
                        let inside = at[d] > 0 && at[d] < n[d];
                        let moved = if inside { number(rng, -0.2, 0.2) } else { 0.0 };
                        x[d] = (at[d] as f64 + moved) / n[d] as f64;
                    }
                    x[up] += block as f64;
                    nodes.push(x);
                }
            }
        }
        let sides = |at: usize, top: bool| if top { n[up] } else { at };
        let groups = [2 * block + 1, 2 * block + 2];
        for k in 0..n[2].max(1) {
            for j in 0..n[1].max(1) {
                for i in 0..n[0] {
                    let c = |a: usize, b: usize, c: usize| id([i + a, j + b, k + c]);
                    let body = 5 + block;
                    match (dim, triangles) {
                        (2, true) => {
                            cells.push((2, body, vec![c(0, 0, 0), c(1, 0, 0), c(1, 1, 0)]));
                            cells.push((2, body, vec![c(0, 0, 0), c(1, 1, 0), c(0, 1, 0)]));
                        }
                        (2, false) => {
                            let square = vec![c(0, 0, 0), c(1, 0, 0), c(1, 1, 0), c(0, 1, 0)];
                            cells.push((3, body, square));
                        }
                        _ => {
                            let of = |z| [c(0, 0, z), c(1, 0, z), c(1, 1, z), c(0, 1, z)];
                            cells.push((5, body, [of(0), of(1)].concat()));
                        }
                    }
                    for (top, group) in [(false, groups[0]), (true, groups[1])] {
                        if dim == 2 && j == 0 {
                            let y = sides(0, top);
                            cells.push((1, group, vec![id([i, y, 0]), id([i + 1, y, 0])]));
                        } else if dim == 3 && k == 0 {
                            let z = sides(0, top);
                            let at = |a, b| id([i + a, j + b, z]);
                            cells.push((3, group, vec![at(0, 0), at(1, 0), at(1, 1), at(0, 1)]));
                        }
                    }
                }
            }
        }
    }
    let mut out = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n".to_string();
    for (block, name) in ["lower", "upper"].into_iter().enumerate() {
        let (a, b) = (2 * block + 1, 2 * block + 2);
        let _ = write!(
            out,
            "{0} {a} \"{name}_{low}\"\n{0} {b} \"{name}_{high}\"\n",
            dim - 1
        );
        let _ = writeln!(out, "{dim} {} \"{name}\"", 5 + block);
    }
    let _ = write!(out, "$EndPhysicalNames\n$Nodes\n{}\n", nodes.len());
    for (k, x) in nodes.iter().enumerate() {
        let _ = writeln!(out, "{} {} {} {}", k + 1, x[0], x[1], x[2]);
    }
    let _ = write!(out, "$EndNodes\n$Elements\n{}\n", cells.len());
    for (k, (kind, group, of)) in cells.iter().enumerate() {
        let of: Vec<String> = of.iter().map(usize::to_string).collect();
        let _ = writeln!(out, "{} {kind} 2 {group} {group} {}", k + 1, of.join(" "));
    }
    out + "$EndElements\n"
}
