//! Forces in a cell.

use super::map::for_each_sample_of;
use super::reference::Rule;
use super::Element;
use crate::q1::Quadrature;

/// The nodal forces ∫ f_i N_a of a force per volume `f`, into `out`, of length 2^`dim` · `components`.
///
/// [`Quadrature::Gauss`] is the rule for loads of [the table](super). [`Quadrature::Midpoint`] evaluates `f` once, at
/// the mean of the corners, and multiplies by ∫ N_a: on a box each corner gets an equal share. The total of a constant
/// force is exact with both.
///
/// # Panics
/// When `dim` is not 2 or 3, or a length is wrong.
pub fn body_load<F>(
    dim: usize,
    points: &[[f64; 3]],
    element: Element,
    quadrature: Quadrature,
    components: usize,
    mut f: F,
    out: &mut [f64],
) where
    F: FnMut([f64; 3]) -> [f64; 3],
{
    let n = points.len() * components;
    assert_eq!(out.len(), n, "a cell has {n} degrees of freedom");
    out.fill(0.0);
    let constant = (quadrature == Quadrature::Midpoint).then(|| {
        let sum = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64;
        f([sum(0), sum(1), sum(2)])
    });
    for_each_sample_of(dim, points, element, Rule::Load, |s| {
        let force = constant
            .unwrap_or_else(|| f(s.point))
            .map(|value| value * s.weight);
        for (node, shape) in out.chunks_exact_mut(components).zip(s.shape) {
            for (entry, value) in node.iter_mut().zip(force) {
                *entry += value * shape;
            }
        }
    });
}

#[cfg(test)]
#[path = "../../tests/cell/loads.rs"]
mod tests;
