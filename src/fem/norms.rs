//! Distance between a Q1 function and an exact solution.

use super::q1;
use crate::mesh::SubdomainMesh;

/// Error norms over the whole problem.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ErrorNorms {
    /// ‖u_h − u‖ in L².
    pub l2: f64,
    /// ‖∇(u_h − u)‖ in L²: the H¹ seminorm.
    pub h1: f64,
    /// The energy norm (∫ ρ|∇(u_h − u)|²)^½.
    pub energy: f64,
}

impl ErrorNorms {
    /// The norms from the squares that [`error_squares`] gives, summed over all subdomains (and ranks).
    pub fn from_squares(squares: [f64; 3]) -> ErrorNorms {
        let [l2, h1, energy] = squares.map(f64::sqrt);
        ErrorNorms { l2, h1, energy }
    }
}

/// Squares of the L² norm, the H¹ seminorm and the energy norm of the error on one subdomain, by the 4 × 4 Gauss rule.
///
/// `nodal` has an entry per node; `exact` returns u and ∇u at a point.
pub fn error_squares<F>(mesh: &SubdomainMesh, nodal: &[f64], mut exact: F) -> [f64; 3]
where
    F: FnMut([f64; 2]) -> (f64, [f64; 2]),
{
    let [dx, dy] = mesh.step;
    let [nx, ny] = mesh.elements;
    let mut squares = [0.0; 3];
    for (e, place) in (0..ny)
        .flat_map(|j| (0..nx).map(move |i| [i, j]))
        .enumerate()
    {
        let nodes = mesh.element_nodes(place);
        let [x, y] = mesh.points[nodes[0]];
        for (t, wt) in q1::GAUSS4 {
            for (s, ws) in q1::GAUSS4 {
                let (u, gradient) = exact([x + s * dx, y + t * dy]);
                let (mut value, mut gx, mut gy) = (-u, -gradient[0], -gradient[1]);
                let shapes = q1::shape(s, t).into_iter().zip(q1::shape_gradient(s, t));
                for (&node, (shape, [by_s, by_t])) in nodes.iter().zip(shapes) {
                    value += nodal[node] * shape;
                    gx += nodal[node] * by_s / dx;
                    gy += nodal[node] * by_t / dy;
                }
                let weight = ws * wt * dx * dy;
                let slope = weight * (gx * gx + gy * gy);
                squares[0] += weight * value * value;
                squares[1] += slope;
                squares[2] += slope * mesh.rho[e];
            }
        }
    }
    squares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norms_of_a_known_difference() {
        // u_h = 0 against u = x y on [0,2] × [0,1] with ρ = 3: ∫x²y² = 8/9, ∫|∇u|² = ∫x² + y² = 8/3 + 2/3.
        let mesh = SubdomainMesh {
            index: 0,
            body: 0,
            elements: [2, 1],
            step: [1.0, 1.0],
            points: (0..6).map(|k| [(k % 3) as f64, (k / 3) as f64]).collect(),
            dof: (0..6).collect(),
            prescribed: vec![0.0; 6],
            rho: vec![3.0; 2],
        };
        let squares = error_squares(&mesh, &[0.0; 6], |[x, y]| (x * y, [y, x]));
        let norms = ErrorNorms::from_squares(squares);
        assert!((norms.l2 - (8.0_f64 / 9.0).sqrt()).abs() < 1e-14);
        assert!((norms.h1 - (10.0_f64 / 3.0).sqrt()).abs() < 1e-14);
        assert!((norms.energy - 10.0_f64.sqrt()).abs() < 1e-14);
        // The bilinear interpolant of x y is x y itself.
        let nodal: Vec<f64> = mesh.points.iter().map(|p| p[0] * p[1]).collect();
        let squares = error_squares(&mesh, &nodal, |[x, y]| (x * y, [y, x]));
        assert!(squares.iter().all(|s| *s < 1e-28));
    }
}
