//! Distance between a finite element function and an exact solution on one cell.

use super::map::for_each_sample_of;
use super::reference::Rule;
use super::{Element, Material};

/// Squares of the L² norm, the H¹ seminorm (∫ |∇e|², all components) and the energy norm of e = u_h − u, by the rule
/// for errors of [the table](super).
///
/// `nodal` has the cell's degrees of freedom; `exact` returns u and its gradient, `[i][j]` = ∂u_i/∂x_j, at a point. The
/// energy is the stiffness' own, for e: ∫ ρ|∇e|², or ∫ 2μ ε:ε + λ(∇·e)² where [`Cure`](super::Cure) replaces ∇·e by its
/// mean.
///
/// # Panics
/// When `dim` is not 2 or 3, a length is wrong, or the material is refused by [`Material::check`] for its cure.
pub fn error_squares<F>(
    dim: usize,
    points: &[[f64; 3]],
    element: Element,
    material: &Material,
    nodal: &[f64],
    mut exact: F,
) -> [f64; 3]
where
    F: FnMut([f64; 3]) -> ([f64; 3], [[f64; 3]; 3]),
{
    let n = points.len() * material.components(dim);
    assert_eq!(nodal.len(), n, "a cell has {n} degrees of freedom");
    let components = material.components(dim);
    let moduli = material.moduli(dim, element);
    let mut squares = [0.0; 3];
    let (mut volume, mut dilatation) = (0.0, 0.0);
    for_each_sample_of(dim, points, element, Rule::Error, |s| {
        let (u, slope) = exact(s.point);
        let (mut value, mut gradient) = (u.map(|v| -v), slope.map(|row| row.map(|v| -v)));
        for (a, node) in nodal.chunks_exact(components).enumerate() {
            for (i, &x) in node.iter().enumerate() {
                value[i] += x * s.shape[a];
                for j in 0..dim {
                    gradient[i][j] += x * s.gradient[j][a];
                }
            }
        }
        let l2: f64 = value[..components].iter().map(|v| v * v).sum();
        let h1: f64 = gradient[..components]
            .iter()
            .flat_map(|row| &row[..dim])
            .map(|v| v * v)
            .sum();
        let energy = if let Material::Scalar { rho } = material {
            rho * h1
        } else {
            let divergence: f64 = (0..dim).map(|i| gradient[i][i]).sum();
            dilatation += s.weight * divergence;
            // In the plane nothing changes across it.
            if dim == 2 {
                gradient.iter_mut().for_each(|row| row[2] = 0.0);
                gradient[2] = [0.0; 3];
            }
            moduli.energy(&gradient)
        };
        volume += s.weight;
        squares[0] += s.weight * l2;
        squares[1] += s.weight * h1;
        squares[2] += s.weight * energy;
    });
    squares[2] += moduli.mean() * dilatation * dilatation / volume;
    squares
}

#[cfg(test)]
#[path = "../../tests/cell/errors.rs"]
mod tests;
