//! Rules of quadrature on the reference cells.

use crate::kind::CellKind;

/// The purpose of an integration, which determines the order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Stiffness: exact on affine cells.
    Full,
    /// Stiffness with fewer points.
    Reduced,
    /// One point in the middle.
    Centre,
    /// Loads, volumes, normals: exact for constants, also on curved cells.
    Load,
    /// Errors.
    Error,
    /// Not a rule: the nodes, with weights zero.
    Nodes,
}

impl Purpose {
    /// All of them.
    pub const ALL: [Purpose; 6] = [
        Purpose::Full,
        Purpose::Reduced,
        Purpose::Centre,
        Purpose::Load,
        Purpose::Error,
        Purpose::Nodes,
    ];
}

/// A point of the reference cell with its weight.
pub(super) type QuadraturePoint = ([f64; 3], f64);

/// The rule of a cell for a purpose; the weights sum to the volume of the reference cell. Where a cell has no reduced
/// rule it is the full one.
pub fn rule(kind: CellKind, purpose: Purpose) -> Vec<QuadraturePoint> {
    let quadratic = kind.order() == 2;
    let n = match purpose {
        Purpose::Centre => 1,
        Purpose::Full | Purpose::Load => 2 + usize::from(quadratic),
        Purpose::Reduced => 1 + usize::from(quadratic),
        Purpose::Error => 4 + usize::from(quadratic),
        Purpose::Nodes => {
            let nodes = super::shape_functions::reference_nodes(kind);
            return nodes.into_iter().map(|at| (at, 0.0)).collect();
        }
    };
    match kind.linear() {
        CellKind::Point1 => vec![([0.0; 3], 1.0)],
        CellKind::Line2 => tensor(1, n),
        CellKind::Quad4 => tensor(2, n),
        CellKind::Hex8 => tensor(3, n),
        CellKind::Triangle3 => triangle(kind, purpose),
        CellKind::Tet4 => tetrahedron(kind, purpose),
        CellKind::Wedge6 => {
            let flat = match (purpose, quadratic) {
                (Purpose::Centre, _) | (Purpose::Reduced, false) => simplex_one(2),
                (Purpose::Error, _) => collapsed(2, n),
                (Purpose::Full | Purpose::Load, true) => triangle_six(),
                _ => triangle_three(),
            };
            // Linear wedges have two points along the axis in any rule, quadratic ones three.
            let along = match purpose {
                Purpose::Reduced => n + 1,
                _ => n,
            };
            prism(&flat, along)
        }
        _ => pyramid(purpose),
    }
}

fn triangle(kind: CellKind, purpose: Purpose) -> Vec<QuadraturePoint> {
    match (purpose, kind) {
        (Purpose::Centre, _) | (Purpose::Full | Purpose::Reduced, CellKind::Triangle3) => {
            simplex_one(2)
        }
        (Purpose::Error, CellKind::Triangle3) => collapsed(2, 4),
        (Purpose::Error, _) => collapsed(2, 5),
        (Purpose::Load, CellKind::Triangle6) => triangle_six(),
        _ => triangle_three(),
    }
}

fn tetrahedron(kind: CellKind, purpose: Purpose) -> Vec<QuadraturePoint> {
    match (purpose, kind) {
        (Purpose::Centre, _) | (Purpose::Full | Purpose::Reduced, CellKind::Tet4) => simplex_one(3),
        (Purpose::Error, CellKind::Tet4) => collapsed(3, 4),
        (Purpose::Error, _) => collapsed(3, 5),
        (Purpose::Load, CellKind::Tet10) => tetrahedron_fourteen(),
        _ => tetrahedron_four(),
    }
}

/// The Gauss rule with `n` points on \[−1, 1\], exact for degree 2n − 1: (point, weight).
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let mut rule: Vec<(f64, f64)> = (0..n)
        .map(|k| {
            // Newton's method from a point that is close to the k-th zero of the Legendre polynomial.
            let mut x = -(std::f64::consts::PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
            for _ in 0..8 {
                let (value, slope) = legendre(n, x);
                x -= value / slope;
            }
            let (_, slope) = legendre(n, x);
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect();
    // To the last bit symmetric.
    for k in 0..n / 2 {
        let (x, weight) = rule[n - 1 - k];
        rule[k] = (-x, weight);
    }
    if n % 2 == 1 {
        rule[n / 2].0 = 0.0;
    }
    rule
}

/// The Legendre polynomial of degree `n` and its slope.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 1..=n {
        let k = k as f64;
        (before, value) = (
            value,
            ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k,
        );
    }
    (value, n as f64 * (x * value - before) / (x * x - 1.0))
}

/// n Gauss points in each direction.
fn tensor(dim: usize, n: usize) -> Vec<QuadraturePoint> {
    let line = gauss(n);
    (0..n.pow(dim as u32))
        .map(|k| {
            let (mut at, mut weight, mut rest) = ([0.0; 3], 1.0, k);
            for x in &mut at[..dim] {
                let (point, w) = line[rest % n];
                *x = point;
                weight *= w;
                rest /= n;
            }
            (at, weight)
        })
        .collect()
}

/// A rule of the triangle times `n` Gauss points.
fn prism(flat: &[QuadraturePoint], n: usize) -> Vec<QuadraturePoint> {
    let mut rule = Vec::new();
    for (z, along) in gauss(n) {
        for &([x, y, _], weight) in flat {
            rule.push(([x, y, z], weight * along));
        }
    }
    rule
}

/// The slopes of the pyramid's functions, and with them the Jacobian, depend on x/(1 − z) and y/(1 − z) only: one point
/// along the axis, where the weight (1 − z)² has its mean, integrates every stiffness as well as many.
fn pyramid(purpose: Purpose) -> Vec<QuadraturePoint> {
    let (n, line) = match purpose {
        Purpose::Centre => (1, vec![(0.25, 1.0 / 3.0)]),
        Purpose::Full | Purpose::Reduced | Purpose::Nodes => (2, vec![(0.25, 1.0 / 3.0)]),
        Purpose::Load => (2, collapsed_axis(2)),
        Purpose::Error => (4, collapsed_axis(4)),
    };
    let mut rule = Vec::new();
    for (z, along) in line {
        for ([a, b, _], weight) in tensor(2, n) {
            rule.push(([a * (1.0 - z), b * (1.0 - z), z], weight * along));
        }
    }
    rule
}

/// n points on \[0, 1\] with the weight (1 − z)².
fn collapsed_axis(n: usize) -> Vec<(f64, f64)> {
    let line = gauss(n).into_iter();
    line.map(|(s, weight)| {
        let z = 0.5 * (1.0 + s);
        (z, 0.5 * weight * (1.0 - z) * (1.0 - z))
    })
    .collect()
}

/// A rule on the triangle that is exact for this degree: ((r, s), weight); the weights sum to 1/2. Symmetric rules have
/// 6 points for degree 4 and 16 for degree 8, others are collapsed squares.
pub fn triangle_rule(degree: usize) -> Vec<([f64; 2], f64)> {
    let rule = match degree {
        4 => triangle_six(),
        8 => triangle_sixteen(),
        _ => collapsed(2, degree / 2 + 1),
    };
    let flat = rule.into_iter();
    flat.map(|([r, s, _], weight)| ([r, s], weight)).collect()
}

/// A simplex as a collapsed cube with n Gauss points in each direction: exact for degree 2n − D.
fn collapsed(dim: usize, n: usize) -> Vec<QuadraturePoint> {
    let cube = tensor(dim, n).into_iter();
    cube.map(|(s, mut weight)| {
        let (mut at, mut left) = ([0.0; 3], 1.0);
        for d in 0..dim {
            let part = 0.5 * (1.0 + s[d]);
            weight *= 0.5 * left;
            at[d] = part * left;
            left *= 1.0 - part;
        }
        (at, weight)
    })
    .collect()
}

/// The centroid of a simplex: exact for degree 1.
fn simplex_one(dim: usize) -> Vec<QuadraturePoint> {
    let mut at = [0.0; 3];
    at[..dim].fill(1.0 / (dim + 1) as f64);
    vec![(at, 1.0 / (1..=dim).product::<usize>() as f64)]
}

/// D + 1 points of a simplex that differ in one barycentric coordinate, `peak`; the others are equal.
fn orbit(dim: usize, peak: f64, weight: f64, rule: &mut Vec<QuadraturePoint>) {
    let mut base = [0.0; 3];
    base[..dim].fill((1.0 - peak) / dim as f64);
    rule.push((base, weight));
    for d in 0..dim {
        let mut at = base;
        at[d] = peak;
        rule.push((at, weight));
    }
}

/// Exact for degree 2.
fn triangle_three() -> Vec<QuadraturePoint> {
    let mut rule = Vec::new();
    orbit(2, 2.0 / 3.0, 1.0 / 6.0, &mut rule);
    rule
}

/// Exact for degree 4, in closed form (Strang and Fix; Dunavant).
fn triangle_six() -> Vec<QuadraturePoint> {
    let (ten, mut rule) = (10_f64.sqrt(), Vec::new());
    let root = (38.0 - 44.0 * 0.4_f64.sqrt()).sqrt();
    let difference = (213_125.0 - 53_320.0 * ten).sqrt();
    for sign in [1.0, -1.0] {
        let twice = (8.0 - ten + sign * root) / 9.0;
        orbit(
            2,
            1.0 - twice,
            (620.0 + sign * difference) / 7440.0,
            &mut rule,
        );
    }
    rule
}

/// Exact for degree 8 (Dunavant 1985).
fn triangle_sixteen() -> Vec<QuadraturePoint> {
    let mut rule = vec![([1.0 / 3.0, 1.0 / 3.0, 0.0], 0.5 * 0.144_315_607_677_787_2)];
    for (peak, weight) in [
        (0.081_414_823_414_553_7, 0.095_091_634_267_284_62),
        (0.658_861_384_496_480_2, 0.103_217_370_534_718_25),
        (0.898_905_543_365_938_1, 0.032_458_497_623_198_08),
    ] {
        orbit(2, peak, 0.5 * weight, &mut rule);
    }
    let (near, far) = (0.008_394_777_409_957_605, 0.263_112_829_634_638_1);
    let l = [near, far, 1.0 - near - far];
    for [p, q] in [[0, 1], [1, 0], [0, 2], [2, 0], [1, 2], [2, 1]] {
        rule.push(([l[p], l[q], 0.0], 0.5 * 0.027_230_314_174_434_995));
    }
    rule
}

/// Exact for degree 2.
fn tetrahedron_four() -> Vec<QuadraturePoint> {
    let mut rule = Vec::new();
    orbit(3, 0.25 + 0.15 * 5_f64.sqrt(), 1.0 / 24.0, &mut rule);
    rule
}

/// Exact for degree 5 with positive weights (Grundmann and Möller; Walkington).
fn tetrahedron_fourteen() -> Vec<QuadraturePoint> {
    let mut rule = Vec::new();
    let near = 0.310_885_919_263_300_6;
    let far = 0.092_735_250_310_891_23;
    let edge = 0.045_503_704_125_649_65;
    orbit(
        3,
        1.0 - 3.0 * near,
        0.112_687_925_718_015_85 / 6.0,
        &mut rule,
    );
    orbit(
        3,
        1.0 - 3.0 * far,
        0.073_493_043_116_361_95 / 6.0,
        &mut rule,
    );
    for pair in 0..6 {
        // The two of four barycentric coordinates that are large.
        let [p, q] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]][pair];
        let mut l = [edge; 4];
        l[p] = 0.5 - edge;
        l[q] = 0.5 - edge;
        rule.push(([l[1], l[2], l[3]], 0.042_546_020_777_081_47 / 6.0));
    }
    rule
}

#[cfg(test)]
#[path = "../../tests/element/quadrature.rs"]
mod tests;
