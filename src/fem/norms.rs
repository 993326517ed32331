//! Distance between a finite element function and an exact solution.

use super::cell;
use super::SubdomainMesh;

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

/// Squares of the L² norm, the H¹ seminorm and the energy norm of the error on one subdomain, by four Gauss points in
/// each direction.
///
/// `nodal` has an entry per degree of freedom; `exact` returns u and ∇u at a point: row i of the gradient belongs to
/// component i.
pub fn error_squares<F>(mesh: &SubdomainMesh, nodal: &[f64], mut exact: F) -> [f64; 3]
where
    F: FnMut([f64; 3]) -> ([f64; 3], [[f64; 3]; 3]),
{
    let (c, corners) = (mesh.components(), mesh.corners());
    let mut squares = [0.0; 3];
    let mut local = vec![0.0; corners * c];
    for (e, place) in mesh.element_places().enumerate() {
        let nodes = mesh.element_nodes(place);
        for (values, &node) in local.chunks_exact_mut(c).zip(&nodes) {
            values.copy_from_slice(&nodal[c * node..c * (node + 1)]);
        }
        let points = mesh.element_points(place);
        let (element, material) = (mesh.form.element, mesh.material(e));
        let points = &points[..corners];
        let here = cell::error_squares(mesh.dim, points, element, &material, &local, &mut exact);
        (0..3).for_each(|k| squares[k] += here[k]);
    }
    squares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::Form;

    #[test]
    fn norms_of_a_known_difference() {
        // u_h = 0 against u = x y on [0,2] × [0,1] with ρ = 3: ∫x²y² = 8/9, ∫|∇u|² = ∫x² + y² = 8/3 + 2/3.
        let mesh = SubdomainMesh {
            index: 0,
            body: 0,
            dim: 2,
            form: Form::default(),
            elements: [2, 1, 0],
            step: Some([1.0, 1.0, 0.0]),
            points: (0..6)
                .map(|k| [(k % 3) as f64, (k / 3) as f64, 0.0])
                .collect(),
            dof: (0..6).collect(),
            prescribed: vec![0.0; 6],
            rho: vec![3.0; 2],
            poisson: Vec::new(),
            spring: Vec::new(),
        };
        let exact = |[x, y, _]: [f64; 3]| ([x * y, 0.0, 0.0], [[y, x, 0.0], [0.0; 3], [0.0; 3]]);
        let squares = error_squares(&mesh, &[0.0; 6], exact);
        let norms = ErrorNorms::from_squares(squares);
        assert!((norms.l2 - (8.0_f64 / 9.0).sqrt()).abs() < 1e-14);
        assert!((norms.h1 - (10.0_f64 / 3.0).sqrt()).abs() < 1e-14);
        assert!((norms.energy - 10.0_f64.sqrt()).abs() < 1e-14);
        // The bilinear interpolant of x y is x y itself.
        let nodal: Vec<f64> = mesh.points.iter().map(|p| p[0] * p[1]).collect();
        let squares = error_squares(&mesh, &nodal, exact);
        assert!(squares.iter().all(|s| *s < 1e-28));
    }
}
