//! Pressure, half-width and peak from the multipliers of a solution.

use super::theory::{Contact, Pair};
use crate::fem::cell::{side_weights, Side};
use crate::scene::{Member, Scene};
use crate::study::solved::Row;

/// The pressure at a node that may touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressure {
    /// Signed distance from the middle; of a ball the radius.
    pub x: f64,
    /// Multiplier over nodal length or area.
    pub value: f64,
    /// The nodal length or area.
    pub weight: f64,
    /// Whether the node touches.
    pub active: bool,
}

/// What a solution says about the contact zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Sum of the multipliers: the force of the modelled part.
    pub force: f64,
    /// Where p² = p0² (1 − x²/a²), fitted to the pressures, ends, and its p0.
    pub fit: Contact,
    /// The last node that touches, and the largest nodal pressure.
    pub nodal: Contact,
    /// Nodes that touch.
    pub active: usize,
}

/// The nodal pressures: rows must be those of one contact between facing sides, or of one plane obstacle, around the origin.
pub fn pressures(scene: &Scene, rows: &[Row]) -> Vec<Pressure> {
    rows.iter()
        .filter(|row| row.inequality)
        .filter_map(|row| {
            let [x, _, z] = row.label.point;
            let weight = projected_area(scene, row)?;
            Some(Pressure {
                x: if scene.dim() == 2 { x } else { x.hypot(z) },
                value: row.multiplier / weight,
                weight,
                active: row.active,
            })
        })
        .collect()
}

/// ∫ N_a over the side of the row's first member, projected along the row: Hertz's pressure acts on the tangent plane.
fn projected_area(scene: &Scene, row: &Row) -> Option<f64> {
    let Member { body, node } = row.label.members[0]?;
    let body = &scene.bodies[body].spec;
    let mesh = &body.mesh;
    let (dim, place) = (mesh.dim(), mesh.place(node));
    let side = match row.label.source {
        crate::scene::RowSource::Obstacle(k) => scene.obstacles[k].side,
        crate::scene::RowSource::Interface(k) => {
            let interface = &scene.interfaces[k];
            let first = interface
                .bodies
                .iter()
                .position(|&b| row.label.members[0].is_some_and(|m| m.body == b))?;
            interface.sides[first]
        }
    };
    let geometry = Side {
        axis: side / 2,
        upper: side % 2 == 1,
    };
    let mut normal = [0.0; 3];
    // The elements on the side around the node, by their lowest corner.
    let along: Vec<usize> = (0..dim).filter(|&d| d != geometry.axis).collect();
    for step in 0..1 << along.len() {
        let mut first = place;
        if geometry.upper {
            first[geometry.axis] = mesh.elements[geometry.axis] - 1;
        }
        let mut inside = true;
        for (k, &d) in along.iter().enumerate() {
            match (step >> k & 1, first[d]) {
                (0, i) => inside &= i < mesh.elements[d],
                (_, 0) => inside = false,
                (_, i) => first[d] = i - 1,
            }
        }
        if !inside {
            continue;
        }
        let corner = |a: usize| [0, 1, 2].map(|d| first[d] + (a >> d & 1));
        let corners: Vec<usize> = geometry.corners(dim).collect();
        let points: Vec<[f64; 3]> = corners.iter().map(|&a| body.position(corner(a))).collect();
        let found = side_weights(dim, &points, geometry.outward(dim), scene.form.element);
        let here = corners.iter().position(|&a| corner(a) == place)?;
        let part = found.normal[here];
        normal.iter_mut().zip(part).for_each(|(sum, v)| *sum += v);
    }
    let along = crate::study::dot(normal, row.label.direction).abs();
    (along > 0.0).then_some(along)
}

/// Force, half-width and peak; `None` where fewer than three nodes touch.
pub fn measure(rows: &[Row], pressures: &[Pressure]) -> Option<Measured> {
    let force = rows
        .iter()
        .filter(|r| r.inequality)
        .map(|r| r.multiplier)
        .sum();
    let active: Vec<&Pressure> = pressures.iter().filter(|p| p.active).collect();
    let last = active.iter().map(|p| p.x.abs()).fold(0.0, f64::max);
    let peak = active.iter().map(|p| p.value).fold(0.0, f64::max);
    // The nodes at the edge carry the pressure of half a neighbourhood: they say nothing about the curve.
    let inner = active.iter().filter(|p| p.x.abs() < 0.999 * last);
    // Weighted least squares of p² = b − c x².
    let mut sums = [0.0; 5];
    for p in inner {
        let (w, s, y) = (p.weight, p.x * p.x, p.value * p.value);
        for (sum, term) in sums.iter_mut().zip([1.0, s, s * s, y, s * y]) {
            *sum += w * term;
        }
    }
    let [n, s, ss, y, sy] = sums;
    let det = n * ss - s * s;
    let (b, c) = ((y * ss - s * sy) / det, (s * y - n * sy) / det);
    let good = active.len() > 3 && b > 0.0 && c > 0.0;
    good.then(|| Measured {
        force,
        fit: Contact {
            a: (b / c).sqrt(),
            p0: b.sqrt(),
        },
        nodal: Contact { a: last, p0: peak },
        active: active.len(),
    })
}

/// The theory for the measured force; `share`: the whole force over the modelled one.
pub fn theory(pair: &Pair, measured: &Measured, share: f64) -> Contact {
    pair.under(share * measured.force)
}
