//! Pressure, half-width and peak from the multipliers of a solution.

use std::collections::HashMap;

use super::theory::{HertzContact, HertzPair};
use base::linalg::vec3::dot;
use fetifeti::problem::BodyNode;
use fetifeti::solution::SolvedRow;
use scene::Scene;

/// The pressure at a node that may touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodalPressure {
    /// Signed distance from the middle; for a ball, the distance from the axis.
    pub x: f64,
    /// Multiplier over nodal length or area.
    pub value: f64,
    /// The nodal length or area.
    pub weight: f64,
    /// Whether the node touches.
    pub active: bool,
}

/// The measured properties of the contact zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredContact {
    /// Sum of the multipliers: the force of the modelled part.
    pub force: f64,
    /// The half-width a and the peak p0 of the curve p² = p0² (1 − x²/a²) fitted to the pressures.
    pub fit: HertzContact,
    /// The position of the last node that touches, and the largest nodal pressure.
    pub nodal: HertzContact,
    /// Nodes that touch.
    pub active: usize,
}

/// The nodal pressures. The rows must be those of one contact between facing sides, or of one plane obstacle, around
/// the origin.
pub fn pressures(scene: &Scene, rows: &[SolvedRow]) -> Vec<NodalPressure> {
    let mut normals: HashMap<(usize, usize), HashMap<usize, [f64; 3]>> = HashMap::new();
    // The integral of N_a over the side of the row's first member, projected along the row: Hertz's pressure acts on
    // the tangent plane.
    let mut projected_area = |row: &SolvedRow| {
        let BodyNode { body, node } = row.label.members[0]?;
        let side = scene.side_of(row.label.source, body)?;
        let normals = normals.entry((body, side)).or_insert_with(|| {
            let spec = &scene.bodies[body].spec;
            spec.side_normals(side, scene.form.element, spec.faces(side))
        });
        let along = dot(*normals.get(&node)?, row.normal()).abs();
        (along > 0.0).then_some(along)
    };
    rows.iter()
        .filter(|row| row.is_inequality())
        .filter_map(|row| {
            let [x, _, z] = row.label.point;
            let weight = projected_area(row)?;
            Some(NodalPressure {
                x: if scene.dim() == 2 { x } else { x.hypot(z) },
                value: row.multiplier / weight,
                weight,
                active: row.holds(),
            })
        })
        .collect()
}

/// Force, half-width and peak; `None` where fewer than three nodes touch.
pub fn measure(rows: &[SolvedRow], pressures: &[NodalPressure]) -> Option<MeasuredContact> {
    let force = rows
        .iter()
        .filter(|r| r.is_inequality())
        .map(|r| r.multiplier)
        .sum();
    let active: Vec<&NodalPressure> = pressures.iter().filter(|p| p.active).collect();
    let last = active.iter().map(|p| p.x.abs()).fold(0.0, f64::max);
    let peak = active.iter().map(|p| p.value).fold(0.0, f64::max);
    // Nodes at the edge carry the pressure of half a neighbourhood; they are left out of the fit.
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
    good.then(|| MeasuredContact {
        force,
        fit: HertzContact {
            a: (b / c).sqrt(),
            p0: b.sqrt(),
        },
        nodal: HertzContact { a: last, p0: peak },
        active: active.len(),
    })
}

/// The theory for the measured force; `share`: the whole force over that of the modelled part.
pub fn theory(pair: &HertzPair, measured: &MeasuredContact, share: f64) -> HertzContact {
    pair.under(share * measured.force)
}
