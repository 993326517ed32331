//! The forces of expansion by heat, and its part of the stress.

use super::SubdomainMesh;
use elements::element::{self, NodeStress};
use elements::kind::CellKind;

/// Adds ∫ Bᵀ C α ΔT to a load by degree of freedom of the mesh.
pub fn add_thermal_load(mesh: &SubdomainMesh, load: &mut [f64]) {
    let Some(heat) = &mesh.heat else { return };
    let c = mesh.components();
    let (mut points, mut temperatures, mut force) = (Vec::new(), Vec::new(), Vec::new());
    for (e, (kind, nodes)) in mesh.cells().iter().enumerate() {
        heat.of(kind, nodes, &mut temperatures);
        if temperatures.iter().all(|t| *t == 0.0) {
            continue;
        }
        points.clear();
        points.extend(nodes.iter().map(|&k| mesh.points[k as usize]));
        force.clear();
        force.resize(c * nodes.len(), 0.0);
        let (material, rule) = (mesh.material(e), mesh.integration(e));
        element::thermal_load(
            kind,
            mesh.dim,
            &points,
            &material,
            rule,
            &heat.expansion[e],
            &temperatures,
            &mut force,
        );
        for (&k, part) in nodes.iter().zip(force.chunks_exact(c)) {
            let to = &mut load[c * k as usize..c * (k as usize + 1)];
            to.iter_mut().zip(part).for_each(|(to, part)| *to += part);
        }
    }
}

/// Adds `sign` times the stress C α ΔT to those at the nodes of element `e`.
pub(super) fn add_thermal_stress(
    mesh: &SubdomainMesh,
    (e, kind, nodes): (usize, CellKind, &[u32]),
    sign: f64,
    at: &mut [NodeStress],
) {
    let Some(heat) = &mesh.heat else { return };
    let mut temperatures = Vec::new();
    heat.of(kind, nodes, &mut temperatures);
    let of_a_degree = element::thermal_stress(mesh.dim, &mesh.material(e), &heat.expansion[e]);
    for (node, t) in at.iter_mut().zip(&temperatures) {
        for c in 0..6 {
            node.stress[c] += sign * t * of_a_degree.stress[c];
            node.strain[c] += sign * t * of_a_degree.strain[c];
        }
    }
}
