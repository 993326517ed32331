//! Coefficients by element, the weights of ρ-scaling, coefficient ranges, and fields at points of a subdomain.

use super::body::Body;
use super::checked::Scene;
use super::model::expr::Variables;
use super::model::field::{At, Field};
use crate::assembly::{Grid, SubdomainElements, SubdomainMesh};
use base::Result;
use elements::element;
use mesh::places;

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
    inside: usize,
    mesh: &SubdomainMesh,
    field: &Field,
    check: impl Fn(f64, [f64; 3]) -> Result<f64>,
) -> Result<Vec<f64>> {
    let mut middles = middles(mesh);
    if let (Field::Cells(cells), Some(grid)) = (field, body.mesh().grid()) {
        let values = cells.sample(body.spec.place, grid, &grid.block(inside))?;
        let checked = |(value, point)| check(value, point);
        return values.into_iter().zip(middles).map(checked).collect();
    }
    if let (Field::ByCell(values), Some(cells)) = (field, body.mesh().cells()) {
        let of = cells
            .parts
            .cells(inside)
            .iter()
            .map(|&c| values[c as usize]);
        let checked = |(value, point)| check(value, point);
        return of.zip(middles).map(checked).collect();
    }
    if field.is_constant_by_subdomain() {
        let point = middles.next().unwrap_or_default();
        let value = check(evaluate(body, inside, field, body.spec.own(point)), point)?;
        return Ok(vec![value; mesh.n_elements()]);
    }
    let value = |point| check(evaluate(body, inside, field, body.spec.own(point)), point);
    middles.map(value).collect()
}

/// A point in the middle of every element.
pub(super) fn middles(mesh: &SubdomainMesh) -> Box<dyn Iterator<Item = [f64; 3]> + '_> {
    match &mesh.elements {
        SubdomainElements::Grid(grid) => {
            Box::new(grid.element_places().map(|p| middle(mesh, grid, p)))
        }
        SubdomainElements::Cells(cells) => Box::new(cells.iter().map(|(kind, nodes)| {
            let points: Vec<_> = nodes.iter().map(|&k| mesh.points[k as usize]).collect();
            element::middle(kind, &points)
        })),
    }
}

fn middle(mesh: &SubdomainMesh, grid: &Grid, place: [usize; 3]) -> [f64; 3] {
    match grid.step {
        Some(step) => {
            let first = mesh.points[grid.element_nodes(place)[0]];
            [0, 1, 2].map(|d| first[d] + 0.5 * step[d])
        }
        None => {
            // In the plane the last four corners repeat the first.
            let corners = mesh.element_points(grid, place);
            [0, 1, 2].map(|d| corners.iter().map(|p| p[d]).sum::<f64>() / 8.0)
        }
    }
}

/// The largest coefficient in the elements around each node of the subdomain, which is its weight in ρ-scaling. The
/// elements around a node act in parallel: the stiffest one determines its motion.
pub(super) fn stiffest(mesh: &SubdomainMesh) -> Vec<f64> {
    match &mesh.elements {
        SubdomainElements::Grid(grid) => places(grid.nodes())
            .map(|p| stiffest_at(mesh, grid, p))
            .collect(),
        SubdomainElements::Cells(cells) => {
            let mut out = vec![0.0_f64; mesh.points.len()];
            for ((_, nodes), rho) in cells.iter().zip(&mesh.rho) {
                for &k in nodes {
                    out[k as usize] = out[k as usize].max(*rho);
                }
            }
            out
        }
    }
}

fn stiffest_at(mesh: &SubdomainMesh, grid: &Grid, place: [usize; 3]) -> f64 {
    let counts = grid.counts();
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

/// A point of subdomain `inside` of a body, with the variables on which fields depend.
pub(super) fn at(body: &Body, inside: usize, point: [f64; 3]) -> At {
    At {
        variables: Variables {
            point,
            body: body.spec.place,
            subdomain: body.mesh().subdomain_place(inside),
        },
        subdomains: body.mesh().subdomain_counts(),
    }
}

/// The value of a field at a point of a subdomain.
pub(super) fn evaluate(body: &Body, inside: usize, field: &Field, point: [f64; 3]) -> f64 {
    field.eval(&at(body, inside, point))
}
