use super::super::stiffness;
use super::super::testing::{affine, solid_kinds, STEEL};
use super::*;

/// The stresses of a linear displacement are constant: recovered ones are the same, the energy is that of the
/// stiffness, and stresses that are wrong by a factor are wrong by its square in the energy.
#[test]
fn linear_displacements_have_no_error_and_the_energy_of_the_stiffness() {
    let slope = [[0.3, -0.2, 0.5], [0.7, 0.1, -0.3], [-0.6, 0.4, 0.9]];
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = affine(kind);
        for material in [Material::Scalar { rho: 3.0 }, STEEL] {
            let c = material.components(dim);
            let value = |p: &[f64; 3], i: usize| (0..dim).map(|j| slope[i][j] * p[j]).sum::<f64>();
            let of = |p: &[f64; 3]| (0..c).map(|i| value(p, i)).collect::<Vec<_>>();
            let nodal: Vec<f64> = points.iter().flat_map(of).collect();
            let mut at = vec![NodeStress::default(); points.len()];
            let full = Integration::Full;
            stress_at_nodes(kind, dim, &points, &material, full, &nodal, &mut at);
            let squares = |at: &[NodeStress]| {
                recovered_squares(kind, dim, &points, &material, full, &nodal, at)
            };
            let [error, energy] = squares(&at);
            let mut k = vec![0.0; nodal.len() * nodal.len()];
            stiffness(kind, dim, &points, &material, full, &mut k);
            let rows = k.chunks_exact(nodal.len()).zip(&nodal);
            let work = rows.map(|(row, u)| {
                let force: f64 = row.iter().zip(&nodal).map(|(k, v)| k * v).sum();
                u * force
            });
            let expected: f64 = work.sum();
            assert!((energy / expected - 1.0).abs() < 1e-10, "{kind:?}");
            assert!(error < 1e-20 * energy, "{kind:?}: {error:e}");
            for node in &mut at {
                node.strain.iter_mut().for_each(|e| *e *= 1.5);
                node.stress.iter_mut().for_each(|s| *s *= 1.5);
            }
            let [error, _] = squares(&at);
            assert!((error / energy - 0.25).abs() < 1e-10, "{kind:?}: {error:e}");
            let own = interpolated(&[1.0 / 1.5], &at[..1]);
            let constant = recovered_squares_of(kind, dim, &points, &material, &own, &at);
            assert!((constant[0] / energy - 0.25).abs() < 1e-10, "{kind:?}");
        }
    }
}
