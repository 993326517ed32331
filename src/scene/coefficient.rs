//! Coefficients by element, the weights of ρ-scaling, coefficient ranges, and fields at points of a subdomain.

use super::body::Body;
use super::checked::Scene;
use super::model::expr::Variables;
use super::model::field::{At, Field};
use crate::error::Result;
use crate::fem::SubdomainMesh;
use crate::mesh::Block;

impl Scene {
    /// Least and greatest ρ (Young's modulus in elasticity) by body, over the subdomains for which `owns` holds. A body
    /// without such subdomains gets ∞ and −∞.
    ///
    /// # Errors
    /// As [`Scene::subdomain_mesh`].
    pub fn coefficient_ranges(&self, owns: &dyn Fn(usize) -> bool) -> Result<Vec<[f64; 2]>> {
        let mut out = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.n_bodies()];
        for index in (0..self.n_subdomains()).filter(|&s| owns(s)) {
            let (b, _) = self.body_of(index);
            let [low, high] = &mut out[b];
            let mut add = |value: f64| {
                *low = low.min(value);
                *high = high.max(value);
            };
            match self.bodies[b].spec.rho.as_constant() {
                Some(value) => add(value),
                None => self.subdomain_mesh(index)?.rho.into_iter().for_each(add),
            }
        }
        Ok(out)
    }
}

/// A coefficient in the middle of every element.
pub(super) fn by_element(
    body: &Body,
    block: &Block,
    mesh: &SubdomainMesh,
    field: &Field,
    check: impl Fn(f64, [f64; 3]) -> Result<f64>,
) -> Result<Vec<f64>> {
    let middle = |place: [usize; 3]| match mesh.step {
        Some(step) => {
            let first = mesh.points[mesh.element_nodes(place)[0]];
            [0, 1, 2].map(|d| first[d] + 0.5 * step[d])
        }
        None => {
            // In the plane the last four corners repeat the first.
            let corners = mesh.element_points(place);
            [0, 1, 2].map(|d| corners.iter().map(|p| p[d]).sum::<f64>() / 8.0)
        }
    };
    if let Field::Cells(cells) = field {
        let values = cells.sample(body.spec.place, body.mesh(), block)?;
        let checked = |(value, place)| check(value, middle(place));
        return values
            .into_iter()
            .zip(mesh.element_places())
            .map(checked)
            .collect();
    }
    if field.is_constant_by_subdomain() {
        let point = middle([0; 3]);
        let value = check(evaluate(body, block, field, point), point)?;
        return Ok(vec![value; mesh.n_elements()]);
    }
    let value = |place| {
        let point = middle(place);
        check(evaluate(body, block, field, point), point)
    };
    mesh.element_places().map(value).collect()
}

/// The largest coefficient in the elements around a node of the subdomain, which is its weight in ρ-scaling. The
/// elements around a node act in parallel: the stiffest one determines its motion.
pub(super) fn stiffest(mesh: &SubdomainMesh, place: [usize; 3]) -> f64 {
    let counts = mesh.elements.map(|n| n.max(1));
    let range = |d: usize| place[d].saturating_sub(1)..=place[d].min(counts[d] - 1);
    let mut largest = 0.0_f64;
    for k in range(2) {
        for j in range(1) {
            let row = (k * counts[1] + j) * counts[0];
            let around = range(0);
            for &value in &mesh.rho[row + around.start()..=row + around.end()] {
                largest = largest.max(value);
            }
        }
    }
    largest
}

/// A point of a subdomain, with the variables on which fields depend.
pub(super) fn at(body: &Body, block: &Block, point: [f64; 3]) -> At {
    At {
        variables: Variables {
            point,
            body: body.spec.place,
            subdomain: block.place,
        },
        subdomains: body.mesh().subdomains,
    }
}

/// The value of a field at a point of a subdomain.
pub(super) fn evaluate(body: &Body, block: &Block, field: &Field, point: [f64; 3]) -> f64 {
    field.eval(&at(body, block, point))
}
