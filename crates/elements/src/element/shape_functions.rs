//! Shape functions on the reference cells, and where their nodes lie.
//!
//! | cells | reference cell |
//! |---|---|
//! | segments, quadrilaterals, hexahedra | \[−1, 1\]^D |
//! | triangles, tetrahedra | the corners 0 and the unit vectors |
//! | wedges | the triangle × \[−1, 1\] |
//! | the pyramid | the base \[−1, 1\]², the apex (0, 0, 1) |

use std::sync::OnceLock;

use crate::kind::CellKind;

/// Most nodes of a cell.
const MOST: usize = CellKind::MOST_NODES;

/// The shape functions at a point of the reference cell.
pub(super) struct ShapeFunctions {
    /// N_a.
    pub value: [f64; MOST],
    /// `[j][a]` = ∂N_a/∂s_j.
    pub slope: [[f64; MOST]; 3],
}

/// The shape functions of a cell at the point `at` of its reference cell; all of them are polynomials but those of the
/// pyramid, whose slopes have no limit at the apex: there they are those on the axis.
pub(super) fn shape(kind: CellKind, at: [f64; 3]) -> ShapeFunctions {
    let mut out = ShapeFunctions {
        value: [0.0; MOST],
        slope: [[0.0; MOST]; 3],
    };
    match kind {
        CellKind::Point1 => out.value[0] = 1.0,
        CellKind::Line2 | CellKind::Quad4 | CellKind::Hex8 => {
            for (a, &node) in known_nodes(kind).iter().enumerate() {
                let dim = kind.dim();
                product(&mut out, a, dim, |d| linear(at[d], node[d]));
            }
        }
        CellKind::Line3 | CellKind::Quad9 | CellKind::Hex27 => {
            for (a, &node) in known_nodes(kind).iter().enumerate() {
                let dim = kind.dim();
                product(&mut out, a, dim, |d| quadratic(at[d], node[d]));
            }
        }
        CellKind::Quad8 | CellKind::Hex20 => {
            for (a, &node) in known_nodes(kind).iter().enumerate() {
                serendipity(&mut out, a, kind.dim(), at, node);
            }
        }
        CellKind::Triangle3 | CellKind::Triangle6 | CellKind::Tet4 | CellKind::Tet10 => {
            simplex(&mut out, kind, at);
        }
        CellKind::Wedge6 | CellKind::Wedge15 => wedge(&mut out, kind, at),
        CellKind::Pyramid5 => pyramid(&mut out, at, known_nodes(kind)),
    }
    out
}

/// [`reference_nodes`], found once.
fn known_nodes(kind: CellKind) -> &'static [[f64; 3]] {
    static NODES: [OnceLock<Vec<[f64; 3]>>; CellKind::ALL.len()] =
        [const { OnceLock::new() }; CellKind::ALL.len()];
    NODES[kind as usize].get_or_init(|| reference_nodes(kind))
}

/// Where the nodes of a cell lie in its reference cell: middle nodes in the middle of their edges and faces.
pub(super) fn reference_nodes(kind: CellKind) -> Vec<[f64; 3]> {
    let corners: &[[i8; 3]] = match kind.linear() {
        CellKind::Point1 => &[[0, 0, 0]],
        CellKind::Line2 => &[[-1, 0, 0], [1, 0, 0]],
        CellKind::Triangle3 => &[[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        CellKind::Quad4 => &[[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]],
        CellKind::Tet4 => &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        CellKind::Pyramid5 => &[[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 1]],
        CellKind::Wedge6 => &[
            [0, 0, -1],
            [1, 0, -1],
            [0, 1, -1],
            [0, 0, 1],
            [1, 0, 1],
            [0, 1, 1],
        ],
        _ => &[
            [-1, -1, -1],
            [1, -1, -1],
            [1, 1, -1],
            [-1, 1, -1],
            [-1, -1, 1],
            [1, -1, 1],
            [1, 1, 1],
            [-1, 1, 1],
        ],
    };
    let mut nodes: Vec<[f64; 3]> = corners.iter().map(|c| c.map(f64::from)).collect();
    let mean = |nodes: &[[f64; 3]], of: &[u8]| {
        let sum = |d: usize| of.iter().map(|&a| nodes[usize::from(a)][d]).sum::<f64>();
        [0, 1, 2].map(|d| sum(d) / of.len() as f64)
    };
    if kind.order() == 2 {
        for edge in kind.edges() {
            nodes.push(mean(&nodes, edge));
        }
    }
    match kind {
        CellKind::Quad9 => nodes.push([0.0; 3]),
        CellKind::Hex27 => {
            nodes.resize(MOST, [0.0; 3]);
            for side in kind.sides() {
                let face = usize::from(side.nodes[8]);
                nodes[face] = mean(&nodes, &side.nodes[..4]);
            }
        }
        _ => {}
    }
    nodes
}

/// Value and slope of the function of \[−1, 1\] that is linear, 1 at the end `node` and 0 at the other.
fn linear(s: f64, node: f64) -> (f64, f64) {
    (0.5 * (1.0 + node * s), 0.5 * node)
}

/// Value and slope of the function of \[−1, 1\] that is quadratic, 1 at `node` and 0 at the other two of −1, 0, 1.
fn quadratic(s: f64, node: f64) -> (f64, f64) {
    if node == 0.0 {
        (1.0 - s * s, -2.0 * s)
    } else {
        (0.5 * s * (s + node), s + 0.5 * node)
    }
}

/// N_a as a product of functions of one coordinate each.
fn product(out: &mut ShapeFunctions, a: usize, dim: usize, factor: impl Fn(usize) -> (f64, f64)) {
    out.value[a] = 1.0;
    for j in 0..dim {
        out.slope[j][a] = 1.0;
    }
    for d in 0..dim {
        let (value, slope) = factor(d);
        out.value[a] *= value;
        for j in 0..dim {
            out.slope[j][a] *= if j == d { slope } else { value };
        }
    }
}

/// The functions without a node in the middle of faces and cell: at corners Π (1 + c_d s_d)/2 · (Σ c_d s_d − D + 1), in
/// the middle of an edge along axis k (1 − s_k²) times the linear functions of the other coordinates.
fn serendipity(out: &mut ShapeFunctions, a: usize, dim: usize, at: [f64; 3], node: [f64; 3]) {
    if let Some(along) = (0..dim).find(|&d| node[d] == 0.0) {
        return product(out, a, dim, |d| {
            if d == along {
                quadratic(at[d], 0.0)
            } else {
                linear(at[d], node[d])
            }
        });
    }
    product(out, a, dim, |d| linear(at[d], node[d]));
    let sum: f64 = (0..dim).map(|d| node[d] * at[d]).sum();
    let factor = sum - (dim - 1) as f64;
    for j in 0..dim {
        out.slope[j][a] = out.slope[j][a] * factor + out.value[a] * node[j];
    }
    out.value[a] *= factor;
}

/// Barycentric coordinates of a simplex and their constant slopes.
fn barycentric(dim: usize, at: [f64; 3]) -> ([f64; 4], [[f64; 3]; 4]) {
    let (mut value, mut slope) = ([0.0; 4], [[0.0; 3]; 4]);
    value[0] = 1.0 - at[..dim].iter().sum::<f64>();
    for d in 0..dim {
        slope[0][d] = -1.0;
        value[d + 1] = at[d];
        slope[d + 1][d] = 1.0;
    }
    (value, slope)
}

/// L_a; or L_a (2 L_a − 1) at corners and 4 L_p L_q in the middle of edges.
fn simplex(out: &mut ShapeFunctions, kind: CellKind, at: [f64; 3]) {
    let dim = kind.dim();
    let (l, slope) = barycentric(dim, at);
    for a in 0..=dim {
        let (value, factor) = if kind.order() == 1 {
            (l[a], 1.0)
        } else {
            (l[a] * (2.0 * l[a] - 1.0), 4.0 * l[a] - 1.0)
        };
        out.value[a] = value;
        for j in 0..dim {
            out.slope[j][a] = factor * slope[a][j];
        }
    }
    if kind.order() == 2 {
        for (e, edge) in kind.edges().iter().enumerate() {
            let [p, q] = edge.map(usize::from);
            let a = dim + 1 + e;
            out.value[a] = 4.0 * l[p] * l[q];
            for j in 0..dim {
                out.slope[j][a] = 4.0 * (slope[p][j] * l[q] + l[p] * slope[q][j]);
            }
        }
    }
}

/// With barycentric coordinates L of the triangle and z = ±1 at a node: L (1 ± z)/2; of second order
/// L (1 ± z)(2 L − 2 ± z)/2 at corners, 2 L_p L_q (1 ± z) on the edges of the triangles, L (1 − z²) on those between.
fn wedge(out: &mut ShapeFunctions, kind: CellKind, at: [f64; 3]) {
    let (l, slope) = barycentric(2, at);
    let z = at[2];
    let mut set = |a: usize, value: f64, by_l: [f64; 3], by_z: f64| {
        out.value[a] = value;
        for j in 0..2 {
            out.slope[j][a] = (0..3).map(|i| by_l[i] * slope[i][j]).sum();
        }
        out.slope[2][a] = by_z;
    };
    let only = |i: usize, value: f64| {
        let mut by = [0.0; 3];
        by[i] = value;
        by
    };
    for a in 0..6 {
        let (i, end) = (a % 3, if a < 3 { -1.0 } else { 1.0 });
        let rise = 1.0 + end * z;
        if kind == CellKind::Wedge6 {
            set(a, 0.5 * l[i] * rise, only(i, 0.5 * rise), 0.5 * end * l[i]);
        } else {
            let rest = 2.0 * l[i] - 2.0 + end * z;
            set(
                a,
                0.5 * l[i] * rise * rest,
                only(i, 0.5 * rise * (rest + 2.0 * l[i])),
                0.5 * l[i] * end * (rest + rise),
            );
        }
    }
    if kind == CellKind::Wedge6 {
        return;
    }
    for (e, edge) in kind.edges().iter().enumerate() {
        let [p, q] = edge.map(|c| usize::from(c % 3));
        if p == q {
            let bubble = 1.0 - z * z;
            set(6 + e, l[p] * bubble, only(p, bubble), -2.0 * l[p] * z);
        } else {
            let end = if e < 3 { -1.0 } else { 1.0 };
            let rise = 2.0 * (1.0 + end * z);
            let mut by = only(p, rise * l[q]);
            by[q] = rise * l[p];
            set(6 + e, rise * l[p] * l[q], by, 2.0 * end * l[p] * l[q]);
        }
    }
}

/// With a = x/(1 − z) and b = y/(1 − z): (1 ± a)(1 ± b)(1 − z)/4 at the corners of the base, z at the apex. On the base
/// these are the functions of a quadrilateral, on the other sides those of triangles.
fn pyramid(out: &mut ShapeFunctions, at: [f64; 3], nodes: &[[f64; 3]]) {
    let left = 1.0 - at[2];
    let (a, b) = if left.abs() < 1e-14 {
        (0.0, 0.0)
    } else {
        (at[0] / left, at[1] / left)
    };
    for (i, &[s, t, _]) in nodes[..4].iter().enumerate() {
        let (x, y) = (1.0 + s * a, 1.0 + t * b);
        out.value[i] = 0.25 * x * y * left;
        out.slope[0][i] = 0.25 * s * y;
        out.slope[1][i] = 0.25 * t * x;
        out.slope[2][i] = 0.25 * (s * t * a * b - 1.0);
    }
    out.value[4] = at[2];
    out.slope[2][4] = 1.0;
}

#[cfg(test)]
#[path = "../../tests/element/shape_functions.rs"]
mod tests;
